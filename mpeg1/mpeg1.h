// MPEG-1 video [ISO/IEC 11172-2]: the public face of the codec.
//
//   auto encoder = mpeg1::Encoder::create({.width = 640, .height = 480, .quantizer_scale = 4});
//   for (const Frame420& frame : frames) PAC_CHECK(encoder->add(frame, bytes));
//   encoder->finish(bytes);
//
//   mpeg1::Decoder decoder;
//   decoder.feed(bytes);
//   decoder.finish();
//   for (;;) { auto picture = decoder.next(); if (!picture || *picture == nullptr) break; use((*picture)->view); }
//
// One object, one thread at a time; distinct objects are independent. The encoder writes I and P pictures; its
// reconstruction is the decoder's picture bit for bit, on every instruction set and with every number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"

namespace pac::mpeg1 {

// Legal frame rates [11172-2 2.4.3.2, picture_rate], in 1/1000 frames a second; index = picture_rate code.
constexpr int kPictureRatesMilli[9] = {0, 23976, 24000, 25000, 29970, 30000, 50000, 59940, 60000};

// The paper's 20 frames a second is no legal picture_rate: the code of the nearest one that is not slower.
constexpr int picture_rate_code(int rate_milli) {
  for (int code = 1; code <= 8; ++code)
    if (kPictureRatesMilli[code] >= rate_milli) return code;
  return 8;
}

constexpr int kMaxWidth = 4095, kMaxHeight = 2800;  // 12-bit fields [2.4.2.3]; slice_vertical_position ends at row 175

// picture_coding_type [2.4.3.4]. The encoder writes I and P.
enum class PictureType : uint8_t { I = 1, P = 2, B = 3, D = 4 };

// In half samples of luma, from a macroblock to its prediction: x to the right, y down.
struct MotionVector {
  int16_t x_halfpel = 0, y_halfpel = 0;
  friend bool operator==(const MotionVector&, const MotionVector&) = default;
};

// A 4:2:0 picture that somebody else owns: chroma planes of half the luma size, rounded up.
struct FrameView {
  PlaneView<const uint8_t> y, cb, cr;
  int width() const { return y.width; }
  int height() const { return y.height; }
};
FrameView view_of(const Frame420& frame);
// A copy of its own.
Frame420 copy_of(const FrameView& frame);

// Quantizer matrices in natural (row) order, entries 1..255; intra[0] is 8. Entries below 16 quantize finer than
// quantizer_scale says.
using QuantizerMatrix = std::array<uint8_t, 64>;
extern const QuantizerMatrix kDefaultIntraMatrix;     // [2.4.3.2]
extern const QuantizerMatrix kDefaultNonIntraMatrix;  // all 16

// ---- Encoder -------------------------------------------------------------------------------------------------------

// How hard the encoder searches.
enum class Effort : uint8_t {
  fast,    // one pass: predictors, half-pel by SAD, dead-zone quantization
  normal,  // rate-distortion decisions of mode, vector and coefficients
  best,    // wider search, full trellis, more candidates
};

constexpr double kLeastQuantizerScale = 0.1875;  // makes 3 of a matrix entry of 16

struct SequenceOptions {
  int width = 0, height = 0;      // 1..kMaxWidth, 1..kMaxHeight, luma samples
  int picture_rate_code = 5;      // 1..8: kPictureRatesMilli
  int pel_aspect_ratio_code = 1;  // 1..14 [2.4.3.2]; 1 = square
  int gop_length = 15;            // an I picture every so many pictures, 1..132; display order is coding order
  // kLeastQuantizerScale..31 where bit_rate_bps is 0: of P pictures; below 1, quantizer_scale 1 and matrices that are
  // multiplied by it; between integers, macroblocks of both kinds. I pictures are quantized
  // finer, down to 0.7 of it where the group before stood still: their quality is what the others inherit.
  double quantizer_scale = 4;
  int64_t bit_rate_bps = 0;  // 400..104857200 (multiple of 400 after rounding up): constant bit rate with VBV
  int vbv_buffer_size = 0;   // 1..1023 units of 16384 bits; 0: chosen
  Effort effort = Effort::normal;
  int slice_rows = 0;         // macroblock rows a slice, 0: one slice a picture
  int threads = 1;            // 0: all processors; the bytes never depend on it
  bool scene_cuts = false;    // an I picture instead of a P picture where the scene changes
  bool intra_refresh = true;  // each macroblock intra at least once in 132 predicted codings [2.4.4.2]
  // Absent: the default ones; from 320x240 on, efforts normal and best send an intra matrix that is nearer to flat.
  std::optional<QuantizerMatrix> intra_matrix, non_intra_matrix;
  // Later groups begin with matrices that suit the coefficients of the groups before. Not at Effort::fast, and not for
  // players that read the first sequence header only, as jsmpeg does.
  bool adapt_matrices = false;
  Limits limits;
};

// What a caller pays who codes a picture's syntax elements another way than Annex B does: costs in 1/256 bit, 0..65535.
struct BlockPrices {
  static constexpr int kSizes = 4;
  uint16_t left_out = 0, coded = 0;  // of the block in coded_block_pattern
  // By zigzag position: no level there while others follow, or one, its sign included; after it more, or none.
  uint16_t zero[64] = {}, level[64] = {}, more[64] = {}, last[64] = {};
  uint16_t size[64][kSizes] = {};  // of |level| 1..kSizes there
  uint16_t step[64] = {};          // of each step beyond
};
struct MacroblockPrices {
  uint16_t skipped = 0, inter = 0, intra = 0;  // its kind
  uint16_t still = 0, moving = 0;              // of inter: vector zero; another, before its own bits
  uint16_t same = 0, changed = 0;              // quantizer_scale as of the last coded macroblock, or the next one to it
  BlockPrices blocks[6];
};

// What one picture's caller may decide. Everything has a meaning when left out.
struct PictureOptions {
  // I or P; absent: by gop_length (and scene_cuts). The first picture is I whatever this says, unless it is P with a
  // reference of the caller's. An I picture starts a new group of pictures.
  std::optional<PictureType> type;
  // Predict a P picture from this instead of the last reconstruction: same size as the sequence. The decoder must be
  // given the same samples (DecoderOptions::reference). Borrowed for the call.
  const Frame420* reference = nullptr;
  // Vectors to try, besides the encoder's own: `candidates_per_macroblock` for each macroblock in raster order. Those
  // that lead outside the picture are clamped. Size: macroblock count times that number, or empty.
  std::span<const MotionVector> candidates;
  int candidates_per_macroblock = 0;
  // quantizer_scale of each macroblock, 1..31, raster order; empty: quantizer_scale everywhere.
  std::span<const uint8_t> quantizer_map;
  // What quantizer_scale is multiplied by in each macroblock, 1/16..16, raster order; empty: by 1. An error of a
  // macroblock of 1/2 counts four times as much. Followed where it is worth the change of quantizer_scale that it
  // costs. Not with a quantizer_map or a constant bit rate.
  std::span<const float> quantizer_factors;
  // The frames that come after this one, in order, as many as are known; those after the group are not looked at. Where
  // the picture starts a group the encoder sees from them which macroblocks the group goes on showing, and quantizes
  // those finer than quantizer_scale, here and in the pictures that follow: more bytes at the same quantizer_scale,
  // fewer at the same error; at a constant bit rate, less error. Frames that come otherwise than told cost bytes,
  // nothing else. No effect with a quantizer_map or a quantizer_scale of the picture's own. Borrowed for the call;
  // fails with bad_argument where one is null or has another size.
  std::span<const Frame420* const> following;
  // 1..31, exactly that for this picture; 0: the sequence's, or the rate control's.
  double quantizer_scale = 0;
  // A caller's own rate control: told the picture's quantizer_scale and size, headers included, it returns the scale
  // 1..31 to code the picture at instead (not with a quantizer_map), kSkipEverything, or 0 to keep what was coded; it
  // is asked again after each. Where there is no constant bit rate.
  double (*code_again)(void* context, double quantizer_scale, uint64_t size_bytes) = nullptr;
  void* code_again_context = nullptr;
  // Of each macroblock in raster order: what decisions about its levels, pattern and kind weigh instead of Annex B's
  // code lengths; empty: those. code_again may set them for the next coding. P pictures, not at Effort::fast; levels of
  // intra macroblocks, vectors and quantizers stay at Annex B's.
  std::span<const MacroblockPrices> prices;
};

// Instead of a quantizer_scale: a P picture of nothing but skipped macroblocks, which shows its reference in some 20
// bytes and is kept. I pictures are coded at 31 instead.
constexpr double kSkipEverything = -1;

struct PictureReport {
  PictureType type = PictureType::I;
  uint64_t size_bytes = 0;  // appended to `out`, all headers included
  double quantizer_scale = 0;
  int intra_macroblocks = 0, skipped_macroblocks = 0, coded_macroblocks = 0;  // of P pictures: inter with coefficients
};

class Encoder {
 public:
  // Fails with bad_argument where an option leaves its range, limit_exceeded for too many pixels.
  static Result<Encoder> create(const SequenceOptions& options, Isa isa = best_isa());
  ~Encoder();
  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;

