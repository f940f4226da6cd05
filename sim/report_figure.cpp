#include "sim/report_figure.h"

#include <algorithm>
#include <cmath>

#include "sim/report_markup.h"

namespace pac::sim {
namespace {

constexpr int kEnlargedSide = 128;  // pixels of a picture that an enlargement shows

std::string arm_name(ArmKind kind) {
  return kind == ArmKind::image_based ? "Image-based" : "Polygon-assisted";
}

std::string arm_alt(const Renderings& renderings, const Arm& arm, ArmKind kind) {
  const std::string how = kind == ArmKind::image_based ? "The high-quality rendering after JPEG"
                                                       : "The low-quality rendering plus the decoded difference image";
  return how + " at quality " + short_quality(arm.coded.quality) + ", " + renderings.split.name + " split";
}

// Sums of squared differences over cells of 8 x 8 pixels, row by row.
struct ErrorCells {
  static constexpr int kSide = 8;
  int columns = 0, rows = 0;
  std::vector<int64_t> sums;

  ErrorCells(ConstRgbView reference, ConstRgbView test)
      : columns(reference.width / kSide),
        rows(reference.height / kSide),
        sums(static_cast<size_t>(columns) * static_cast<size_t>(rows)) {
    for (int y = 0; y < rows * kSide; ++y)
      for (int x = 0; x < columns * kSide; ++x)
        for (int c = 0; c < 3; ++c) {
          const int difference = reference.pixel(x, y)[c] - test.pixel(x, y)[c];
          at(x / kSide, y / kSide) += difference * difference;
        }
  }
  int64_t& at(int column, int row) {
    return sums[static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)];
  }
  int64_t sum(int column, int row, int width, int height) {
    int64_t total = 0;
    for (int y = row; y < row + height; ++y)
      for (int x = column; x < column + width; ++x) total += at(x, y);
    return total;
  }
};

}  // namespace

std::string short_quality(double quality) {
  const std::string text = decimal_text(quality, 1);
  return text.ends_with(".0") ? text.substr(0, text.size() - 2) : text;
}

std::string quality_text(const Arm& arm, ArmKind kind) {
  std::string text = std::string("q ") + short_quality(arm.coded.quality);
  if (kind == ArmKind::polygon_assisted)
    text += std::string(" (") + short_quality(arm.coded.equivalent_quality) + " with the division by two undone)";
  return text;
}

std::string size_text(const Arm& arm) {
  return decimal_text(static_cast<double>(arm.total_bytes), 0) + " bytes, " + decimal_text(arm.compression_ratio, 0) +
         ":1";
}

std::string scores_text(const Scores& scores) {
  return std::string("rms ") + decimal_text(scores.rms, 2) + ", PSNR " + decimal_text(scores.psnr_db, 2) +
         " dB, SSIM " + decimal_text(scores.ssim, 4);
}

Place worst_place(ConstRgbView reference, ConstRgbView test, int size) {
  ErrorCells cells(reference, test);
  const int width = std::min(size / ErrorCells::kSide, cells.columns);
  const int height = std::min(size / ErrorCells::kSide, cells.rows);
  Place worst;
  int64_t most = -1;
  for (int row = 0; row + height <= cells.rows; ++row)
    for (int column = 0; column + width <= cells.columns; ++column) {
      const int64_t sum = cells.sum(column, row, width, height);
      if (sum <= most) continue;
      most = sum;
      worst = {column * ErrorCells::kSide, row * ErrorCells::kSide};
    }
  return worst;
}

FigureBuilder::FigureBuilder(std::string key, std::string number, std::string title, std::vector<ReportImage>& images)
    : key_(std::move(key)), images_(images) {
  figure_.id = key_;
  figure_.number = std::move(number);
  figure_.title = std::move(title);
}

ReportPicture& FigureBuilder::add_picture(const std::string& name, ConstRgbView image) {
  if (figure_.rows.empty()) figure_.rows.emplace_back();
  ReportPicture& picture = figure_.rows.back().pictures.emplace_back();
  picture.id = id_of(name);
  picture.file = picture.id + ".png";
  picture.width = image.width;
  picture.height = image.height;
  images_.push_back({picture.file, image});
  return picture;
}

