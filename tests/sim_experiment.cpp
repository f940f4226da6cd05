#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/metrics.h"
#include "sim/difference.h"
#include "sim/experiment.h"
#include "sim/rate_curve.h"
#include "sim/table1.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;
using sim::ArmKind;
using sim::Metric;

const sim::SceneSet& scene() {
  static const sim::SceneSet set = test::small_scene(false);
  return set;
}

sim::StillOptions still_options(const char* split = "texture") {
  sim::StillOptions options;
  options.render.split = split;
  options.render.samples = 4;
  return options;
}

sim::Still run(const sim::StillOptions& options) {
  auto still = sim::run_still(scene(), test::small_camera(0, 1), options);
  REQUIRE(still.ok());
  return std::move(*still);
}

TEST_CASE("a still: sizes match, ratios follow from the sizes, scores from the pictures") {
  const sim::Still still = run(still_options());
  const sim::Arm &image = still.image_based, &assisted = still.polygon_assisted;
  CHECK(image.coded.quality == 15);
  CHECK(std::fabs(static_cast<double>(assisted.image_bytes) - static_cast<double>(image.image_bytes)) <=
        0.01 * static_cast<double>(image.image_bytes));
  for (const sim::Arm* arm : {&image, &assisted}) {
    CHECK(arm->image_bytes == arm->coded.bytes.size());
    CHECK(arm->total_bytes == arm->image_bytes);
    CHECK(arm->compression_ratio == doctest::Approx(96.0 * 96 * 3 / static_cast<double>(arm->total_bytes)));
    CHECK(arm->budget_share == doctest::Approx(static_cast<double>(arm->total_bytes) / 12500));
    CHECK(arm->scores.rms == rms_error(still.renderings.high.view(), arm->shown.view()));
    CHECK(arm->scores.ssim == ssim_luma(still.renderings.high.view(), arm->shown.view()));
    CHECK(arm->optimal_huffman_bytes < arm->image_bytes);
  }
  RgbImage composite(96, 96);
  sim::composite_image(still.renderings.low.view(), assisted.decoded.view(), composite.view());
  CHECK(sim::image_hash(composite.view()) == sim::image_hash(assisted.shown.view()));
}

TEST_CASE("on a smoothly shaded, textured scene polygon assistance wins at equal bytes, as the paper says") {
  const sim::Still still = run(still_options());
  CHECK(still.renderings.difference_entropy.luma < still.renderings.high_entropy.luma);
  CHECK(still.renderings.difference_entropy.mean_rgb < still.renderings.high_entropy.mean_rgb);
  CHECK(still.renderings.difference_entropy.joint_rgb < still.renderings.high_entropy.joint_rgb);
  CHECK(still.polygon_assisted.scores.ssim > still.image_based.scores.ssim);
  CHECK(still.polygon_assisted.scores.rms < still.image_based.scores.rms);
  CHECK(still.polygon_assisted.coded.quality >= 2 * still.image_based.coded.quality);
}

TEST_CASE("a wanted size binds both arms; charging the model takes it from the assisted one's share") {
  sim::StillOptions options = still_options();
  options.target_bytes = 3000;
  options.render.transmit_model = true;
  const sim::Still free_model = run(options);
  CHECK(std::llabs(static_cast<long long>(free_model.image_based.image_bytes) - 3000) <= 30);
  CHECK(std::llabs(static_cast<long long>(free_model.polygon_assisted.image_bytes) - 3000) <= 30);
  CHECK(free_model.polygon_assisted.total_bytes ==
        free_model.polygon_assisted.image_bytes + free_model.renderings.model_bytes);
  options.charge_model = true;
  options.target_bytes = free_model.renderings.model_bytes + 2000;
  const sim::Still charged = run(options);
  CHECK(std::llabs(static_cast<long long>(charged.polygon_assisted.total_bytes - options.target_bytes)) <= 25);
  options.target_bytes = free_model.renderings.model_bytes;
  const auto impossible = sim::run_still(scene(), test::small_camera(0, 1), options);
  REQUIRE(!impossible.ok());
  CHECK(impossible.failure().error == Error::limit_exceeded);
}

TEST_CASE("a byte budget is divided between the model's positions and the image so that the composite is best") {
  sim::StillOptions options = still_options();
  options.target_bytes = 2500;
  const auto divided = sim::divide_budget(scene(), test::small_camera(0, 1), options);
  REQUIRE(divided.ok());
  const sim::Still& still = divided->still;
  REQUIRE(divided->divisions.size() >= 3);
  CHECK(still.renderings.model_transmitted);
  CHECK(still.polygon_assisted.total_bytes <= 2550);
  CHECK(std::llabs(static_cast<long long>(still.image_based.total_bytes) - 2500) <= 25);
  int last_bits = 0;
  for (const sim::Division& division : divided->divisions) {
    CAPTURE(division.position_bits);
    CHECK(division.position_bits > last_bits);
    CHECK(division.model_bytes + division.image_bytes <= 2550);
    CHECK(still.polygon_assisted.scores.rms <= division.rms);
    last_bits = division.position_bits;
  }
  CHECK(divided->divisions.front().model_bytes < divided->divisions.back().model_bytes);
  // The division chosen is what a still of that precision comes to.
  options.render.transmit_model = options.charge_model = true;
  options.render.position_bits = still.renderings.position_bits;
  const sim::Still again = run(options);
  CHECK(again.renderings.model_bytes == still.renderings.model_bytes);
  CHECK(again.polygon_assisted.coded.bytes == still.polygon_assisted.coded.bytes);
  CHECK(sim::image_hash(again.polygon_assisted.shown.view()) == sim::image_hash(still.polygon_assisted.shown.view()));
}

