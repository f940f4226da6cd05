// Rasterization inside one tile: coverage and depth, interpolation, lighting, texture filter, accumulation of samples.
//
// Positions are 24.8 fixed-point pixels, x to the right and y down; pixel (px, py) covers [256 px, 256 px + 256) x ....
// Lanes: one lane is one sample to shade (or one corner to light). Arrays of lanes are "rows" of kBatchLanes floats,
// 32-byte aligned; kernels work on whole groups of 8 lanes, so unused lanes of the last group must hold readable
// values. Every float result is a fixed sequence of IEEE single-precision + - * / sqrt and comparisons in each lane: no
// operation mixes lanes, so the width of a vector register cannot matter.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac {

constexpr int kTileSize = 32;     // pixels a side; a tile's buffers are row-major, kTileSize wide, 32-byte aligned
constexpr int kBatchLanes = 256;  // lanes that one call shades; a multiple of 8
constexpr int kBatchPacks = kBatchLanes / 8;
constexpr int kMaxMipLevels = 16;     // sides up to 32768
constexpr int kMaxAttributes = 18;    // color 3, texture coordinates 2, opacity 1, normal 3, position 3, tangents 6
constexpr int kMaxKernelLights = 16;  // lights that one scene may have

// A triangle on the sample grid. Corners are ordered so that area2 > 0. Edge function i is opposite to corner i and
// vanishes on that edge; with (X, Y) = sample - corner 0:
//   E1 = a[1] X + b[1] Y,  E2 = a[2] X + b[2] Y,  E0 = area2 - E1 - E2,
// exactly, in units of 2^-16 square pixels. |a|, |b| <= 2^23 (guard band), |E| < 2^52.
// Two cache lines: the first is what rasterizing reads of small triangles, and most of what it reads of others.
struct alignas(64) RasterTriangle {
  int32_t x0, y0;                      // corner 0
  int16_t min_x, min_y, max_x, max_y;  // pixels that some sample position of which may be inside; inclusive, >= 0
  uint8_t exclude[3];                  // 1 where a sample on edge i is outside (not a top or left edge)
  uint8_t covered;  // bit x + 2 y: the sample of pixel (min_x + x, min_y + y) is inside; 0 where not all are told so
  float z0, dzdx, dzdy, z_min, z_max;  // window depth: z0 + dzdy Y + dzdx X, clamped to the corners' range
  int32_t a[3], b[3];                  // change of E_i by 1/256 pixel
  int64_t area2;                       // E0 + E1 + E2 > 0
  float w[3];                          // 1/w of the corners divided by the largest of them
  uint32_t id;                         // 1 + face number
  uint32_t state[2];                   // per rendering: how it is shaded
  // Per rendering: a0, a1 - a0, a2 - a0 for each attribute. [2]: clip coordinates in the previous frame.
  const float* attributes[3];
  uint8_t shift;   // smallest k >= 0 with area2 >> k < 2^31
  uint8_t planar;  // 1: attributes inside are interpolated as planes, see planes_simd.inc
};
static_assert(sizeof(RasterTriangle) == 128);

// What 1/w inside planar triangles stays above; outside it is raised to it.
constexpr float kLeastPlanarW = 0x1p-9f;

// The sample of the tile's pixel (0, 0): 256 * tile origin + sample offset.
struct SamplePosition {
  int32_t x, y;
};

// Eight neighbouring samples of one row of a tile, those in `mask` (bit k = lane k) belonging to one triangle.
struct LanePack {
  const RasterTriangle* triangle;
  uint8_t x, y;  // of lane 0 in the tile; x is a multiple of 8
  uint8_t mask;
  uint8_t weight[8];  // how many samples of its pixel a lane of the mask stands for: collect_grid() alone sets it
};

// One sample by itself, for lanes of different triangles: lane x % 8 of the pack at x - x % 8.
struct LaneSample {
  const RasterTriangle* triangle;
  uint8_t x, y;    // in the tile
  uint8_t weight;  // as LanePack's
};

