#include "sim/table1.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>

#include "sim/json.h"

namespace pac::sim {

namespace {

// The paper's figures, room then pin; a negative one is a figure that the paper does not give.
struct PaperFigures {
  double high_polygons, width, height, high_entropy, low_polygons, difference_entropy;
  double image_quality, image_bytes, image_ratio, image_rms;
  double assisted_quality, assisted_bytes, assisted_ratio, assisted_rms;
  double model_bytes, total_bytes, total_ratio;
};
constexpr PaperFigures kRoom = {1131, 512, 512, 5.8, 1131, 3.0, 15, 9836, 80, 6.1, 41, 9759, 81, 7.5, 3770, 13529, 58};
constexpr PaperFigures kPin = {75467, 320, 800,  3.0, 3153, 1.3,   15,    6030, 127,
                               4.1,   55,  5955, 129, 2.9,  10510, 16465, 47};

const PaperFigures* paper_figures(const std::string& scene) {
  if (scene == "room") return &kRoom;
  if (scene == "pin") return &kPin;
  return nullptr;
}

// Fills a column row by row.
class RowWriter {
 public:
  RowWriter(Table1Column& column, const PaperFigures* paper) : column_(column), paper_(paper) {}

  void row(char section, const char* key, const char* label, const char* unit, int decimals,
           double PaperFigures::*paper, double ours, const char* note = "") {
    Table1Row row{section, key, label, unit, decimals, std::nullopt, ours, note};
    if (paper_ != nullptr && paper != nullptr) row.paper = paper_->*paper;
    column_.rows.push_back(row);
  }

