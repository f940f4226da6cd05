#include "jpeg/abbreviated.h"

#include "jpeg/header_reader.h"
#include "jpeg/image_encoder.h"
#include "jpeg/marker_writer.h"
#include "jpeg/scan_decoder.h"
#include "jpeg/stream_tables.h"

namespace pac::jpeg {

Result<StreamTables> StreamTables::standard(const QuantTables& steps) {
  for (const QuantTable* table : {&steps.luma, &steps.chroma})
    for (const uint16_t step : *table)
      if (step < 1 || step > 255) return Failure{Error::bad_argument, 0, "quantizer step is not within 1..255"};
  return StreamTables(std::make_shared<const State>(State{steps, standard_tables()}));
}

Result<StreamTables> StreamTables::for_pictures(std::span<const ConstRgbView> pictures, const EncodeOptions& options) {
  if (pictures.empty()) return Failure{Error::bad_argument, 0, "no picture to make tables for"};
  EncodeOptions own = options;
  own.stream = nullptr;
  uint64_t seen[kTableCount][256] = {};
  ImageEncoder encoder;
  for (const ConstRgbView& picture : pictures) {
    PAC_CHECK(check_options(rgb_image(picture), own));
    encoder.start(rgb_image(picture), own, false);
    if (!own.tables) own.tables = encoder.tables_at(own.quality, false);
    const Histogram counted = encoder.count_symbols(*own.tables, own.quality);
    for (size_t table = 0; table < kTableCount; ++table)
      for (size_t symbol = 0; symbol < 256; ++symbol) seen[table][symbol] += counted.count[table][symbol];
  }
  State state{*own.tables, {}};
  for (uint32_t table = 0; table < kTableCount; ++table)
    state.huffman.spec[table] = complete_huffman(table == kDc0 || table == kDc1, seen[table]);
  return StreamTables(std::make_shared<const State>(state));
}

StreamTables::StreamTables(std::shared_ptr<const State> state) : state_(std::move(state)) {}
StreamTables::StreamTables(const StreamTables&) = default;
StreamTables::StreamTables(StreamTables&&) noexcept = default;
StreamTables& StreamTables::operator=(const StreamTables&) = default;
StreamTables& StreamTables::operator=(StreamTables&&) noexcept = default;
StreamTables::~StreamTables() = default;

const QuantTables& StreamTables::steps() const {
  return state_->steps;
}

std::vector<uint8_t> StreamTables::file() const {
  std::vector<uint8_t> bytes;
  ByteSink sink(bytes);
  write_start_of_image(sink);
  write_dqt(state_->steps.luma, 0, sink);
  write_dqt(state_->steps.chroma, 1, sink);
  for (int i = 0; i < kTableCount; ++i) write_dht(state_->huffman.spec[i], i & 1, i >> 1, sink);
  write_end_of_image(sink);
  return bytes;
}

struct StreamDecoder::State {
  DecodeOptions options;
  DecodeRequest request;
  ScanDecoder decoder;
  TableState tables;
};

StreamDecoder::StreamDecoder(const DecodeOptions& options)
    : state_(new State{options, request_of(options), ScanDecoder(kernels_of(options.isa)), {}}) {
  PAC_ASSERT(check_options(options).ok());
  state_->decoder.set_threads(options.threads);
}
StreamDecoder::~StreamDecoder() = default;
StreamDecoder::StreamDecoder(StreamDecoder&&) noexcept = default;
StreamDecoder& StreamDecoder::operator=(StreamDecoder&&) noexcept = default;

Result<void> StreamDecoder::read_tables(std::span<const uint8_t> bytes) {
  HeaderReader reader(bytes, state_->options.limits);
  reader.inherit(state_->tables);
  PAC_CHECK(reader.start());
  PAC_CHECK(reader.read_tables_only());
  state_->tables = reader.headers().tables;
  return {};
}

Result<RgbImage> StreamDecoder::decode(std::span<const uint8_t> bytes) {
  State& s = *state_;
  s.request.tables = &s.tables;
  PAC_CHECK(s.decoder.open(bytes, s.request));
  PAC_TRY(RgbImage image, RgbImage::create(s.decoder.width(), s.decoder.height(), s.options.limits));
  RowTarget target;
  target.rgb = image.view();
  PAC_CHECK(s.decoder.decode(target, false));
  s.tables = s.decoder.headers().tables;
  return image;
}

void StreamDecoder::forget_tables() {
  state_->tables = {};
}

}  // namespace pac::jpeg
