#include "base/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <utility>
#include <vector>

namespace pac::test {
namespace {

TEST_CASE("every index runs exactly once, whatever the numbers of threads and indices") {
  for (const int n_threads : {1, 2, 3, 8}) {
    ThreadPool pool(n_threads);
    CHECK(pool.thread_count() >= 1);
    CHECK(pool.thread_count() <= n_threads);
    for (const int64_t count : {0, 1, 2, 3, 7, 8, 9, 1000, 100000}) {
      std::vector<std::atomic<int>> runs(static_cast<size_t>(count));
      pool.for_each(count, [&](int64_t i) { runs[static_cast<size_t>(i)].fetch_add(1); });
      for (const auto& n : runs) REQUIRE(n == 1);
    }
  }
}

TEST_CASE("steps of chains are taken once each, those of a chain in order, on any number of threads") {
  const std::vector<int> lengths = {7, 0, 40, 1, 12};
  for (const int n_threads : {1, 2, 3, 8}) {
    ThreadPool pool(n_threads);
    for (int round = 0; round < 50; ++round) {
      std::vector<int> reached(lengths.size());  // written without a lock: only by one thread after another
      std::atomic<int> n_out_of_order{0};
      pool.for_each_step(lengths, [&](int chain, int step) {
        if (reached[static_cast<size_t>(chain)]++ != step) ++n_out_of_order;
      });
      REQUIRE(n_out_of_order == 0);
      REQUIRE(reached == lengths);
    }
  }
}

TEST_CASE("many small loops on one pool: none starts before the one before has ended") {
  ThreadPool pool(4);
  std::vector<int> values(16, 0);
  for (int round = 0; round < 2000; ++round)
    pool.for_each(16, [&](int64_t i) { values[static_cast<size_t>(i)] += round; });
  for (const int value : values) REQUIRE(value == 1999000);
}

TEST_CASE("a loop on another pool inside a loop's body works: distinct pools are independent") {
  std::vector<std::atomic<int>> runs(12 * 7);
  ThreadPool outer(3);
  outer.for_each(12, [&](int64_t i) {
    ThreadPool inner(2);
    inner.for_each(7, [&](int64_t k) { runs[static_cast<size_t>(i * 7 + k)].fetch_add(1); });
  });
  for (const auto& n : runs) REQUIRE(n == 1);
}

TEST_CASE("what the loop wrote is visible afterwards, on one thread and on all") {
  for (const int n_threads : {0, 1, 5}) {
    std::vector<int64_t> squares(3000);
    parallel_for(n_threads, 3000, [&](int64_t i) { squares[static_cast<size_t>(i)] = i * i; });
    int64_t sum = 0;
    for (const int64_t s : squares) sum += s;
    CHECK(sum == 8995500500);
  }
  CHECK(hardware_thread_count() >= 1);
}

TEST_CASE("a moved pool goes on working") {
  ThreadPool pool(3);
  ThreadPool moved = std::move(pool);
  std::atomic<int> n{0};
  moved.for_each(50, [&](int64_t) { n.fetch_add(1); });
  CHECK(n == 50);
  moved = ThreadPool(2);
  moved.for_each(50, [&](int64_t) { n.fetch_add(1); });
  CHECK(n == 100);
}

}  // namespace
}  // namespace pac::test
