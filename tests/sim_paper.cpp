// The whole paper in miniature: every figure and table column, at an eighth of the size.
#include <doctest/doctest.h>

#include <set>
#include <string>

#include "sim/paper_figures.h"

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

TEST_CASE("a size divisor below one is refused") {
  sim::PaperOptions options;
  options.size_divisor = 0;
  CHECK(sim::run_paper(options).failure().error == Error::bad_argument);
}

}  // namespace