// What several samples of each pixel of a tile see. Pixels that show one triangle at all samples hold its id alone; the
// others hold id and depth of every sample. Which form a pixel has may differ between instruction sets, what its
// samples see may not. All arrays are the caller's, 32-byte aligned.
constexpr int kGridSamples = 16;              // room for so many a pixel
constexpr uint32_t kSplitPixel = UINT32_MAX;  // in `whole`: see ids and depth
struct SampleGrid {
  int n;                                     // 4 or 16 samples in use
  int32_t x[kGridSamples], y[kGridSamples];  // their offsets inside the pixel, 0..255; beyond n: any such
  uint32_t* whole;                           // kTileSize^2: 0 = background, else 1 + index of the triangle
  float *near_z, *far_z;                     // kTileSize^2: every depth of the pixel lies between them
  uint32_t* ids;                             // kTileSize^2 * kGridSamples, sample after sample
  float* depth;                              // the same
};

// Where first_sample() writes: rows so many elements apart.
struct FirstSampleTarget {
  float* depth;
  ptrdiff_t depth_stride;
  uint32_t* ids;
  ptrdiff_t id_stride;
};

// Rows that interpolate() writes. LOD needs the texture's size; null `lod` where there is no texture.
struct InterpolateTarget {
  int rendering;     // 0, 1 or 2: which RasterTriangle::attributes
  int n_attributes;  // attribute j goes to rows + j * kBatchLanes
  float* rows;
  float* lod;           // log2 of the larger of the lengths in level-0 texels of d(uv)/dx and d(uv)/dy, plus lod_bias
  int uv;               // number of the attribute u; v follows
  float width, height;  // of level 0
  float lod_bias;
  bool inside = false;  // interpolate() alone: all samples of the masks are inside their triangles
};

// Rows that footprint() writes: how far one pixel reaches in a texture. A pixel's footprint is the parallelogram of the
// screen derivatives d(uv)/dx and d(uv)/dy; its longer side is the major axis.
struct FootprintTarget {
  int rendering;        // as in InterpolateTarget
  int uv;               // number of the attribute u; v follows
  float width, height;  // of level 0
  float lod_bias;       // added to the level of detail
  float scale;          // of the footprint: the distance in pixels of the places where a pixel is shaded
  float max_probes;     // whole number, >= 1
  float* lod;           // log2 of (length of the major axis in texels of level 0 / probes), plus lod_bias
  // Null, or: the major axis in units of u and v times `scale` (magnitudes up to 2^20), and the number of probes along
  // it, a whole number: the ratio of the axes' lengths rounded up, at most max_probes and at most one a texel.
  float *axis_u, *axis_v, *probes;
};

// A mip chain. Texels are 4 bytes RGBA. Each row of a level is followed by a copy of its first texel, so that two
// horizontal neighbours are one 8-byte load.
struct TextureSampler {
  const uint8_t* texels;
  int32_t level_count;                                  // 1..kMaxMipLevels
  int32_t filter;                                       // 0 nearest, 1 bilinear (both: nearest level), 2 trilinear
  int32_t clamp;                                        // 0: repeat
  int32_t offset[kMaxMipLevels];                        // first texel of the level
  int32_t width[kMaxMipLevels], height[kMaxMipLevels];  // of level i: max(1, that of level 0 >> i)
  int32_t pitch[kMaxMipLevels];                         // width + 1
};

// What one sample of each pixel sees: ids in rows kTileSize apart, and where the sample of pixel (0, 0) is.
struct SampleIds {
  const uint32_t* ids;
  SamplePosition origin;
};

// What add_textured() and paint_textured() shade by one RasterTriangle::state: attributes 0..2 are the color and, where
// there is a texture to multiply it, 3 and 4 its coordinates.
struct PaintedSurface {
  const TextureSampler* texture;  // or null
  float lod_bias;
};

// Colors in units where 255 is full intensity; everything finite, magnitudes below 2^20.
struct KernelLight {
  float vector[3];      // directional: unit vector towards the light; point: its position
  float diffuse[3];     // light color * material's diffuse * 255
  float specular[3];    // light color * material's specular * 255
  float inverse_range;  // point: intensity 1 / (1 + (distance * inverse_range)^2)
  float axis[3];        // spot: unit vector along the beam
  // Spot: intensity scales by (axis . direction of travel) * cone_scale + cone_offset, clamped to [0, 1]. Other points:
  // 0 and 1.
  float cone_scale, cone_offset;
  float radius;        // of the ball that the light is, for shadows; directional: tangent of its angular radius
  int32_t is_point;    // point or spot
  int32_t has_shadow;  // for shadows: 0 = nothing occludes it
};
struct LightingParameters {
  float eye[3];
  float emission[3];
  float ambient[3];
  int32_t shininess;     // 0..65535
  int32_t has_specular;  // 0: specular rows are not written
  int32_t light_count;
  KernelLight lights[kMaxKernelLights];
};

