// The public decoding functions.
#include "jpeg/jpeg.h"
#include "jpeg/scan_decoder.h"

namespace pac::jpeg {
namespace {

const Kernels& kernels_of(Isa isa) {
  const Kernels* table = kernels_for(isa);
  return table != nullptr ? *table : kernels();
}

Result<void> check_options(const DecodeOptions& options) {
  if (options.threads < 0 || options.threads > 1024)
    return Failure{Error::bad_argument, 0, "thread count is not within 0..1024"};
  return {};
}

}  // namespace

Result<RgbImage> decode(std::span<const uint8_t> bytes, const DecodeOptions& options) {
  PAC_CHECK(check_options(options));
  const auto decoder = std::make_unique<ScanDecoder>(kernels_of(options.isa));
  decoder->set_threads(options.threads);
  PAC_CHECK(decoder->open(bytes, options.limits));
  PAC_TRY(RgbImage image, RgbImage::create(decoder->width(), decoder->height(), options.limits));
  PAC_CHECK(decoder->decode(image.view(), false));
  return image;
}

Result<RgbImage> decode(std::span<const uint8_t> bytes, const Limits& limits, Isa isa) {
  return decode(bytes, DecodeOptions{limits, isa});
}

Result<LenientImage> decode_lenient(std::span<const uint8_t> bytes, const DecodeOptions& options) {
  PAC_CHECK(check_options(options));
  const auto decoder = std::make_unique<ScanDecoder>(kernels_of(options.isa));
  decoder->set_threads(options.threads);
  PAC_CHECK(decoder->open(bytes, options.limits));
  PAC_TRY(RgbImage image, RgbImage::create(decoder->width(), decoder->height(), options.limits));
  PAC_CHECK(decoder->decode(image.view(), true));
  return LenientImage{std::move(image), decoder->first_failure(), decoder->warnings()};
}

Result<LenientImage> decode_lenient(std::span<const uint8_t> bytes, const Limits& limits, Isa isa) {
  return decode_lenient(bytes, DecodeOptions{limits, isa});
}

struct Decoder::State {
  Limits limits;
  ScanDecoder decoder;
};

Decoder::Decoder(const Limits& limits, Isa isa) : state_(new State{limits, ScanDecoder(kernels_of(isa))}) {}
Decoder::Decoder(const DecodeOptions& options) : Decoder(options.limits, options.isa) {
  PAC_ASSERT(check_options(options).ok());
  state_->decoder.set_threads(options.threads);
}
Decoder::~Decoder() = default;
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;

Result<void> Decoder::decode_into(std::span<const uint8_t> bytes, RgbView out) {
  ScanDecoder& decoder = state_->decoder;
  PAC_CHECK(decoder.open(bytes, state_->limits));
  if (out.width != decoder.width() || out.height != decoder.height())
    return Failure{Error::bad_argument, 0, "the output image has another size than the file"};
  return decoder.decode(out, false);
}

}  // namespace pac::jpeg
