#include "jpeg/progressive.h"

#include "base/kernels/block_kernels.h"

namespace pac::jpeg {
namespace {

int16_t wrapped(int value) {
  return static_cast<int16_t>(static_cast<uint16_t>(value));
}

BlockError read_dc_first(BitWindow& bits, const HuffmanDecoder& table, int low, int& dc, int16_t* levels) {
  bits.refill();
  const int size = read_symbol(bits, table);
  if (size < 0) return BlockError::undefined_code;
  if (size > 0) dc = wrapped(dc + extend(bits.read(size), size));
  levels[0] = wrapped(dc * (1 << low));
  return BlockError::none;
}

void read_dc_refinement(BitWindow& bits, int low, int16_t* levels) {
  bits.refill();
  if (bits.read(1) != 0) levels[0] = wrapped(levels[0] | 1 << low);
}

// EOBn: this block and 2^n - 1 + (n bits) more end here.
uint32_t read_eob_run(BitWindow& bits, int n) {
  return (uint32_t{1} << n) + (n > 0 ? bits.read(n) : 0);
}

BlockError read_ac_first(BitWindow& bits, const Progression& p, const HuffmanDecoder& table, uint32_t& eob_run,
                         int16_t* levels) {
  for (int k = p.first; k <= p.last; ++k) {
    bits.refill();
    const int symbol = read_symbol(bits, table);
    if (symbol < 0) return BlockError::undefined_code;
    const int run = symbol >> 4, size = symbol & 15;
    if (size == 0 && run < 15) {
      eob_run = read_eob_run(bits, run) - 1;
      return BlockError::none;
    }
    k += run;
    if (size == 0) continue;  // sixteen zeros
    if (k > p.last) return BlockError::past_end;
    levels[kNaturalFromZigzag[k]] = wrapped(extend(bits.read(size), size) * (1 << p.low));
  }
  return BlockError::none;
}

// Another bit for a level that is not 0 already: away from zero.
void correct(BitWindow& bits, int unit, int16_t& level) {
  bits.refill();
  if (bits.read(1) != 0 && (level & unit) == 0) level = wrapped(level + (level >= 0 ? unit : -unit));
}

// Passes `run` levels that are 0, correcting those that are not. Returns the position of the 0 behind them.
int pass_zeros(BitWindow& bits, const Progression& p, int k, int run, int16_t* levels) {
  for (; k <= p.last; ++k) {
    int16_t& level = levels[kNaturalFromZigzag[k]];
    if (level != 0)
      correct(bits, 1 << p.low, level);
    else if (run-- == 0)
      break;
  }
  return k;
}

BlockError read_ac_refinement(BitWindow& bits, const Progression& p, const HuffmanDecoder& table, uint32_t& eob_run,
                              int16_t* levels) {
  int k = p.first;
  for (; eob_run == 0 && k <= p.last; ++k) {
    bits.refill();
    const int symbol = read_symbol(bits, table);
    if (symbol < 0) return BlockError::undefined_code;
    const int run = symbol >> 4, size = symbol & 15;
    if (size > 1) return BlockError::undefined_symbol;  // a new level has one bit
    int value = 0;
    if (size == 1) {
      value = bits.read(1) != 0 ? 1 << p.low : -(1 << p.low);
    } else if (run < 15) {
      eob_run = read_eob_run(bits, run);
      break;
    }
    k = pass_zeros(bits, p, k, run, levels);
    if (value == 0) continue;
    if (k > p.last) return BlockError::past_end;
    levels[kNaturalFromZigzag[k]] = wrapped(value);
  }
  if (eob_run == 0) return BlockError::none;
  pass_zeros(bits, p, k, 64, levels);
  eob_run -= 1;
  return BlockError::none;
}

}  // namespace

BlockError read_progressive_block(EntropyReader& reader, const Progression& progression, const HuffmanDecoder* dc_table,
                                  const HuffmanDecoder* ac_table, int& dc, uint32_t& eob_run, int16_t* levels) {
  if (progression.is_dc() && progression.refines()) {
    read_dc_refinement(reader.bits, progression.low, levels);
    return BlockError::none;
  }
  if (progression.is_dc()) return read_dc_first(reader.bits, *dc_table, progression.low, dc, levels);
  if (progression.refines()) return read_ac_refinement(reader.bits, progression, *ac_table, eob_run, levels);
  if (eob_run > 0) {
    eob_run -= 1;
    return BlockError::none;
  }
  return read_ac_first(reader.bits, progression, *ac_table, eob_run, levels);
}

}  // namespace pac::jpeg
