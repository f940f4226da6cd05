// The whole paper in miniature: every figure and table column, at an eighth of the size.
#include <doctest/doctest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "sim/paper_animations.h"
#include "sim/paper_figures.h"
#include "sim/report_animations.h"

namespace {

using namespace pac;

TEST_CASE("the paper in miniature: all figures, both columns, less entropy in D than in H, matched sizes") {
  sim::PaperOptions options;
  options.size_divisor = 8;
  int calls = 0, last_done = -1, total = 0;
  options.progress = [&](const char* step, int done, int of) {
    CHECK(step[0] != '\0');
    CHECK(done == last_done + 1);
    last_done = done;
    total = of;
    ++calls;
  };
  const auto results = sim::run_paper(options);
  REQUIRE(results.ok());
  CHECK(calls == total);

  REQUIRE(results->table1.columns.size() == 2);
  CHECK(results->table1.columns[0].scene == "room");
  CHECK(results->table1.columns[1].scene == "pin");
  CHECK(results->room.renderings.high_polygons == 1131);
  CHECK(results->room.renderings.low_polygons == 1131);
  CHECK(results->pin.renderings.high_polygons == doctest::Approx(75467).epsilon(0.01));
  CHECK(results->pin.renderings.low_polygons == doctest::Approx(3153).epsilon(0.01));
  CHECK(results->room_transmitted.renderings.model_bytes > 0);

  std::set<std::string> keys;
  for (const sim::FigureSet& set : results->figures) {
    INFO(set.key);
    keys.insert(set.key);
    CHECK(set.renderings.difference_entropy.luma < set.renderings.high_entropy.luma);
    CHECK(set.renderings.difference_entropy.mean_rgb < set.renderings.high_entropy.mean_rgb);
    CHECK(!set.pairs.empty());
    for (const sim::MatchedPair& pair : set.pairs) {
      const auto image = static_cast<double>(pair.image_based.image_bytes);
      CHECK(static_cast<double>(pair.polygon_assisted.image_bytes) == doctest::Approx(image).epsilon(0.01));
      CHECK(pair.polygon_assisted.coded.quality > pair.image_based.coded.quality);
    }
    CHECK(set.image_curve.points.size() == set.assisted_curve.points.size());
    CHECK(set.finding.back() == '.');
  }
  for (const char* key : {"figure2", "figure3", "figure4", "figure5", "antialiasing", "lighting", "cubes"})
    CHECK(keys.count(key) == 1);
}

TEST_CASE("the paper's animations in miniature: arms at matched bytes, MPEG-1 ahead, streams that the page names") {
  sim::PaperOptions options;
  options.size_divisor = 4;
  const auto sets = sim::run_paper_animations(options);
  REQUIRE(sets.ok());
  REQUIRE(sets->size() == 2);
  for (const sim::AnimationSet& set : *sets) {
    INFO(set.key);
    const auto curve = [&](sim::AnimationArm arm) -> const sim::AnimationCurve& {
      return set.curves[static_cast<size_t>(arm)];
    };
    using sim::AnimationArm;
    for (const auto& [image, assisted] : {std::pair(AnimationArm::mjpeg, AnimationArm::mjpeg_assisted),
                                          std::pair(AnimationArm::mpeg1, AnimationArm::mpeg1_assisted),
                                          std::pair(AnimationArm::mpeg1, AnimationArm::mpeg1_predicted)}) {
      REQUIRE(curve(image).points.size() == curve(assisted).points.size());
      const auto of_image = static_cast<double>(curve(image).points[sim::kShownRate].arm.bytes);
      CHECK(static_cast<double>(curve(assisted).points[sim::kShownRate].arm.bytes) ==
            doctest::Approx(of_image).epsilon(0.1));
      CHECK(curve(image).points[0].arm.bytes > curve(image).points[sim::kShownRate].arm.bytes);
    }
    CHECK(sim::bytes_saved_percent(curve(AnimationArm::mjpeg), curve(AnimationArm::mpeg1), 0).value_or(0) > 30);
    for (const sim::AnimationCurve& one : set.curves) {
      CHECK(one.film.width() == set.width);
      CHECK(one.film.height() == set.height * set.frames);
    }
    for (const sim::AnimationStreams& streams : set.streams)
      CHECK(std::min({streams.image.size(), streams.difference.size(), streams.session.size()}) > 100);
  }
  const sim::IllustratedReport page = sim::animations_report(*sets);
  CHECK(page.images.size() == 12);
  const std::string html = sim::report_html(page.report);
  for (const sim::ReportImage& image : page.images) CHECK(html.find(image.file) != std::string::npos);
  for (const sim::AnimationStreams& streams : (*sets)[0].streams)
    CHECK(html.find(sim::streams_folder((*sets)[0], streams) + "/difference.m") != std::string::npos);
  CHECK(html.find("--frames:16") != std::string::npos);
}

TEST_CASE("a size divisor below one is refused") {
  sim::PaperOptions options;
  options.size_divisor = 0;
  CHECK(sim::run_paper(options).failure().error == Error::bad_argument);
  CHECK(sim::run_paper_animations(options).failure().error == Error::bad_argument);
}

}  // namespace
