// How a picture's rows are shared among threads.
#pragma once

#include <algorithm>

namespace pac::jpeg {

// Of n_left units (runs of MCU rows between restart markers) of n_all, so many that the next band takes: large bands
// first, small ones last, so that threads that take one after the other end together, and bands stay few.
inline int next_band(int n_left, int n_all, int n_threads) {
  constexpr int kSmallest = 64;  // of the picture
  return std::min(n_left, std::max({n_left / (2 * n_threads), n_all / kSmallest, 1}));
}

}  // namespace pac::jpeg
