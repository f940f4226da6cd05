#include "sim/report_sweep.h"

#include <algorithm>
#include <set>
#include <utility>

#include "sim/report_markup.h"

namespace pac::sim {

namespace {

using Text = std::string;

constexpr size_t kPlottedMetrics = 3;  // the verdict's: the first of kScores

const char* codec_title(SweepCodec codec) {
  constexpr const char* kTitles[] = {"JPEG", "Motion JPEG", "MPEG-1"};
  return kTitles[static_cast<size_t>(codec)];
}

struct Style {
  const char* name;  // of a curve
  const char* css;
};
Style style_of(SweepArm arm) {
  constexpr Style kStyles[] = {{"H itself", "image"},
                               {"polygons", "polygon"},
                               {"from L", "hue2"},
                               {"by blocks", "hue3"},
                               {"by the model", "polygon"}};
  return kStyles[static_cast<size_t>(arm)];
}

// "texture,lighting" as people read it.
Text split_text(const Text& split) {
  Text text;
  for (const char c : split) text += c == ',' ? Text(" + ") : Text(1, c);
  return text;
}

// The part of a path that tells models apart.
Text scene_text(const Text& scene) {
  const size_t slash = scene.rfind('/');
  return slash == Text::npos ? scene : scene.substr(slash + 1);
}

Text short_number(double number) {
  Text text = decimal_text(number, 2);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

// ---- plots

Text slug(const Text& text) {
  Text out;
  for (const char c : text) {
    const bool is_upper = c >= 'A' && c <= 'Z';
    const bool is_plain = is_upper || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
    if (is_plain)
      out += is_upper ? static_cast<char>(c - 'A' + 'a') : c;
    else if (!out.empty() && out.back() != '-')
      out += '-';
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out;
}

Text point_label(const SweepPoint& point) {
  const bool is_video = point.codec == SweepCodec::mpeg1;
  Text label = Text(style_of(point.arm).name) + (is_video ? ", quantizer " : ", q ") + short_number(point.setting) +
               '\n' + decimal_text(static_cast<double>(point.bytes) / point.frames, 0) + " bytes a frame";
  for (size_t kind = 0; kind < kPlottedMetrics; ++kind)
    label += Text("\n") + kScores[kind].label + " " + decimal_text(point.scores[kind].mean, kScores[kind].digits) +
             ", worst " + decimal_text(point.scores[kind].worst_5_percent, kScores[kind].digits);
  return label;
}

PlotSeries series_of(const std::vector<SweepPoint>& curve, SweepArm arm, size_t kind) {
  PlotSeries series;
  series.name = style_of(arm).name;
  series.style = style_of(arm).css;
  for (const SweepPoint& point : curve)
    series.points.push_back(
        {static_cast<double>(point.bytes) / point.frames, point.scores[kind].mean, point_label(point)});
  return series;
}

Plot rate_plot(const SweepTable& table, const SweepPoint& any, SweepCodec codec, size_t kind) {
  Plot plot;
  const Text metric = kScores[kind].label;
  plot.title = Text(codec_title(codec)) + ": " + metric;
  plot.description = metric + " against bytes a frame, " + any.scene + ", " + split_text(any.split) + " split, " +
                     codec_title(codec) + (kScores[kind].larger_is_better ? "; higher" : "; lower") + " is better";
  plot.x_label = "bytes a frame";
  plot.y_label = metric + (kScores[kind].larger_is_better ? "" : " (lower is better)");
  for (const SweepArm arm : {SweepArm::image, SweepArm::polygons, SweepArm::none, SweepArm::block, SweepArm::model}) {
    const auto curve = curve_of(table, any.scene, any.split, codec, arm);
    if (curve.empty()) continue;
    plot.series.push_back(series_of(curve, arm, kind));
    if (codec == SweepCodec::jpeg) {
      plot.top_per_x = 8.0 / (static_cast<double>(curve[0].width) * curve[0].height);
    } else {
      plot.top_label = "kb/s";
      plot.top_per_x = 8e-3 * curve[0].frames_per_second;
    }
  }
  return plot;
}

// ---- tables

// "−52.1".
Text signed_text(double number) {
  return Text(number < 0 ? "−" : "+") + decimal_text(number < 0 ? -number : number, 1);
}

Text percent_text(double percent) {
  return signed_text(percent) + " %";
}

Text cell(const Text& content, const char* attributes = "") {
  return html_tag("td", attributes, content);
}

Text table_head(const char* first) {
  Text head = html_tag("th", "scope=\"col\" class=\"letter\"", first);
  for (const ScoreKind& kind : kScores) head += html_tag("th", "scope=\"col\"", html_escaped(kind.label));
  return html_tag("thead", "",
                  html_tag("tr", "", head + html_tag("th", "scope=\"col\" class=\"letter\"", "at equal bytes"))) +
         "\n";
}

Text table_of(const char* first, const Text& label, const Text& rows) {
  return html_tag("div", Text("class=\"scroll\" tabindex=\"0\" role=\"region\" ") + html_attribute("aria-label", label),
                  html_tag("table", "class=\"table-one gains\"", table_head(first) + rows)) +
         "\n";
}

Text part_row(const Text& title) {
  const Text span = Text("colspan=\"") + std::to_string(kScoreCount + 2) + "\" scope=\"rowgroup\"";
  return html_tag("tr", "class=\"part\"", html_tag("th", span, html_escaped(title))) + "\n";
}

Text row_name(const SweepComparison& comparison) {
  return html_tag("th", "scope=\"row\"",
                  html_escaped(Text(codec_title(comparison.codec)) + ": " + comparison_text(comparison)));
}

Text soft(const Text& text) {
  return html_tag("span", "class=\"unit\"", text);
}

Text interval_cell(const std::optional<GainInterval>& mean, const std::optional<GainInterval>& worst, bool is_video) {
  if (!mean) return cell(soft("–"));
  Text content = percent_text(mean->percent);
  if (mean->n_scenes > 1) content += Text("<br>") + soft(signed_text(mean->low) + " … " + signed_text(mean->high));
  if (is_video) content += Text("<br>") + soft(worst ? "worst " + percent_text(worst->percent) : Text("worst –"));
  return cell(content, "class=\"ours\"");
}

Text counts_text(const SplitGain& gain) {
  Text text;
  const auto add = [&](int count, const char* what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + Text(what) + " in " + std::to_string(count);
  };
  add(gain.n_better, "better");
  add(gain.n_worse, "worse");
  add(gain.n_disagree, "metrics disagree");
  return text.empty() ? "no common size" : text;
}

Text summary_table(const SweepGains& gains) {
  Text rows;
  Text last;
  for (const SplitGain& gain : gains.splits) {
    if (rows.empty() || gain.split != last) rows += part_row("Split " + split_text(gain.split));
    last = gain.split;
    Text cells = row_name(gain.comparison);
    for (size_t kind = 0; kind < kScoreCount; ++kind)
      cells += interval_cell(gain.mean[kind], gain.worst[kind], gain.comparison.codec != SweepCodec::jpeg);
    rows += html_tag("tr", "", cells + cell(counts_text(gain), "class=\"note\"")) + "\n";
  }
  return table_of("Bytes at equal score", "Bytes at equal score over the scenes", html_tag("tbody", "", "\n" + rows));
}

Text verdict_of_test(const SceneGain& gain) {
  if (!gain.verdict) return "no common size";
  const Text where = " at " + decimal_text(gain.verdict_bytes, 0) + " bytes";
  if (*gain.verdict == pac::Verdict::second_better) return "better" + where;
  if (*gain.verdict == pac::Verdict::first_better) return "worse" + where;
  return Text(verdict_text(*gain.verdict)) + where;
}

Text scene_table(const SweepGains& gains, const SweepPlots& scene) {
  Text rows;
  for (const SceneGain& gain : gains.scenes) {
    if (gain.scene != scene.scene || gain.split != scene.split) continue;
    Text cells = row_name(gain.comparison);
    for (size_t kind = 0; kind < kScoreCount; ++kind) {
      Text content = gain.mean[kind] ? percent_text(*gain.mean[kind]) : soft("–");
      if (gain.comparison.codec != SweepCodec::jpeg)
        content += Text("<br>") + soft(gain.worst[kind] ? "worst " + percent_text(*gain.worst[kind]) : Text("worst –"));
      cells += cell(content, "class=\"ours\"");
    }
    rows += html_tag("tr", "", cells + cell(verdict_of_test(gain), "class=\"note\"")) + "\n";
  }
  if (rows.empty()) return "";
  return table_of("Bytes at equal score", "Bytes at equal score in this scene", html_tag("tbody", "", "\n" + rows));
}

// ---- the page

Text scene_id(size_t number) {
  return "scene-" + std::to_string(number + 1);
}

Text scene_facts(const SweepTable& table, const SweepPlots& scene) {
  const SweepPoint* still = nullptr;
  const SweepPoint* video = nullptr;
  uint64_t model_bytes = 0;
  for (const SweepPoint& point : table.points) {
    if (point.scene != scene.scene || point.split != scene.split) continue;
    (point.codec == SweepCodec::jpeg ? still : video) = &point;
    model_bytes = std::max(model_bytes, point.resident_model_bytes);
  }
  const SweepPoint* any = video != nullptr ? video : still;
  if (any == nullptr) return "";
  Text text = std::to_string(any->width) + " x " + std::to_string(any->height) + " pixels";
  if (video != nullptr)
    text += ", " + std::to_string(video->frames) + (video->frames == 1 ? " frame" : " frames") + " at " +
            std::to_string(video->frames_per_second) + " a second";
  if (model_bytes > 0)
    text += ". The client holds a model of " + decimal_text(static_cast<double>(model_bytes), 0) +
            " bytes, which no curve charges";
  return html_tag("p", "", html_escaped(text) + ".");
}

Text scene_section(const SweepTable& table, const SweepGains& gains, const SweepPlots& scene, size_t number) {
  Text plots;
  for (const Plot& plot : scene.plots)
    plots += html_tag("figure", "", html_tag("p", "", html_escaped(plot.title)) + plot_svg(plot)) + "\n";
  return html_section(
      scene_id(number), "Split " + split_text(scene.split), scene_text(scene.scene),
      scene_facts(table, scene) + html_tag("div", "class=\"plots\"", "\n" + plots) + scene_table(gains, scene));
}

// The strongest claim first, with its counterpart of every other metric in the table below.
Text highlights(const SweepGains& gains) {
  constexpr size_t kMost = 4;
  Text items;
  size_t count = 0;
  for (const SplitGain& gain : gains.splits) {
    if (!gain.mean[0] || gain.comparison.test == SweepArm::none || count == kMost) continue;
    ++count;
    const int n = gain.mean[0]->n_scenes;
    const Text what = Text("bytes of ") + codec_title(gain.comparison.codec) + ", " + comparison_text(gain.comparison) +
                      ", at equal SSIMULACRA 2; split " + split_text(gain.split) + ", " + std::to_string(n) +
                      (n == 1 ? " scene." : " scenes.");
    items += html_tag("div", "",
                      html_tag("dt", "", percent_text(gain.mean[0]->percent)) + html_tag("dd", "", html_escaped(what)));
  }
  return items.empty() ? "" : html_tag("dl", "class=\"highlights\"", items);
}

Text masthead(const SweepTable& table, const SweepGains& gains) {
  const Text words =
      html_tag("p", "class=\"kicker\"", "polygon-assisted compression") + html_tag("h1", "", "Rate and distortion") +
      html_tag(
          "p", "class=\"lede\"",
          Text("Every curve is one way to code the same frames H: by the codec alone, or with polygons drawn by the "
               "client and the difference coded. ") +
              decimal_text(static_cast<double>(table.points.size()), 0) +
              " measurements; bytes of everything sent, first picture, headers and packets included.");
  return html_tag(
             "header", "class=\"masthead\"",
             html_tag("div", "class=\"wrap\"", html_tag("div", "class=\"words\"", "\n" + words) + highlights(gains))) +
         "\n";
}

Text contents(const std::vector<SweepPlots>& scenes, bool has_gains) {
  Text links;
  const auto link = [&](const Text& id, const Text& text) {
    links += html_tag("a", "href=\"#" + id + "\"", html_escaped(text)) + "\n";
  };
  if (has_gains) link("gains", "Bytes at equal score");
  for (size_t i = 0; i < scenes.size(); ++i)
    link(scene_id(i), scene_text(scenes[i].scene) + ", " + split_text(scenes[i].split));
  link("methods", "Methods");
  return html_tag("nav", "class=\"contents\" aria-label=\"Contents\"",
                  html_tag("div", "class=\"wrap\"", "\n" + links)) +
         "\n";
}

Text gains_section(const SweepGains& gains) {
  return html_section(
      "gains", "", "Bytes at equal score",
      html_tag("p", "",
               "Percent of bytes that the first of each pair takes more (+) or fewer (−) than the second, over all "
               "scores that both curves reach; geometric mean over the scenes and, below it, its 95\u00a0% interval. "
               "“Worst” is "
               "the same of the worst 5\u00a0% of the frames. The last column asks at equal bytes: better only where "
               "SSIMULACRA 2 (by more than 2 points), FLIP and PSNR-HVS-M agree, on mean and worst frames.") +
          "\n" + summary_table(gains));
}

Text methods_section(const SweepTable& table) {
  constexpr const char* kMethods[] = {
      "Scores compare what a viewer sees, in RGB, with H. A curve’s score is the mean over the frames.",
      "Bytes at equal score: Bjontegaard’s difference with monotone cubic interpolation of the logarithm of bytes. “–” "
      "where the "
      "curves share no range of scores.",
      "95 % intervals: bootstrap over scenes, 10,000 resamples, percentiles. They answer for more scenes like these, "
      "and "
      "are narrow beyond reason where there are few.",
      "At equal bytes: scores interpolated at the middle, in logarithms, of the sizes that both curves reach.",
      "JPEG: optimal Huffman codes and 4:2:0 on both arms; the quality of D is given as the tables would treat H, the "
      "division "
      "by two undone. MPEG-1: one quantizer a curve’s point, I and P pictures; key pictures of model prediction are "
      "finer."};
  Text items;
  for (const char* method : kMethods) items += html_tag("li", "", method) + "\n";
  return html_section("methods", "", "Methods",
                      html_tag("ul", "class=\"plain\"", "\n" + items) +
                          Text("<p>For machines: <a href=\"sweep.csv\">sweep.csv</a>, every point; <a "
                               "href=\"gains.csv\">gains.csv</a>, every difference; <a "
                               "href=\"times.csv\">times.csv</a>, milliseconds.</p>") +
                          html_tag("h3", "", "To reproduce") +
                          html_tag("pre", "", html_escaped("pac sweep " + table.plan + " -o sweep")));
}

}  // namespace

std::vector<SweepPlots> sweep_plots(const SweepTable& table) {
  std::vector<SweepPlots> all;
  std::set<Text> ids;
  for (const SweepPoint& point : table.points) {
    const bool is_known = std::any_of(all.begin(), all.end(), [&](const SweepPlots& one) {
      return one.scene == point.scene && one.split == point.split;
    });
    if (is_known) continue;
    SweepPlots scene{point.scene, point.split, {}};
    for (const SweepCodec codec : {SweepCodec::jpeg, SweepCodec::mjpeg, SweepCodec::mpeg1})
      for (size_t kind = 0; kind < kPlottedMetrics; ++kind) {
        Plot plot = rate_plot(table, point, codec, kind);
        if (plot.series.empty()) continue;
        const Text wanted =
            slug(scene_text(point.scene) + "-" + point.split + "-" + sweep_codec_name(codec) + "-" + kScores[kind].key);
        plot.id = wanted;
        for (int n = 2; !ids.insert(plot.id).second; ++n) plot.id = wanted + "-" + std::to_string(n);
        scene.plots.push_back(std::move(plot));
      }
    all.push_back(std::move(scene));
  }
  return all;
}

std::string plot_svg_file(const Plot& plot) {
  constexpr std::string_view kStart = "<svg ";
  Text svg = plot_svg(plot);
  PAC_ASSERT(svg.starts_with(kStart));
  svg.insert(kStart.size(), "xmlns=\"http://www.w3.org/2000/svg\" ");
  constexpr const char* kStyle =
      "<style>svg{background:#fdfcf8;font-family:system-ui,sans-serif}text{fill:#1c1b19;font-size:12px}"
      ".tick,.note{fill:#5d5a54;font-size:11.5px}.middle{text-anchor:middle}.end{text-anchor:end}"
      ".grid{stroke:#eeebe3}.faint{opacity:.55}.frame{fill:none;stroke:#5d5a54}"
      ".series path{fill:none;stroke:currentColor;stroke-width:2.2}"
      ".series polygon,.series circle{fill:currentColor;stroke:#fdfcf8}"
      ".image,.hue1{color:#b3560b}.polygon,.hue0{color:#1a5fb0}.hue2{color:#6a4c93}.hue3{color:#2a6f3c}"
      ".hue4{color:#c2185b}.hue5{color:#0b8f9e}.hue6{color:#5d5a54}"
      ".zero{stroke:#1c1b19;stroke-width:1.2}.mark{stroke:#a61e4d;stroke-dasharray:2 3}"
      ".series.wide path{stroke-width:3.6}.series.dashed path{stroke-dasharray:7 4}.series.dotted "
      "path{stroke-dasharray:2 3}"
      ".series.bare .point{display:none}</style>";
  svg.insert(svg.find('>') + 1, kStyle);
  return Text("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") + svg;
}

std::string sweep_html(const SweepTable& table, const SweepGains& gains, const std::vector<SweepPlots>& plots) {
  Text main;
  if (!gains.splits.empty()) main += gains_section(gains);
  for (size_t i = 0; i < plots.size(); ++i) main += scene_section(table, gains, plots[i], i);
  main += methods_section(table);
  return html_page("Rate and distortion", masthead(table, gains) + contents(plots, !gains.splits.empty()), main,
                   "Made by pac sweep. Nothing on this page is loaded from anywhere.");
}

}  // namespace pac::sim
