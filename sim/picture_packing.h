// MPEG-1 pictures of the difference in fewer bytes: the same syntax elements, coded by an adaptive arithmetic coder
// whose contexts are what is already known: levels of the blocks around, of this block's lower frequencies, and of the
// same surface elsewhere, which client and server know from the model. What comes out of unpacking is the MPEG-1
// picture, bit for bit.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/file_io.h"
#include "base/image.h"
#include "base/result.h"
#include "mpeg1/mpeg1.h"

namespace pac::sim {

// One object on each side, one thread at a time. A picture that stands alone begins anew; each picture after it goes on
// from what that one taught, so that a lost picture takes none with it but those that need it as their prediction.
class PicturePacker {
 public:
  // Of the pictures, in samples.
  PicturePacker(int width, int height);
  ~PicturePacker();
  PicturePacker(PicturePacker&&) noexcept;
  PicturePacker& operator=(PicturePacker&&) noexcept;

  // The packed picture; empty where that would not be shorter, or where `mpeg1` is not one picture with or without
  // headers of sequence and group as mpeg1::Encoder writes it. `surface`: which surfaces L shows, as
  // ModelPredictor::surface() has them, or empty; the same on both sides: it decides the size, not what comes out.
  Bytes pack(std::span<const uint8_t> mpeg1, bool stands_alone, PlaneView<const uint32_t> surface);
  // The size pack() would give, or that of mpeg1; nothing is learned.
  uint64_t packed_size(std::span<const uint8_t> mpeg1, bool stands_alone, PlaneView<const uint32_t> surface);

  // What each decision about the picture's macroblocks costs here: of the decision itself, and of what would have been
  // coded otherwise. For an encoder that codes it again; nothing is learned. False where there is nothing to pack.
  bool prices(std::span<const uint8_t> mpeg1, bool stands_alone, PlaneView<const uint32_t> surface,
              std::vector<mpeg1::MacroblockPrices>& out);

  // A picture that stands alone was sent as it is: the next ones begin anew. On the receiving side.
  void forget();

  // Appends the MPEG-1 picture. Fails with corrupt; nothing is learned then.
  Result<void> unpack(std::span<const uint8_t> packed, bool stands_alone, PlaneView<const uint32_t> surface,
                      Bytes& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pac::sim
