#include "jpeg/scan_reader.h"

#include "base/kernels/block_kernels.h"

namespace pac::jpeg {
namespace {

// A symbol whose code is longer than the look-up index, or -1 [T.81 F.2.2.3 DECODE].
int read_long_symbol(EntropyReader& reader, const HuffmanDecoder& table) {
  for (int length = HuffmanDecoder::kLookupBits + 1; length <= kMaxCodeLength; ++length) {
    const auto code = static_cast<int32_t>(reader.peek(length));
    if (code <= table.max_code[length]) {
      reader.skip(length);
      return table.symbols[(code + table.offset[length]) & 255];
    }
  }
  return -1;
}

}  // namespace

void EntropyReader::refill_bytewise() {
  reservoir_ = n_bits_ > 0 ? reservoir_ >> (64 - n_bits_) << (64 - n_bits_) : 0;
  while (n_bits_ <= 56) {
    uint64_t byte = 0;
    if (next_ < end_ && *next_ != 0xFF) {
      byte = *next_++;
    } else if (end_ - next_ >= 2 && next_[1] == 0) {
      byte = 0xFF;
      next_ += 2;
    } else {
      n_padding_bits_ += 8;
    }
    reservoir_ |= byte << (56 - n_bits_);
    n_bits_ += 8;
  }
}

uint64_t EntropyReader::byte_offset() const {
  // Walk back over the whole unread bytes; a stuffed zero belongs to the 0xFF before it.
  const uint8_t* at = next_;
  for (int64_t bits = n_bits_ - n_padding_bits_; bits >= 8 && at > begin_; bits -= 8) {
    --at;
    if (*at == 0 && at > begin_ && at[-1] == 0xFF) --at;
  }
  return static_cast<uint64_t>(at - begin_);
}

void EntropyReader::restart_at(uint64_t offset) {
  next_ = begin_ + offset;
  reservoir_ = 0;
  n_bits_ = 0;
  n_padding_bits_ = 0;
}

BlockError read_block(EntropyReader& reader, const HuffmanDecoder& dc_table, const HuffmanDecoder& ac_table, int& dc,
                      int16_t* levels, uint8_t& last) {
  last = 0;
  reader.refill();
  const HuffmanDecoder::Entry entry = dc_table.lookup[reader.peek(HuffmanDecoder::kLookupBits)];
  int difference = entry.value;
  reader.skip(entry.length);
  if (difference == 0) {
    const int size = entry.length > 0 ? entry.symbol : read_long_symbol(reader, dc_table);
    if (size < 0) return BlockError::undefined_code;
    if (size > 0) difference = extend(reader.read(size), size);
  }
  dc = static_cast<int16_t>(static_cast<uint16_t>(dc + difference));
  levels[0] = static_cast<int16_t>(dc);

  for (int k = 1; k < 64; ++k) {
    reader.refill();
    const HuffmanDecoder::Entry ac = ac_table.lookup[reader.peek(HuffmanDecoder::kLookupBits)];
    int value = ac.value, symbol = ac.symbol;
    reader.skip(ac.length);
    if (value == 0) {
      if (ac.length == 0) symbol = read_long_symbol(reader, ac_table);
      if (symbol < 0) return BlockError::undefined_code;
      const int size = symbol & 15;
      if (size == 0) {
        if (symbol == 0) return BlockError::none;  // EOB
        if (symbol != 0xF0) return BlockError::undefined_symbol;
        k += 15;  // ZRL: sixteen zeros
        if (k >= 63) return BlockError::past_end;
        continue;
      }
      value = extend(reader.read(size), size);
    }
    k += symbol >> 4;
    if (k > 63) return BlockError::past_end;
    levels[kNaturalFromZigzag[k]] = static_cast<int16_t>(value);
    last = static_cast<uint8_t>(k);
  }
  return BlockError::none;
}

}  // namespace pac::jpeg