 private:
  Table1Column& column_;
  const PaperFigures* paper_;
};

constexpr const char* kEntropyNote =
    "the paper does not define it; ours is the first-order entropy of luma, other definitions below";

void add_renderings(RowWriter& out, const Renderings& r) {
  using P = PaperFigures;
  out.row('A', "high_polygons", "number of polygons", "polygons", 0, &P::high_polygons,
          static_cast<double>(r.high_polygons));
  out.row('A', "width", "width", "pixels", 0, &P::width, r.high.width());
  out.row('A', "height", "height", "pixels", 0, &P::height, r.high.height());
  out.row('A', "high_entropy", "entropy", "bits/pixel", 2, &P::high_entropy, r.high_entropy.luma, kEntropyNote);
  out.row('A', "high_entropy_mean_rgb", "entropy, mean of R, G, B", "bits/sample", 2, nullptr, r.high_entropy.mean_rgb);
  out.row('A', "high_entropy_joint_rgb", "entropy of whole pixels", "bits/pixel", 2, nullptr, r.high_entropy.joint_rgb);
  out.row('B', "low_polygons", "number of polygons", "polygons", 0, &P::low_polygons,
          static_cast<double>(r.low_polygons));
  out.row('C', "difference_entropy", "entropy", "bits/pixel", 2, &P::difference_entropy, r.difference_entropy.luma,
          kEntropyNote);
  out.row('C', "difference_entropy_mean_rgb", "entropy, mean of R, G, B", "bits/sample", 2, nullptr,
          r.difference_entropy.mean_rgb);
  out.row('C', "difference_entropy_joint_rgb", "entropy of whole pixels", "bits/pixel", 2, nullptr,
          r.difference_entropy.joint_rgb);
}

void add_image_based(RowWriter& out, const Arm& arm) {
  using P = PaperFigures;
  out.row('D', "image_quality", "JPEG quality factor", "", 1, &P::image_quality, arm.coded.quality);
  out.row('D', "image_bytes", "JPEG code size", "bytes/frame", 0, &P::image_bytes,
          static_cast<double>(arm.image_bytes));
  out.row('D', "image_ratio", "compression ratio", ":1", 0, &P::image_ratio, arm.compression_ratio);
  out.row('D', "image_rms", "error versus uncompressed (rms)", "levels", 1, &P::image_rms, arm.scores.rms);
  out.row('D', "image_ssim", "structural similarity", "", 4, nullptr, arm.scores.ssim);
  out.row('D', "image_optimal_huffman_bytes", "code size with optimal Huffman codes", "bytes/frame", 0, nullptr,
          static_cast<double>(arm.optimal_huffman_bytes));
  out.row('D', "image_budget_share", "share of 2 Mb/s at 20 frames/s", "%", 0, nullptr, 100 * arm.budget_share);
}

void add_assisted(RowWriter& out, const Arm& arm) {
  using P = PaperFigures;
  out.row('E', "assisted_quality", "JPEG quality factor", "", 1, &P::assisted_quality, arm.coded.quality,
          "of the tables in the file, which the division by two has halved");
  out.row('E', "assisted_equivalent_quality", "the same, division by two undone", "", 1, nullptr,
          arm.coded.equivalent_quality, "the paper's 41 and 55 are 20.5 and 27.8 so");
  out.row('E', "assisted_bytes", "JPEG code size", "bytes/frame", 0, &P::assisted_bytes,
          static_cast<double>(arm.image_bytes));
  out.row('E', "assisted_ratio", "compression ratio", ":1", 0, &P::assisted_ratio, arm.compression_ratio);
  out.row('E', "assisted_rms", "error versus uncompressed (rms)", "levels", 1, &P::assisted_rms, arm.scores.rms);
  out.row('E', "assisted_ssim", "structural similarity", "", 4, nullptr, arm.scores.ssim);
  out.row('E', "assisted_optimal_huffman_bytes", "code size with optimal Huffman codes", "bytes/frame", 0, nullptr,
          static_cast<double>(arm.optimal_huffman_bytes));
}

void add_transmitted(RowWriter& out, const Still& still) {
  using P = PaperFigures;
  const Arm& arm = still.polygon_assisted;
  const Renderings& r = still.renderings;
  out.row('F', "transmitted_image_bytes", "JPEG code size", "bytes/frame", 0, &P::assisted_bytes,
          static_cast<double>(arm.image_bytes),
          "the paper repeats row E's; ours is coded again, against L drawn from the decoded 16-bit vertices");
  out.row('F', "transmitted_model_bytes", "model size", "bytes/frame", 0, &P::model_bytes,
          static_cast<double>(arm.model_bytes),
          "the paper estimates 10/3 bytes a polygon without connectivity; ours is measured, connectivity included");
  out.row('F', "transmitted_model_estimate", "model size by the paper's estimate", "bytes/frame", 0, &P::model_bytes,
          r.estimated_model_bytes);
  out.row('F', "transmitted_polygons", "polygons sent", "polygons", 0, nullptr,
          static_cast<double>(r.visible_low_polygons), "those that the view does not clip away");
  out.row('F', "transmitted_bytes_per_polygon", "model size a polygon sent", "bytes", 2, nullptr,
          r.visible_low_polygons > 0
              ? static_cast<double>(arm.model_bytes) / static_cast<double>(r.visible_low_polygons)
              : 0);
  out.row('F', "transmitted_total_bytes", "total size", "bytes/frame", 0, &P::total_bytes,
          static_cast<double>(arm.total_bytes));
  out.row('F', "transmitted_ratio", "compression ratio", ":1", 0, &P::total_ratio, arm.compression_ratio);
  out.row('F', "transmitted_rms", "error versus uncompressed (rms)", "levels", 1, nullptr, arm.scores.rms);
  out.row('F', "transmitted_ssim", "structural similarity", "", 4, nullptr, arm.scores.ssim);
  out.row('F', "transmitted_budget_share", "share of 2 Mb/s at 20 frames/s", "%", 0, nullptr, 100 * arm.budget_share,
          "over 100 % in the paper's table too, which it does not say");
  out.row('F', "same_size_image_quality", "quality of image-based JPEG at the total size", "", 1, nullptr,
          still.image_based.coded.quality);
  out.row('F', "same_size_image_ssim", "its structural similarity", "", 4, nullptr, still.image_based.scores.ssim);
}

bool within_one_percent(uint64_t a, uint64_t b) {
  return std::fabs(static_cast<double>(a) - static_cast<double>(b)) <= 0.01 * static_cast<double>(b);
}

std::vector<Table1Claim> check_claims(const std::string& scene, const Still& still, const Still& transmitted) {
  const Renderings& r = still.renderings;
  const Arm& image = still.image_based;
  const Arm& assisted = still.polygon_assisted;
  const Arm& sent = transmitted.polygon_assisted;
  const double needed = coded_quality(image.coded.quality, Content::difference);
  std::vector<Table1Claim> claims = {
      {"entropy_falls", "the difference image has less entropy than the high-quality rendering", true,
       r.difference_entropy.luma < r.high_entropy.luma},
      {"sizes_match", "both arms' code sizes agree within 1 %", true,
       within_one_percent(assisted.image_bytes, image.image_bytes)},
      {"fits_budget", "image-based compression at this quality fits 2 Mb/s at 20 frames/s", true,
       image.budget_share <= 1},
      {"quality_beyond_halving", "the difference image gets a higher quality than the division by two requires", true,
       assisted.coded.quality > needed},
      {"quality_twice", "its quality factor is at least twice that of image-based compression", true,
       assisted.coded.quality >= 2 * image.coded.quality},
      {"rms_lower", "polygon-assisted compression has the lower rms error", scene != "room",
       assisted.scores.rms < image.scores.rms},
      {"looks_better", "polygon-assisted compression looks better (ours: higher structural similarity)", true,
       assisted.scores.ssim > image.scores.ssim},
      {"model_within_estimate", "the transmitted model takes no more than 10/3 bytes a polygon of the model", true,
       static_cast<double>(sent.model_bytes) <= r.estimated_model_bytes},
      {"transmitted_fits_budget", "with the model transmitted, a frame fits 2 Mb/s at 20 frames/s", false,
       sent.budget_share <= 1},
  };
  if (scene == "room") {  // said of figure 2 alone, which lies between 2e and 2f with its model
    const Arm& same_size = transmitted.image_based;
    claims.push_back({"transmitted_higher_quality",
                      "with the model paid for, its quality factor (division by two undone) is still above that of "
                      "image-based compression of the same total size",
                      true, sent.coded.equivalent_quality > same_size.coded.quality});
    claims.push_back({"transmitted_still_better",
                      "with the model paid for, it still looks better than image-based compression of the same total "
                      "size (ours: higher structural similarity)",
                      true, sent.scores.ssim > same_size.scores.ssim});
  }
  return claims;
}

std::string fixed_decimal(double number, int decimals) {
  if (!std::isfinite(number) || std::fabs(number) > 1e15) return "";
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, number, std::chars_format::fixed, decimals).ptr;
  return std::string(text, end);
}

// Labels hold commas: every text field is quoted.
std::string quoted(const char* text) {
  std::string out = "\"";
  for (const char* c = text; *c != '\0'; ++c) {
    if (*c == '"') out += '"';
    out += *c;
  }
  return out + '"';
}

}  // namespace

