#include "jpeg/decoder.h"

#include <algorithm>

#include "jpeg/markers.h"
#include "jpeg/tables.h"

namespace pac::jpeg {
namespace {

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

}  // namespace

// What remains the same for all blocks of a component in a scan.
struct ScanDecoder::ScanComponent {
  const Component* component = nullptr;
  int index = 0;
  int h = 1, v = 1;  // blocks in an MCU
  const HuffmanDecoder* dc_table = nullptr;
  const HuffmanDecoder* ac_table = nullptr;
  const uint16_t* steps = nullptr;
  int dc = 0;  // PRED
  size_t blocks_per_row = 0;
  std::vector<int16_t>* levels = nullptr;
  std::vector<uint8_t>* last = nullptr;
};

Result<RgbImage> ScanDecoder::decode(std::span<const uint8_t> bytes, const Limits& limits, bool lenient) {
  bytes_ = bytes;
  lenient_ = lenient;
  first_failure_.reset();
  warnings_ = 0;
  std::fill(std::begin(decoded_), std::end(decoded_), false);
  HeaderReader reader(bytes, limits);
  PAC_CHECK(reader.start());
  PAC_TRY(ScanHeader scan, reader.next_scan());
  const Info& info = reader.headers().info;
  if (info.unsupported != nullptr) return Failure{Error::unsupported, reader.headers().frame_offset, info.unsupported};
  PAC_TRY(RgbImage image, prepare(reader.headers(), scan, limits));
  int n_decoded = 0;
  while (scan.n_components > 0) {
    if (auto done = decode_scan(reader.headers(), scan, image.view()); !done.ok()) {
      if (!lenient) return done.failure();
      note(done.failure());
      break;
    }
    n_decoded += scan.n_components;
    reader.set_position(position_);
    auto next = reader.next_scan();
    if (!next.ok()) {
      if (!lenient) return next.failure();
      note(next.failure());
      break;
    }
    scan = *next;
  }
  if (n_decoded < reader.headers().frame.n_components && !first_failure_) {
    const Failure failure{Error::corrupt, position_, "EOI before every component had its scan"};
    if (!lenient) return failure;
    note(failure);
  }
  warnings_ += reader.headers().warnings;
  if (!single_scan_) planes_.write_rgb(0, image.height(), image.view());
  return image;
}

void ScanDecoder::note(const Failure& failure) {
  if (!first_failure_) first_failure_ = failure;
  warnings_ += 1;
}

// Allocates, after checking against the limits, everything whose size the header decides.
Result<RgbImage> ScanDecoder::prepare(const Headers& headers, const ScanHeader& scan, const Limits& limits) {
  const Frame& frame = headers.frame;
  single_scan_ = scan.n_components == frame.n_components;
  const uint64_t need = ComponentPlanes::size_bytes(frame, !single_scan_) +
                        uint64_t{3} * static_cast<uint64_t>(frame.width) * static_cast<uint64_t>(frame.height);
  if (need > limits.max_bytes)
    return Failure{Error::limit_exceeded, headers.frame_offset, "decoded image needs more memory than the limit"};
  planes_.reset(frame, !single_scan_, headers.info.color, kernels_);
  return RgbImage::create(frame.width, frame.height, limits);
}

// Tables and geometry of a scan. Without any DHT the tables of Annex K are meant (motion JPEG frames omit them).
Result<void> ScanDecoder::set_up(const Headers& headers, const ScanHeader& scan, ScanComponent (&components)[4]) {
  for (int i = 0; i < scan.n_components; ++i) {
    ScanComponent& sc = components[i];
    sc.index = scan.components[i].index;
    sc.component = &headers.frame.components[sc.index];
    if (decoded_[sc.index]) return Failure{Error::corrupt, scan.offset, "second scan of a component"};
    decoded_[sc.index] = true;
    const auto& steps = headers.info.quant_tables[sc.component->quant_table];
    if (!steps) return Failure{Error::corrupt, scan.offset, "quantization table is not defined"};
    std::copy(steps->begin(), steps->end(), steps_[sc.index]);
    sc.steps = steps_[sc.index];
    const uint8_t ids[2] = {scan.components[i].dc_table, scan.components[i].ac_table};
    for (int table_class = 0; table_class < 2; ++table_class) {
      const uint8_t id = ids[table_class];
      HuffmanDecoder& table = tables_[table_class][id];
      if (headers.have_huffman[table_class][id])
        make_decoder(headers.huffman[table_class][id], table);
      else if (!headers.any_dht && id < 2)
        make_decoder(table_class == 0 ? standard_dc(id) : standard_ac(id), table);
      else
        return Failure{Error::corrupt, scan.offset, "Huffman table is not defined"};
    }
    sc.dc_table = &tables_[0][ids[0]];
    sc.ac_table = &tables_[1][ids[1]];
    const bool interleaved = scan.n_components > 1;
    sc.h = interleaved ? sc.component->h : 1;
    sc.v = interleaved ? sc.component->v : 1;
    sc.blocks_per_row =
        static_cast<size_t>(interleaved ? sc.component->padded_width_blocks : sc.component->width_blocks);
    sc.levels = &levels_[i];
    sc.last = &last_[i];
    sc.levels->resize(64 * sc.blocks_per_row * static_cast<size_t>(sc.v));
    sc.last->resize(sc.blocks_per_row * static_cast<size_t>(sc.v));
  }
  return {};
}

// One MCU: the blocks of each component in turn [T.81 A.2.3].
BlockError ScanDecoder::read_mcu(EntropyReader& reader, int mcu, ScanComponent* components, int n_components) {
  for (int i = 0; i < n_components; ++i) {
    ScanComponent& sc = components[i];
    for (int by = 0; by < sc.v; ++by) {
      for (int bx = 0; bx < sc.h; ++bx) {
        const size_t block = static_cast<size_t>(by) * sc.blocks_per_row + static_cast<size_t>(mcu * sc.h + bx);
        const BlockError error =
            read_block(reader, *sc.dc_table, *sc.ac_table, sc.dc, sc.levels->data() + 64 * block, (*sc.last)[block]);
        if (error != BlockError::none) return error;
      }
    }
  }
  return BlockError::none;
}

// Expects RSTm at the reader's position.
Result<void> ScanDecoder::pass_restart(EntropyReader& reader, int expected) {
  uint64_t at = reader.byte_offset();
  if (at < bytes_.size() && bytes_[at] != 0xFF) {
    while (at + 1 < bytes_.size() && !(bytes_[at] == 0xFF && bytes_[at + 1] != 0)) ++at;
    warnings_ += 1;
  }
  while (at + 1 < bytes_.size() && bytes_[at] == 0xFF && bytes_[at + 1] == 0xFF) ++at;
  if (at + 1 >= bytes_.size())
    return Failure{Error::truncated, bytes_.size(), "file ends where a restart marker is due"};
  if (bytes_[at] != 0xFF || bytes_[at + 1] != kRst0 + expected)
    return Failure{Error::corrupt, at, "restart marker is missing or out of order"};
  reader.restart_at(at + 2);
  return {};
}

Result<void> ScanDecoder::decode_scan(const Headers& headers, const ScanHeader& scan, RgbView out) {
  ScanComponent components[4];
  PAC_CHECK(set_up(headers, scan, components));
  const Frame& frame = headers.frame;
  const int n = scan.n_components;
  const int mcus_per_row = n > 1 ? frame.mcus_per_row : components[0].component->width_blocks;
  const int mcu_rows = n > 1 ? frame.mcu_rows : components[0].component->height_blocks;
  const int interval = headers.info.restart_interval_mcus;
  EntropyReader reader(bytes_, scan.data_offset);
  int to_restart = interval, next_restart = 0;
  for (int row = 0; row < mcu_rows; ++row) {
    for (int i = 0; i < n; ++i) std::fill(components[i].levels->begin(), components[i].levels->end(), int16_t{0});
    for (int mcu = 0; mcu < mcus_per_row; ++mcu) {
      if (interval > 0 && to_restart == 0) {
        PAC_CHECK(pass_restart(reader, next_restart));
        next_restart = (next_restart + 1) & 7;
        to_restart = interval;
        for (ScanComponent& sc : components) sc.dc = 0;
      }
      to_restart -= 1;
      const BlockError error = read_mcu(reader, mcu, components, n);
      if (reader.overrun()) {
        const uint64_t at = reader.byte_offset();
        return at + 1 < bytes_.size()
                   ? Failure{Error::corrupt, at, "marker inside the entropy-coded data"}
                   : Failure{Error::truncated, bytes_.size(), "file ends inside the entropy-coded data"};
      }
      if (error != BlockError::none) return Failure{Error::corrupt, reader.byte_offset(), text_of(error)};
    }
    for (int i = 0; i < n; ++i) transform_row(row, components[i]);
    if (single_scan_) write_finished_rows(row, mcu_rows, n > 1 ? 8 * frame.v_max : 8, out);
  }
  position_ = reader.byte_offset();
  return {};
}

void ScanDecoder::transform_row(int mcu_row, const ScanComponent& sc) {
  for (int by = 0; by < sc.v; ++by) {
    const size_t first = static_cast<size_t>(by) * sc.blocks_per_row;
    kernels_.block.idct_islow(sc.levels->data() + 64 * first, sc.steps, sc.last->data() + first, sc.blocks_per_row,
                              planes_.block_row(sc.index, mcu_row * sc.v + by), planes_.stride(sc.index));
  }
}

// The last pixel row of an MCU row waits for the next one: upsampling may look one row of samples ahead.
void ScanDecoder::write_finished_rows(int mcu_row, int mcu_rows, int mcu_height, RgbView out) {
  const int begin = mcu_row == 0 ? 0 : mcu_row * mcu_height - 1;
  const int end = mcu_row + 1 == mcu_rows ? out.height : (mcu_row + 1) * mcu_height - 1;
  planes_.write_rgb(begin, end, out);
}

Result<RgbImage> decode(std::span<const uint8_t> bytes, const Limits& limits, Isa isa) {
  const Kernels* table = kernels_for(isa);
  return ScanDecoder(table != nullptr ? *table : kernels()).decode(bytes, limits, false);
}

}  // namespace pac::jpeg
