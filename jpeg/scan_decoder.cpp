#include "jpeg/scan_decoder.h"

#include <algorithm>
#include <cstring>

#include "jpeg/reduced_idct.h"
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
Result<void> ScanDecoder::open(std::span<const uint8_t> bytes, const DecodeRequest& request) {
  bytes_ = bytes;
  reader_ = HeaderReader(bytes, request.limits);
  if (request.tables != nullptr) reader_.inherit(*request.tables);
  PAC_CHECK(reader_.start());
  PAC_TRY(first_scan_, reader_.next_scan());
  const Headers& headers = reader_.headers();
  if (headers.info.unsupported != nullptr)
    return Failure{Error::unsupported, headers.frame_offset, headers.info.unsupported};
  const Frame& frame = headers.frame;
  is_progressive_ = headers.is_progressive();
  wanted_ = request.wanted;
  keeps_levels_ = is_progressive_ || wanted_ == Wanted::levels;
  single_scan_ = !keeps_levels_ && first_scan_.n_components == frame.n_components;
  scaled_ = scaled_frame(frame, request.scale);
  PAC_CHECK(choose_window(request));
  PAC_CHECK(check_memory(request));
  const bool whole_planes = wanted_ == Wanted::planes || (!single_scan_ && !keeps_levels_);
  planes_.reset(scaled_, whole_planes, headers.info.color, *kernels_);
  for (int c = 0; keeps_levels_ && c < frame.n_components; ++c)
    levels_[c].assign(n_padded_blocks(frame.components[c]) * 64, 0);
  return {};
}

Result<void> ScanDecoder::choose_window(const DecodeRequest& request) {
  const int width = scaled_.frame.width, height = scaled_.frame.height;
  window_ = request.crop ? *request.crop : Crop{0, 0, width, height};
  const bool inside = window_.x >= 0 && window_.y >= 0 && window_.width > 0 && window_.height > 0 &&
                      window_.width <= width - window_.x && window_.height <= height - window_.y;
  if (!inside) return Failure{Error::bad_argument, 0, "the crop does not lie inside the picture"};
  is_partial_ = window_.width < width || window_.height < height;
  const Frame& frame = scaled_.frame;
  needed_ = mcus_of(window_, scaled_.mcu_width(), 8 / scaled_.scale * frame.v_max, frame.mcus_per_row, frame.mcu_rows);
  return {};
}

Result<void> ScanDecoder::check_memory(const DecodeRequest& request) {
  const Frame& frame = reader_.headers().frame;
  const bool whole_planes = wanted_ == Wanted::planes || (!single_scan_ && !keeps_levels_);
  const uint64_t pixels = static_cast<uint64_t>(window_.width) * static_cast<uint64_t>(window_.height);
  const uint64_t need = ComponentPlanes::size_bytes(scaled_, whole_planes) + (keeps_levels_ ? level_bytes(frame) : 0) +
                        (request.makes_image ? 3 * pixels : 0);
  if (need > request.limits.max_bytes)
    return Failure{Error::limit_exceeded, reader_.headers().frame_offset,
                   "decoded image needs more memory than the limit"};
  // Bands have two rings of two MCU rows each, together at most four times the image.
  use_bands_ = single_scan_ && pool_ && scaled_.scale == 1 && !is_partial_ &&
               need + 4 * ComponentPlanes::size_bytes(frame, true) <= request.limits.max_bytes;
  return {};
}

void ScanDecoder::set_threads(int n_threads) {
  if (n_threads == 0) n_threads = hardware_thread_count();
  if (n_threads <= 1)
    pool_.reset();
  else if (!pool_ || pool_->thread_count() != n_threads)
    pool_.emplace(n_threads);
}

Result<void> ScanDecoder::decode(const RowTarget& target, bool lenient) {
  damage_ = {};
  damage_.lenient = lenient;
  position_ = first_scan_.data_offset;
  std::fill(std::begin(decoded_), std::end(decoded_), false);
  target_ = target;
  int first = 0, width = scaled_.frame.width;
  if (window_.width < width) {
    planes_.narrow(needed_.first_column, needed_.end_column);
    first = needed_.first_column * scaled_.mcu_width();
    width = std::min(width, needed_.end_column * scaled_.mcu_width()) - first;
  }
  output_.start(target, window_, first, width, reader_.headers().info.color);
  if (auto done = decode_scans(); !done.ok()) PAC_CHECK(damage_.tolerate(done.failure()));
  if (wanted_ == Wanted::levels) return {};
  if (is_progressive_)
    transform_progressive();
  else if (!single_scan_ && wanted_ == Wanted::rows)
    output_.rows_ready(0, scaled_.frame.height, planes_);
  return {};
}