Table1Column make_table1_column(const std::string& scene, const Still& still, const Still& transmitted) {
  Table1Column column;
  column.scene = scene;
  column.width = still.renderings.high.width();
  column.height = still.renderings.high.height();
  RowWriter out(column, paper_figures(scene));
  add_renderings(out, still.renderings);
  add_image_based(out, still.image_based);
  add_assisted(out, still.polygon_assisted);
  add_transmitted(out, transmitted);
  column.claims = check_claims(scene, still, transmitted);
  return column;
}

std::string table1_json(const Table1& table) {
  JsonWriter json;
  json.begin_object();
  json.begin_array("columns");
  for (const Table1Column& column : table.columns) {
    json.begin_object();
    json.field("scene", column.scene);
    json.field("width", column.width);
    json.field("height", column.height);
    json.begin_array("rows");
    for (const Table1Row& row : column.rows) {
      json.begin_object();
      json.field("section", std::string_view(&row.section, 1));
      json.field("key", row.key);
      json.field("label", row.label);
      json.field("unit", row.unit);
      json.key("paper");
      if (row.paper)
        json.value(*row.paper);
      else
        json.null();
      json.field("ours", row.ours);
      json.field("note", row.note);
      json.end_object();
    }
    json.end_array();
    json.begin_array("claims");
    for (const Table1Claim& claim : column.claims) {
      json.begin_object();
      json.field("key", claim.key);
      json.field("text", claim.text);
      json.field("paper_holds", claim.paper_holds);
      json.field("ours_holds", claim.ours_holds);
      json.end_object();
    }
    json.end_array();
    json.end_object();
  }
  json.end_array();
  json.end_object();
  return json.text() + "\n";
}

std::string table1_csv(const Table1& table) {
  std::string csv = "section,key,label,unit";
  for (const Table1Column& column : table.columns) csv += ',' + column.scene + " paper," + column.scene + " ours";
  csv += ",note\n";
  const size_t n_rows = table.columns.empty() ? 0 : table.columns.front().rows.size();
  for (size_t i = 0; i < n_rows; ++i) {
    const Table1Row& first = table.columns.front().rows[i];
    csv += first.section;
    csv += ',' + std::string(first.key) + ',' + quoted(first.label) + ',' + quoted(first.unit);
    for (const Table1Column& column : table.columns) {
      const Table1Row& row = column.rows[i];
      csv += ',' + (row.paper ? fixed_decimal(*row.paper, row.decimals) : std::string());
      csv += ',' + fixed_decimal(row.ours, row.decimals);
    }
    csv += ',' + quoted(first.note) + '\n';
  }
  return csv;
}

}  // namespace pac::sim
