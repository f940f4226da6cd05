#include "geomcodec/table_coder.h"

#include <algorithm>
#include <bit>

#include "geomcodec/size_estimator.h"

namespace pac::geomcodec {
namespace {

// How a context's table is told.
enum TableKind : uint32_t { kExpected, kOneSymbol, kOwn, kAsBefore };

uint64_t total_of(const SymbolCounts& counts) {
  uint64_t total = 0;
  for (const uint32_t count : counts) total += count;
  return total;
}

// Frequencies in proportion to counts, at least 1 where a symbol occurs; the most frequent one takes what is left.
FrequencyTable normalized(const SymbolCounts& counts) {
  const uint64_t total = total_of(counts);
  const size_t most = static_cast<size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
  std::array<uint32_t, kTableSymbols> freq = {};
  uint32_t others = 0;
  for (size_t s = 0; s < kTableSymbols; ++s) {
    if (s == most || counts[s] == 0) continue;
    freq[s] = static_cast<uint32_t>(std::max<uint64_t>(1, (uint64_t{counts[s]} * kTableTotal + total / 2) / total));
    others += freq[s];
  }
  // The most frequent of 16 symbols has a sixteenth at least, roundings add at most half a unit each and 15 in all.
  freq[most] = kTableTotal - others;
  FrequencyTable table;
  uint32_t start = 0;
  for (size_t s = 0; s < kTableSymbols; ++s) {
    table.entry[s] = {static_cast<uint16_t>(freq[s]), static_cast<uint16_t>(start)};
    start += freq[s];
  }
  return table;
}

// Bits, lowest first, into bytes.
class BitsOut {
 public:
  void put(int count, uint32_t value) {
    word_ |= uint64_t{value} << n_;
    for (n_ += count; n_ >= 8; n_ -= 8, word_ >>= 8) bytes_.push_back(static_cast<uint8_t>(word_));
  }
  std::vector<uint8_t> take() {
    if (n_ > 0) bytes_.push_back(static_cast<uint8_t>(word_));
    return std::move(bytes_);
  }

 private:
  std::vector<uint8_t> bytes_;
  uint64_t word_ = 0;
  int n_ = 0;
};

class BitsIn {
 public:
  explicit BitsIn(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  uint32_t get(int count) {
    uint32_t value = 0;
    for (int i = 0; i < count; ++i, ++at_) {
      if (at_ / 8 >= bytes_.size()) return failed_ = true, 0;
      value |= static_cast<uint32_t>(bytes_[at_ / 8] >> (at_ & 7) & 1) << i;
    }
    return value;
  }
  bool failed() const { return failed_; }
  // Whole bytes; the bits left in the last one must be zeros.
  size_t finish() {
    while (at_ % 8 != 0)
      if (get(1) != 0) failed_ = true;
    return at_ / 8;
  }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
  bool failed_ = false;
};

constexpr int kLengthBits = 4;  // of a frequency, 0..11, or of a run of contexts, 1..11

// Below 2^15.
void put_number(BitsOut& out, uint32_t number) {
  const auto length = static_cast<int>(std::bit_width(number));
  out.put(kLengthBits, static_cast<uint32_t>(length));
  if (length > 1) out.put(length - 1, number & ((1u << (length - 1)) - 1));
}

uint32_t get_number(BitsIn& in) {
  const auto length = static_cast<int>(in.get(kLengthBits));
  if (length == 0) return 0;
  return 1u << (length - 1) | (length > 1 ? in.get(length - 1) : 0);
}

size_t highest_of(const FrequencyTable& table) {
  size_t highest = kTableSymbols - 1;
  while (table.entry[highest].freq == 0) --highest;
  return highest;
}

// All but the highest symbol's, which is what is left.
void put_own(BitsOut& out, const FrequencyTable& table) {
  const size_t highest = highest_of(table);
  out.put(4, static_cast<uint32_t>(highest));
  for (size_t s = 0; s < highest; ++s) put_number(out, table.entry[s].freq);
}

uint32_t bits_of_own(const FrequencyTable& table) {
  const size_t highest = highest_of(table);
  uint32_t bits = 4;
  for (size_t s = 0; s < highest; ++s)
    bits += kLengthBits + static_cast<uint32_t>(std::max(1, static_cast<int>(std::bit_width(table.entry[s].freq)))) - 1;
  return bits;
}

bool get_own(BitsIn& in, FrequencyTable& table) {
  const uint32_t highest = in.get(4);
  uint32_t start = 0;
  for (uint32_t s = 0; s <= highest; ++s) {
    uint32_t freq = kTableTotal - start;
    if (s < highest) {
      freq = get_number(in);
      if (freq >= kTableTotal - start) return false;
    }
    table.entry[s] = {static_cast<uint16_t>(freq), static_cast<uint16_t>(start)};
    start += freq;
  }
  return highest > 0;
}

FrequencyTable only(uint32_t symbol) {
  FrequencyTable table;
  table.entry[symbol] = {static_cast<uint16_t>(kTableTotal), 0};
  return table;
}

constexpr uint64_t kUnit = 65536;              // parts of a bit
constexpr uint64_t kImpossible = kUnit << 40;  // a table that lacks a symbol
constexpr uint64_t kRunBits = 10;              // about so many tell a run of expected tables

// What the counts take by a table, in kUnit.
uint64_t cost(const SymbolCounts& counts, const FrequencyTable& table) {
  uint64_t sum = 0;
  for (size_t s = 0; s < kTableSymbols; ++s) {
    if (counts[s] == 0) continue;
    if (table.entry[s].freq == 0) return kImpossible;
    sum += counts[s] * (kTableBits * kUnit - logarithm_of(table.entry[s].freq));
  }
  return sum;
}

// A context's own table and what counts take by it, the telling included.
struct OwnTable {
  FrequencyTable table;
  bool single = false;
  uint64_t cost = kImpossible;

