// The public encoding functions.
#include "jpeg/byte_sink.h"
#include "jpeg/frame.h"
#include "jpeg/image_encoder.h"
#include "jpeg/jpeg.h"
#include "jpeg/pixel_io.h"

namespace pac::jpeg {
namespace {

Result<void> encode_source(ImageEncoder& encoder, const SourceImage& image, const EncodeOptions& options,
                           ByteSink& sink) {
  PAC_CHECK(check_options(image, options));
  encoder.start(image, options, false);
  encoder.write_file(encoder.tables_at(options.quality, false), options.quality, sink);
  sink.flush();
  if (image.pulled != nullptr && image.pulled->failed)
    return Failure{Error::bad_argument, 0, "the source of rows had no row to give"};
  if (sink.overflowed()) return Failure{Error::out_of_space, 0, "the output buffer is too small"};
  return {};
}

Result<std::vector<uint8_t>> encode_vector(const SourceImage& image, const EncodeOptions& options) {
  ImageEncoder encoder;
  std::vector<uint8_t> bytes;
  ByteSink sink(bytes);
  PAC_CHECK(encode_source(encoder, image, options, sink));
  return bytes;
}

// Pixels of a format, or their size alone where rows are pulled.
EncodeOptions with_format(const EncodeOptions& options, PixelFormat format) {
  EncodeOptions own = options;
  if (format == PixelFormat::gray) own.subsampling = Subsampling::gray;
  return own;
}

SourceImage pulled_image(int width, int height, PixelFormat format, PulledRows& pulled) {
  SourceImage image;
  image.pixels = {nullptr, width, height, 0, format};
  image.pulled = &pulled;
  return image;
}

// A block: DC of at most 16 + 11 bits and 63 AC of at most 16 + 10 (an EOB or ZRL replaces at least one of them), every
// byte perhaps stuffed. Headers: SOI 2, APP0 18, DQT 2 * 69, SOF 19, DHT 2 * (21 + 12) + 2 * (21 + 162), DRI 6, SOS 14,
// EOI 2; Huffman tables hold at most the 12 and 162 symbols that can occur.
uint64_t bound_of(const Frame& frame, int restart_interval_mcus) {
  constexpr uint64_t kHeaderBytes = 700, kBlockBits = 27 + 63 * 26;
  const uint64_t mcus = static_cast<uint64_t>(frame.mcus_per_row) * static_cast<uint64_t>(frame.mcu_rows);
  uint64_t blocks_in_mcu = 0;
  for (int c = 0; c < frame.n_components; ++c)
    blocks_in_mcu += static_cast<uint64_t>(frame.components[c].h) * frame.components[c].v;
  const uint64_t intervals =
      restart_interval_mcus > 0 ? 1 + mcus / static_cast<uint64_t>(restart_interval_mcus) : uint64_t{1};
  // An interval ends with up to 7 bits of padding (a byte, perhaps stuffed) and a marker.
  return kHeaderBytes + 2 * ((mcus * blocks_in_mcu * kBlockBits + 7) / 8) + 4 * intervals;
}

bool fits(const PlaneView<const uint8_t>& plane, const Component& component) {
  return plane.width == component.width && plane.height == component.height;
}

}  // namespace

struct Encoder::State {
  ImageEncoder encoder;
};

Encoder::Encoder() : state_(std::make_unique<State>()) {}
Encoder::~Encoder() = default;
Encoder::Encoder(Encoder&&) noexcept = default;
Encoder& Encoder::operator=(Encoder&&) noexcept = default;

Result<size_t> Encoder::encode_into(ConstRgbView image, const EncodeOptions& options, std::span<uint8_t> out) {
  ByteSink sink(out);
  PAC_CHECK(encode_source(state_->encoder, rgb_image(image), options, sink));
  return sink.size();
}

Result<void> Encoder::encode_append(ConstRgbView image, const EncodeOptions& options, std::vector<uint8_t>& out) {
  ByteSink sink(out);
  return encode_source(state_->encoder, rgb_image(image), options, sink);
}

Result<size_t> encode_into(ConstRgbView image, const EncodeOptions& options, std::span<uint8_t> out) {
  return Encoder().encode_into(image, options, out);
}

Result<std::vector<uint8_t>> encode(ConstRgbView image, const EncodeOptions& options) {
  return encode_vector(rgb_image(image), options);
}

Result<std::vector<uint8_t>> encode_gray(PlaneView<const uint8_t> image, const EncodeOptions& options) {
  EncodeOptions gray = options;
  gray.subsampling = Subsampling::gray;
  SourceImage source;
  source.gray = image;
  return encode_vector(source, gray);
}

Result<std::vector<uint8_t>> encode_pixels(ConstPixelView image, const EncodeOptions& options) {
  SourceImage source;
  if (image.format == PixelFormat::rgb)
    source.rgb = {image.data, image.width, image.height, image.stride_bytes};
  else
    source.pixels = image;
  return encode_vector(source, with_format(options, image.format));
}

Result<std::vector<uint8_t>> encode_rows(int width, int height, PixelFormat format, const RowSource& source,
                                         const EncodeOptions& options) {
  PulledRows pulled{&source};
  return encode_vector(pulled_image(width, height, format, pulled), with_format(options, format));
}

Result<uint64_t> encode_rows(int width, int height, PixelFormat format, const RowSource& source,
                             const ByteReceiver& receiver, const EncodeOptions& options) {
  PulledRows pulled{&source};
  ImageEncoder encoder;
  ByteSink sink(receiver);
  PAC_CHECK(encode_source(encoder, pulled_image(width, height, format, pulled), with_format(options, format), sink));
  return uint64_t{sink.size()};
}

Result<std::vector<uint8_t>> encode_planes(const YccPlanes& planes, const EncodeOptions& options) {
  SourceImage source;
  source.planes = &planes;
  PAC_CHECK(check_options(source, options));
  const Frame frame = make_frame(source, options);
  const bool fit =
      fits(planes.y, frame.components[0]) &&
      (frame.n_components == 1 || (fits(planes.cb, frame.components[1]) && fits(planes.cr, frame.components[2])));
  if (!fit) return Failure{Error::bad_argument, 0, "a plane has another size than the sampling factors say"};
  return encode_vector(source, options);
}

EncodeOptions options_for(Effort effort, Tune tune, double quality) {
  EncodeOptions options;
  options.quality = quality;
  options.tune = tune;
  options.table_source = effort == Effort::fast     ? TableSource::tuned
                         : effort == Effort::normal ? TableSource::fitted
                                                    : TableSource::adapted;
  options.huffman = effort == Effort::fast ? Huffman::standard : Huffman::optimal;
  options.dead_zone = effort == Effort::fast ? 0.0 : 0.18;
  options.trellis = effort == Effort::best;
  return options;
}

uint64_t encode_bound(int width, int height, Subsampling subsampling, int restart_interval_mcus) {
  return bound_of(make_frame(width, height, subsampling), restart_interval_mcus);
}

uint64_t encode_bound(int width, int height, const SamplingFactors& sampling, int restart_interval_mcus) {
  return bound_of(make_frame(width, height, 3, sampling), restart_interval_mcus);
}

int row_restart_interval(int width, const SamplingFactors& sampling) {
  return make_frame(width, 1, 3, sampling).mcus_per_row;
}

int row_restart_interval(int width, Subsampling subsampling) {
  return make_frame(width, 1, subsampling).mcus_per_row;
}

Result<QuantTables> adapted_tables(ConstRgbView image, Subsampling subsampling, Tune tune, double quality) {
  EncodeOptions options;
  options.subsampling = subsampling;
  options.tune = tune;
  options.quality = quality;
  options.table_source = TableSource::adapted;
  PAC_CHECK(check_options(rgb_image(image), options));
  ImageEncoder encoder;
  encoder.start(rgb_image(image), options, true);
  return encoder.tables_at(quality, false);
}

}  // namespace pac::jpeg
