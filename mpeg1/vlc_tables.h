// The variable length codes of video [11172-2 Annex B]: tables B.1 to B.5, once, for reading and writing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace pac::mpeg1 {

struct Code {
  uint16_t bits = 0;   // right-aligned
  uint8_t length = 0;  // 0: no such code
};

// Table B.1, macroblock_address_increment 1..33 at [1..33].
constexpr int kAddressEscape = 34;    // 0000 0001 000: adds 33
constexpr int kAddressStuffing = 35;  // 0000 0001 111: to be skipped
extern const std::array<Code, 36> kAddressIncrementCodes;

// What a macroblock_type [tables B.2a..d] says is in the macroblock.
constexpr uint8_t kQuant = 16, kForward = 8, kBackward = 4, kPattern = 2, kIntra = 1;
struct MacroblockType {
  uint8_t flags;
  Code code;
};
extern const std::array<MacroblockType, 2> kTypesOfI;
extern const std::array<MacroblockType, 7> kTypesOfP;
extern const std::array<MacroblockType, 11> kTypesOfB;

// Table B.3: coded_block_pattern 1..63 at [1..63]; bit 5 = first luma block, bit 0 = Cr. 0 has no code.
extern const std::array<Code, 64> kPatternCodes;

// Table B.4: |motion_code| 0..16, without the sign bit that follows those above 0.
extern const std::array<Code, 17> kMotionCodes;

// Tables B.5a, B.5b: dct_dc_size 0..8.
extern const std::array<Code, 9> kDcSizeLuminance, kDcSizeChrominance;

// Tables B.5c..f, dct_coeff_next: run, |level|, without the sign bit. Run 0 level 1 is '11'; as dct_coeff_first '1'.
struct RunLevelCode {
  uint8_t run, level;
  Code code;
};
extern const std::array<RunLevelCode, 111> kRunLevelCodes;
constexpr Code kEscapeCode{0b000001, 6};
constexpr Code kEndOfBlock{0b10, 2};
constexpr int kMaxTableRun = 31, kMaxTableLevel = 40;

// ---- For reading: tables indexed by the next bits ------------------------------------------------------------------

// Any code of up to kBits bits: symbol and length; length 0 where no code begins so.
struct Symbol {
  uint8_t value = 0, length = 0;
};
// dct_coeff_next with its sign. `advance` is run + 1, or one of the below, which lead any position beyond the 64th: one
// comparison finds them all.
struct CoefficientSymbol {
  uint8_t length = 0;   // with the sign bit; of an escape: without what follows
  uint8_t advance = 0;  // 1..32, or one of the below; never 0
  int16_t level = 0;    // signed
};
constexpr uint8_t kAdvanceNone = 65;  // no code begins so; in the first table: perhaps in the second
constexpr uint8_t kAdvanceEndOfBlock = 66, kAdvanceEscape = 67;
constexpr int kShortBits = 9, kLongBits = 17;  // first table; longest code with sign
constexpr int kLongPrefix = 6;                 // all longer codes begin with so many zeros

struct ReadingTables {
  std::array<Symbol, 2048> address_increment;             // 11 bits
  std::array<std::array<Symbol, 64>, 5> macroblock_type;  // 6 bits, by PictureType 1..4; value: flags
  std::array<Symbol, 512> pattern;                        // 9 bits
  std::array<Symbol, 2048> motion;                        // 11 bits with the sign; value: code + 16, length with sign
  std::array<Symbol, 128> dc_luminance;                   // 7 bits
  std::array<Symbol, 256> dc_chrominance;                 // 8 bits
  std::array<CoefficientSymbol, 1 << kShortBits> coefficient_short;
  std::array<CoefficientSymbol, 1 << (kLongBits - kLongPrefix)> coefficient_long;
};
extern const ReadingTables kReading;

// ---- For writing ---------------------------------------------------------------------------------------------------

// What the table of whole tokens knows: runs below kTokenRuns, levels -kTokenLevels < level < kTokenLevels.
constexpr int kTokenRuns = 32, kTokenLevels = 64;

struct WritingTables {
  std::array<Code, 32> type_of_p;  // macroblock_type [table B.2b] by its flags
  // dct_coeff_next with the sign, escapes included: code << 5 | length at [run][level + kTokenLevels]; level 0:
  // nothing.
  std::array<std::array<uint32_t, 2 * kTokenLevels>, kTokenRuns> token;
  // [run][|level|]: code without sign; length 0 where only the escape serves.
  std::array<std::array<Code, kMaxTableLevel + 1>, kMaxTableRun + 1> run_level;
  // Bits of dct_coeff_next with the sign or the escape, at [|level|][run]; the last two rows are those of all levels
  // above kMaxTableLevel: below 128 and from there on.
  std::array<std::array<uint8_t, 64>, kMaxTableLevel + 3> bits;
  // Of the same rows: the most bits by which, after any run, a level is longer than that before it; 0 for level 1.
  std::array<uint8_t, kMaxTableLevel + 3> longer_level;
  // [n]: the most bits by which the same level is longer after a run of n zeros more.
  std::array<uint8_t, 64> longer_run;
};
extern const WritingTables kWriting;

// code << 5 | length, of dct_coeff_next with the sign, escapes included: run 0..63, level -255..255 but not 0. What the
// table does not hold is an escape.
uint32_t long_escape_code(int run, int level);
inline uint32_t coefficient_code(int run, int level) {
  if (run < kTokenRuns && level > -kTokenLevels && level < kTokenLevels) [[likely]]
    return kWriting.token[static_cast<size_t>(run)][static_cast<size_t>(level + kTokenLevels)];
  return long_escape_code(run, level);
}
// The same of dct_coeff_first with run 0 and level 1 or -1, and of the end of a block.
inline uint32_t first_one_code(int level) {
  return (level < 0 ? 3u : 2u) << 5 | 2;
}
constexpr uint32_t kEndOfBlockCode = uint32_t{kEndOfBlock.bits} << 5 | kEndOfBlock.length;

inline size_t row_of_level(int level) {
  return static_cast<size_t>(level <= kMaxTableLevel ? level : kMaxTableLevel + (level < 128 ? 1 : 2));
}
// Bits of dct_coeff_next for |level| >= 1 after each run, sign included [2.4.3.7].
inline const std::array<uint8_t, 64>& bits_of_level(int level) {
  return kWriting.bits[row_of_level(level)];
}
inline int run_level_bits(int run, int level) {
  return bits_of_level(level)[static_cast<size_t>(run)];
}

}  // namespace pac::mpeg1