  OwnTable() = default;
  explicit OwnTable(const SymbolCounts& counts) {
    if (total_of(counts) == 0) return;
    table = normalized(counts);
    single = table.entry[highest_of(table)].freq == kTableTotal;
    cost = geomcodec::cost(counts, table) + (2 + (single ? 4 : bits_of_own(table))) * kUnit;
  }
};

// Whether each context keeps the expected table, those together costing least.
std::vector<uint8_t> choose_expected(std::span<const SymbolCounts> counts, std::span<const OwnTable> own,
                                     const std::vector<const LookupTable*>& expected) {
  // Least of all contexts up to this one if it has its own table, if it has the expected one, and whether the one
  // before it has that then.
  uint64_t with_own = 0, with_expected = kImpossible;
  std::vector<std::array<uint8_t, 2>> before(counts.size());
  for (size_t context = 0; context < counts.size(); ++context) {
    const bool is_met = own[context].cost != kImpossible;
    const uint64_t here = !is_met ? 0 : expected.empty() ? kImpossible : cost(counts[context], *expected[context]);
    const uint64_t starts = with_own + kRunBits * kUnit;
    before[context] = {static_cast<uint8_t>(with_expected < with_own), static_cast<uint8_t>(with_expected <= starts)};
    with_own = std::min(with_own, with_expected) + own[context].cost;
    with_expected = std::min(with_expected, starts) + here;
  }
  std::vector<uint8_t> keeps(counts.size());
  uint8_t now = with_expected < with_own ? 1 : 0;
  for (size_t context = counts.size(); context-- > 0; now = before[context][now]) keeps[context] = now;
  return keeps;
}

// The table of each context, told as the cheapest of the kinds.
std::vector<FrequencyTable> choose_tables(std::span<const SymbolCounts> counts, Expected what, BitsOut& out) {
  const std::vector<const LookupTable*>& expected = expected_tables(what);
  std::vector<OwnTable> own;
  own.reserve(counts.size());
  for (const SymbolCounts& of_context : counts) own.emplace_back(of_context);
  const std::vector<uint8_t> keeps = choose_expected(counts, own, expected);
  std::vector<FrequencyTable> tables(counts.size());
  const FrequencyTable* before = nullptr;
  for (size_t context = 0; context < counts.size(); ++context) {
    size_t end = context;
    for (; end < counts.size() && keeps[end] != 0; ++end)
      if (!expected.empty()) tables[end] = *expected[end];
    if (end > context) {
      out.put(2, kExpected);
      put_number(out, static_cast<uint32_t>(end - context));
      context = end - 1;
      continue;
    }
    tables[context] = own[context].table;
    if (before != nullptr && cost(counts[context], *before) + 2 * kUnit <= own[context].cost) {
      out.put(2, kAsBefore);
      tables[context] = *before;
    } else if (own[context].single) {
      out.put(2, kOneSymbol);
      out.put(4, static_cast<uint32_t>(highest_of(tables[context])));
    } else {
      out.put(2, kOwn);
      put_own(out, tables[context]);
    }
    before = &tables[context];
  }
  return tables;
}

}  // namespace

std::vector<SymbolCounts> TableEncoder::counts() const {
  std::vector<SymbolCounts> counts(n_contexts_, SymbolCounts{});
  for (const uint16_t note : noted_) ++counts[note >> 6][note >> 2 & 15];
  return counts;
}

std::vector<uint8_t> TableEncoder::finish() {
  BitsOut out;
  const std::vector<FrequencyTable> tables = choose_tables(counts(), expected_, out);
  std::vector<uint8_t> bytes = out.take();

  // Backwards, as a decoder meets the symbols forwards.
  std::array<uint32_t, kLanes> state;
  state.fill(kLowestState);
  std::vector<uint16_t> words;
  for (size_t i = noted_.size(); i-- > 0;) {
    const uint16_t note = noted_[i];
    const FrequencyTable::Entry entry = tables[note >> 6].entry[note >> 2 & 15];
    uint32_t& x = state[note & 3];
    if (x >> (32 - kTableBits) >= entry.freq) {
      words.push_back(static_cast<uint16_t>(x));
      x >>= 16;
    }
    x = (x / entry.freq << kTableBits) + x % entry.freq + entry.start;
  }
  for (size_t lane = 0; lane < lanes_of(expected_); ++lane)
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(state[lane] >> shift));
  for (size_t i = words.size(); i-- > 0;) {
    bytes.push_back(static_cast<uint8_t>(words[i]));
    bytes.push_back(static_cast<uint8_t>(words[i] >> 8));
  }
  flush_raw();
  if (raw_count_ > 0) raw_bytes_.push_back(static_cast<uint8_t>(raw_word_));
  bytes.insert(bytes.end(), raw_bytes_.rbegin(), raw_bytes_.rend());
  return bytes;
}

// Of contexts that have none, where nothing is expected: only a broken stream asks.
static const LookupTable* table_of_nothing() {
  static const LookupTable table = [] {
    LookupTable zeros;
    zeros.assign(only(0));
    return zeros;
  }();
  return &table;
}

size_t SymbolTables::parse(std::span<const uint8_t> bytes, size_t n_contexts, Expected expected) {
  BitsIn in(bytes);
  if (expected == Expected::nothing)
    of_context_.assign(n_contexts, table_of_nothing());
  else
    of_context_ = expected_tables(expected);
  std::vector<FrequencyTable> tables;
  std::vector<std::pair<size_t, size_t>> uses;  // context, table
  for (size_t context = 0; context < n_contexts && !in.failed(); ++context) {
    FrequencyTable table;
    switch (in.get(2)) {
      case kExpected: {
        const uint32_t run = get_number(in);
        if (run == 0 || run > n_contexts - context) return 0;
        context += run - 1;
        continue;
      }
      case kOneSymbol:
        tables.push_back(only(in.get(4)));
        break;
      case kOwn:
        if (!get_own(in, table)) return 0;
        tables.push_back(table);
        break;
      default:
        if (tables.empty()) return 0;
    }
    uses.emplace_back(context, tables.size() - 1);
  }
  const size_t size = in.finish();
  if (in.failed()) return 0;
  told_ = std::make_unique_for_overwrite<LookupTable[]>(tables.size());
  for (size_t i = 0; i < tables.size(); ++i) told_[i].assign(tables[i]);
  for (const auto& [context, table] : uses) of_context_[context] = &told_[table];
  return size;
}

TableDecoder::TableDecoder(std::span<const uint8_t> bytes, size_t n_contexts, Expected expected, SymbolTables& tables)
    : data_(bytes.data()), size_(bytes.size()) {
  const size_t n_lanes = lanes_of(expected), tables_size = tables.parse(bytes, n_contexts, expected);
  of_context_ = tables.of_context();
  static constexpr uint8_t kNothing[2] = {0, 0};
  bool sound = tables_size > 0 && bytes.size() - tables_size >= 4 * n_lanes;
  for (size_t lane = 0; lane < kLanes; ++lane) {
    state_[lane] = kLowestState;
    if (!sound || lane >= n_lanes) continue;
    const uint8_t* at = data_ + tables_size + 4 * lane;
    state_[lane] = uint32_t{at[0]} | uint32_t{at[1]} << 8 | uint32_t{at[2]} << 16 | uint32_t{at[3]} << 24;
    sound = state_[lane] >= kLowestState;
  }
  position_ = tables_size + 4 * n_lanes;
  if (sound) return;
  data_ = kNothing;
  size_ = 2;
  position_ = 3;
}

uint32_t TableDecoder::raw_at_start(int count) {
  uint32_t value = 0;
  for (int i = 0; i < count; ++i, ++raw_used_) {
    const uint64_t whole = raw_used_ >> 3;
    const uint32_t byte = whole < size_ ? data_[size_ - 1 - whole] : 0;
    value |= (byte >> (raw_used_ & 7) & 1) << i;
  }
  return value;
}

}  // namespace pac::geomcodec
