// The public face of the rasterizer: a Scene and a Camera become color, depth and ids.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"
#include "raster/scene.h"

namespace pac::raster {

enum class Shading : uint8_t {
  flat,     // one color a polygon: lit at its first corner with the polygon's own normal
  gouraud,  // lit at the vertices, colors interpolated
  phong,    // normals interpolated, lit at each sample
};

// How much light finds its way to lit materials; colors of unlit ones are final.
enum class Lighting : uint8_t {
  local,  // every light reaches every point that faces it, ambient light reaches all
  full,   // shadows of all lights, soft ones where the light has a size, and occlusion of the ambient light: by rays
  // Shadows of directional and spot lights by depth maps seen from them, edges softened over three texels; lights have
  // no size, point lights and ambient light no shadows. Cheaper than rays.
  shadow_maps,
};

// What one rendering does. The two renderings of a split differ only in this and, for tessellation, in the Scene.
struct RenderQuality {
  Shading shading = Shading::gouraud;
  bool texture = true;           // false: every texture is replaced by its mean color
  int samples = 1;               // 1, 4, 16 or 64 a pixel, box-filtered
  bool cull_back_faces = false;  // true: materials that are not two_sided lose their back faces
  Lighting lighting = Lighting::local;
  // Where colors are computed: 0 = at every sample (supersampling, the reference; scenes with materials whose alpha is
  // not opaque always are); else once for each triangle that a
  // pixel shows, at the pixel's center (1; samples 4, 16 or 64) or at the centers of its quarters (4; samples 16 or
  // 64), and weighted by the samples that show it. Coverage and depth are the samples' own either way.
  int shading_samples = 0;
  int light_samples = 16;      // full lighting: rays a pixel to each light with a size, and of ambient occlusion: 1..64
  int shadow_map_side = 1024;  // shadow maps: texels, 32..8192 (clamped, rounded down to a multiple of 32)

  bool operator==(const RenderQuality&) const = default;
};

// Where the results go. Empty views are skipped. All views that are given have the renderer's size.
struct RenderTargets {
  RgbView color;
  PlaneView<float> depth;  // window z in [0, 1] at the first sample; 1 = background
  PlaneView<uint32_t> id;  // 1 + face number at the first sample; 0 = background
  // Where what the pixel shows was in the previous frame, under `previous_camera` and the objects' previous transforms:
  // x and y in pixels (a surface that has not moved: the pixel's center, column + 0.5 and row + 0.5), rounded to 1/256
  // and not limited to the image, then window z. x = y = kNoPrevious where there is no surface or it was behind the
  // camera.
  ImageView<float, 3> previous{};
  const Camera* previous_camera = nullptr;  // required for `previous`
};
constexpr float kNoPrevious = -65536.0f;

constexpr int kBandRows = 32;
// Rows first..last - 1 of a picture are drawn.
using RowsDrawn = std::function<void(int first, int last)>;

struct RenderStats {
  uint64_t triangles_submitted = 0;  // after polygons are cut, before clipping
  uint64_t triangles_drawn = 0;      // after clipping and culling
  uint64_t triangles_dropped = 0;    // not finite, or zero area after snapping
};

struct RendererOptions {
  int threads = 1;       // 0 = all
  Isa isa = best_isa();  // must be built and supported
  int max_side = 32768;  // pixels
};

// Draws scenes at one image size. Same bits for every ISA and thread count. Keeps its buffers between frames and no
// pointer to a scene or target afterwards. One object, one thread at a time; distinct objects are independent.
class Renderer {
 public:
  // 0 is a legal side (nothing is drawn). Fails with bad_argument or limit_exceeded.
  static Result<Renderer> create(int width, int height, const RendererOptions& options = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  // Draws. Fails with corrupt (mesh, object or material indices out of range: nothing is drawn) or bad_argument
  // (samples, shading_samples, view sizes, a camera that is singular or not finite).
  Result<RenderStats> render(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                             const RenderTargets& targets);

  // The same, for who uses a picture's rows as they come, while they are in the cache: `drawn` is called for kBandRows
  // rows, or what is left, after the other, from the top, before the next ones are begun. targets.depth and id have
  // kBandRows rows: at each call, those of the rows that are drawn. bad_argument where `previous` is wanted.
  Result<RenderStats> render_bands(const Scene& scene, const Camera& camera, const RenderQuality& quality,
                                   const RenderTargets& targets, const RowsDrawn& drawn);

  // H, L and D = 127 + (H-L)/2 of a split that shares the geometry, in one traversal [Levoy95 s.4.1 footnote]:
  // clipping, setup, visibility once. `high` and `low` must have equal samples and cull_back_faces; shading_samples may
  // differ. Bits equal two render() calls and a subtraction.
  Result<RenderStats> render_pair(const Scene& scene, const Camera& camera, const RenderQuality& high,
                                  const RenderQuality& low, const RenderTargets& high_targets, RgbView low_color,
                                  RgbView difference);

 private:
  struct State;
  explicit Renderer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace pac::raster
