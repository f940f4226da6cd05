#include "mpeg1/vlc_tables.h"

namespace pac::mpeg1 {

constexpr std::array<Code, 36> kAddressIncrementCodes = {
    {{},         {0x1, 1},   {0x3, 3},   {0x2, 3},   {0x3, 4},   {0x2, 4},   {0x3, 5},   {0x2, 5},   {0x7, 7},
     {0x6, 7},   {0xb, 8},   {0xa, 8},   {0x9, 8},   {0x8, 8},   {0x7, 8},   {0x6, 8},   {0x17, 10}, {0x16, 10},
     {0x15, 10}, {0x14, 10}, {0x13, 10}, {0x12, 10}, {0x23, 11}, {0x22, 11}, {0x21, 11}, {0x20, 11}, {0x1f, 11},
     {0x1e, 11}, {0x1d, 11}, {0x1c, 11}, {0x1b, 11}, {0x1a, 11}, {0x19, 11}, {0x18, 11}, {0x8, 11},  {0xf, 11}}};

constexpr std::array<MacroblockType, 2> kTypesOfI = {{{kIntra, {0b1, 1}}, {kIntra | kQuant, {0b01, 2}}}};
constexpr std::array<MacroblockType, 7> kTypesOfP = {{
    {kForward | kPattern, {0b1, 1}},
    {kPattern, {0b01, 2}},
    {kForward, {0b001, 3}},
    {kIntra, {0b00011, 5}},
    {kForward | kPattern | kQuant, {0b00010, 5}},
    {kPattern | kQuant, {0b00001, 5}},
    {kIntra | kQuant, {0b000001, 6}},
}};
constexpr std::array<MacroblockType, 11> kTypesOfB = {{
    {kForward | kBackward, {0b10, 2}},
    {kForward | kBackward | kPattern, {0b11, 2}},
    {kBackward, {0b010, 3}},
    {kBackward | kPattern, {0b011, 3}},
    {kForward, {0b0010, 4}},
    {kForward | kPattern, {0b0011, 4}},
    {kIntra, {0b00011, 5}},
    {kForward | kBackward | kPattern | kQuant, {0b00010, 5}},
    {kForward | kPattern | kQuant, {0b000011, 6}},
    {kBackward | kPattern | kQuant, {0b000010, 6}},
    {kIntra | kQuant, {0b000001, 6}},
}};

constexpr std::array<Code, 64> kPatternCodes = {
    {{},        {0xb, 5},  {0x9, 5},  {0xd, 6},  {0xd, 4},  {0x17, 7}, {0x13, 7}, {0x1f, 8}, {0xc, 4},  {0x16, 7},
     {0x12, 7}, {0x1e, 8}, {0x13, 5}, {0x1b, 8}, {0x17, 8}, {0x13, 8}, {0xb, 4},  {0x15, 7}, {0x11, 7}, {0x1d, 8},
     {0x11, 5}, {0x19, 8}, {0x15, 8}, {0x11, 8}, {0xf, 6},  {0xf, 8},  {0xd, 8},  {0x3, 9},  {0xf, 5},  {0xb, 8},
     {0x7, 8},  {0x7, 9},  {0xa, 4},  {0x14, 7}, {0x10, 7}, {0x1c, 8}, {0xe, 6},  {0xe, 8},  {0xc, 8},  {0x2, 9},
     {0x10, 5}, {0x18, 8}, {0x14, 8}, {0x10, 8}, {0xe, 5},  {0xa, 8},  {0x6, 8},  {0x6, 9},  {0x12, 5}, {0x1a, 8},
     {0x16, 8}, {0x12, 8}, {0xd, 5},  {0x9, 8},  {0x5, 8},  {0x5, 9},  {0xc, 5},  {0x8, 8},  {0x4, 8},  {0x4, 9},
     {0x7, 3},  {0xa, 5},  {0x8, 5},  {0xc, 6}}};

constexpr std::array<Code, 17> kMotionCodes = {{{0x1, 1},
                                                {0x1, 2},
                                                {0x1, 3},
                                                {0x1, 4},
                                                {0x3, 6},
                                                {0x5, 7},
                                                {0x4, 7},
                                                {0x3, 7},
                                                {0xb, 9},
                                                {0xa, 9},
                                                {0x9, 9},
                                                {0x11, 10},
                                                {0x10, 10},
                                                {0xf, 10},
                                                {0xe, 10},
                                                {0xd, 10},
                                                {0xc, 10}}};

constexpr std::array<Code, 9> kDcSizeLuminance = {
    {{0x4, 3}, {0x0, 2}, {0x1, 2}, {0x5, 3}, {0x6, 3}, {0xe, 4}, {0x1e, 5}, {0x3e, 6}, {0x7e, 7}}};
constexpr std::array<Code, 9> kDcSizeChrominance = {
    {{0x0, 2}, {0x1, 2}, {0x2, 2}, {0x6, 3}, {0xe, 4}, {0x1e, 5}, {0x3e, 6}, {0x7e, 7}, {0xfe, 8}}};

constexpr std::array<RunLevelCode, 111> kRunLevelCodes = {
    {{0, 1, {0x3, 2}},    {0, 2, {0x4, 4}},    {0, 3, {0x5, 5}},    {0, 4, {0x6, 7}},    {0, 5, {0x26, 8}},
     {0, 6, {0x21, 8}},   {0, 7, {0xa, 10}},   {0, 8, {0x1d, 12}},  {0, 9, {0x18, 12}},  {0, 10, {0x13, 12}},
     {0, 11, {0x10, 12}}, {0, 12, {0x1a, 13}}, {0, 13, {0x19, 13}}, {0, 14, {0x18, 13}}, {0, 15, {0x17, 13}},
     {0, 16, {0x1f, 14}}, {0, 17, {0x1e, 14}}, {0, 18, {0x1d, 14}}, {0, 19, {0x1c, 14}}, {0, 20, {0x1b, 14}},
     {0, 21, {0x1a, 14}}, {0, 22, {0x19, 14}}, {0, 23, {0x18, 14}}, {0, 24, {0x17, 14}}, {0, 25, {0x16, 14}},
     {0, 26, {0x15, 14}}, {0, 27, {0x14, 14}}, {0, 28, {0x13, 14}}, {0, 29, {0x12, 14}}, {0, 30, {0x11, 14}},
     {0, 31, {0x10, 14}}, {0, 32, {0x18, 15}}, {0, 33, {0x17, 15}}, {0, 34, {0x16, 15}}, {0, 35, {0x15, 15}},
     {0, 36, {0x14, 15}}, {0, 37, {0x13, 15}}, {0, 38, {0x12, 15}}, {0, 39, {0x11, 15}}, {0, 40, {0x10, 15}},
     {1, 1, {0x3, 3}},    {1, 2, {0x6, 6}},    {1, 3, {0x25, 8}},   {1, 4, {0xc, 10}},   {1, 5, {0x1b, 12}},
     {1, 6, {0x16, 13}},  {1, 7, {0x15, 13}},  {1, 8, {0x1f, 15}},  {1, 9, {0x1e, 15}},  {1, 10, {0x1d, 15}},
     {1, 11, {0x1c, 15}}, {1, 12, {0x1b, 15}}, {1, 13, {0x1a, 15}}, {1, 14, {0x19, 15}}, {1, 15, {0x13, 16}},
     {1, 16, {0x12, 16}}, {1, 17, {0x11, 16}}, {1, 18, {0x10, 16}}, {2, 1, {0x5, 4}},    {2, 2, {0x4, 7}},
     {2, 3, {0xb, 10}},   {2, 4, {0x14, 12}},  {2, 5, {0x14, 13}},  {3, 1, {0x7, 5}},    {3, 2, {0x24, 8}},
     {3, 3, {0x1c, 12}},  {3, 4, {0x13, 13}},  {4, 1, {0x6, 5}},    {4, 2, {0xf, 10}},   {4, 3, {0x12, 12}},
     {5, 1, {0x7, 6}},    {5, 2, {0x9, 10}},   {5, 3, {0x12, 13}},  {6, 1, {0x5, 6}},    {6, 2, {0x1e, 12}},
     {6, 3, {0x14, 16}},  {7, 1, {0x4, 6}},    {7, 2, {0x15, 12}},  {8, 1, {0x7, 7}},    {8, 2, {0x11, 12}},
     {9, 1, {0x5, 7}},    {9, 2, {0x11, 13}},  {10, 1, {0x27, 8}},  {10, 2, {0x10, 13}}, {11, 1, {0x23, 8}},
     {11, 2, {0x1a, 16}}, {12, 1, {0x22, 8}},  {12, 2, {0x19, 16}}, {13, 1, {0x20, 8}},  {13, 2, {0x18, 16}},
     {14, 1, {0xe, 10}},  {14, 2, {0x17, 16}}, {15, 1, {0xd, 10}},  {15, 2, {0x16, 16}}, {16, 1, {0x8, 10}},
     {16, 2, {0x15, 16}}, {17, 1, {0x1f, 12}}, {18, 1, {0x1a, 12}}, {19, 1, {0x19, 12}}, {20, 1, {0x17, 12}},
     {21, 1, {0x16, 12}}, {22, 1, {0x1f, 13}}, {23, 1, {0x1e, 13}}, {24, 1, {0x1d, 13}}, {25, 1, {0x1c, 13}},
     {26, 1, {0x1b, 13}}, {27, 1, {0x1f, 16}}, {28, 1, {0x1e, 16}}, {29, 1, {0x1d, 16}}, {30, 1, {0x1c, 16}},
     {31, 1, {0x1b, 16}}}};

namespace {

// Fills every entry of a table indexed by `index_bits` bits that begins with the code.
template <class Entry, size_t kSize>
constexpr void enter(std::array<Entry, kSize>& table, int index_bits, uint32_t code, int length, const Entry& entry) {
  const int free_bits = index_bits - length;
  for (uint32_t i = 0; i < uint32_t{1} << free_bits; ++i) table[(code << free_bits) + i] = entry;
}

template <size_t kSize>
constexpr void enter(std::array<Symbol, kSize>& table, int index_bits, const Code& code, int value) {
  if (code.length == 0) return;
  enter(table, index_bits, code.bits, code.length, Symbol{static_cast<uint8_t>(value), code.length});
}

constexpr void enter_coefficient(ReadingTables& tables, uint32_t code, int length, const CoefficientSymbol& entry) {
  if (length <= kShortBits)
    enter(tables.coefficient_short, kShortBits, code, length, entry);
  else  // the prefix of zeros adds nothing to the number
    enter(tables.coefficient_long, kLongBits - kLongPrefix, code, length - kLongPrefix, entry);
}

constexpr ReadingTables make_reading_tables() {
  ReadingTables tables{};
  tables.coefficient_short.fill({0, kAdvanceNone, 0});
  tables.coefficient_long.fill({0, kAdvanceNone, 0});
  for (size_t i = 1; i < kAddressIncrementCodes.size(); ++i)
    enter(tables.address_increment, 11, kAddressIncrementCodes[i], static_cast<int>(i));
  for (const MacroblockType& type : kTypesOfI) enter(tables.macroblock_type[1], 6, type.code, type.flags);
  for (const MacroblockType& type : kTypesOfP) enter(tables.macroblock_type[2], 6, type.code, type.flags);
  for (const MacroblockType& type : kTypesOfB) enter(tables.macroblock_type[3], 6, type.code, type.flags);
  enter(tables.macroblock_type[4], 6, Code{1, 1}, kIntra);  // table B.2d
  for (size_t i = 1; i < kPatternCodes.size(); ++i) enter(tables.pattern, 9, kPatternCodes[i], static_cast<int>(i));
  for (size_t i = 0; i < kDcSizeLuminance.size(); ++i) {
    enter(tables.dc_luminance, 7, kDcSizeLuminance[i], static_cast<int>(i));
    enter(tables.dc_chrominance, 8, kDcSizeChrominance[i], static_cast<int>(i));
  }
  enter(tables.motion, 11, kMotionCodes[0], 16);
  for (int i = 1; i <= 16; ++i) {
    const Code& code = kMotionCodes[static_cast<size_t>(i)];
    for (const int sign : {0, 1})
      enter(tables.motion, 11,
            Code{static_cast<uint16_t>(code.bits << 1 | sign), static_cast<uint8_t>(code.length + 1)},
            sign != 0 ? 16 - i : 16 + i);
  }
  for (const RunLevelCode& entry : kRunLevelCodes)
    for (const int sign : {0, 1})
      enter_coefficient(tables, static_cast<uint32_t>(entry.code.bits << 1 | sign), entry.code.length + 1,
                        {static_cast<uint8_t>(entry.code.length + 1), static_cast<uint8_t>(entry.run + 1),
                         static_cast<int16_t>(sign != 0 ? -entry.level : entry.level)});
  enter_coefficient(tables, kEndOfBlock.bits, kEndOfBlock.length, {kEndOfBlock.length, kAdvanceEndOfBlock, 0});
  enter_coefficient(tables, kEscapeCode.bits, kEscapeCode.length, {kEscapeCode.length, kAdvanceEscape, 0});
  return tables;
}

// [table B.5f]
constexpr uint32_t escape_code(int run, int level) {
  const uint32_t escape = static_cast<uint32_t>(kEscapeCode.bits) << 6 | static_cast<uint32_t>(run);
  if (level > 127) return (escape << 16 | static_cast<uint32_t>(level)) << 5 | 28;
  if (level < -127) return (escape << 16 | 0x8000 | static_cast<uint32_t>(level + 256)) << 5 | 28;
  return (escape << 8 | (static_cast<uint32_t>(level) & 255)) << 5 | 20;
}

constexpr uint32_t token_code(const WritingTables& tables, int run, int level) {
  const int magnitude = level < 0 ? -level : level;
  if (run <= kMaxTableRun && magnitude <= kMaxTableLevel) {
    const Code& code = tables.run_level[static_cast<size_t>(run)][static_cast<size_t>(magnitude)];
    const uint32_t bits = static_cast<uint32_t>(code.bits) << 1 | (level < 0 ? 1u : 0u);
    if (code.length != 0) return bits << 5 | (code.length + 1u);
  }
  return escape_code(run, level);
}

// By how much a code may be longer than that of another row or run.
constexpr void compare_bits(WritingTables& tables) {
  const auto raise = [](uint8_t& most, int bits) { most = bits > most ? static_cast<uint8_t>(bits) : most; };
  for (size_t row = 1; row < tables.bits.size(); ++row)
    for (size_t run = 0; run <= kTokenRuns; ++run) {  // all longer ones take what this one takes, the most
      const int bits = tables.bits[row][run];
      if (row > 1) raise(tables.longer_level[row], bits - tables.bits[row - 1][run]);
      for (size_t shorter = 0; shorter < run; ++shorter)
        raise(tables.longer_run[run - shorter], bits - tables.bits[row][shorter]);
    }
  for (size_t n = 1; n < tables.longer_run.size(); ++n) raise(tables.longer_run[n], tables.longer_run[n - 1]);
}

constexpr WritingTables make_writing_tables() {
  WritingTables tables{};
  for (const MacroblockType& type : kTypesOfP) tables.type_of_p[type.flags] = type.code;
  for (auto& row : tables.bits) row.fill(20);
  tables.bits.back().fill(28);
  for (const RunLevelCode& entry : kRunLevelCodes) {
    tables.run_level[entry.run][entry.level] = entry.code;
    tables.bits[entry.level][entry.run] = static_cast<uint8_t>(entry.code.length + 1);
  }
  for (int run = 0; run < kTokenRuns; ++run)
    for (int level = 1 - kTokenLevels; level < kTokenLevels; ++level)
      if (level != 0)
        tables.token[static_cast<size_t>(run)][static_cast<size_t>(level + kTokenLevels)] =
            token_code(tables, run, level);
  compare_bits(tables);
  return tables;
}

}  // namespace

constexpr ReadingTables kReading = make_reading_tables();
constexpr WritingTables kWriting = make_writing_tables();

uint32_t long_escape_code(int run, int level) {
  return escape_code(run, level);
}

}  // namespace pac::mpeg1
