#include "jpeg/scan_decoder.h"

#include <algorithm>
#include <cstring>

#include "jpeg/markers.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

constexpr int64_t kNever = INT64_MAX;
// Real progressive files have about ten; each costs a pass over the picture, however few bytes it has.
constexpr int kMaxScans = 200;

const char* text_of(BlockError error) {
  switch (error) {
    case BlockError::undefined_code:
      return "entropy-coded data: undefined Huffman code";
    case BlockError::past_end:
      return "entropy-coded data: run past the last coefficient";
    default:
      return "entropy-coded data: undefined run/size symbol";
  }
}

size_t n_padded_blocks(const Component& c) {
  return static_cast<size_t>(c.padded_width_blocks) * static_cast<size_t>(c.padded_height_blocks);
}

uint64_t level_bytes(const Frame& frame) {
  uint64_t n = 0;
  for (int c = 0; c < frame.n_components; ++c) n += n_padded_blocks(frame.components[c]);
  return n * 64 * sizeof(int16_t);
}

// Offset of the next 0xFF that starts a marker, at or after `at`; the end of the file if there is none.
uint64_t find_marker(std::span<const uint8_t> bytes, uint64_t at) {
  for (; at + 1 < bytes.size(); ++at)
    if (bytes[at] == 0xFF && bytes[at + 1] != 0 && bytes[at + 1] != 0xFF) return at;
  return bytes.size();
}

}  // namespace

// Allocates, after checking against the limits, everything whose size the header decides.
Result<void> ScanDecoder::open(std::span<const uint8_t> bytes, const Limits& limits) {
  bytes_ = bytes;
  reader_ = HeaderReader(bytes, limits);
  PAC_CHECK(reader_.start());
  PAC_TRY(first_scan_, reader_.next_scan());
  const Headers& headers = reader_.headers();
  if (headers.info.unsupported != nullptr)
    return Failure{Error::unsupported, headers.frame_offset, headers.info.unsupported};
  const Frame& frame = headers.frame;
  is_progressive_ = headers.is_progressive();
  single_scan_ = !is_progressive_ && first_scan_.n_components == frame.n_components;
  const bool whole_planes = !single_scan_ && !is_progressive_;
  const uint64_t need = ComponentPlanes::size_bytes(frame, whole_planes) + (is_progressive_ ? level_bytes(frame) : 0) +
                        uint64_t{3} * static_cast<uint64_t>(frame.width) * static_cast<uint64_t>(frame.height);
  if (need > limits.max_bytes)
    return Failure{Error::limit_exceeded, headers.frame_offset, "decoded image needs more memory than the limit"};
  planes_.reset(frame, whole_planes, headers.info.color, *kernels_);
  for (int c = 0; is_progressive_ && c < frame.n_components; ++c)
    levels_[c].assign(n_padded_blocks(frame.components[c]) * 64, 0);
  return {};
}

// In lenient mode a failure is remembered and passed over.
Result<void> ScanDecoder::tolerate(const Failure& failure) {
  if (!lenient_) return failure;
  if (!first_failure_) first_failure_ = failure;
  warnings_ += 1;
  return {};
}

Result<void> ScanDecoder::decode(RgbView out, bool lenient) {
  lenient_ = lenient;
  first_failure_.reset();
  warnings_ = 0;
  position_ = first_scan_.data_offset;
  std::fill(std::begin(decoded_), std::end(decoded_), false);
  if (auto done = decode_scans(out); !done.ok()) PAC_CHECK(tolerate(done.failure()));
  if (is_progressive_)
    transform_progressive(out);
  else if (!single_scan_)
    planes_.write_rgb(0, out.height, out);
  return {};
}

Result<void> ScanDecoder::decode_scans(RgbView out) {
  ScanHeader scan = first_scan_;
  for (int n_scans = 1; scan.n_components > 0; ++n_scans) {
    if (n_scans > kMaxScans) return Failure{Error::limit_exceeded, scan.offset, "more scans than the limit"};
    PAC_CHECK(decode_scan(scan, out));
    reader_.set_position(position_);
    PAC_TRY(scan, reader_.next_scan());
  }
  for (int c = 0; c < reader_.headers().frame.n_components; ++c)
    if (!decoded_[c]) return Failure{Error::corrupt, position_, "EOI before every component had its scan"};
  return {};
}

