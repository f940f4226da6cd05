#include "sim/report_animations.h"

#include <optional>

#include "sim/report_markup.h"

namespace pac::sim {
namespace {

struct ArmText {
  const char *key, *name, *style;  // of files, of captions and plots, of curves (CSS class)
  bool assisted;
};

constexpr ArmText kArms[kAnimationArmCount] = {
    {"mjpeg", "motion JPEG", "hue6", false},
    {"mjpeg-assisted", "polygon-assisted motion JPEG", "hue5", true},
    {"mpeg1", "MPEG-1", "hue1", false},
    {"mpeg1-assisted", "polygon-assisted MPEG-1", "hue0", true},
    {"mpeg1-predicted", "polygon-assisted MPEG-1, predicted by the model", "hue2", true}};

const ArmText& text_of(AnimationArm arm) {
  return kArms[static_cast<size_t>(arm)];
}

double kilobits_a_second(const AnimationSet& set, const VideoArm& arm) {
  return 8e-3 * static_cast<double>(arm.bytes) * set.frames_per_second / set.frames;
}

double mean_of(const VideoArm& arm, size_t kind) {
  std::vector<FrameScores> scores;
  for (const ArmFrame& frame : arm.frames) scores.push_back(frame.scores);
  return summarize(scores, kind).mean;
}

std::string score_text(const VideoArm& arm, size_t kind) {
  return std::string(kScores[kind].label) + " " + decimal_text(mean_of(arm, kind), kScores[kind].digits);
}

std::string size_text(const AnimationSet& set, const VideoArm& arm) {
  return decimal_text(kilobits_a_second(set, arm), 0) + " kb/s, " + decimal_text(static_cast<double>(arm.bytes), 0) +
         " bytes";
}

ReportPicture film(const AnimationSet& set, const RgbImage& strip, const std::string& key, const std::string& title,
                   std::vector<ReportImage>& images) {
  ReportPicture picture;
  picture.id = set.key + "-" + key;
  picture.file = "animation-" + picture.id + ".png";
  picture.title = title;
  picture.alt = set.title + ": " + title + ", playing";
  picture.width = set.width;
  picture.height = set.height;
  picture.frames = set.frames;
  picture.frames_per_second = set.frames_per_second;
  images.push_back({picture.file, strip.view()});
  return picture;
}

ReportPicture arm_film(const AnimationSet& set, AnimationArm arm, std::vector<ReportImage>& images) {
  const ArmText& text = text_of(arm);
  const AnimationCurve& curve = set.curves[static_cast<size_t>(arm)];
  const VideoArm& shown = curve.points[kShownRate].arm;
  ReportPicture picture = film(set, curve.film, text.key, text.name, images);
  picture.caption = size_text(set, shown) + ", " + score_text(shown, 0);
  picture.arm = text.assisted ? PictureArm::polygon_assisted : PictureArm::image_based;
  return picture;
}

// What a polygon-assisted coder, or MPEG-1 instead of motion JPEG, saves: by each metric of the verdict.
ReportFinding saving(const AnimationSet& set, const char* claim, Verdict as_claimed, AnimationArm reference,
                     AnimationArm test) {
  ReportFinding finding;
  finding.claim = claim;
  const AnimationCurve &a = set.curves[static_cast<size_t>(reference)], &b = set.curves[static_cast<size_t>(test)];
  bool all = true, none = true;
  for (size_t kind = 0; kind < 3; ++kind) {
    const std::optional<double> percent = bytes_saved_percent(a, b, kind);
    finding.ours += finding.ours.empty() ? "At equal " : "; at equal ";
    finding.ours += kScores[kind].label;
    if (!percent) {
      finding.ours += " no figure, as the curves share no quality";
      continue;
    }
    (*percent > 0 ? none : all) = false;
    finding.ours += std::string(*percent > 0 ? " " : " −") + decimal_text(*percent > 0 ? *percent : -*percent, 0) +
                    " % of the bytes saved";
  }
  finding.ours += std::string(", ") + text_of(test).name + " against " + text_of(reference).name +
                  (all || none ? "." : "; metrics disagree.");
  if (as_claimed == Verdict::agrees)
    finding.verdict = all ? Verdict::agrees : none ? Verdict::against : Verdict::differs;
  return finding;
}

std::vector<ReportFinding> conclusions(const AnimationSet& set) {
  return {saving(set, "MPEG-1 looks better than motion JPEG even at higher compression (section 3)", Verdict::agrees,
                 AnimationArm::mjpeg, AnimationArm::mpeg1),
          saving(set, "polygon-assisted motion JPEG looks better than motion JPEG (section 3)", Verdict::agrees,
                 AnimationArm::mjpeg, AnimationArm::mjpeg_assisted),
          saving(set, "polygon-assisted MPEG-1 looks better than MPEG-1 (section 3)", Verdict::agrees,
                 AnimationArm::mpeg1, AnimationArm::mpeg1_assisted),
          saving(set, "the model predicts the next picture", Verdict::none, AnimationArm::mpeg1,
                 AnimationArm::mpeg1_predicted)};
}

std::vector<ReportLink> stream_files(const AnimationSet& set) {
  std::vector<ReportLink> files;
  for (const AnimationStreams& streams : set.streams) {
    const std::string folder = streams_folder(set, streams) + "/";
    const std::string assisted = text_of(streams.assisted).name;
    if (streams.codec == VideoCodec::mjpeg) {
      files.push_back({"motion JPEG of H (ffplay, VLC)", folder + "image.mjpeg"});
      files.push_back({"motion JPEG of D", folder + "difference.mjpeg"});
    } else {
      if (streams.assisted == AnimationArm::mpeg1_assisted) {
        files.push_back({"MPEG-1 of H (ffplay, VLC, any player of MPEG-1)", folder + "image.m1v"});
        files.push_back({"the same in an MPEG-1 system stream", folder + "image.mpg"});
      }
      files.push_back({"MPEG-1 pictures of the difference, " + assisted, folder + "difference.m1v"});
    }
    files.push_back({"model and frame packets, " + assisted, folder + "session.pacs"});
  }
  return files;
}

void add_set(const AnimationSet& set, IllustratedReport& page) {
  ReportFigure figure;
  figure.id = set.key;
  figure.number = set.key;
  figure.title = set.title;
  figure.paragraphs = {std::to_string(set.frames) + " frames at " + std::to_string(set.frames_per_second) +
                       " a second, split " + set.split.name +
                       ". Each polygon-assisted sequence has the bytes of the image-based one of its codec; the last "
                       "one, too, has those of MPEG-1."};
  ReportRow first{"H, and both codecs of it", {film(set, set.high_film, "h", "H", page.images)}};
  first.pictures[0].caption = "what the server renders";
  ReportRow second{"Polygon-assisted, in the bytes of the films above", {}};
  for (size_t arm = 0; arm < kAnimationArmCount; ++arm)
    (kArms[arm].assisted ? second : first)
        .pictures.push_back(arm_film(set, static_cast<AnimationArm>(arm), page.images));
  figure.rows = {std::move(first), std::move(second)};
  figure.findings = conclusions(set);
  figure.files = stream_files(set);
  page.report.figures.push_back(std::move(figure));
}

// points_of(arm, name): of that arm's series.
template <class PointsOf>
Plot plot_of_arms(const AnimationSet& set, size_t kind, const char* id, const char* title, const char* description,
                  PointsOf&& points_of) {
  Plot plot;
  plot.id = "plot-" + set.key + id + kScores[kind].key;
  plot.title = set.key + ": " + kScores[kind].label + title;
  plot.description = std::string(kScores[kind].label) + description;
  plot.y_label = kScores[kind].label;
  for (size_t arm = 0; arm < kAnimationArmCount; ++arm)
    plot.series.push_back(
        {kArms[arm].name, kArms[arm].style, points_of(set.curves[arm], std::string(kArms[arm].name))});
  return plot;
}

Plot rate_plot(const AnimationSet& set, size_t kind) {
  const auto points_of = [&](const AnimationCurve& curve, const std::string& name) {
    std::vector<PlotPoint> points;
    for (size_t i = curve.points.size(); i-- > 0;) {  // from the coarsest, the fewest bytes
      const VideoArm& arm = curve.points[i].arm;
      points.push_back({kilobits_a_second(set, arm), mean_of(arm, kind),
                        name + "\n" + size_text(set, arm) + "\n" + score_text(arm, kind)});
    }
    return points;
  };
  Plot plot = plot_of_arms(set, kind, "-", " over the bit rate", ", mean over the frames, against kilobits a second",
                           points_of);
  plot.x_label = "kb/s";
  return plot;
}

// Of the films shown.
Plot frame_plot(const AnimationSet& set, size_t kind) {
  const auto points_of = [&](const AnimationCurve& curve, const std::string& name) {
    std::vector<PlotPoint> points;
    for (const ArmFrame& frame : curve.points[kShownRate].arm.frames)
      points.push_back({static_cast<double>(points.size()), frame.scores[kind],
                        name + ", frame " + std::to_string(points.size()) + "\n" +
                            decimal_text(static_cast<double>(frame.bytes), 0) + " bytes, " +
                            decimal_text(frame.scores[kind], kScores[kind].digits)});
    return points;
  };
  Plot plot = plot_of_arms(set, kind, "-frames-", " frame by frame", " of every frame of the films above", points_of);
  plot.x_label = "frame";
  plot.top_label.clear();
  plot.log_x = false;
  return plot;
}

}  // namespace

std::string streams_folder(const AnimationSet& set, const AnimationStreams& streams) {
  return "animations/" + set.key + "-" + text_of(streams.assisted).key;
}

IllustratedReport animations_report(const std::vector<AnimationSet>& sets) {
  IllustratedReport page;
  Report& report = page.report;
  report.title = "Polygon-assisted motion JPEG and MPEG-1";
  report.subtitle = "Marc Levoy’s animations of 1995, run again";
  report.abstract = {
      "Levoy compared animations by eye: MPEG-1 looked better than motion JPEG, and polygon assistance made both "
      "better. Here the sequences are coded at four rates each, both arms of a pair in the same bytes, and measured."};
  for (const AnimationSet& set : sets) add_set(set, page);
  report.plot_paragraphs = {
      "Means over the frames, by three metrics: SSIMULACRA 2 and PSNR-HVS-M are better when larger, FLIP when smaller. "
      "“Better” is said only where the three agree."};
  for (const AnimationSet& set : sets) {
    for (size_t kind = 0; kind < 3; ++kind) report.plots.push_back(rate_plot(set, kind));
    report.plots.push_back(frame_plot(set, 0));
  }
  report.methods = {
      "Both codecs are our own; MPEG-1 has one intra picture, then predicted ones. Polygon-assisted bytes are whole "
      "packets: header, camera, picture.",
      "Polygon-assisted MPEG-1 codes D = 127 + (H − L)/2 as the paper did, with block matching. “Predicted by the "
      "model” codes H against L plus the difference of the frame before, moved by the model’s own motion; a player of "
      "MPEG-1 cannot show that stream alone.",
      "Bytes saved: the Bjontegaard difference over the qualities that both curves reach.",
      "The films are the decoded frames, in PNG files as tall as they are long; the page moves them by its style "
      "sheet. "
      "20 frames a second is no legal picture_rate: the .m1v and .mpg files say 23.976 and repeat pictures."};
  report.command_lines = {"pac demo -o out", "pac animate room --codec mpeg1 --prediction block -o room-mpeg1",
                          "pac animate cubes --objects moving --codec mpeg1 -o cubes-predicted"};
  report.pages = {{"The stills", "index.html"}};
  report.footer = "After M. Levoy, Polygon-Assisted JPEG and MPEG Compression of Synthetic Images, Proc. SIGGRAPH 95.";
  return page;
}

}  // namespace pac::sim