void FigureBuilder::begin_row(const std::string& label) {
  figure_.rows.emplace_back().label = label;
}

void FigureBuilder::add_renderings(const Renderings& renderings, const std::string& high_label,
                                   const std::string& low_label, const std::string& difference_label) {
  const auto entropy = [](const Entropies& entropies) {
    return std::string("entropy ") + decimal_text(entropies.mean_rgb, 2) + " bits a sample (luma " +
           decimal_text(entropies.luma, 2) + ", joint RGB " + decimal_text(entropies.joint_rgb, 2) + ")";
  };
  const auto polygons = [](uint64_t count) { return decimal_text(static_cast<double>(count), 0) + " polygons"; };
  const auto add = [&](const char* name, const RgbImage& image, const std::string& label, const char* title,
                       const std::string& caption, const Entropies& entropies, const char* alt) {
    ReportPicture& picture = add_picture(name, image.view());
    picture.label = label;
    picture.title = title;
    picture.caption = caption;
    picture.details = entropy(entropies);
    picture.alt = alt;
  };
  add("h", renderings.high, high_label, "High-quality rendering H", polygons(renderings.high_polygons),
      renderings.high_entropy, "The high-quality rendering");
  add("l", renderings.low, low_label, "Low-quality rendering L", polygons(renderings.low_polygons),
      renderings.low_entropy, "The low-quality rendering");
  const std::string lower = std::string("entropy ") + decimal_text(renderings.high_entropy.mean_rgb, 2) + " → " +
                            decimal_text(renderings.difference_entropy.mean_rgb, 2) + " bits";
  add("d", renderings.difference, difference_label, "Difference image D", lower, renderings.difference_entropy,
      "The difference image: gray where both renderings agree");
}

void FigureBuilder::add_arm(const Renderings& renderings, const Arm& arm, ArmKind kind, const std::string& label,
                            const std::string& name) {
  ReportPicture& picture = add_picture(name, arm.shown.view());
  picture.label = label;
  picture.title = arm_name(kind) + ", q\u00a0" + short_quality(arm.coded.quality);
  picture.caption = size_text(arm);
  picture.details = quality_text(arm, kind) + "\n" + scores_text(arm.scores) + "\n" +
                    decimal_text(static_cast<double>(arm.total_bytes) * 8 * 20 / 1e6, 2) +
                    " Mb/s at 20 frames a second (" + decimal_text(100 * arm.budget_share, 0) + " % of 2 Mb/s)";
  if (arm.model_bytes > 0)
    picture.details +=
        std::string("\nof it the model: ") + decimal_text(static_cast<double>(arm.model_bytes), 0) + " bytes";
  picture.alt = arm_alt(renderings, arm, kind);
  picture.arm = kind == ArmKind::image_based ? PictureArm::image_based : PictureArm::polygon_assisted;
}

void FigureBuilder::add_enlargement(const Renderings& renderings, const Arm& image_based, const Arm& polygon_assisted,
                                    ArmKind kind) {
  const bool image = kind == ArmKind::image_based;
  const RgbImage& worse = image ? image_based.shown : polygon_assisted.shown;
  const Place place = worst_place(renderings.high.view(), worse.view(), kEnlargedSide);
  for (const char* name : {"h", "image", "polygon"}) {
    ReportCrop& crop = figure_.crops.emplace_back();
    crop.picture_id = id_of(name);
    crop.caption = image ? "where the image-based picture is worst" : "where the polygon-assisted picture is worst";
    crop.x = place.x;
    crop.y = place.y;
    crop.width = std::min(kEnlargedSide, renderings.high.width());
    crop.height = std::min(kEnlargedSide, renderings.high.height());
  }
}

void FigureBuilder::set_wipe(const std::string& left, const std::string& right) {
  figure_.wipe_left = id_of(left);
  figure_.wipe_right = id_of(right);
}

}  // namespace pac::sim
