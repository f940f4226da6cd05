#include "jpeg/scan_reader.h"

#include "base/kernels/block_kernels.h"

namespace pac::jpeg {
namespace {

// kNaturalFromZigzag, continued for runs that end past the block: what they bring goes to a 65th level.
struct NaturalOrder {
  uint8_t of[64 + 16];
};
constexpr NaturalOrder make_natural_order() {
  NaturalOrder order{};
  for (int k = 0; k < 80; ++k) order.of[k] = k < 64 ? kNaturalFromZigzag[k] : uint8_t{63};
  return order;
}
constexpr NaturalOrder kNatural = make_natural_order();

// A symbol whose code is longer than the look-up index, or -1.
int read_long_symbol(BitWindow& bits, const HuffmanDecoder& table) {
  for (int length = HuffmanDecoder::kLookupBits + 1; length <= kMaxCodeLength; ++length) {
    const auto code = static_cast<int32_t>(bits.peek(length));
    if (code <= table.max_code[length]) {
      bits.skip(length);
      return table.symbols[(code + table.offset[length]) & 255];
    }
  }
  return -1;
}

// Appends bytes from `raw` up to the next marker, the file's end or `limit` in the buffer, without the stuffed zeros.
struct Unstuffed {
  const uint8_t* raw;
  uint8_t* out;
  bool at_marker;
};
Unstuffed unstuff(const uint8_t* raw, const uint8_t* file_end, uint8_t* out, const uint8_t* limit) {
  for (;;) {
    const ptrdiff_t room = limit - out, left = file_end - raw;
    const ptrdiff_t n = room < left ? room : left;
    if (n == 0) return {raw, out, left == 0};
    const void* found = std::memchr(raw, 0xFF, static_cast<size_t>(n));
    const ptrdiff_t plain = found != nullptr ? static_cast<const uint8_t*>(found) - raw : n;
    std::memcpy(out, raw, static_cast<size_t>(plain));
    raw += plain;
    out += plain;
    if (found == nullptr) continue;
    if (file_end - raw < 2 || raw[1] != 0) return {raw, out, true};
    *out++ = 0xFF;
    raw += 2;
  }
}

}  // namespace

EntropyReader::EntropyReader()
    : buffer_(std::make_unique_for_overwrite<uint8_t[]>(static_cast<size_t>(kChunk + kPadding))) {}

void EntropyReader::start(std::span<const uint8_t> file, uint64_t offset) {
  file_begin_ = file.data();
  file_end_ = file.data() + file.size();
  restart_at(offset);
}

void EntropyReader::restart_at(uint64_t offset) {
  raw_ = file_begin_ + offset;
  end_ = buffer_.get();
  is_at_marker_ = false;
  bits = {0, 0, buffer_.get()};
  top_up();
}

// Only where no padding has been fetched yet: bits.next <= end_.
void EntropyReader::top_up() {
  const ptrdiff_t unread = end_ - bits.next;
  if (unread > 0) std::memmove(buffer_.get(), bits.next, static_cast<size_t>(unread));
  bits.next = buffer_.get();
  const Unstuffed done = unstuff(raw_, file_end_, buffer_.get() + unread, buffer_.get() + kChunk);
  raw_ = done.raw;
  end_ = done.out;
  is_at_marker_ = done.at_marker;
  if (is_at_marker_) std::memset(done.out, 0, static_cast<size_t>(kPadding));
}

uint64_t EntropyReader::byte_offset() const {
  // Walk back over the whole unread bytes; a stuffed zero belongs to the 0xFF before it.
  const uint8_t* at = raw_;
  for (ptrdiff_t bytes = end_ - bits.next + (bits.n_bits >> 3); bytes > 0 && at > file_begin_; --bytes) {
    --at;
    if (*at == 0 && at > file_begin_ && at[-1] == 0xFF) --at;
  }
  return static_cast<uint64_t>(at - file_begin_);
}

int read_symbol(BitWindow& bits, const HuffmanDecoder& table) {
  const HuffmanDecoder::Entry entry = table.lookup[bits.peek(HuffmanDecoder::kLookupBits)];
  if (entry.length == 0) return read_long_symbol(bits, table);
  bits.skip(entry.value != 0 ? entry.length - (entry.symbol & 15) : entry.length);
  return entry.symbol;
}

namespace {

BlockError read_dc(BitWindow& bits, const HuffmanDecoder& table, int& dc) {
  bits.refill();
  const HuffmanDecoder::Entry entry = table.lookup[bits.peek(HuffmanDecoder::kLookupBits)];
  int difference = entry.value;
  bits.skip(entry.length);
  if (difference == 0) {
    const int size = entry.length > 0 ? entry.symbol : read_long_symbol(bits, table);
    if (size < 0) return BlockError::undefined_code;
    if (size > 0) difference = extend(bits.read(size), size);
  }
  dc = static_cast<int16_t>(static_cast<uint16_t>(dc + difference));
  return BlockError::none;
}

// What a look-up with value 0 stands for: EOB, ZRL, or a level whose code or extra bits are longer than the index.
// k: the position at hand, moved behind the level read.
enum class Step : uint8_t { level, end, undefined_code, undefined_symbol };
Step read_rare(BitWindow& bits, const HuffmanDecoder& table, HuffmanDecoder::Entry entry, int& k, int16_t* levels) {
  bits.skip(entry.length);
  const int symbol = entry.length > 0 ? entry.symbol : read_long_symbol(bits, table);
  if (symbol < 0) return Step::undefined_code;
  const int size = symbol & 15;
  k += symbol >> 4;
  if (size > 0) {
    levels[kNatural.of[k]] = static_cast<int16_t>(extend(bits.read(size), size));
  } else if (symbol != 0xF0) {  // ZRL is sixteen zeros
    return symbol == 0 ? Step::end : Step::undefined_symbol;
  }
  k += 1;
  return Step::level;
}

// One AC symbol with its extra bits, k < 64.
Step read_ac(BitWindow& bits, const HuffmanDecoder& table, int& k, int16_t* levels) {
  bits.refill();
  const HuffmanDecoder::Entry entry = table.lookup[bits.peek(HuffmanDecoder::kLookupBits)];
  if (entry.value == 0) return read_rare(bits, table, entry, k, levels);
  k += entry.symbol >> 4;
  bits.skip(entry.length);
  levels[kNatural.of[k++]] = entry.value;
  return Step::level;
}

// Look-ups of pairs as long as they find something: moves k; true if the block has ended with an EOB.
inline bool read_ac_pairs(BitWindow& bits, const AcPairs& pairs, int& k, int16_t* levels) {
  constexpr int kLookups = 56 / AcPairs::kBits;  // without refill()
  for (;;) {
    bits.refill();
    for (int i = 0; i < kLookups; ++i) {
      const AcPairs::Entry entry = pairs.lookup[bits.peek(AcPairs::kBits)];
      const int next = k + entry.advance;
      if (next > 64) return false;
      // The second one first: if it is no level, its 0 may meet the first where the block ends.
      levels[kNatural.of[k + entry.place[1]]] = entry.level[1];
      levels[kNatural.of[k + entry.place[0]]] = entry.level[0];
      bits.skip(entry.length_and_end & AcPairs::kLengthMask);
      k = next;
      if ((entry.length_and_end & AcPairs::kEnds) != 0) return true;
    }
  }
}

// Returns the error, if any.
inline BlockError read_block(BitWindow& bits, const BlockSlot& slot, int16_t* levels, uint8_t& last) {
  if (const BlockError error = read_dc(bits, *slot.dc_table, *slot.dc); error != BlockError::none) return error;
  levels[0] = static_cast<int16_t>(*slot.dc);
  BlockError error = BlockError::none;
  int k = 1, end = 1;  // the next position; behind the last level
  while (k < 64 && error == BlockError::none) {
    if (slot.ac_pairs != nullptr) {
      const bool at_end = read_ac_pairs(bits, *slot.ac_pairs, k, levels);
      end = at_end ? k - 1 : k;
      if (at_end || k == 64) break;
    }
    const Step step = read_ac(bits, *slot.ac_table, k, levels);
    if (step == Step::end) break;
    if (step == Step::undefined_code) error = BlockError::undefined_code;
    if (step == Step::undefined_symbol) error = BlockError::undefined_symbol;
    end = k;
  }
  if (k > 64 && error == BlockError::none) error = BlockError::past_end;
  last = static_cast<uint8_t>(end > 64 ? 63 : end - 1);
  return error;
}

}  // namespace

BlockError read_mcu_blocks(EntropyReader& reader, std::span<const BlockSlot> slots, size_t mcu) {
  BitWindow bits = reader.bits;  // a copy that the compiler keeps in registers
  BlockError error = BlockError::none;
  for (const BlockSlot& slot : slots) {
    const size_t block = mcu * slot.blocks_in_row;
    error = read_block(bits, slot, slot.levels + 64 * block, slot.last[block]);
    if (error != BlockError::none) break;
  }
  reader.bits = bits;
  return error;
}

}  // namespace pac::jpeg
