// Abbreviated streams [T.81 B.4, B.5]: tables once, then images that carry none. For sequences of small pictures, where
// the tables of every file would weigh more than the changes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "jpeg/jpeg.h"

namespace pac::jpeg {

// Quantization and Huffman tables that all images of a stream share. Immutable, cheap to copy; may be used by several
// encoders at once. Named by EncodeOptions::stream.
class StreamTables {
 public:
  // With the Huffman tables of Annex K.3. Errors: bad_argument (a step outside 1..255).
  static Result<StreamTables> standard(const QuantTables& steps);
  // With the quantization tables that `options` ask for at the first picture, and Huffman tables that are best for all
  // the pictures together, yet have a code for whatever another one may bring. At least one picture. Errors: as
  // encode().
  static Result<StreamTables> for_pictures(std::span<const ConstRgbView> pictures, const EncodeOptions& options);
  StreamTables(const StreamTables&);
  StreamTables(StreamTables&&) noexcept;
  StreamTables& operator=(const StreamTables&);
  StreamTables& operator=(StreamTables&&) noexcept;
  ~StreamTables();

  const QuantTables& steps() const;
  // SOI, DQT, DHT, EOI: what the decoder must see before the first image.
  std::vector<uint8_t> file() const;

  struct State;
  const State& state() const { return *state_; }

 private:
  explicit StreamTables(std::shared_ptr<const State> state);
  std::shared_ptr<const State> state_;
};

// Decodes a stream's files in order: tables, images without tables, also whole files; tables stay until others replace
// them. Restart intervals do not. Keeps its working memory from image to image.
class StreamDecoder {
 public:
  explicit StreamDecoder(const DecodeOptions& options = {});  // as Decoder
  ~StreamDecoder();
  StreamDecoder(StreamDecoder&&) noexcept;
  StreamDecoder& operator=(StreamDecoder&&) noexcept;

  // A file of tables alone. Errors: truncated, corrupt; then no table has changed.
  Result<void> read_tables(std::span<const uint8_t> bytes);
  // The next image, strictly. Errors: as decode(), and then no table has changed.
  Result<RgbImage> decode(std::span<const uint8_t> bytes);
  // As before the first file.
  void forget_tables();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pac::jpeg
