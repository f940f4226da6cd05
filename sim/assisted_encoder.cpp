#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "raster/sample_pattern.h"
#include "sim/assisted_state.h"
#include "sim/assisted_video.h"
#include "sim/difference.h"
#include "sim/difference_matrices.h"
#include "sim/frame420.h"
#include "sim/model_vectors.h"
#include "sim/object_motion.h"
#include "sim/picture_packing.h"

namespace pac::sim {

namespace {

mpeg1::SequenceOptions sequence_options(const AssistedScene& scene, const AssistedVideoOptions& options) {
  mpeg1::SequenceOptions sequence;
  sequence.width = scene.width;
  sequence.height = scene.height;
  sequence.picture_rate_code = options.picture_rate_code;
  if (options.key_interval > 0) sequence.gop_length = options.key_interval;
  sequence.quantizer_scale = options.quantizer_scale;
  sequence.effort = options.effort;
  const bool is_halved = options.difference == Difference::halved;
  sequence.intra_refresh = options.prediction == Prediction::block;  // elsewhere nothing drifts
  if (options.prediction == Prediction::block) {
    sequence.non_intra_matrix = halved(mpeg1::kDefaultNonIntraMatrix);
  } else {
    constexpr double kSlope = 3;
    sequence.non_intra_matrix = is_halved ? sloping_matrix(8, kSlope / 2) : sloping_matrix(16, kSlope);
  }
  if (is_halved) sequence.intra_matrix = halved_intra();
  return sequence;
}

AssistedVideoOptions settled(AssistedVideoOptions options, const AssistedScene& scene) {
  const bool is_ratio = options.difference == Difference::full && scene.differs_in_light;
  if (options.residual == Residual::by_scene) options.residual = is_ratio ? Residual::ratio : Residual::additive;
  return options;
}

const char* problem_with(const AssistedVideoOptions& options) {
  if (options.prediction == Prediction::block && options.difference == Difference::full)
    return "block prediction codes halved differences";
  if (options.residual == Residual::ratio && options.difference != Difference::full)
    return "a residual of ratios is a full difference";
  if (!(options.quantizer_scale >= 1 && options.quantizer_scale <= 31)) return "quantizer_scale is outside 1..31";
  if (options.key_quantizer_scale != 0 && !(options.key_quantizer_scale >= 1 && options.key_quantizer_scale <= 31))
    return "key_quantizer_scale is outside 1..31";
  if (options.key_interval < 0 || options.key_interval > 132) return "key_interval is outside 0..132";
  if (options.rate.is_on() && options.prediction != Prediction::model) return "a bit rate needs model prediction";
  return nullptr;
}

std::optional<ModelFlow> block_flow_for(const AssistedScene& scene, const AssistedVideoOptions& options, Isa isa) {
  if (options.prediction != Prediction::block) return std::nullopt;
  const raster::SampleOffset sample = raster::sample_pattern(scene.samples)[0];
  return ModelFlow(scene.width, scene.height, sample.x / 256.0, sample.y / 256.0, movers_of(*scene.low), isa);
}

// Why a picture is coded again. It is packed: what its levels cost there, the first coding tells. A bit rate counts
// what is sent: each picture that the encoder offers is packed for its size.
struct PackedSearch {
  std::optional<QuantizerSearch> search;  // of a bit rate
  PicturePacker* packer;                  // null: pictures are sent as they are
  bool is_key;
  PlaneView<const uint32_t> surface;
  const Bytes& out;
  size_t begin;  // of the picture in `out`
  mpeg1::PictureOptions& picture;
  std::vector<mpeg1::MacroblockPrices>* prices;  // null: Annex B's

  static double code_again(void* context, double scale, uint64_t size_bytes) {
    PackedSearch& self = *static_cast<PackedSearch*>(context);
    const std::span<const uint8_t> coded = std::span(self.out).subspan(self.begin);
    if (self.prices != nullptr && self.picture.prices.empty() &&
        self.packer->prices(coded, self.is_key, self.surface, *self.prices)) {
      self.picture.prices = *self.prices;
      return scale;
    }
    if (!self.search) return 0;
    if (self.packer != nullptr) size_bytes = self.packer->packed_size(coded, self.is_key, self.surface);
    return self.search->next(scale, size_bytes);
  }
};

}  // namespace

double key_quantizer_for(const AssistedVideoOptions& options) {
  if (options.key_quantizer_scale != 0) return options.key_quantizer_scale;
  if (options.prediction != Prediction::model) return options.quantizer_scale;
  return std::max(1.0, options.quantizer_scale / kKeyRatio);
}

struct AssistedEncoder::State {
  AssistedVideoOptions options;
  Isa isa;
  AssistedState shared;
  mpeg1::Encoder encoder;
  int64_t since_key = -1;  // -1: nothing coded yet
  Frame420 source;
  RgbImage difference;
  LeakyBucket bucket;
  PicturePacker packer;
  std::vector<mpeg1::MacroblockPrices> prices;
  Bytes picture;                        // of the last frame
  double last_quantizer = 0;            // of a picture between two that stand alone; 0: none yet
  std::optional<ModelFlow> block_flow;  // of block prediction: where the search for vectors begins
  QuantizerAdaptation adaptation;

