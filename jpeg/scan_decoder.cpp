#include "jpeg/scan_decoder.h"

#include <algorithm>

#include "jpeg/markers.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

constexpr int64_t kNever = INT64_MAX;

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
  single_scan_ = first_scan_.n_components == frame.n_components;
  const uint64_t need = ComponentPlanes::size_bytes(frame, !single_scan_) +
                        uint64_t{3} * static_cast<uint64_t>(frame.width) * static_cast<uint64_t>(frame.height);
  if (need > limits.max_bytes)
    return Failure{Error::limit_exceeded, headers.frame_offset, "decoded image needs more memory than the limit"};
  planes_.reset(frame, !single_scan_, headers.info.color, *kernels_);
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
  if (!single_scan_) planes_.write_rgb(0, out.height, out);
  return {};
}

Result<void> ScanDecoder::decode_scans(RgbView out) {
  ScanHeader scan = first_scan_;
  int n_decoded = 0;
  while (scan.n_components > 0) {
    PAC_CHECK(decode_scan(scan, out));
    n_decoded += scan.n_components;
    reader_.set_position(position_);
    PAC_TRY(scan, reader_.next_scan());
  }
  if (n_decoded < reader_.headers().frame.n_components)
    return Failure{Error::corrupt, position_, "EOI before every component had its scan"};
  return {};
}

// Without any DHT in the file the tables of Annex K are meant: motion JPEG frames omit them.
Result<void> ScanDecoder::set_up_tables(const ScanHeader& header, int i, ScanComponent& sc) {
  const Headers& headers = reader_.headers();
  const auto& steps = headers.info.quant_tables[sc.component->quant_table];
  if (!steps) return Failure{Error::corrupt, header.offset, "quantization table is not defined"};
  std::copy(steps->begin(), steps->end(), steps_[sc.index]);
  sc.steps = steps_[sc.index];
  const uint8_t ids[2] = {header.components[i].dc_table, header.components[i].ac_table};
  for (int table_class = 0; table_class < 2; ++table_class) {
    const uint8_t id = ids[table_class];
    HuffmanDecoder& table = tables_[table_class][id];
    if (headers.have_huffman[table_class][id])
      make_decoder(headers.huffman[table_class][id], table);
    else if (!headers.any_dht && id < 2)
      make_decoder(table_class == 0 ? standard_dc(id) : standard_ac(id), table);
    else
      return Failure{Error::corrupt, header.offset, "Huffman table is not defined"};
  }
  sc.dc_table = &tables_[0][ids[0]];
  sc.ac_table = &tables_[1][ids[1]];
  return {};
}

Result<void> ScanDecoder::set_up(const ScanHeader& header, Scan& scan) {
  const Headers& headers = reader_.headers();
  const Frame& frame = headers.frame;
  const bool interleaved = header.n_components > 1;
  scan.n_components = header.n_components;
  for (int i = 0; i < header.n_components; ++i) {
    ScanComponent& sc = scan.components[i];
    sc.index = header.components[i].index;
    sc.component = &frame.components[sc.index];
    if (decoded_[sc.index]) return Failure{Error::corrupt, header.offset, "second scan of a component"};
    decoded_[sc.index] = true;
    PAC_CHECK(set_up_tables(header, i, sc));
    sc.h = interleaved ? sc.component->h : 1;
    sc.v = interleaved ? sc.component->v : 1;
    sc.blocks_per_row =
        static_cast<size_t>(interleaved ? sc.component->padded_width_blocks : sc.component->width_blocks);
    const size_t n_blocks = sc.blocks_per_row * static_cast<size_t>(sc.v);
    levels_[i].resize(64 * n_blocks);
    last_[i].assign(n_blocks, 0);
    sc.levels = levels_[i].data();
    sc.last = last_[i].data();
  }
  scan.mcus_per_row = interleaved ? frame.mcus_per_row : scan.components[0].component->width_blocks;
  scan.mcu_rows = interleaved ? frame.mcu_rows : scan.components[0].component->height_blocks;
  scan.restart_interval = scan.to_restart = headers.info.restart_interval_mcus;
  return {};
}

Result<void> ScanDecoder::decode_scan(const ScanHeader& header, RgbView out) {
  Scan scan;
  PAC_CHECK(set_up(header, scan));
  EntropyReader reader(bytes_, header.data_offset);
  int64_t next_mcu = 0, resume = 0;  // MCUs before `resume` are lost
  for (int row = 0; row < scan.mcu_rows; ++row) {
    for (int i = 0; i < scan.n_components; ++i) std::fill(levels_[i].begin(), levels_[i].end(), int16_t{0});
    for (int mcu = 0; mcu < scan.mcus_per_row; ++mcu, ++next_mcu) {
      if (next_mcu < resume) continue;
      if (auto done = read_mcu(reader, mcu, scan); !done.ok()) {
        PAC_CHECK(tolerate(done.failure()));
        resume = resume_at(reader, next_mcu, scan);
      }
    }
    for (int i = 0; i < scan.n_components; ++i) transform_row(row, scan.components[i]);
    if (single_scan_) write_finished_rows(row, scan, out);
  }
  position_ = reader.byte_offset();
  return {};
}

