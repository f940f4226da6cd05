#include "jpeg/scan_decoder.h"

#include <algorithm>
#include <cstring>

#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

// Real progressive files have about ten; each costs a pass over the picture, however few bytes it has.
constexpr int kMaxScans = 200;

size_t n_padded_blocks(const Component& c) {
  return static_cast<size_t>(c.padded_width_blocks) * static_cast<size_t>(c.padded_height_blocks);
}

uint64_t level_bytes(const Frame& frame) {
  uint64_t n = 0;
  for (int c = 0; c < frame.n_components; ++c) n += n_padded_blocks(frame.components[c]);
  return n * 64 * sizeof(int16_t);
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
  // Bands have a ring of two MCU rows each, together at most twice the image.
  use_bands_ = single_scan_ && pool_ && need + 2 * ComponentPlanes::size_bytes(frame, true) <= limits.max_bytes;
  planes_.reset(frame, whole_planes, headers.info.color, *kernels_);
  for (int c = 0; is_progressive_ && c < frame.n_components; ++c)
    levels_[c].assign(n_padded_blocks(frame.components[c]) * 64, 0);
  return {};
}

void ScanDecoder::set_threads(int n_threads) {
  if (n_threads == 0) n_threads = hardware_thread_count();
  if (n_threads <= 1)
    pool_.reset();
  else if (!pool_ || pool_->thread_count() != n_threads)
    pool_.emplace(n_threads);
}

Result<void> ScanDecoder::decode(RgbView out, bool lenient) {
  damage_ = {};
  damage_.lenient = lenient;
  position_ = first_scan_.data_offset;
  std::fill(std::begin(decoded_), std::end(decoded_), false);
  if (auto done = decode_scans(out); !done.ok()) PAC_CHECK(damage_.tolerate(done.failure()));
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
  if (!is_progressive_) {
    if (decoded_[sc.index]) return Failure{Error::corrupt, header.offset, "second scan of a component"};
    decoded_[sc.index] = true;
    return {};
  }
  if (p.is_dc()) decoded_[sc.index] = true;
  sc.blocks_per_row = static_cast<size_t>(sc.component->padded_width_blocks);
  sc.levels = levels_[sc.index].data();
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
  scan.restart_interval = reader_.headers().info.restart_interval_mcus;
  return {};
}

Result<void> ScanDecoder::decode_scan(const ScanHeader& header, RgbView out) {
  Scan scan;
  PAC_CHECK(set_up(header, scan));
  const int mcu_height = header.n_components > 1 ? 8 * reader_.headers().frame.v_max : 8;
  if (use_bands_) {
    const BandedScan job{bytes_, &scan, header.data_offset, &reader_.headers().frame, reader_.headers().info.color};
    if (const auto end = bands_.decode(job, *pool_, *kernels_, out)) {
      position_ = *end;
      return {};
    }
  }
  mcus_.start(bytes_, scan, header.data_offset, damage_);
  for (int row = 0; row < scan.mcu_rows; ++row) {
    PAC_CHECK(mcus_.decode_row(row, planes_));
    if (single_scan_) write_finished_rows(row, scan.mcu_rows, mcu_height, out);
  }
  position_ = mcus_.byte_offset();
  return {};
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
