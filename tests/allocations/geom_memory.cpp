// What encoding and decoding a mesh of a million triangles holds in memory at once, the mesh and the stream included:
// less than 200 MB, and in proportion to the mesh. Usage: geom_memory [TRIANGLES]. Returns 0 if that is so.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>

#include "geomcodec/geomcodec.h"
#include "tests/support/mesh_zoo.h"

namespace {

size_t n_live = 0, n_peak = 0;  // bytes asked for and not yet given back

// Each block is preceded by its size, at a distance that keeps its alignment.
size_t distance_for(size_t alignment) {
  return std::max(alignment, alignof(std::max_align_t));
}
void* allocate(size_t size, size_t alignment) {
  const size_t distance = distance_for(alignment);
  const size_t whole = (size + distance + distance - 1) / distance * distance;
  auto* block = static_cast<std::byte*>(std::aligned_alloc(distance, whole));
  if (block == nullptr) std::abort();  // libraries are built without exceptions
  *reinterpret_cast<size_t*>(block) = size;
  n_live += size;
  n_peak = std::max(n_peak, n_live);
  return block + distance;
}
void give_back(void* p, size_t alignment) {
  if (p == nullptr) return;
  std::byte* block = static_cast<std::byte*>(p) - distance_for(alignment);
  n_live -= *reinterpret_cast<size_t*>(block);
  std::free(block);
}

}  // namespace

void* operator new(size_t size) {
  return allocate(size, 1);
}
void* operator new(size_t size, std::align_val_t alignment) {
  return allocate(size, static_cast<size_t>(alignment));
}
void operator delete(void* p) noexcept {
  give_back(p, 1);
}
void operator delete(void* p, size_t) noexcept {
  give_back(p, 1);
}
void operator delete(void* p, std::align_val_t alignment) noexcept {
  give_back(p, static_cast<size_t>(alignment));
}
void operator delete(void* p, size_t, std::align_val_t alignment) noexcept {
  give_back(p, static_cast<size_t>(alignment));
}

namespace {

using namespace pac;

struct Peaks {
  bool exact = false;
  size_t encoding = 0, decoding = 0;
};

// A grid of cells of two triangles each; the mesh given and the stream count in both.
Peaks peaks_of(uint32_t columns, uint32_t rows) {
  Peaks peaks;
  const geomcodec::QuantizedMesh mesh = test::wave_mesh(columns, rows, true);
  n_peak = n_live;
  const auto stream = geomcodec::encode(mesh, {.keep_order = true});
  peaks.encoding = n_peak;
  if (!stream.ok()) return peaks;
  Limits limits;
  limits.max_triangles = uint64_t{2} * columns * rows;
  n_peak = n_live;
  const auto decoded = geomcodec::decode(*stream, limits);
  peaks.decoding = n_peak;
  peaks.exact = decoded.ok() && test::same(*decoded, mesh);
  return peaks;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr uint32_t kRows = 250;
  constexpr size_t kMegabyte = 1000 * 1000;
  const auto wanted = static_cast<uint32_t>(argc > 1 ? std::atol(argv[1]) : 1000 * 1000);
  const uint32_t columns = std::max(wanted / (2 * kRows), 8u), n_triangles = 2 * kRows * columns;
  const Peaks part = peaks_of(columns / 8, kRows), whole = peaks_of(columns, kRows);
  std::printf("%u triangles: %zu MB while encoding, %zu MB while decoding; an eighth of them %zu and %zu\n",
              n_triangles, whole.encoding / kMegabyte, whole.decoding / kMegabyte, part.encoding / kMegabyte,
              part.decoding / kMegabyte);
  const size_t allowed = size_t{200} * n_triangles;  // 200 MB for a million
  const auto in_proportion = [](size_t all, size_t eighth) { return all < 16 * eighth + kMegabyte; };
  bool good = true;
  const auto check = [&](bool holds, const char* claim) {
    if (!holds) std::printf("not so: %s\n", claim);
    good &= holds;
  };
  check(part.exact && whole.exact, "the mesh comes back");
  check(whole.encoding < allowed, "encoding takes less than 200 bytes a triangle");
  check(whole.decoding < allowed, "decoding takes less than 200 bytes a triangle");
  check(in_proportion(whole.encoding, part.encoding), "encoding takes memory in proportion to the mesh");
  check(in_proportion(whole.decoding, part.decoding), "decoding takes memory in proportion to the mesh");
  return good ? 0 : 1;
}
