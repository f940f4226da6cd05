// The exactness harness: every instruction set's kernel against the scalar one, bit for bit, in guarded memory.
//
//   KernelCheck check(capacity_bytes);
//   for_each_placement(max_width, [&](size_t width, Guard guard, size_t shift) {
//     const uint8_t* in = check.input<uint8_t>(0, 3 * width, guard, shift, Pattern::random, 0, 255, seed);
//     check.compare<uint8_t>(width, guard, shift, [&](const Kernels& table, uint8_t* out) { table.pixel.f(in, out,
//     width); });
//   });
//
// Kernels that need alignment: pass shifts that are multiples of it (the `step` of for_each_placement), and sizes too.
#pragma once

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/kernels/kernels.h"
#include "tests/support/generators.h"
#include "tests/support/guarded_buffer.h"

namespace pac::test {

// The tables to compare with the scalar one: every other instruction set that is built and supported here.
inline std::vector<const Kernels*> other_tables() {
  std::vector<const Kernels*> tables;
  for (int i = 0; i < kIsaCount; ++i)
    if (const Kernels* table = kernels_for(static_cast<Isa>(i)); table != nullptr && table->isa != Isa::scalar)
      tables.push_back(table);
  return tables;
}

// fn(scalar, other) for each of them, with the instruction set's name in doctest's messages.
template <class Fn>
void for_each_isa(Fn&& fn) {
  for (const Kernels* table : other_tables()) {
    const std::string isa = isa_name(table->isa);
    CAPTURE(isa);
    fn(*kernels_for(Isa::scalar), *table);
  }
}

// fn(width, guard, shift): every width 0..max_width at a few shifts on both sides, and every shift 0..63 at a few
// widths. Shifts are multiples of `step` bytes, widths multiples of `width_step`.
template <class Fn>
void for_each_placement(size_t max_width, Fn&& fn, size_t step = 1, size_t width_step = 1) {
  for (const Guard guard : kGuards) {
    for (size_t width = 0; width <= max_width; width += width_step)
      for (const size_t shift : {size_t{0}, step, 5 * step})
        if (shift < 64) fn(width, guard, shift);
    for (const size_t share : {size_t{1}, size_t{2}, size_t{3}})
      for (size_t shift = 0; shift < 64; shift += step)
        fn(max_width * share / 3 / width_step * width_step, guard, shift);
  }
}

// Guarded inputs (by slot number) and guarded outputs of one kernel test. Reusable; not for nested compare() calls.
class KernelCheck {
 public:
  // Each buffer has room for so many bytes.
  explicit KernelCheck(size_t capacity_bytes)
      : capacity_(capacity_bytes), expected_(capacity_bytes), actual_(capacity_bytes) {}

  // Guarded input memory for `count` elements, filled with a pattern.
  template <class T>
  T* input(size_t slot, size_t count, Guard guard, size_t shift, Pattern pattern, int64_t low, int64_t high,
           uint64_t seed) {
    T* data = input_memory<T>(slot, count, guard, shift);
    fill(std::span(data, count), pattern, low, high, seed);
    return data;
  }
  // The same, left to the caller to fill.
  template <class T>
  T* input_memory(size_t slot, size_t count, Guard guard, size_t shift) {
    while (inputs_.size() <= slot) inputs_.push_back(std::make_unique<GuardedBuffer>(capacity_));
    return inputs_[slot]->place_as<T>(count, guard, shift);
  }

  // Runs call(table, out) with the scalar table and each other one. `out` has `count` elements that hold the same noise
  // for all. Requires equal bits, and intact surroundings of outputs and inputs.
  template <class T, class Call>
  void compare(size_t count, Guard guard, size_t shift, Call&& call) {
    compare_in_place<T>(
        count, guard, shift,
        [](std::span<T> out) {
          for (size_t i = 0; i < out.size(); ++i) out[i] = static_cast<T>(i * 37 + 11);
        },
        call);
  }

  // The same for kernels that read what they overwrite: prepare(std::span<T> out) sets the data before each run.
  template <class T, class Prepare, class Call>
  void compare_in_place(size_t count, Guard guard, size_t shift, Prepare&& prepare, Call&& call) {
    T* expected = expected_.place_as<T>(count, guard, shift);
    prepare(std::span(expected, count));
    call(*kernels_for(Isa::scalar), expected);
    require_intact(expected_);
    for_each_isa([&](const Kernels&, const Kernels& table) {
      T* actual = actual_.place_as<T>(count, guard, shift);
      prepare(std::span(actual, count));
      call(table, actual);
      require_intact(actual_);
      require_equal(std::span<const T>(expected, count), std::span<const T>(actual, count));
    });
  }

 private:
  void require_intact(const GuardedBuffer& output) const {
    if (!output.intact()) FAIL("a kernel wrote outside its output");
    for (const auto& input : inputs_)
      if (!input->intact()) FAIL("a kernel wrote beside its input");
  }
  template <class T>
  static void require_equal(std::span<const T> expected, std::span<const T> actual) {
    if (expected.empty() || std::memcmp(expected.data(), actual.data(), expected.size_bytes()) == 0) return;
    for (size_t i = 0; i < expected.size(); ++i) {
      if (std::memcmp(&expected[i], &actual[i], sizeof(T)) == 0) continue;
      CAPTURE(i);
      CAPTURE(+expected[i]);
      CAPTURE(+actual[i]);
      FAIL("differs from the scalar kernel");
    }
  }

  size_t capacity_;
  std::vector<std::unique_ptr<GuardedBuffer>> inputs_;
  GuardedBuffer expected_, actual_;
};

}  // namespace pac::test