Result<void> ScanDecoder::read_mcu(EntropyReader& reader, int mcu, Scan& scan) {
  if (scan.restart_interval > 0) {
    if (scan.to_restart == 0) {
      PAC_CHECK(pass_restart(reader, scan.next_restart));
      scan.next_restart = (scan.next_restart + 1) & 7;
      scan.to_restart = scan.restart_interval;
      for (ScanComponent& sc : scan.components) sc.dc = 0;
    }
    scan.to_restart -= 1;
  }
  const BlockError error = read_blocks(reader, mcu, scan);
  if (reader.overrun()) {
    const uint64_t at = find_marker(bytes_, reader.byte_offset());
    if (at == bytes_.size()) return Failure{Error::truncated, at, "file ends inside the entropy-coded data"};
    return Failure{Error::corrupt, at, "marker inside the entropy-coded data"};
  }
  if (error != BlockError::none) return Failure{Error::corrupt, reader.byte_offset(), text_of(error)};
  return {};
}

// The blocks of each component in turn [T.81 A.2.3].
BlockError ScanDecoder::read_blocks(EntropyReader& reader, int mcu, Scan& scan) {
  for (int i = 0; i < scan.n_components; ++i) {
    ScanComponent& sc = scan.components[i];
    for (int by = 0; by < sc.v; ++by) {
      for (int bx = 0; bx < sc.h; ++bx) {
        const size_t block = static_cast<size_t>(by) * sc.blocks_per_row + static_cast<size_t>(mcu * sc.h + bx);
        const BlockError error =
            read_block(reader, *sc.dc_table, *sc.ac_table, sc.dc, sc.levels + 64 * block, sc.last[block]);
        if (error != BlockError::none) return error;
      }
    }
  }
  return BlockError::none;
}

// Expects RSTm at the reader's position, perhaps behind fill bytes, or behind bytes that nobody needed (a warning).
Result<void> ScanDecoder::pass_restart(EntropyReader& reader, int expected) {
  const uint64_t due = reader.byte_offset(), at = find_marker(bytes_, due);
  if (at == bytes_.size()) return Failure{Error::truncated, at, "file ends where a restart marker is due"};
  if (bytes_[at + 1] != kRst0 + expected)
    return Failure{Error::corrupt, at, "restart marker is missing or out of order"};
  if (bytes_[due] != 0xFF) warnings_ += 1;
  reader.restart_at(at + 2);
  return {};
}

// After a failure at MCU number `failed_mcu`: sets the reader behind the next usable restart marker and tells the MCU
// that follows it. A marker at most 5 numbers ahead of the one that is due means lost intervals; else it is an old one.
int64_t ScanDecoder::resume_at(EntropyReader& reader, int64_t failed_mcu, Scan& scan) const {
  if (scan.restart_interval == 0) return kNever;
  // Where the marker that is due stands: before the failed MCU if it was missing there, else after its interval.
  const int64_t interval = scan.restart_interval;
  const int64_t due_mcu = scan.to_restart == 0 ? failed_mcu : (failed_mcu / interval + 1) * interval;
  const auto due = static_cast<int>((due_mcu / interval - 1) & 7);
  uint64_t at = find_marker(bytes_, reader.byte_offset());
  for (; at < bytes_.size() && is_restart(bytes_[at + 1]); at = find_marker(bytes_, at + 2)) {
    const int number = bytes_[at + 1] - kRst0, ahead = (number - due) & 7;
    if (ahead > 5) continue;
    reader.restart_at(at + 2);
    for (ScanComponent& sc : scan.components) sc.dc = 0;
    scan.to_restart = scan.restart_interval;
    scan.next_restart = (number + 1) & 7;
    return due_mcu + ahead * interval;
  }
  reader.restart_at(at);
  return kNever;
}

void ScanDecoder::transform_row(int mcu_row, const ScanComponent& sc) {
  for (int by = 0; by < sc.v; ++by) {
    const size_t first = static_cast<size_t>(by) * sc.blocks_per_row;
    kernels_->block.idct_islow(sc.levels + 64 * first, sc.steps, sc.last + first, sc.blocks_per_row,
                               planes_.block_row(sc.index, mcu_row * sc.v + by), planes_.stride(sc.index));
  }
}

// The last pixel row of an MCU row waits for the next one: upsampling may look one row of samples ahead.
void ScanDecoder::write_finished_rows(int mcu_row, const Scan& scan, RgbView out) {
  const int mcu_height = scan.n_components > 1 ? 8 * reader_.headers().frame.v_max : 8;
  const int begin = mcu_row == 0 ? 0 : mcu_row * mcu_height - 1;
  const int end = mcu_row + 1 == scan.mcu_rows ? out.height : (mcu_row + 1) * mcu_height - 1;
  planes_.write_rgb(begin, end, out);
}

}  // namespace pac::jpeg