// Without any DHT in the file the tables of Annex K are meant: motion JPEG frames omit them.
Result<const HuffmanDecoder*> ScanDecoder::set_up_table(const ScanHeader& header, int table_class, uint8_t id) {
  const Headers& headers = reader_.headers();
  const HuffmanSpec* spec = nullptr;
  if (headers.have_huffman[table_class][id])
    spec = &headers.huffman[table_class][id];
  else if (!headers.any_dht && id < 2)
    spec = table_class == 0 ? &standard_dc(id) : &standard_ac(id);
  else
    return Failure{Error::corrupt, header.offset, "Huffman table is not defined"};
  HuffmanDecoder& table = tables_[table_class][id];
  HuffmanSpec& known = table_specs_[table_class][id];
  if (spec->n_symbols() == 0 || std::memcmp(&known, spec, sizeof known) != 0) {
    make_decoder(*spec, table);
    known = *spec;
  }
  return &table;
}

Result<void> ScanDecoder::set_up_component(const ScanHeader& header, int i, ScanComponent& sc) {
  sc.index = header.components[i].index;
  sc.component = &reader_.headers().frame.components[sc.index];
  const auto& steps = reader_.headers().info.quant_tables[sc.component->quant_table];
  if (!steps) return Failure{Error::corrupt, header.offset, "quantization table is not defined"};
  std::copy(steps->begin(), steps->end(), steps_[sc.index]);
  sc.steps = steps_[sc.index];
  const bool is_interleaved = header.n_components > 1;
  sc.h = is_interleaved ? sc.component->h : 1;
  sc.v = is_interleaved ? sc.component->v : 1;
  const Progression& p = header.progression;
  const bool needs_dc = p.is_dc() && !p.refines(), needs_ac = p.last > 0;
  if (needs_dc) {
    PAC_TRY(sc.dc_table, set_up_table(header, 0, header.components[i].dc_table));
  }
  if (needs_ac) {
    PAC_TRY(sc.ac_table, set_up_table(header, 1, header.components[i].ac_table));
  }
  if (is_progressive_) {
    if (p.is_dc()) decoded_[sc.index] = true;
    sc.blocks_per_row = static_cast<size_t>(sc.component->padded_width_blocks);
    sc.levels = levels_[sc.index].data();
    return {};
  }
  if (decoded_[sc.index]) return Failure{Error::corrupt, header.offset, "second scan of a component"};
  decoded_[sc.index] = true;
  sc.blocks_per_row = static_cast<size_t>(kBatchMcus * sc.h);
  levels_[i].resize(64 * sc.blocks_per_row * static_cast<size_t>(sc.v));
  last_[i].resize(sc.blocks_per_row * static_cast<size_t>(sc.v));
  sc.levels = levels_[i].data();
  sc.last = last_[i].data();
  return {};
}

Result<void> ScanDecoder::set_up(const ScanHeader& header, Scan& scan) {
  const Frame& frame = reader_.headers().frame;
  scan.n_components = header.n_components;
  scan.is_progressive = is_progressive_;
  scan.progression = header.progression;
  for (int i = 0; i < header.n_components; ++i) PAC_CHECK(set_up_component(header, i, scan.components[i]));
  const bool is_interleaved = header.n_components > 1;
  scan.mcus_per_row = is_interleaved ? frame.mcus_per_row : scan.components[0].component->width_blocks;
  scan.mcu_rows = is_interleaved ? frame.mcu_rows : scan.components[0].component->height_blocks;
  scan.restart_interval = scan.to_restart = reader_.headers().info.restart_interval_mcus;
  return {};
}

