#include "sim/picture_packing.h"

#include <algorithm>
#include <utility>

#include "geomcodec/range_coder.h"
#include "mpeg1/headers.h"
#include "sim/picture_coder.h"
#include "sim/picture_syntax.h"

namespace pac::sim {

namespace {

using geomcodec::RangeDecoder;
using geomcodec::RangeEncoder;
using packing::Learned;

constexpr size_t kMostHeaders = 255;  // bytes, of sequence and group
constexpr uint8_t kTrusted = 8;       // bits that a context's past counts for at most in the next picture

// Where the picture header begins: behind headers of sequence and group, if there are any.
size_t picture_start(std::span<const uint8_t> bytes) {
  for (size_t i = 0; i + 4 <= bytes.size() && i <= kMostHeaders; ++i)
    if (bytes[i] == 0 && bytes[i + 1] == 0 && bytes[i + 2] == 1 && bytes[i + 3] == mpeg1::kPictureStart) return i;
  return bytes.size();
}

// Their number, then the bytes as they are.
template <class Coder>
void code_headers(Coder& coder, Bytes& headers) {
  const uint32_t has_some = coder.raw(1, headers.empty() ? 0 : 1);
  if (has_some == 0) return;
  headers.resize(coder.raw(8, static_cast<uint32_t>(headers.size())));
  for (uint8_t& byte : headers) byte = static_cast<uint8_t>(coder.raw(8, byte));
}

}  // namespace

struct PicturePacker::State {
  int columns, rows;
  Learned taught;  // by the last picture that stood alone
  PictureSyntax syntax;

  template <class Coder>
  bool code(Coder& coder, bool stands_alone, PlaneView<const uint32_t> surface, Learned& learned,
            mpeg1::MacroblockPrices* prices = nullptr) {
    learned = stands_alone ? Learned() : taught;
    if (!stands_alone) learned.mixer.loosen(kTrusted);
    return packing::PictureCoder<Coder>(coder, learned, syntax, surface, columns, rows, prices).code();
  }

  Bytes pack(std::span<const uint8_t> mpeg1, bool stands_alone, PlaneView<const uint32_t> surface, Learned& learned) {
    const size_t start = picture_start(mpeg1);
    Bytes headers(mpeg1.begin(), mpeg1.begin() + static_cast<ptrdiff_t>(start)), again = headers;
    if (start > kMostHeaders || !read_picture(mpeg1.subspan(start), columns, rows, syntax)) return {};
    write_picture(syntax, columns, rows, again);
    if (!std::equal(again.begin(), again.end(), mpeg1.begin(), mpeg1.end())) return {};
    RangeEncoder coder;
    code_headers(coder, headers);
    if (!code(coder, stands_alone, surface, learned)) return {};
    Bytes packed = coder.finish();
    return packed.size() < mpeg1.size() ? packed : Bytes();
  }
};

PicturePacker::PicturePacker(int width, int height)
    : state_(new State{mpeg1::macroblock_columns(width), mpeg1::macroblock_rows(height), {}, {}}) {}
PicturePacker::~PicturePacker() = default;
PicturePacker::PicturePacker(PicturePacker&&) noexcept = default;
PicturePacker& PicturePacker::operator=(PicturePacker&&) noexcept = default;

Bytes PicturePacker::pack(std::span<const uint8_t> mpeg1, bool stands_alone, PlaneView<const uint32_t> surface) {
  Learned learned;
  Bytes packed = state_->pack(mpeg1, stands_alone, surface, learned);
  if (stands_alone) state_->taught = packed.empty() ? Learned() : std::move(learned);
  return packed;
}

uint64_t PicturePacker::packed_size(std::span<const uint8_t> mpeg1, bool stands_alone,
                                    PlaneView<const uint32_t> surface) {
  Learned learned;
  const Bytes packed = state_->pack(mpeg1, stands_alone, surface, learned);
  return packed.empty() ? mpeg1.size() : packed.size();
}

bool PicturePacker::prices(std::span<const uint8_t> mpeg1, bool stands_alone, PlaneView<const uint32_t> surface,
                           std::vector<mpeg1::MacroblockPrices>& out) {
  State& s = *state_;
  const size_t start = picture_start(mpeg1);
  if (!read_picture(mpeg1.subspan(start), s.columns, s.rows, s.syntax)) return false;
  out.resize(s.syntax.macroblocks.size());
  RangeEncoder coder;
  Learned learned;
  return s.code(coder, stands_alone, surface, learned, out.data());
}

void PicturePacker::forget() {
  state_->taught = Learned();
}

Result<void> PicturePacker::unpack(std::span<const uint8_t> packed, bool stands_alone,
                                   PlaneView<const uint32_t> surface, Bytes& out) {
  State& s = *state_;
  RangeDecoder coder(packed);
  Bytes headers;
  Learned learned;
  s.syntax = {};
  code_headers(coder, headers);
  if (!s.code(coder, stands_alone, surface, learned) || !coder.ends_exactly())
    return Failure{Error::corrupt, 0, "packed picture is damaged"};
  if (stands_alone) s.taught = std::move(learned);
  out.insert(out.end(), headers.begin(), headers.end());
  write_picture(s.syntax, s.columns, s.rows, out);
  return {};
}

}  // namespace pac::sim