// Fog between the eye and a point at distance d: the share exp2(-(d * rate)^power) of its light arrives, or where
// power = 0 the share (end - d) * rate, clamped to [0, 1]; the rest is the fog's color (255 = full).
struct FogParameters {
  float eye[3];
  float color[3];
  float end, rate;
  int32_t power;  // 0 linear, 1, 2
};

// Depths of what a light sees first, row-major, `side` texels square. A world position p and its unit normal n are
// looked up at q = p + normal_offset * n, column x = (m[0] . (q, 1)) / w, row y = (m[1] . (q, 1)) / w, depth
// z = (m[2] . (q, 1)) / w where w = m[3] . (q, 1); texel (i, j) has its center at (i + 0.5, j + 0.5).
struct ShadowMap {
  const float* depths;
  int32_t side;  // 1..16384
  float m[4][4];
  float normal_offset, depth_bias;
};

// Triangles in a bounding volume hierarchy, for rays. The left child of an inner node follows it, the right one is at
// `first`. A path from the root has at most kMaxRayDepth nodes.
constexpr int kMaxRayDepth = 128;
struct RayTriangle {
  float corner[3], edge1[3], edge2[3];  // counter-clockwise from its front
};
struct RayNode {
  float low[3], high[3];
  uint32_t first;
  uint16_t count;  // leaf: how many triangles from `first`; 0: inner node
  uint16_t axis;   // inner: the left child is the lower one along it
};
struct RayTree {
  const RayNode* nodes;  // null: nothing to hit
  const RayTriangle* triangles;
  float back_limit;  // backs of triangles nearer than this do not occlude: see occluded()
};

// One table of operations. See tile_scalar.cpp for the definition of each on the last bit.
struct TileKernels {
  // Depth-tests and writes the samples of the tile inside `triangle`: where z < depth: depth = z, ids = id.
  // depth, ids: kTileSize * kTileSize.
  void (*rasterize)(const RasterTriangle& triangle, uint32_t id, SamplePosition origin, float* depth, uint32_t* ids);

  // The same for triangles[i] and id i + 1, in order, over depth 1 and id 0: what depth and ids held does not count.
  // ids: null where depth is all that is wanted.
  void (*rasterize_all)(const RasterTriangle* const* triangles, uint32_t n, SamplePosition origin, float* depth,
                        uint32_t* ids);

  // What all samples of the grid see of triangles[i], as id i + 1, in order, before the background: rasterize() for
  // each. Fills the grid's arrays; origin: 256 * tile origin.
  void (*rasterize_grid)(const RasterTriangle* const* triangles, uint32_t n, SamplePosition origin,
                         const SampleGrid& grid);

  // Depth and RasterTriangle::id of the tile's first width x height pixels at sample 0 of the grid, as rasterize()
  // finds them there; 1 and 0 where nothing is. Groups of eight are read whole.
  void (*first_sample)(const SampleGrid& grid, int width, int height, const RasterTriangle* const* triangles,
                       SamplePosition origin, const FirstSampleTarget& target);

  // As collect_packs() for rows [first_row, last_row) of the tile: one pack for each triangle that the samples in the
  // set `samples` (bit s = sample s) see in each group of eight pixels, with the number of such samples as weights.
  // Room for 4 * kGridSamples * 8 packs a row.
  int (*collect_grid)(const SampleGrid& grid, uint32_t samples, int first_row, int last_row, int width,
                      const RasterTriangle* const* triangles, LanePack* packs);

  // RGB of width x height pixels, rows `stride` bytes apart: the mean over the grid's samples, rounded, of attributes
  // 0..2 as final colors at `origin` (of pixel (0, 0)), each rounded, of the triangle that they show. By planes in
  // planar triangles that a pixel shows at all samples, so that the place is inside. Groups of eight are read whole.
  // Records of attributes as for interpolate_lanes().
  void (*paint_grid)(const SampleGrid& grid, int width, int height, const RasterTriangle* const* triangles,
                     int rendering, SamplePosition origin, const uint8_t background[3], uint8_t* rgb, ptrdiff_t stride);

