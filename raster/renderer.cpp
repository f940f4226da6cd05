#include "raster/renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/kernels/kernels.h"
#include "base/parallel.h"
#include "raster/draw_list.h"
#include "raster/occluder_tree.h"
#include "raster/pose.h"
#include "raster/sample_pattern.h"
#include "raster/shadow_maps.h"
#include "raster/surface.h"
#include "raster/tile_painter.h"

namespace pac::raster {

struct Renderer::State {
  int width, height;
  const Kernels* kernels;
  ThreadPool pool;
  DrawList draw_list;
  std::vector<Surface> surfaces[2];
  std::vector<PaintedSurface> painted[2];  // of them
  OccluderTree occluders;
  ShadowScene shadows[2];
  ShadowMaps shadow_maps[2];
  Mesh posed;                                          // of scenes with objects
  std::vector<float> previous_clip;                    // of the vertices
  std::vector<std::unique_ptr<TilePainter>> painters;  // one a thread

  Result<const Mesh*> pose(const Scene& scene);
  Result<const ShadowScene*> prepare_shadows(const Scene& scene, const Mesh& mesh, const RenderQuality& quality,
                                             int rendering);
  Result<RenderStats> draw(const Scene& scene, const Camera& camera, const RenderQuality* const qualities[2],
                           const Camera* previous_camera, PaintInput& input, const RowsDrawn* drawn = nullptr);
  void paint(PaintInput& input, const RowsDrawn* drawn);
};

namespace {

constexpr int kMaxSide = 32768;  // the guard band and exact edge functions end there

template <class T, int kChannels>
bool fits(const ImageView<T, kChannels>& view, int width, int height) {
  return view.data == nullptr || (view.width == width && view.height == height);
}

// Finite, and not (nearly) singular: |det| > 1e-20 * product of the rows' lengths.
bool is_usable(const glm::mat4& m) {
  double a[4][4], scale = 1;
  for (int row = 0; row < 4; ++row) {
    double squared = 0;
    for (int column = 0; column < 4; ++column) {
      a[row][column] = m[column][row];
      if (!std::isfinite(a[row][column])) return false;
      squared += a[row][column] * a[row][column];
    }
    scale *= std::sqrt(squared);
  }
  const auto minor2 = [&](int r, int i, int j) { return a[r][i] * a[r + 1][j] - a[r][j] * a[r + 1][i]; };
  // Laplace expansion along the first two rows.
  const double det = minor2(0, 0, 1) * minor2(2, 2, 3) - minor2(0, 0, 2) * minor2(2, 1, 3) +
                     minor2(0, 0, 3) * minor2(2, 1, 2) + minor2(0, 1, 2) * minor2(2, 0, 3) -
                     minor2(0, 1, 3) * minor2(2, 0, 2) + minor2(0, 2, 3) * minor2(2, 0, 1);
  return std::fabs(det) > 1e-20 * scale;
}

uint8_t to_byte(float unit) {
  if (!(unit > 0)) return 0;
  return static_cast<uint8_t>(std::min(unit, 1.0f) * 255.0f + 0.5f);
}

}  // namespace

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Result<Renderer> Renderer::create(int width, int height, const RendererOptions& options) {
  if (width < 0 || height < 0) return Failure{Error::bad_argument, 0, "negative image size"};
  if (options.threads < 0 || options.threads > 1024)
    return Failure{Error::bad_argument, 0, "thread count outside 0..1024"};
  const int max_side = std::min(options.max_side, kMaxSide);
  if (width > max_side || height > max_side) return Failure{Error::limit_exceeded, 0, "image side over the limit"};
  const Kernels* kernels = kernels_for(options.isa);
  if (kernels == nullptr) return Failure{Error::bad_argument, 0, "instruction set not available"};
  std::unique_ptr<State> state(
      new State{width, height, kernels, ThreadPool(options.threads), {}, {}, {}, {}, {}, {}, {}, {}, {}});
  for (int i = 0; i < state->pool.thread_count(); ++i) state->painters.push_back(std::make_unique<TilePainter>());
  return Renderer(std::move(state));
}

// The scene's own mesh, or a posed copy.
Result<const Mesh*> Renderer::State::pose(const Scene& scene) {
  if (scene.objects.empty()) return &scene.mesh;
  PAC_CHECK(pose_mesh(scene, posed));
  return &posed;
}

// Null where the quality casts no shadows.
Result<const ShadowScene*> Renderer::State::prepare_shadows(const Scene& scene, const Mesh& mesh,
                                                            const RenderQuality& quality, int rendering) {
  if (quality.lighting == Lighting::local) return nullptr;
  ShadowScene& out = shadows[rendering];
  if (quality.lighting == Lighting::shadow_maps) {
    out.samples.count = 1;
    PAC_CHECK(shadow_maps[rendering].draw(scene, mesh, quality.shadow_map_side, *kernels, pool, painters, out));
    return &out;
  }
  out.by_maps = false;
  occluders.update(mesh);
  out.tree = occluders.view();
  out.offset = 2e-4f * occluders.diagonal();
  const float reach = scene.ambient_reach;
  out.ambient_reach = reach < 0 ? 0.2f * occluders.diagonal() : reach <= 0x1p60f ? reach : 0.0f;
  const int count = std::clamp(quality.light_samples, 1, kMaxLightSamples);
  if (out.samples.count != count) out.samples = make_light_samples(count);
  return &out;
}

Result<RenderStats> Renderer::State::draw(const Scene& scene, const Camera& camera,
                                          const RenderQuality* const qualities[2], const Camera* previous_camera,
                                          PaintInput& input, const RowsDrawn* drawn) {
  if (!is_usable(camera.clip_from_world))
    return Failure{Error::bad_argument, 0, "camera matrix is singular or not finite"};
  if (!input.previous.empty() && (previous_camera == nullptr || !is_usable(previous_camera->clip_from_world)))
    return Failure{Error::bad_argument, 0, "previous camera is missing, singular or not finite"};
  input.pattern = sample_pattern(qualities[0]->samples);
  if (input.pattern.empty()) return Failure{Error::bad_argument, 0, "samples must be 1, 4, 16 or 64"};
  input.has_transparent = std::any_of(scene.materials.begin(), scene.materials.end(),
                                      [](const Material& material) { return material.alpha != AlphaMode::opaque; });
  for (int r = 0; r < 2; ++r) {
    if (qualities[r] == nullptr) continue;
    const int n = input.shading_samples[r] = qualities[r]->shading_samples;
    if (n != 0 && ((n != 1 && n != 4) || n >= qualities[r]->samples))
      return Failure{Error::bad_argument, 0, "shading_samples must be 0, or 1 or 4 and fewer than samples"};
    if (input.has_transparent) input.shading_samples[r] = 0;
  }
  if (width == 0 || height == 0) return RenderStats{};
  PAC_TRY(const Mesh* const mesh, pose(scene));
  const bool is_shaded = !input.color[0].empty() || !input.color[1].empty() || !input.difference.empty();
  FrameInput frame{&scene,
                   mesh,
                   &camera,
                   kernels,
                   make_viewport(width, height),
                   sample_hull(input.pattern),
                   {nullptr, nullptr},
                   nullptr,
                   is_shaded || input.has_transparent};
  if (!input.previous.empty()) {
    previous_clip_positions(scene, *previous_camera, pool, previous_clip);
    frame.previous_clip = previous_clip.data();
  }
  for (int r = 0; r < 2; ++r) {
    input.surfaces[r] = nullptr;
    if (qualities[r] == nullptr) continue;
    RenderQuality quality = *qualities[r];
    quality.shading_samples = input.shading_samples[r];
    PAC_TRY(const ShadowScene* const cast, prepare_shadows(scene, *mesh, quality, r));
    PAC_CHECK(prepare_surfaces(scene, camera, quality, cast, surfaces[r]));
    frame.surfaces[r] = input.surfaces[r] = &surfaces[r];
    input.has_final_colors[r] = std::all_of(surfaces[r].begin(), surfaces[r].end(), BatchShader::has_final_colors);
    input.shades_lanes[r] = std::all_of(surfaces[r].begin(), surfaces[r].end(), BatchShader::shades_lanes);
    painted[r].clear();
    for (const Surface& surface : surfaces[r])
      painted[r].push_back({surface.textured ? &surface.sampler : nullptr, surface.lod_bias});
    const bool paints = std::all_of(surfaces[r].begin(), surfaces[r].end(), BatchShader::has_painted_colors);
    input.painted[r] = paints ? painted[r].data() : nullptr;
    input.has_one_batch[r] = std::all_of(surfaces[r].begin(), surfaces[r].end(), [&](const Surface& surface) {
      return surface.batch == surfaces[r].front().batch;
    });
  }
  frame.wants_normals = false;
  for (int r = 0; r < 2; ++r)
    frame.wants_normals =
        frame.wants_normals || (frame.surfaces[r] != nullptr &&
                                std::any_of(surfaces[r].begin(), surfaces[r].end(),
                                            [](const Surface& surface) { return surface.lit != Surface::Lit::no; }));
  auto stats = draw_list.build(frame, pool);
  if (!stats.ok()) return stats;

  input.draw_list = &draw_list;
  input.kernels = kernels;
  input.width = width;
  input.height = height;
  for (int c = 0; c < 3; ++c) input.background[c] = to_byte(scene.background[c]);
  paint(input, drawn);
  return stats;
}

void Renderer::State::paint(PaintInput& input, const RowsDrawn* drawn) {
  const int columns = draw_list.tiles_x(), rows = draw_list.tiles_y();
  if (drawn == nullptr) return paint_tiles(input, painters, pool, 0, columns * rows);
  static_assert(kBandRows == kTileSize);
  for (int row = 0; row < rows; ++row) {
    input.first_row = row * kBandRows;
    paint_tiles(input, painters, pool, columns * row, columns * (row + 1));
    (*drawn)(input.first_row, std::min(input.first_row + kBandRows, height));
  }
}

Result<RenderStats> Renderer::render(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                                     const RenderTargets& targets) {
  const int w = state_->width, h = state_->height;
  if (!fits(targets.color, w, h) || !fits(targets.depth, w, h) || !fits(targets.id, w, h) ||
      !fits(targets.previous, w, h))
    return Failure{Error::bad_argument, 0, "target size is not the renderer's"};
  PaintInput input{};
  input.color[0] = targets.color;
  input.depth = targets.depth;
  input.id = targets.id;
  input.previous = targets.previous;
  const RenderQuality* const qualities[2] = {&quality, nullptr};
  return state_->draw(scene, camera, qualities, targets.previous_camera, input);
}

Result<RenderStats> Renderer::render_bands(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                                           const RenderTargets& targets, const RowsDrawn& drawn) {
  const int w = state_->width, h = state_->height;
  if (!fits(targets.color, w, h) || !fits(targets.depth, w, kBandRows) || !fits(targets.id, w, kBandRows))
    return Failure{Error::bad_argument, 0, "target size is not the renderer's"};
  if (!targets.previous.empty()) return Failure{Error::bad_argument, 0, "bands have no previous places"};
  PaintInput input{};
  input.color[0] = targets.color;
  input.depth = targets.depth;
  input.id = targets.id;
  const RenderQuality* const qualities[2] = {&quality, nullptr};
  return state_->draw(scene, camera, qualities, nullptr, input, &drawn);
}

Result<RenderStats> Renderer::render_pair(const Scene& scene, const Camera& camera, const RenderQuality& high,
                                          const RenderQuality& low, const RenderTargets& high_targets,
                                          RgbView low_color, RgbView difference) {
  const int w = state_->width, h = state_->height;
  if (!fits(high_targets.color, w, h) || !fits(high_targets.depth, w, h) || !fits(high_targets.id, w, h) ||
      !fits(high_targets.previous, w, h) || !fits(low_color, w, h) || !fits(difference, w, h))
    return Failure{Error::bad_argument, 0, "target size is not the renderer's"};
  if (high.samples != low.samples || high.cull_back_faces != low.cull_back_faces)
    return Failure{Error::bad_argument, 0, "a pair shares samples and culling"};
  PaintInput input{};
  input.color[0] = high_targets.color;
  input.color[1] = low_color;
  input.depth = high_targets.depth;
  input.id = high_targets.id;
  input.previous = high_targets.previous;
  input.difference = difference;
  const RenderQuality* const qualities[2] = {&high, &low};
  return state_->draw(scene, camera, qualities, high_targets.previous_camera, input);
}

}  // namespace pac::raster
