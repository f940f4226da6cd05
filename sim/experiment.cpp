#include "sim/experiment.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "base/metrics.h"
#include "sim/difference.h"
#include "sim/frame_renderer.h"
#include "sim/packet.h"

namespace pac::sim {

namespace {

class Stopwatch {
 public:
  double milliseconds() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

Entropies measure_entropies_of(const RgbImage& image) {
  return image.empty() ? Entropies{} : measure_entropies(image.view());
}

// Each rendering by itself, for the price list; the pictures are thrown away.
Result<void> time_renders(const SceneSet& scene, const raster::Camera& camera, const RenderOptions& options,
                          FrameRenderer& frame, Renderings& out) {
  RgbImage high(out.high.width(), out.high.height()), low(high.width(), high.height());
  RgbImage difference(high.width(), high.height());
  raster::Renderer& renderer = frame.renderer();
  const Stopwatch high_watch;
  PAC_CHECK(renderer.render(scene.fine, camera, out.split.high, {high.view(), {}, {}}));
  out.timings.render_high = high_watch.milliseconds();
  const Stopwatch low_watch;
  PAC_CHECK(renderer.render(frame.low_scene(), camera, out.split.low, {low.view(), {}, {}}));
  out.timings.render_low = low_watch.milliseconds();
  if (out.split.single_pass()) {
    const Stopwatch pair_watch;
    PAC_CHECK(renderer.render_pair(scene.fine, camera, out.split.high, out.split.low, {high.view(), {}, {}}, low.view(),
                                   difference.view()));
    out.timings.render_pair = pair_watch.milliseconds();
  }
  if (options.transmit_model) {
    const Stopwatch encode_watch;
    PAC_TRY(const ScreenModel model, encode_screen_model(frame.low_scene(), camera, out.split.low, high.width(),
                                                         high.height(), options.position_bits));
    out.timings.encode_model = encode_watch.milliseconds();
    const Stopwatch decode_watch;
    PAC_CHECK(geomcodec::decode(model.bytes));
    out.timings.decode_model = decode_watch.milliseconds();
  }
  return {};
}

const RgbImage& coded_picture(const Renderings& renderings, ArmKind kind) {
  return kind == ArmKind::image_based ? renderings.high : renderings.difference;
}

Content content_of(ArmKind kind) {
  return kind == ArmKind::image_based ? Content::image : Content::difference;
}

// What depends on the picture besides what the caller wants.
CodingOptions with_importance(CodingOptions options, const Renderings& renderings) {
  options.importance = renderings.blocks.importance;
  return options;
}

double& encode_time(Timings& timings, ArmKind kind) {
  return kind == ArmKind::image_based ? timings.encode_image : timings.encode_difference;
}

// Everything about an arm once its file exists.
Result<Arm> finish_arm(const Renderings& renderings, ArmKind kind, CodedImage coded, const CodingOptions& options,
                       Timings* timings) {
  Arm arm;
  const Stopwatch decode_watch;
  PAC_TRY(RgbImage decoded, jpeg::decode(coded.bytes, {}, options.isa));
  const double decode_ms = decode_watch.milliseconds();
  if (kind == ArmKind::image_based) {
    arm.shown = std::move(decoded);
  } else {
    arm.shown = RgbImage(decoded.width(), decoded.height());
    const Stopwatch composite_watch;
    composite_image(renderings.low.view(), decoded.view(), arm.shown.view(), options.isa);
    if (timings != nullptr) timings->composite = composite_watch.milliseconds();
    arm.decoded = std::move(decoded);
    arm.model_bytes = renderings.model_bytes;
  }
  if (timings != nullptr)
    (kind == ArmKind::image_based ? timings->decode_image : timings->decode_difference) = decode_ms;
  arm.image_bytes = coded.bytes.size();
  arm.total_bytes = arm.image_bytes + arm.model_bytes;
  arm.compression_ratio = compression_ratio(arm.shown.width(), arm.shown.height(), arm.total_bytes);
  arm.budget_share = static_cast<double>(arm.total_bytes) / kBudgetBytesPerFrame;
  arm.scores = measure_scores(renderings.high.view(), arm.shown.view());
  arm.coded = std::move(coded);
  return arm;
}

Result<RenderOptions> with_defaults(RenderOptions options, const SceneSet& scene) {
  if (options.split.empty()) options.split = scene.default_split;
  if (options.width == 0) options.width = scene.width;
  if (options.height == 0) options.height = scene.height;
  if (options.width < 1 || options.width > 65535 || options.height < 1 || options.height > 65535)
    return Failure{Error::bad_argument, 0, "picture sides must be 1..65535"};
  return options;
}

// What the same tables cost with Huffman codes made for the picture: the standard ones hide half of the gain.
Result<void> measure_optimal_huffman(const Renderings& renderings, ArmKind kind, CodingOptions options, Arm& arm) {
  options.huffman = jpeg::Huffman::optimal;
  PAC_TRY(const CodedImage coded,
          code_at_quality(coded_picture(renderings, kind).view(), content_of(kind), arm.coded.quality,
                          with_importance(options, renderings), renderings.high.view()));
  arm.optimal_huffman_bytes = coded.bytes.size();
  return {};
}

// What a rendering of L says: its picture, D and the model.
void take_low(FrameImages images, Renderings& out) {
  out.high = std::move(images.high);
  out.low = std::move(images.low);
  out.difference = std::move(images.difference);
  out.low_entropy = measure_entropies_of(out.low);
  out.difference_entropy = measure_entropies_of(out.difference);
  out.visible_low_polygons = images.model.polygons;
  out.visible_low_vertices = images.model.vertices;
  out.model_bytes = images.model.bytes.size();
  out.model_parts = images.model.parts;
}

}  // namespace

Entropies measure_entropies(ConstRgbView image) {
  return {entropy_luma(image), entropy_per_channel(image), entropy_joint(image)};
}

Scores measure_scores(ConstRgbView reference, ConstRgbView test) {
  const double mse = mean_squared_error(reference, test);
  return {std::sqrt(mse), psnr_from_mse(mse), ssim_luma(reference, test)};
}

Result<Renderings> render_split(const SceneSet& scene, const raster::Camera& camera, const RenderOptions& requested) {
  PAC_TRY(const RenderOptions options, with_defaults(requested, scene));
  Renderings out;
  PAC_TRY(out.split, make_split(options.split, scene, {options.samples}));
  PAC_TRY(FrameRenderer frame, FrameRenderer::create(scene, out.split, options.transmit_model, options.width,
                                                     options.height, options.threads, options.isa));
  frame.set_position_bits(options.position_bits);
  PAC_TRY(FrameImages images, frame.render(scene, camera));
  take_low(std::move(images), out);
  out.high_entropy = measure_entropies_of(out.high);
  out.high_polygons = high_polygon_count(scene);
  out.low_polygons = low_polygon_count(scene, out.split);
  out.model_transmitted = options.transmit_model;
  out.position_bits = options.transmit_model ? options.position_bits : 0;
  out.estimated_model_bytes = static_cast<double>(out.low_polygons) * 10 / 3;
  out.resident_model_bytes = serialize_model(frame.low_scene(), out.split.low.texture).size();
  if (options.time_renders) PAC_CHECK(time_renders(scene, camera, options, frame, out));
  if (options.find_blocks || options.importance.is_on()) {
    PAC_TRY(out.blocks, find_importance(frame.renderer(), scene.fine, camera, out.split.high, options.width,
                                        options.height, options.importance));
  }
  return out;
}

Result<Arm> code_arm_at_quality(const Renderings& renderings, ArmKind kind, double quality,
                                const CodingOptions& options, Timings* timings) {
  const Stopwatch watch;
  PAC_TRY(CodedImage coded, code_at_quality(coded_picture(renderings, kind).view(), content_of(kind), quality,
                                            with_importance(options, renderings), renderings.high.view()));
  if (timings != nullptr) encode_time(*timings, kind) = watch.milliseconds();
  return finish_arm(renderings, kind, std::move(coded), options, timings);
}

Result<Arm> code_arm_at_size(const Renderings& renderings, ArmKind kind, uint64_t target_bytes,
                             const CodingOptions& given, Timings* timings) {
  const CodingOptions options = with_importance(given, renderings);
  const ConstRgbView picture = coded_picture(renderings, kind).view(), seen = renderings.high.view();
  PAC_TRY(CodedImage coded, code_at_size(picture, content_of(kind), target_bytes, options, seen));
  if (timings != nullptr) {  // of one encode, not of the search
    const Stopwatch watch;
    PAC_CHECK(code_at_quality(picture, content_of(kind), coded.quality, options, seen));
    encode_time(*timings, kind) = watch.milliseconds();
  }
  return finish_arm(renderings, kind, std::move(coded), options, timings);
}

Result<Still> run_transmitted(const SceneSet& scene, const raster::Camera& camera, const StillOptions& options,
                              double difference_quality) {
  StillOptions transmitted = options;
  transmitted.render.transmit_model = true;
  Still still;
  PAC_TRY(still.renderings, render_split(scene, camera, transmitted.render));
  still.timings = still.renderings.timings;
  PAC_TRY(still.polygon_assisted, code_arm_at_quality(still.renderings, ArmKind::polygon_assisted, difference_quality,
                                                      options.coding, &still.timings));
  PAC_TRY(still.image_based, code_arm_at_size(still.renderings, ArmKind::image_based,
                                              still.polygon_assisted.total_bytes, options.coding, &still.timings));
  return still;
}

Result<Still> run_still(const SceneSet& scene, const raster::Camera& camera, const StillOptions& options) {
  if (!(options.quality > 0 && options.quality <= 100))
    return Failure{Error::bad_argument, 0, "quality must be in (0, 100]"};
  Still still;
  PAC_TRY(still.renderings, render_split(scene, camera, options.render));
  still.timings = still.renderings.timings;
  const Renderings& renderings = still.renderings;
  if (options.target_bytes > 0) {
    PAC_TRY(still.image_based,
            code_arm_at_size(renderings, ArmKind::image_based, options.target_bytes, options.coding, &still.timings));
  } else {
    PAC_TRY(still.image_based,
            code_arm_at_quality(renderings, ArmKind::image_based, options.quality, options.coding, &still.timings));
  }
  uint64_t target = options.target_bytes > 0 ? options.target_bytes : still.image_based.image_bytes;
  if (options.charge_model) {
    if (renderings.model_bytes >= target)
      return Failure{Error::limit_exceeded, 0, "the transmitted model alone is larger than the wanted size"};
    target -= renderings.model_bytes;
  }
  PAC_TRY(still.polygon_assisted,
          code_arm_at_size(renderings, ArmKind::polygon_assisted, target, options.coding, &still.timings));
  PAC_CHECK(measure_optimal_huffman(renderings, ArmKind::image_based, options.coding, still.image_based));
  PAC_CHECK(measure_optimal_huffman(renderings, ArmKind::polygon_assisted, options.coding, still.polygon_assisted));
  return still;
}

namespace {

// The assisted arm of `renderings` within the budget, and what it is as a division; false: the model leaves too little.
Result<bool> code_division(const Renderings& renderings, const StillOptions& options, Arm& arm, Division& division,
                           Timings& timings) {
  constexpr uint64_t kFewestImageBytes = 200;  // its headers alone take more
  if (renderings.model_bytes + kFewestImageBytes > options.target_bytes) return false;
  const uint64_t image_target = options.target_bytes - renderings.model_bytes;
  PAC_TRY(arm, code_arm_at_size(renderings, ArmKind::polygon_assisted, image_target, options.coding, &timings));
  division = {renderings.position_bits, renderings.model_bytes, arm.image_bytes, arm.coded.quality, arm.scores.rms};
  return arm.image_bytes <= image_target + image_target / 50;  // else no quality is low enough
}

// Draws L, the model and D of `renderings` at another precision.
Result<void> redraw_at(int position_bits, const raster::Camera& camera, FrameRenderer& frame, Renderings& renderings) {
  FrameImages images;
  images.high = std::move(renderings.high);
  images.low = std::move(renderings.low);
  images.difference = std::move(renderings.difference);
  frame.set_position_bits(position_bits);
  PAC_CHECK(frame.redraw_low(camera, images));
  take_low(std::move(images), renderings);
  renderings.position_bits = position_bits;
  return {};
}

}  // namespace

Result<DividedStill> divide_budget(const SceneSet& scene, const raster::Camera& camera, const StillOptions& given) {
  if (given.target_bytes == 0) return Failure{Error::bad_argument, 0, "no byte budget to divide"};
  StillOptions options = given;
  PAC_TRY(options.render, with_defaults(given.render, scene));
  options.render.transmit_model = true;
  options.render.position_bits = kMostPositionBits;
  DividedStill out;
  Still& still = out.still;
  PAC_TRY(still.renderings, render_split(scene, camera, options.render));
  Renderings& renderings = still.renderings;
  still.timings = renderings.timings;
  PAC_TRY(still.image_based,
          code_arm_at_size(renderings, ArmKind::image_based, options.target_bytes, options.coding, &still.timings));
  PAC_TRY(FrameRenderer frame,
          FrameRenderer::create(scene, renderings.split, true, options.render.width, options.render.height,
                                options.render.threads, options.render.isa));
  int best_bits = 0;
  for (int bits = kFewestPositionBits; bits <= kMostPositionBits; ++bits) {
    PAC_CHECK(redraw_at(bits, camera, frame, renderings));
    Arm arm;
    Division division;
    PAC_TRY(const bool fits, code_division(renderings, options, arm, division, still.timings));
    if (!fits) continue;
    out.divisions.push_back(division);
    if (best_bits != 0 && arm.scores.rms >= still.polygon_assisted.scores.rms) continue;
    still.polygon_assisted = std::move(arm);
    best_bits = bits;
  }
  if (best_bits == 0)
    return Failure{Error::limit_exceeded, 0, "the transmitted model leaves no bytes for an image at any precision"};
  PAC_CHECK(redraw_at(best_bits, camera, frame, renderings));
  PAC_CHECK(measure_optimal_huffman(renderings, ArmKind::image_based, options.coding, still.image_based));
  PAC_CHECK(measure_optimal_huffman(renderings, ArmKind::polygon_assisted, options.coding, still.polygon_assisted));
  return out;
}

}  // namespace pac::sim