Result<void> ScanDecoder::decode_scan(const ScanHeader& header, RgbView out) {
  Scan scan;
  PAC_CHECK(set_up(header, scan));
  entropy_.start(bytes_, header.data_offset);
  const int mcu_height = header.n_components > 1 ? 8 * reader_.headers().frame.v_max : 8;
  for (int row = 0; row < scan.mcu_rows; ++row) {
    if (is_progressive_) {
      PAC_CHECK(decode_progressive_row(row, scan));
      continue;
    }
    PAC_CHECK(decode_sequential_row(row, scan));
    if (single_scan_) write_finished_rows(row, scan.mcu_rows, mcu_height, out);
  }
  position_ = entropy_.byte_offset();
  return {};
}

Result<void> ScanDecoder::decode_sequential_row(int mcu_row, Scan& scan) {
  for (int mcu = 0; mcu < scan.mcus_per_row; mcu += kBatchMcus) {
    const int n = std::min(kBatchMcus, scan.mcus_per_row - mcu);
    for (int i = 0; i < scan.n_components; ++i) {
      std::fill(levels_[i].begin(), levels_[i].end(), int16_t{0});
      std::fill(last_[i].begin(), last_[i].end(), uint8_t{0});
    }
    for (int j = 0; j < n; ++j) {
      for (ScanComponent& sc : scan.components) sc.first_block = static_cast<size_t>(j * sc.h);
      PAC_CHECK(read_next_mcu(scan));
    }
    for (int i = 0; i < scan.n_components; ++i) transform_batch(mcu_row, mcu, n, scan.components[i]);
  }
  return {};
}

Result<void> ScanDecoder::decode_progressive_row(int mcu_row, Scan& scan) {
  for (int mcu = 0; mcu < scan.mcus_per_row; ++mcu) {
    for (ScanComponent& sc : scan.components)
      sc.first_block = static_cast<size_t>(mcu_row * sc.v) * sc.blocks_per_row + static_cast<size_t>(mcu * sc.h);
    PAC_CHECK(read_next_mcu(scan));
  }
  return {};
}

// Skips what is lost; looks for a place to go on after a failure.
Result<void> ScanDecoder::read_next_mcu(Scan& scan) {
  const int64_t mcu = scan.next_mcu++;
  if (mcu < scan.resume) return {};
  if (auto done = read_mcu(scan); !done.ok()) {
    PAC_CHECK(tolerate(done.failure()));
    scan.resume = resume_at(mcu, scan);
  }
  return {};
}

Result<void> ScanDecoder::read_mcu(Scan& scan) {
  if (scan.restart_interval > 0) {
    if (scan.to_restart == 0) {
      PAC_CHECK(pass_restart(scan.next_restart));
      scan.next_restart = (scan.next_restart + 1) & 7;
      scan.to_restart = scan.restart_interval;
      scan.eob_run = 0;
      for (ScanComponent& sc : scan.components) sc.dc = 0;
    }
    scan.to_restart -= 1;
  }
  entropy_.prepare_mcu();
  const BlockError error = read_blocks(scan);
  if (entropy_.overrun()) {
    const uint64_t at = find_marker(bytes_, entropy_.byte_offset());
    if (at == bytes_.size()) return Failure{Error::truncated, at, "file ends inside the entropy-coded data"};
    return Failure{Error::corrupt, at, "marker inside the entropy-coded data"};
  }
  if (error != BlockError::none) return Failure{Error::corrupt, entropy_.byte_offset(), text_of(error)};
  return {};
}

// The blocks of each component in turn [T.81 A.2.3].
BlockError ScanDecoder::read_blocks(Scan& scan) {
  for (int i = 0; i < scan.n_components; ++i) {
    ScanComponent& sc = scan.components[i];
    for (int by = 0; by < sc.v; ++by) {
      for (int bx = 0; bx < sc.h; ++bx) {
        const size_t block = sc.first_block + static_cast<size_t>(by) * sc.blocks_per_row + static_cast<size_t>(bx);
        int16_t* levels = sc.levels + 64 * block;
        const BlockError error = scan.is_progressive
                                     ? read_progressive_block(entropy_, scan.progression, sc.dc_table, sc.ac_table,
                                                              sc.dc, scan.eob_run, levels)
                                     : read_block(entropy_, *sc.dc_table, *sc.ac_table, sc.dc, levels, sc.last[block]);
        if (error != BlockError::none) return error;
      }
    }
  }
  return BlockError::none;
}