  // One pack for each triangle seen in each group of eight of the tile's first width x height pixels, in order. ids: 0
  // = none, else 1 + index into `triangles`; groups of eight are read whole. Room for kTileSize^2 packs; returns how
  // many.
  int (*collect_packs)(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles,
                       LanePack* packs);

  // The same, but one pack for all triangles of the same `state[rendering]` in a group, `triangle` the one in its
  // lowest lane; by squares of 8 x 8 pixels, row after row in each. rendering < 0: all states are the same.
  int (*collect_groups)(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles,
                        int rendering, LanePack* packs);

  // Perspective-correct attributes (and LOD) of 8 * n lanes. Lanes outside a pack's mask get finite values too. Where
  // target.inside says so, by planes in planar triangles.
  void (*interpolate)(const LanePack* packs, int n, SamplePosition origin, const InterpolateTarget& target);

  // The same for n lanes of any triangles, rounded up to 8: each gets the bits that its pack would give it. The records
  // of attributes must be readable for one float beyond their ends.
  void (*interpolate_lanes)(const LaneSample* samples, int n, SamplePosition origin, const InterpolateTarget& target);

  // The same for packs of collect_groups() from ids of samples that are inside their triangles: each lane of a mask
  // gets the bits that the pack of its own triangle would give it with target.inside, the others those of the triangle
  // in the lowest lane. Records of attributes as for interpolate_lanes().
  void (*interpolate_groups)(const LanePack* packs, int n, const uint32_t* ids, const RasterTriangle* const* triangles,
                             SamplePosition origin, const InterpolateTarget& target);

  // Blinn-Phong lighting of n lanes (rounded up to 8): color rows[0..2] (255 = full) become
  // emission + color/255 * (ambient + sum diffuse N.L); specular rows get sum specular (N.H)^shininess.
  // normal: 3 rows, any length (zero or not finite: towards the eye); position: 3 rows. visibility: null, or a row of
  // factors for `ambient` and then one for each light.
  void (*light)(const LightingParameters& parameters, int n, const float* normal, const float* position,
                const float* visibility, float* color, float* specular);

  // Which of eight rays hit a triangle at a distance in (0, limit): bits of `mask`. origin, direction: 3 rows,
  // direction of unit length; limit: one row. The front of a triangle always counts, its back only from
  // tree.back_limit on: a ray that starts on a facet which turns away from the light, while the interpolated normal
  // does not yet, leaves the solid close by through its back, and must not be shadowed by that.
  uint32_t (*occluded)(const RayTree& tree, const float* origin, const float* direction, const float* limit,
                       uint32_t mask);

  // Filtered texels of n lanes (rounded up to 8), u and v finite: rows of red, green and blue in [0, 255].
  void (*sample_texture)(const TextureSampler& texture, int n, const float* u, const float* v, const float* lod,
                         float* texels);

  // How far each lane of 8 * n lanes reaches in a texture.
  void (*footprint)(const LanePack* packs, int n, SamplePosition origin, const FootprintTarget& target);

  // Mean of `probes` texels (as sample_texture's) at even steps along the axis, centered on (u, v); probes: 1..16.
  void (*sample_anisotropic)(const TextureSampler& texture, int n, const float* u, const float* v, const float* lod,
                             const float* axis_u, const float* axis_v, const float* probes, float* texels);

  // The filtered fourth channel, in [0, 255].
  void (*sample_alpha)(const TextureSampler& texture, int n, const float* u, const float* v, const float* lod,
                       float* alpha);

  // Normals of n lanes (rounded up to 8) bent by texels of a normal map, (channel - 128) / 127 each: the sum of
  // scale * red * t, scale * green * b and blue * n, where n is the unit normal, t and b the parts of tangent (3 rows)
  // and bitangent (the next 3) orthogonal to n, of unit length. Where the normal, t or b has no direction: unchanged.
  void (*bend_normals)(int n, float scale, const float* texels, const float* tangents, float* normal);

  // Where the view reflected at `normal` (3 rows, any length) meets an environment with y up, stored by longitude and
  // latitude: u = 0.5 + azimuth / (2 pi), 0 at -z and growing towards +x; v = angle from +y / pi. Both in [0, 1].
  void (*reflect)(const float eye[3], int n, const float* normal, const float* position, float* u, float* v);