  // Codes one frame of the sequence's size and appends the complete picture (with sequence and group headers where one
  // starts). Fails with bad_argument and appends nothing where the frame or an option does not fit.
  Result<PictureReport> add(const Frame420& frame, std::vector<uint8_t>& out, const PictureOptions& options = {});
  // A P picture of skipped macroblocks only: shows the last picture again, in some 20 bytes.
  Result<PictureReport> repeat(std::vector<uint8_t>& out);
  // Appends sequence_end_code. The next add() would start a new sequence.
  void finish(std::vector<uint8_t>& out);

  // What a decoder shows for the last picture. Valid until the next call.
  FrameView reconstruction() const;

 private:
  struct State;
  explicit Encoder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

int macroblock_columns(int width);  // ceil(width / 16)
int macroblock_rows(int height);

// ---- Decoder -------------------------------------------------------------------------------------------------------

// sequence_header [2.4.2.3].
struct SequenceHeader {
  int width = 0, height = 0;
  int pel_aspect_ratio_code = 1, picture_rate_code = 5;
  int bit_rate = 0x3FFFF;   // units of 400 bits a second; 0x3FFFF: variable
  int vbv_buffer_size = 0;  // units of 16384 bits
  bool constrained_parameters = false;
  bool has_intra_matrix = false, has_non_intra_matrix = false;
  QuantizerMatrix intra_matrix = kDefaultIntraMatrix, non_intra_matrix = kDefaultNonIntraMatrix;
};

// picture header [2.4.2.5].
struct PictureHeader {
  PictureType type = PictureType::I;
  int temporal_reference = 0;  // 0..1023
  int vbv_delay = 0xFFFF;      // 90 kHz ticks
  bool full_pel_forward = false, full_pel_backward = false;
  int forward_f_code = 1, backward_f_code = 1;  // 1..7
};

struct DecodedPicture {
  FrameView view;  // cropped to the sequence's size; valid until the next call of the decoder
  PictureHeader header;
  uint64_t byte_offset = 0;       // of the picture_start_code
  int concealed_macroblocks = 0;  // copied from the reference because the stream lacks them
  // Of a picture that DecoderOptions::reference predicted, delivered at once: a byte a macroblock, row by row,
  // kCopiedMacroblock where it shows what that frame shows there. Valid as long as `view`; else empty.
  std::span<const uint8_t> macroblocks;
};
constexpr uint8_t kCopiedMacroblock = 3;

// What was wrong with a stream that was decoded all the same.
struct ErrorReport {
  uint64_t errors = 0;  // violations met
  uint64_t concealed_macroblocks = 0;
  uint64_t dropped_pictures = 0;  // B or P pictures without their references, unreadable headers
  Failure first;                  // the first one, with its byte offset; meaningful where errors > 0
};

struct DecoderOptions {
  Limits limits;           // max_pixels a picture; max_bytes waiting to be decoded
  bool strict = false;     // stop at the first violation instead of concealing
  bool low_delay = false;  // deliver I and P pictures at once: for streams without B pictures
  // Called before each P picture: what predicts it instead of `last`, the latest reference picture; null: `last`. The
  // frame has the sequence's size and lives until the picture is delivered.
  const Frame420* (*reference)(void* context, const PictureHeader& header, const FrameView& last) = nullptr;
  void* reference_context = nullptr;
};

// Elementary video streams (system streams: demultiplex first, mpeg1/system.h). Copies what it is fed.
class Decoder {
 public:
  explicit Decoder(const DecoderOptions& options = {}, Isa isa = best_isa());
  ~Decoder();
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;

  // Appends bytes of the stream; any division into calls gives the same pictures.
  void feed(std::span<const uint8_t> bytes);
  // The bytes fed so far end with a complete picture: decode it without waiting for the next start code.
  void end_picture();
  // The stream is over: the last pictures come out. A later feed() continues as if another stream were appended.
  void finish();

  // The next picture in display order, or null: more bytes are needed (after finish(): there are no more). Fails on
  // unsupported streams and limits, in strict mode on any violation; after a failure, again with the same one.
  Result<const DecodedPicture*> next();

  // The latest sequence_header; null before the first.
  const SequenceHeader* sequence() const;
  const ErrorReport& report() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pac::mpeg1