  // Where the search of a bit rate begins.
  double first_guess(bool is_key) const {
    if (is_key || last_quantizer == 0) return is_key ? key_quantizer_for(options) : options.quantizer_scale;
    return last_quantizer;
  }
};

Result<AssistedEncoder> AssistedEncoder::create(const AssistedScene& scene, const AssistedVideoOptions& options,
                                                Isa isa) {
  PAC_CHECK(check(scene));
  if (const char* problem = problem_with(options)) return Failure{Error::bad_argument, 0, problem};
  if (const char* problem = problem_with(options.rate, scene.width, scene.height))
    return Failure{Error::bad_argument, 0, problem};
  PAC_TRY(QuantizerAdaptation adaptation, QuantizerAdaptation::create(*scene.low, options.foreground));
  PAC_TRY(mpeg1::Encoder encoder, mpeg1::Encoder::create(sequence_options(scene, options), isa));
  return AssistedEncoder(std::make_unique<State>(State{settled(options, scene),
                                                       isa,
                                                       AssistedState(scene, isa),
                                                       std::move(encoder),
                                                       -1,
                                                       Frame420(scene.width, scene.height),
                                                       RgbImage(scene.width, scene.height),
                                                       LeakyBucket(options.rate),
                                                       PicturePacker(scene.width, scene.height),
                                                       {},
                                                       {},
                                                       0,
                                                       block_flow_for(scene, options, isa),
                                                       std::move(adaptation)}));
}

AssistedEncoder::AssistedEncoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
AssistedEncoder::~AssistedEncoder() = default;
AssistedEncoder::AssistedEncoder(AssistedEncoder&&) noexcept = default;
AssistedEncoder& AssistedEncoder::operator=(AssistedEncoder&&) noexcept = default;

bool AssistedEncoder::next_is_key(bool force_key) const {
  const State& s = *state_;
  return force_key || s.options.prediction == Prediction::none || s.since_key < 0 ||
         (s.options.key_interval > 0 && s.since_key + 1 >= s.options.key_interval);
}

std::span<const uint8_t> AssistedEncoder::picture() const {
  return state_->picture;
}

const LeakyBucket& AssistedEncoder::bucket() const {
  return state_->bucket;
}

Result<AssistedReport> AssistedEncoder::encode(const AssistedFrame& frame, Bytes& out, bool force_key,
                                               double quantizer_scale) {
  State& s = *state_;
  const AssistedVideoOptions& options = s.options;
  const bool is_key = next_is_key(force_key);
  mpeg1::PictureOptions picture;
  picture.reference = s.shared.reference(options.prediction, options.difference, options.residual, is_key, frame.low,
                                         frame.depth, frame.id, frame.camera, frame.objects);
  if (options.difference == Difference::full) {
    s.shared.frame420_of(frame.high, s.source);
  } else {
    difference_image(frame.high, frame.low, s.difference.view(), s.isa);
    frame420_from_rgb(s.difference.view(), s.source, s.isa);
  }
  const bool replaced = picture.reference != nullptr;
  picture.type = replaced || !is_key ? mpeg1::PictureType::P : mpeg1::PictureType::I;
  AssistedVideoOptions wanted = options;
  if (quantizer_scale > 0) wanted.quantizer_scale = quantizer_scale;
  picture.quantizer_scale = is_key ? key_quantizer_for(wanted) : wanted.quantizer_scale;
  const bool packs = replaced && options.is_packed;
  const bool masks = is_key && options.adapts_to_texture;
  picture.quantizer_factors = s.adaptation.factors(frame.high, frame.id, masks);
  const size_t before = out.size(), begin = before + 1;  // a byte before the picture
  const bool is_priced = packs && options.is_priced && options.effort != mpeg1::Effort::fast;
  PackedSearch search{std::nullopt, packs ? &s.packer : nullptr,    is_key, s.shared.surface(), out, begin,
                      picture,      is_priced ? &s.prices : nullptr};
  if (options.rate.is_on()) {
    search.search.emplace(s.bucket.next(), frame.overhead_bytes + 1);
    picture.quantizer_scale = s.first_guess(is_key);
  }
  if (search.search || is_priced) {
    picture.code_again = PackedSearch::code_again;
    picture.code_again_context = &search;
  }

  std::vector<mpeg1::MotionVector> vectors;
  if (s.block_flow) {
    if (!is_key) {
      vectors = vectors_of(s.block_flow->find(frame.depth, frame.id, frame.camera, frame.objects));
      picture.candidates = vectors;
      picture.candidates_per_macroblock = kModelVectors;
    }
    s.block_flow->remember(frame.camera, frame.objects);
  }

  out.push_back(static_cast<uint8_t>((is_key ? kKey : 0) | static_cast<int>(options.prediction) << kPredictionShift |
                                     (options.difference == Difference::full ? kFull : 0) |
                                     (options.residual == Residual::ratio ? kRatio : 0)));
  PAC_TRY(const mpeg1::PictureReport coded, s.encoder.add(s.source, out, picture));
  s.picture.assign(out.begin() + static_cast<ptrdiff_t>(begin), out.end());
  if (packs) {
    const Bytes packed = s.packer.pack(s.picture, is_key, s.shared.surface());
    if (!packed.empty()) {
      out[before] |= kPacked;
      out.resize(begin);
      out.insert(out.end(), packed.begin(), packed.end());
    }
  }
  s.shared.keep(s.encoder.reconstruction(), replaced);
  s.since_key = is_key ? 0 : s.since_key + 1;
  AssistedReport report;
  report.is_key = is_key;
  report.bytes = out.size() - before;
  report.quantizer_scale = coded.quantizer_scale;
  if (options.rate.is_on()) s.bucket.add(report.bytes + frame.overhead_bytes);
  if (!is_key) s.last_quantizer = coded.quantizer_scale;
  report.carried_share = s.shared.carried_share();
  report.skipped_macroblocks = coded.skipped_macroblocks;
  report.coded_macroblocks = coded.coded_macroblocks;
  report.intra_macroblocks = coded.intra_macroblocks;
  return report;
}

void AssistedEncoder::composite(ConstRgbView low, RgbView shown) const {
  state_->shared.composite(low, shown);
}

}  // namespace pac::sim
