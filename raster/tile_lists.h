// Which triangles touch which tile, in the order in which they came.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/kernels/tile_kernels.h"

namespace pac::raster {

// A list a tile, in blocks of a memory that is kept between frames.
class TileLists {
 public:
  // Empty lists of n tiles.
  void reset(size_t n) {
    lists_.assign(n, {});
    used_ = 0;
  }

  void append(size_t tile, const RasterTriangle* triangle) {
    List& list = lists_[tile];
    if (reinterpret_cast<uintptr_t>(list.next) % sizeof(Block) == 0) add_block(list);
    *list.next++ = triangle;
  }

  // Appends the tile's triangles to `out`.
  void copy(size_t tile, std::vector<const RasterTriangle*>& out) const {
    const List& list = lists_[tile];
    for (const Block* block = list.first; block != nullptr; block = block->following) {
      const bool last = block->following == nullptr;
      out.insert(out.end(), block->triangles, last ? list.next : block->triangles + kLength);
    }
  }

 private:
  static constexpr size_t kLength = 15, kBlocksAtOnce = 64;
  struct alignas(128) Block {
    Block* following;
    const RasterTriangle* triangles[kLength];
  };
  static_assert(sizeof(Block) == 128, "next is a multiple of it behind a full block, and nowhere else");
  struct List {
    Block* first = nullptr;
    const RasterTriangle** next = nullptr;  // where the next one goes; null, or behind the last block where it is full
  };

  void add_block(List& list) {
    if (used_ % kBlocksAtOnce == 0 && used_ / kBlocksAtOnce == memory_.size())
      memory_.emplace_back(new Block[kBlocksAtOnce]);
    Block* const block = &memory_[used_ / kBlocksAtOnce][used_ % kBlocksAtOnce];
    ++used_;
    block->following = nullptr;
    if (list.first == nullptr)
      list.first = block;
    else
      reinterpret_cast<Block*>(list.next)[-1].following = block;
    list.next = block->triangles;
  }

  std::vector<List> lists_;
  std::vector<std::unique_ptr<Block[]>> memory_;
  size_t used_ = 0;  // blocks
};

}  // namespace pac::raster
