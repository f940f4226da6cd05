// The public decoding functions.
#include <cstring>

#include "jpeg/jpeg.h"
#include "jpeg/pixel_io.h"
#include "jpeg/scan_decoder.h"

namespace pac::jpeg {
namespace {

RowTarget rgb_target(RgbView view) {
  RowTarget target;
  target.rgb = view;
  return target;
}

// Opened, and on the heap: it is large.
Result<std::unique_ptr<ScanDecoder>> open_decoder(std::span<const uint8_t> bytes, const DecodeOptions& options,
                                                  const DecodeRequest& request) {
  PAC_CHECK(check_options(options));
  auto decoder = std::make_unique<ScanDecoder>(kernels_of(options.isa));
  decoder->set_threads(options.threads);
  PAC_CHECK(decoder->open(bytes, request));
  return decoder;
}

DecodeReport report_of(const ScanDecoder& decoder) {
  return {decoder.width(), decoder.height(), decoder.first_failure(), decoder.errors(), decoder.warnings()};
}

}  // namespace

PictureSize scaled_size(const Info& info, int scale_denominator) {
  return {ceil_div(info.width, scale_denominator), ceil_div(info.height, scale_denominator)};
}

Result<RgbImage> decode(std::span<const uint8_t> bytes, const DecodeOptions& options) {
  PAC_TRY(const auto decoder, open_decoder(bytes, options, request_of(options)));
  PAC_TRY(RgbImage image, RgbImage::create(decoder->width(), decoder->height(), options.limits));
  PAC_CHECK(decoder->decode(rgb_target(image.view()), false));
  return image;
}

Result<RgbImage> decode(std::span<const uint8_t> bytes, const Limits& limits, Isa isa) {
  return decode(bytes, DecodeOptions{limits, isa});
}

Result<LenientImage> decode_lenient(std::span<const uint8_t> bytes, const DecodeOptions& options) {
  PAC_TRY(const auto decoder, open_decoder(bytes, options, request_of(options)));
  PAC_TRY(RgbImage image, RgbImage::create(decoder->width(), decoder->height(), options.limits));
  PAC_CHECK(decoder->decode(rgb_target(image.view()), true));
  return LenientImage{std::move(image), decoder->first_failure(), decoder->errors(), decoder->warnings()};
}

Result<LenientImage> decode_lenient(std::span<const uint8_t> bytes, const Limits& limits, Isa isa) {
  return decode_lenient(bytes, DecodeOptions{limits, isa});
}

Result<DecodeReport> decode_pixels(std::span<const uint8_t> bytes, PixelView out, const DecodeOptions& options,
                                   Damaged damaged) {
  DecodeRequest request = request_of(options);
  request.makes_image = false;
  PAC_TRY(const auto decoder, open_decoder(bytes, options, request));
  if (out.width != decoder->width() || out.height != decoder->height())
    return Failure{Error::bad_argument, 0, "the output image has another size than the file"};
  RowTarget target;
  target.pixels = out;
  if (out.format == PixelFormat::rgb) target.rgb = {out.data, out.width, out.height, out.stride_bytes};
  PAC_CHECK(decoder->decode(target, damaged == Damaged::keep));
  return report_of(*decoder);
}

Result<DecodeReport> decode_rows(std::span<const uint8_t> bytes, PixelFormat format, const RowSink& sink,
                                 const DecodeOptions& options, Damaged damaged) {
  DecodeRequest request = request_of(options);
  request.makes_image = false;
  PAC_TRY(const auto decoder, open_decoder(bytes, options, request));
  RowTarget target;
  target.sink = &sink;
  target.format = format;
  PAC_CHECK(decoder->decode(target, damaged == Damaged::keep));
  return report_of(*decoder);
}

Result<SamplePlanes> decode_planes(std::span<const uint8_t> bytes, const DecodeOptions& options, Damaged damaged) {
  if (options.crop) return Failure{Error::bad_argument, 0, "planes cannot be cropped"};
  DecodeRequest request = request_of(options);
  request.wanted = Wanted::planes;
  PAC_TRY(const auto decoder, open_decoder(bytes, options, request));
  PAC_CHECK(decoder->decode_planes(damaged == Damaged::keep));
  const Frame& frame = decoder->scaled().frame;
  SamplePlanes out{frame.width, frame.height, decoder->headers().info.color, {}};
  for (int i = 0; i < frame.n_components; ++i) {
    const Component& c = frame.components[i];
    const auto width = static_cast<size_t>(c.width);
    SamplePlane plane{c.width, c.height, c.h, c.v, std::vector<uint8_t>(width * static_cast<size_t>(c.height))};
    for (int y = 0; y < c.height; ++y)
      std::memcpy(plane.samples.data() + static_cast<size_t>(y) * width, decoder->planes().sample_row(i, y), width);
    out.planes.push_back(std::move(plane));
  }
  return out;
}

struct Decoder::State {
  DecodeRequest request;
  ScanDecoder decoder;
};

Decoder::Decoder(const Limits& limits, Isa isa) : Decoder(DecodeOptions{limits, isa}) {}
Decoder::Decoder(const DecodeOptions& options)
    : state_(new State{request_of(options), ScanDecoder(kernels_of(options.isa))}) {
  PAC_ASSERT(check_options(options).ok());
  state_->decoder.set_threads(options.threads);
}
Decoder::~Decoder() = default;
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;

Result<void> Decoder::decode_into(std::span<const uint8_t> bytes, RgbView out) {
  ScanDecoder& decoder = state_->decoder;
  PAC_CHECK(decoder.open(bytes, state_->request));
  if (out.width != decoder.width() || out.height != decoder.height())
    return Failure{Error::bad_argument, 0, "the output image has another size than the file"};
  return decoder.decode(rgb_target(out), false);
}

}  // namespace pac::jpeg