TEST_CASE("no budget, and one that the model alone exceeds, are refused") {
  sim::StillOptions options = still_options();
  CHECK(sim::divide_budget(scene(), test::small_camera(0, 1), options).failure().error == Error::bad_argument);
  options.target_bytes = 40;
  const auto divided = sim::divide_budget(scene(), test::small_camera(0, 1), options);
  REQUIRE(!divided.ok());
  CHECK(divided.failure().error == Error::limit_exceeded);
}

TEST_CASE("one traversal and two give the same H, L and D") {
  // tessellation,texture cannot share a traversal; with the fine model as its own coarse one it draws the same
  // pictures.
  sim::SceneSet twin = test::small_scene(false);
  twin.coarse = twin.fine;
  sim::RenderOptions options;
  options.samples = 4;
  options.split = "texture";
  const auto once = sim::render_split(twin, test::small_camera(2, 1), options);
  options.split = "texture,tessellation";
  const auto twice = sim::render_split(twin, test::small_camera(2, 1), options);
  REQUIRE(once.ok());
  REQUIRE(twice.ok());
  CHECK(once->split.single_pass());
  CHECK(!twice->split.single_pass());
  CHECK(sim::image_hash(once->high.view()) == sim::image_hash(twice->high.view()));
  CHECK(sim::image_hash(once->low.view()) == sim::image_hash(twice->low.view()));
  CHECK(sim::image_hash(once->difference.view()) == sim::image_hash(twice->difference.view()));
}

TEST_CASE("options out of range are refused") {
  sim::StillOptions options = still_options();
  options.quality = 0;
  CHECK(!sim::run_still(scene(), test::small_camera(0, 1), options).ok());
  options = still_options("no such split");
  CHECK(!sim::run_still(scene(), test::small_camera(0, 1), options).ok());
  options = still_options();
  options.render.width = -5;
  CHECK(!sim::run_still(scene(), test::small_camera(0, 1), options).ok());
}

// A curve whose rms falls as a / bytes^b, and whose ssim is 1 - rms / 100.
sim::RateCurve power_curve(double a, double b) {
  sim::RateCurve curve;
  for (double bytes = 1000; bytes <= 64000; bytes *= 2) {
    sim::RatePoint point;
    point.bytes = static_cast<uint64_t>(bytes);
    point.compression_ratio = 100000 / bytes;
    point.scores.rms = a * std::pow(bytes, -b);
    point.scores.ssim = 1 - point.scores.rms / 100;
    curve.points.push_back(point);
  }
  return curve;
}

TEST_CASE("bytes at equal quality and the crossing are read off the curves") {
  const sim::RateCurve image = power_curve(1000, 0.5), assisted = power_curve(1000 / 2.0, 0.5);
  // Half the error at all sizes: the same error at a quarter of the bytes.
  CHECK(*sim::equal_quality_gain(image, assisted, Metric::rms, 3) == doctest::Approx(4).epsilon(0.03));
  CHECK(*sim::equal_quality_gain(image, assisted, Metric::ssim, 3) == doctest::Approx(4).epsilon(0.03));
  CHECK(!sim::equal_quality_gain(image, assisted, Metric::rms, 0).has_value());
  const sim::Crossing never = sim::find_crossing(image, assisted, Metric::rms);
  CHECK(!never.ratio.has_value());
  CHECK(never.assisted_wins_at_high_ratio);
  CHECK(never.assisted_wins_at_low_ratio);
  // Falls more slowly: better below 8000 bytes, worse above, so the crossing is at 100000 / 8000.
  const sim::RateCurve slow = power_curve(1000 / std::pow(8000, 0.25), 0.25);
  const sim::Crossing crossing = sim::find_crossing(image, slow, Metric::rms);
  REQUIRE(crossing.ratio.has_value());
  CHECK(*crossing.ratio == doctest::Approx(12.5).epsilon(0.02));
  CHECK(!crossing.assisted_wins_at_low_ratio);
  // The other way round there is no place where it stops paying, but one above which it is behind.
  const sim::Crossing reverse = sim::find_crossing(slow, image, Metric::rms);
  CHECK(!reverse.ratio.has_value());
  CHECK(*reverse.behind_above == doctest::Approx(12.5).epsilon(0.02));
}