// Expects RSTm at the reader's position, perhaps behind fill bytes, or behind bytes that nobody needed (a warning).
Result<void> ScanDecoder::pass_restart(int expected) {
  const uint64_t due = entropy_.byte_offset(), at = find_marker(bytes_, due);
  if (at == bytes_.size()) return Failure{Error::truncated, at, "file ends where a restart marker is due"};
  if (bytes_[at + 1] != kRst0 + expected)
    return Failure{Error::corrupt, at, "restart marker is missing or out of order"};
  if (bytes_[due] != 0xFF) warnings_ += 1;
  entropy_.restart_at(at + 2);
  return {};
}

// After a failure at MCU number `failed_mcu`: sets the reader behind the next usable restart marker and tells the MCU
// that follows it. A marker at most 5 numbers ahead of the one that is due means lost intervals; else it is an old one.
int64_t ScanDecoder::resume_at(int64_t failed_mcu, Scan& scan) {
  if (scan.restart_interval == 0) return kNever;
  // Where the marker that is due stands: before the failed MCU if it was missing there, else after its interval.
  const int64_t interval = scan.restart_interval;
  const int64_t due_mcu = scan.to_restart == 0 ? failed_mcu : (failed_mcu / interval + 1) * interval;
  const auto due = static_cast<int>((due_mcu / interval - 1) & 7);
  uint64_t at = find_marker(bytes_, entropy_.byte_offset());
  for (; at < bytes_.size() && is_restart(bytes_[at + 1]); at = find_marker(bytes_, at + 2)) {
    const int number = bytes_[at + 1] - kRst0, ahead = (number - due) & 7;
    if (ahead > 5) continue;
    entropy_.restart_at(at + 2);
    for (ScanComponent& sc : scan.components) sc.dc = 0;
    scan.eob_run = 0;
    scan.to_restart = scan.restart_interval;
    scan.next_restart = (number + 1) & 7;
    return due_mcu + ahead * interval;
  }
  entropy_.restart_at(at);
  return kNever;
}

void ScanDecoder::transform_batch(int mcu_row, int first_mcu, int n_mcus, const ScanComponent& sc) {
  for (int by = 0; by < sc.v; ++by) {
    const size_t first = static_cast<size_t>(by) * sc.blocks_per_row;
    kernels_->block.idct_islow(sc.levels + 64 * first, sc.steps, sc.last + first, static_cast<size_t>(n_mcus * sc.h),
                               planes_.block_row(sc.index, mcu_row * sc.v + by) + 8 * first_mcu * sc.h,
                               planes_.stride(sc.index));
  }
}

void ScanDecoder::transform_progressive(RgbView out) {
  const Frame& frame = reader_.headers().frame;
  const std::vector<uint8_t> last(static_cast<size_t>(frame.mcus_per_row * frame.h_max), 63);
  for (int row = 0; row < frame.mcu_rows; ++row) {
    for (int c = 0; c < frame.n_components; ++c) {
      const Component& component = frame.components[c];
      const auto n = static_cast<size_t>(component.padded_width_blocks);
      for (int by = row * component.v; by < (row + 1) * component.v; ++by)
        kernels_->block.idct_islow(levels_[c].data() + 64 * n * static_cast<size_t>(by), steps_[c], last.data(), n,
                                   planes_.block_row(c, by), planes_.stride(c));
    }
    write_finished_rows(row, frame.mcu_rows, 8 * frame.v_max, out);
  }
}

// The last pixel row of an MCU row waits for the next one: upsampling may look one row of samples ahead.
void ScanDecoder::write_finished_rows(int mcu_row, int mcu_rows, int mcu_height, RgbView out) {
  const int begin = mcu_row == 0 ? 0 : mcu_row * mcu_height - 1;
  const int end = mcu_row + 1 == mcu_rows ? out.height : (mcu_row + 1) * mcu_height - 1;
  planes_.write_rgb(begin, end, out);
}

}  // namespace pac::jpeg