Result<void> ScanDecoder::decode_scans() {
  ScanHeader scan = first_scan_;
  for (int n_scans = 1; scan.n_components > 0; ++n_scans) {
    if (n_scans > kMaxScans) return Failure{Error::limit_exceeded, scan.offset, "more scans than the limit"};
    PAC_CHECK(decode_scan(scan));
    if (single_scan_ && (is_partial_ || output_.is_stopped())) return {};
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
  if (headers.tables.have_huffman[table_class][id])
    spec = &headers.tables.huffman[table_class][id];
  else if (!headers.tables.any_dht && id < 2)
    spec = table_class == 0 ? &standard_dc(id) : &standard_ac(id);
  else
    return Failure{Error::corrupt, header.offset, "Huffman table is not defined"};
  HuffmanDecoder& table = tables_[table_class][id];
  HuffmanSpec& known = table_specs_[table_class][id];
  if (spec->n_symbols() == 0 || std::memcmp(&known, spec, sizeof known) != 0) {
    make_decoder(*spec, table);
    known = *spec;
    if (table_class == 1) {
      has_ac_pairs_[id] = false;
      ac_pixels_[id] = 0;
    }
  }
  return &table;
}

// The pairs of an AC table take as long to make as some thousand blocks take to read without them: of one picture, or
// of several small ones that have the table in common.
const AcPairs* ScanDecoder::set_up_pairs(uint8_t id) {
  constexpr int64_t kMinPixels = 512 * 512;
  const Frame& frame = reader_.headers().frame;
  if (!has_ac_pairs_[id]) {
    ac_pixels_[id] += int64_t{frame.width} * frame.height;
    if (ac_pixels_[id] < kMinPixels) return nullptr;
    make_ac_pairs(tables_[1][id], ac_pairs_[id]);
    has_ac_pairs_[id] = true;
  }
  return &ac_pairs_[id];
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
  if (!is_progressive_ && decoded_[sc.index])
    return Failure{Error::corrupt, header.offset, "second scan of a component"};
  if (!is_progressive_) sc.ac_pairs = set_up_pairs(header.components[i].ac_table);
  if (p.is_dc()) decoded_[sc.index] = true;
  if (!keeps_levels_) return {};
  sc.blocks_per_row = static_cast<size_t>(sc.component->padded_width_blocks);
  sc.levels = levels_[sc.index].data();
  return {};
}

Result<void> ScanDecoder::set_up(const ScanHeader& header, Scan& scan) {
  const Frame& frame = reader_.headers().frame;
  scan.n_components = header.n_components;
  scan.is_progressive = is_progressive_;
  scan.keeps_levels = keeps_levels_;
  scan.progression = header.progression;
  for (int i = 0; i < header.n_components; ++i) PAC_CHECK(set_up_component(header, i, scan.components[i]));
  const bool is_interleaved = header.n_components > 1;
  scan.mcus_per_row = is_interleaved ? frame.mcus_per_row : scan.components[0].component->width_blocks;
  scan.mcu_rows = is_interleaved ? frame.mcu_rows : scan.components[0].component->height_blocks;
  const int h = is_interleaved ? 1 : scan.components[0].component->h;
  const int v = is_interleaved ? 1 : scan.components[0].component->v;
  scan.needed = {needed_.first_row * v, needed_.end_row * v, needed_.first_column * h, needed_.end_column * h};
  scan.restart_interval = reader_.headers().info.restart_interval_mcus;
  return {};
}

Result<void> ScanDecoder::decode_scan(const ScanHeader& header) {
  Scan scan;
  PAC_CHECK(set_up(header, scan));
  if (use_bands_ && target_.rgb.data != nullptr && decode_bands(header, scan)) return {};
  const int mcu_height = 8 / scaled_.scale * (header.n_components > 1 ? scaled_.frame.v_max : 1);
  const int end = single_scan_ && is_partial_ ? std::min(scan.needed.end_row, scan.mcu_rows) : scan.mcu_rows;
  mcus_.start(bytes_, scan, header.data_offset, damage_);
  find_crop_restarts(header, scan, end);
  for (int row = skip_to_crop(scan, 0); row < end && !output_.is_stopped(); ++row) {
    skip_to_crop(scan, row);
    PAC_CHECK(mcus_.decode_row(row, planes_));
    if (single_scan_ && wanted_ == Wanted::rows) write_finished_rows(row, scan.mcu_rows, mcu_height);
  }
  position_ = mcus_.byte_offset();
  return {};
}

// Of a crop's only scan: the markers before the last interval that it needs, where all of them are in order.
void ScanDecoder::find_crop_restarts(const ScanHeader& header, const Scan& scan, int end_row) {
  crop_restarts_.clear();
  if (!single_scan_ || !is_partial_ || scan.restart_interval == 0 || end_row == 0) return;
  const int64_t last_mcu = int64_t{end_row - 1} * scan.mcus_per_row + scan.needed.first_column;
  const auto n = static_cast<uint64_t>(last_mcu / scan.restart_interval);
  if (!find_restarts(bytes_, header.data_offset, n, crop_restarts_)) crop_restarts_.clear();
}

// Before a row: jumps over the intervals that end before the first MCU needed in it, or in the first row needed.
// Returns the row to go on with: an interval may begin before the row whose MCUs it holds.
int ScanDecoder::skip_to_crop(const Scan& scan, int row) {
  if (crop_restarts_.empty()) return row;
  const int64_t wanted = int64_t{std::max(row, scan.needed.first_row)} * scan.mcus_per_row + scan.needed.first_column;
  const auto interval = std::min<int64_t>(wanted / scan.restart_interval, static_cast<int64_t>(crop_restarts_.size()));
  const int64_t mcu = interval * scan.restart_interval;
  if (mcu <= mcus_.next_mcu()) return row;
  mcus_.jump(crop_restarts_[static_cast<size_t>(interval - 1)] + 2, interval);
  return static_cast<int>(mcu / scan.mcus_per_row);
}

bool ScanDecoder::decode_bands(const ScanHeader& header, const Scan& scan) {
  const BandedScan job{bytes_, &scan, header.data_offset, &reader_.headers().frame, reader_.headers().info.color};
  const auto end = bands_.decode(job, *pool_, *kernels_, target_.rgb);
  if (end) position_ = *end;
  return end.has_value();
}

void ScanDecoder::transform_progressive() {
  const Frame& frame = reader_.headers().frame;
  const std::vector<uint8_t> last(static_cast<size_t>(frame.mcus_per_row * frame.h_max), 63);
  for (int row = needed_.first_row; row < needed_.end_row && !output_.is_stopped(); ++row) {
    for (int c = 0; c < frame.n_components; ++c) {
      const Component& component = frame.components[c];
      const int size = planes_.block_size(c), first = needed_.first_column * component.h;
      const auto n = static_cast<size_t>(needed_.end_column * component.h - first);
      for (int by = row * component.v; by < (row + 1) * component.v; ++by) {
        const int16_t* levels = levels_[c].data() + 64 * (ptrdiff_t{component.padded_width_blocks} * by + first);
        uint8_t* out = planes_.block_row(c, by) + ptrdiff_t{size} * first;
        idct_to_size(kernels_->block, size, levels, steps_[c], last.data(), n, out, planes_.stride(c));
      }
    }
    if (wanted_ == Wanted::rows) write_finished_rows(row, frame.mcu_rows, 8 / scaled_.scale * frame.v_max);
  }
}

// The last pixel row of an MCU row waits for the next one: upsampling may look one row of samples ahead.
void ScanDecoder::write_finished_rows(int mcu_row, int mcu_rows, int mcu_height) {
  const int begin = mcu_row == 0 ? 0 : mcu_row * mcu_height - 1;
  const int end = mcu_row + 1 == mcu_rows ? scaled_.frame.height : (mcu_row + 1) * mcu_height - 1;
  output_.rows_ready(begin, end, planes_);
}

}  // namespace pac::jpeg