TEST_CASE("a rate curve holds one point a quality, larger files being better ones") {
  const sim::Still still = run(still_options());
  const double qualities[] = {10, 40, 80};
  sim::CodingOptions options;
  options.threads = 2;
  for (const ArmKind kind : {ArmKind::image_based, ArmKind::polygon_assisted}) {
    const auto curve = sim::rate_curve(still.renderings, kind, qualities, options);
    REQUIRE(curve.ok());
    REQUIRE(curve->points.size() == 3);
    for (size_t i = 0; i < 3; ++i) CHECK(curve->points[i].quality == qualities[i]);
    CHECK(curve->points[0].bytes < curve->points[1].bytes);
    CHECK(curve->points[1].scores.rms > curve->points[2].scores.rms);
    CHECK(curve->points[0].scores.ssim < curve->points[2].scores.ssim);
  }
}

sim::Table1 small_table() {
  const sim::StillOptions options = still_options();
  const sim::Still still = run(options);
  auto transmitted =
      sim::run_transmitted(scene(), test::small_camera(0, 1), options, still.polygon_assisted.coded.quality);
  REQUIRE(transmitted.ok());
  sim::Table1 table;
  table.columns.push_back(sim::make_table1_column("room", still, *transmitted));
  table.columns.push_back(sim::make_table1_column("pin", still, *transmitted));
  return table;
}

const sim::Table1Row& row(const sim::Table1Column& column, const std::string& key) {
  const auto found =
      std::find_if(column.rows.begin(), column.rows.end(), [&](const sim::Table1Row& r) { return key == r.key; });
  REQUIRE(found != column.rows.end());
  return *found;
}

TEST_CASE("Table I holds the paper's figures, whose ratios and estimates agree with one another") {
  const sim::Table1 table = small_table();
  for (const sim::Table1Column& column : table.columns) {
    const auto paper = [&](const char* key) { return *row(column, key).paper; };
    const double raw = paper("width") * paper("height") * 3;
    CHECK(std::round(raw / paper("image_bytes")) == paper("image_ratio"));
    // The pin's 129.03 and the room's 80.6 and 58.1 as printed.
    CHECK(std::fabs(raw / paper("assisted_bytes") - paper("assisted_ratio")) < 0.6);
    CHECK(std::fabs(raw / paper("transmitted_total_bytes") - paper("transmitted_ratio")) < 0.6);
    CHECK(paper("transmitted_image_bytes") + paper("transmitted_model_bytes") == paper("transmitted_total_bytes"));
    CHECK(std::fabs(paper("low_polygons") * 10 / 3 - paper("transmitted_model_bytes")) < 1);
  }
}

TEST_CASE("row F: the model is paid for, and the image-based arm gets the same total") {
  const sim::Table1 table = small_table();
  const sim::Table1Column& column = table.columns[0];
  CHECK(row(column, "transmitted_total_bytes").ours ==
        row(column, "transmitted_image_bytes").ours + row(column, "transmitted_model_bytes").ours);
  CHECK(row(column, "transmitted_model_bytes").ours > 0);
  CHECK(row(column, "same_size_image_quality").ours > row(column, "image_quality").ours);
  CHECK(row(column, "assisted_equivalent_quality").ours < row(column, "assisted_quality").ours);
}

TEST_CASE("every column has the same rows, and the files name each of them") {
  const sim::Table1 table = small_table();
  const std::string json = sim::table1_json(table), csv = sim::table1_csv(table);
  REQUIRE(table.columns[0].rows.size() == table.columns[1].rows.size());
  for (size_t i = 0; i < table.columns[0].rows.size(); ++i) {
    const std::string key = table.columns[0].rows[i].key;
    CHECK(key == table.columns[1].rows[i].key);
    CHECK(json.find('"' + key + '"') != std::string::npos);
    CHECK(csv.find(',' + key + ',') != std::string::npos);
  }
  CHECK(std::count(csv.begin(), csv.end(), '\n') == static_cast<long>(table.columns[0].rows.size() + 1));
  CHECK(csv.find("room paper,room ours,pin paper,pin ours") != std::string::npos);
}

TEST_CASE("a claim that our numbers contradict is marked, not hidden") {
  sim::StillOptions options = still_options();
  sim::Still still = run(options);
  auto transmitted =
      sim::run_transmitted(scene(), test::small_camera(0, 1), options, still.polygon_assisted.coded.quality);
  REQUIRE(transmitted.ok());
  still.polygon_assisted.scores.ssim = still.image_based.scores.ssim - 0.1;
  const sim::Table1Column column = sim::make_table1_column("pin", still, *transmitted);
  for (const sim::Table1Claim& claim : column.claims)
    if (std::string(claim.key) == "looks_better") {
      CHECK(claim.paper_holds);
      CHECK(!claim.ours_holds);
    }
}

}  // namespace
