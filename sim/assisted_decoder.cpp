#include <optional>
#include <utility>

#include "mpeg1/headers.h"
#include "sim/assisted_state.h"
#include "sim/assisted_video.h"
#include "sim/picture_packing.h"

namespace pac::sim {

struct AssistedDecoder::State {
  State(const AssistedScene& scene, const Limits& wanted_limits, Isa wanted_isa)
      : width(scene.width),
        height(scene.height),
        limits(wanted_limits),
        isa(wanted_isa),
        shared(scene, isa),
        decoder(options(), isa),
        packer(scene.width, scene.height) {}

  mpeg1::DecoderOptions options() {
    mpeg1::DecoderOptions result;
    result.limits = limits;
    result.strict = true;
    result.low_delay = true;
    result.reference = [](void* context, const mpeg1::PictureHeader&, const mpeg1::FrameView&) {
      const State& state = *static_cast<const State*>(context);
      const mpeg1::SequenceHeader* header = state.decoder.sequence();
      const bool fits = header != nullptr && header->width == state.width && header->height == state.height;
      return fits ? state.reference : nullptr;
    };
    result.reference_context = this;
    return result;
  }

  // A decoder that has failed fails for ever: another one goes on, which knows the sequence by its last good header.
  // What it may not have is the picture before: block prediction waits for a picture that stands alone.
  Failure start_again(const Failure& failure) {
    decoder = mpeg1::Decoder(options(), isa);
    if (sequence) {
      Bytes header;
      mpeg1::write_sequence_header(*sequence, header);
      decoder.feed(header);
    }
    return failure;
  }

  int width, height;
  Limits limits;
  Isa isa;
  AssistedState shared;
  mpeg1::Decoder decoder;
  std::optional<mpeg1::SequenceHeader> sequence;  // of the last picture that was good
  PicturePacker packer;
  Bytes unpacked;
  const Frame420* reference = nullptr;
  std::span<const uint8_t> bytes;  // of the frame that was begun
  bool is_predicted = false, was_key = false;
};

Result<AssistedDecoder> AssistedDecoder::create(const AssistedScene& scene, const Limits& limits, Isa isa) {
  PAC_CHECK(check(scene));
  return AssistedDecoder(std::make_unique<State>(scene, limits, isa));
}

AssistedDecoder::AssistedDecoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
AssistedDecoder::~AssistedDecoder() = default;
AssistedDecoder::AssistedDecoder(AssistedDecoder&&) noexcept = default;
AssistedDecoder& AssistedDecoder::operator=(AssistedDecoder&&) noexcept = default;

bool AssistedDecoder::last_was_key() const {
  return state_->was_key;
}

Result<void> AssistedDecoder::decode(std::span<const uint8_t> bytes, ConstRgbView low, PlaneView<const float> depth,
                                     PlaneView<const uint32_t> id, const raster::Camera& camera, RgbView shown,
                                     std::span<const glm::mat4> objects) {
  PAC_CHECK(begin(bytes, camera, objects));
  add_rows(low, depth, id, 0, low.height);
  return end(low, shown);
}

Result<void> AssistedDecoder::begin(std::span<const uint8_t> bytes, const raster::Camera& camera,
                                    std::span<const glm::mat4> objects) {
  State& s = *state_;
  if (bytes.empty()) return Failure{Error::truncated, 0, "video frame has no bytes"};
  const int prediction = (bytes[0] & kPredictionMask) >> kPredictionShift;
  if ((bytes[0] & ~(kKey | kPredictionMask | kFull | kPacked | kRatio)) != 0 ||
      prediction > static_cast<int>(Prediction::model))
    return Failure{Error::unsupported, 0, "unknown kind of video frame"};
  const auto kind = static_cast<Prediction>(prediction);
  const bool is_full = (bytes[0] & kFull) != 0;
  if (is_full && kind == Prediction::block) return Failure{Error::corrupt, 0, "block prediction of full differences"};
  const bool is_ratio = (bytes[0] & kRatio) != 0;
  if (is_ratio && !is_full) return Failure{Error::corrupt, 0, "ratios of halved differences"};
  s.bytes = bytes;
  s.was_key = (bytes[0] & kKey) != 0;
  s.is_predicted = s.shared.begin(kind, is_full ? Difference::full : Difference::halved,
                                  is_ratio ? Residual::ratio : Residual::additive, s.was_key, camera, objects);
  return {};
}

void AssistedDecoder::add_rows(ConstRgbView low, PlaneView<const float> depth, PlaneView<const uint32_t> id, int first,
                               int last) {
  if (state_->is_predicted) state_->shared.add_rows(low, depth, id, first, last);
}

Result<void> AssistedDecoder::end(ConstRgbView low, RgbView shown) {
  State& s = *state_;
  const std::span<const uint8_t> bytes = s.bytes;
  s.reference = s.is_predicted ? s.shared.end() : nullptr;
  std::span<const uint8_t> picture_bytes = bytes.subspan(1);
  if ((bytes[0] & kPacked) != 0) {
    if (s.reference == nullptr) return Failure{Error::corrupt, 0, "packed picture without the model's prediction"};
    s.unpacked.clear();
    PAC_CHECK(s.packer.unpack(picture_bytes, s.was_key, s.shared.surface(), s.unpacked));
    picture_bytes = s.unpacked;
  } else if (s.was_key) {
    s.packer.forget();
  }
  s.decoder.feed(picture_bytes);
  s.decoder.end_picture();
  const auto decoded = s.decoder.next();
  if (!decoded.ok()) return s.start_again(decoded.failure());
  const mpeg1::DecodedPicture* picture = *decoded;
  if (picture == nullptr) return s.start_again({Error::truncated, bytes.size(), "no picture in the video frame"});
  if (picture->view.width() != s.width || picture->view.height() != s.height)
    return s.start_again({Error::corrupt, 1, "pictures have another size than the session"});
  s.shared.keep(picture->view, s.reference != nullptr, picture->macroblocks);
  s.shared.composite(low, shown);
  s.sequence = *s.decoder.sequence();
  const auto more = s.decoder.next();  // it would come out in place of the next frame's
  if (!more.ok()) return s.start_again(more.failure());
  if (*more != nullptr) return s.start_again({Error::corrupt, 1, "more than one picture in the video frame"});
  return {};
}

}  // namespace pac::sim
