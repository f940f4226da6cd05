#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/verdict.h"

namespace pac::test {
namespace {

std::vector<QualityScores> frames(int n, double ssimulacra2, double flip, double psnr_hvs_m_db) {
  return std::vector<QualityScores>(static_cast<size_t>(n), {ssimulacra2, flip, psnr_hvs_m_db});
}
Verdict compare(const std::vector<QualityScores>& a, const std::vector<QualityScores>& b, uint64_t bytes_a = 1000,
                uint64_t bytes_b = 1000) {
  return compare_quality({bytes_a, a}, {bytes_b, b});
}

TEST_CASE("worst 5 %: the worst of twenty, the second worst of forty, from the bad end") {
  std::vector<double> values;
  for (int i = 40; i >= 1; --i) values.push_back(i);
  CHECK(summarize_frames(values, Better::larger).worst_5_percent == 2);
  CHECK(summarize_frames(values, Better::smaller).worst_5_percent == 39);
  CHECK(summarize_frames(values, Better::larger).mean == doctest::Approx(20.5));
  values.resize(20);
  CHECK(summarize_frames(values, Better::larger).worst_5_percent == 21);
  CHECK(summarize_frames({}, Better::larger).mean == 0);
}

TEST_CASE("an infinite PSNR counts as 100 dB in a mean") {
  const double values[] = {std::numeric_limits<double>::infinity(), 40};
  CHECK(summarize_frames(values, Better::larger).mean == 70);
}

TEST_CASE("better is said only where all three metrics agree, whichever comes first") {
  const auto good = frames(10, 70, 0.05, 40), bad = frames(10, 60, 0.08, 37);
  CHECK(compare(good, bad) == Verdict::first_better);
  CHECK(compare(bad, good) == Verdict::second_better);
  CHECK(compare(good, good) == Verdict::disagree);
  CHECK(compare(frames(10, 70, 0.09, 40), bad) == Verdict::disagree);  // FLIP objects
  CHECK(compare(frames(10, 70, 0.05, 36), bad) == Verdict::disagree);  // PSNR-HVS-M objects
  CHECK(compare(frames(10, 62, 0.05, 40), bad) == Verdict::disagree);  // 2 points are no difference
  CHECK(compare(frames(10, 62.01, 0.05, 40), bad) == Verdict::first_better);
}

TEST_CASE("one bad frame in twenty takes the verdict away though the mean is better") {
  auto good = frames(20, 70, 0.05, 40);
  const auto bad = frames(20, 60, 0.08, 37);
  CHECK(compare(good, bad) == Verdict::first_better);
  good[7].flip = 0.2;
  CHECK(compare(good, bad) == Verdict::disagree);
}

TEST_CASE("the winner may take fewer bytes, but not over 1 % more") {
  const auto good = frames(3, 70, 0.05, 40), bad = frames(3, 60, 0.08, 37);
  CHECK(compare(good, bad, 1010, 1000) == Verdict::first_better);
  CHECK(compare(good, bad, 1011, 1000) == Verdict::bytes_differ);
  CHECK(compare(good, bad, 500, 1000) == Verdict::first_better);
  CHECK(compare(bad, good, 1000, 2000) == Verdict::bytes_differ);
  CHECK(std::string(verdict_text(Verdict::disagree)) == "metrics disagree");
}

}  // namespace
}  // namespace pac::test