  // color becomes color * texel / 255 + specular, clamped to 0..255, seen through fog. texels, specular: or null.
  void (*fog)(const FogParameters& parameters, int n, const float* position, const float* texels, const float* specular,
              float* color);

  // Percentage-closer filtering: the share in [0, 1] of the map's texels around each of n lanes that are not nearer to
  // the light, 4x4 of them with the weights of a 3x3 box moved by fractions of a texel. 1 outside the map.
  void (*shadow_map)(const ShadowMap& map, int n, const float* normal, const float* position, float* share);

  // Lays color * texel / 255 + specular (clamped to 0..255) times alpha in [0, 1] (a row, clamped) over the colors in
  // the masks, of which `colors` holds 3 planes of kTileSize^2 in 0..255; rounded. texels, specular: 3 rows or null.
  void (*blend)(const LanePack* packs, int n, const float* color, const float* texels, const float* specular,
                const float* alpha, uint16_t* colors);

  // Rounds color * texel / 255 + specular to 0..255 and adds it minus `background`, as often as the lane's weight says
  // where `weighted`, to the accumulators of the pixels in the masks. texels, specular: 3 rows or null. sums: 3 planes
  // of kTileSize^2; modulo 2^16.
  void (*accumulate)(const LanePack* packs, int n, bool weighted, const float* color, const float* texels,
                     const float* specular, const uint8_t background[3], uint16_t* sums);

  // The same for n lanes of any triangles.
  void (*accumulate_lanes)(const LaneSample* samples, int n, bool weighted, const float* color, const float* texels,
                           const float* specular, const uint8_t background[3], uint16_t* sums);

  // collect_packs(), interpolate() inside of attributes 0..2 and accumulate() of them as final colors, in one, for each
  // of the samples: the colors of all that is in their ids, which is inside its triangles, are added to the sums.
  // Groups of eight are read whole. Records of attributes as for interpolate_lanes().
  void (*add_colors)(const SampleIds* samples, int n_samples, int width, int height,
                     const RasterTriangle* const* triangles, int rendering, const uint8_t background[3],
                     uint16_t* sums);

  // The same for pictures of one sample a pixel: width x height pixels of RGB bytes, rows `stride` bytes apart.
  void (*paint_colors)(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles,
                       int rendering, SamplePosition origin, const uint8_t background[3], uint8_t* rgb,
                       ptrdiff_t stride);

  // The same two with textures: `surfaces` of the triangles' states in the rendering. What collect_groups(),
  // interpolate_groups(), sample_texture() and accumulate() do, in one.
  void (*add_textured)(const SampleIds* samples, int n_samples, int width, int height,
                       const RasterTriangle* const* triangles, int rendering, const PaintedSurface* surfaces,
                       const uint8_t background[3], uint16_t* sums);
  void (*paint_textured)(const uint32_t* ids, int width, int height, const RasterTriangle* const* triangles,
                         int rendering, SamplePosition origin, const PaintedSurface* surfaces,
                         const uint8_t background[3], uint8_t* rgb, ptrdiff_t stride);

  // add_textured() of all samples of a grid of kGridSamples; origin: 256 * tile origin. Squares of 2 x 2 pixels are
  // read and added to whole.
  void (*add_textured_grid)(const SampleGrid& grid, int width, int height, const RasterTriangle* const* triangles,
                            int rendering, SamplePosition origin, const PaintedSurface* surfaces,
                            const uint8_t background[3], uint16_t* sums);

  // RGB bytes of `width` (<= kTileSize) pixels: (sums >> shift), the three planes kTileSize^2 apart.
  void (*resolve_row)(const uint16_t* sums, int shift, int width, uint8_t* rgb);
};

// One per instruction set: overwrites the entries that it improves.
void fill_tile_scalar(TileKernels& table);
void fill_grid_scalar(TileKernels& table);
void fill_shade_scalar(TileKernels& table);    // shade_scalar.cpp: lights, shadows, normals, fog
void fill_texture_scalar(TileKernels& table);  // texture_scalar.cpp
void fill_paint_scalar(TileKernels& table);    // paint_scalar.cpp: textured colors in one
void fill_tile_sse41(TileKernels& table);
void fill_tile_avx2(TileKernels& table);
void fill_tile_neon(TileKernels& table);

}  // namespace pac
