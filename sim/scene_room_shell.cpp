// Floor, walls, ceiling and beams, window, fireplace, rug and the sun's patch on the floor.
#include "sim/scene_room.h"

namespace pac::sim {

namespace {

constexpr float kW = kRoomWidth, kD = kRoomDepth, kH = kRoomHeight;
constexpr float kPlankRepeat = 0.84f, kPlankLength = 1.68f;  // metres a repeat of the floor's texture
constexpr float kWallRepeat = 1.5f;
const glm::vec2 kTimber(0.22f, 0.88f);  // metres a repeat of the timber's texture, across and along the grain

std::vector<float> scaled(std::vector<float> metres, float length) {
  for (float& line : metres) line /= length;
  return metres;
}

TextureWindow repeats(float width, float height, float size) {
  return {0.0f, 0.0f, width / size, height / size};
}

constexpr auto kNoHoles = [](int, int) { return false; };

// Floor, walls and ceiling reach this far past one another: their grids differ, and nothing shows between them.
constexpr float kOverlap = 0.01f;

std::vector<float> equal_metres(int n, float length) {
  std::vector<float> lines = equal_lines(n);
  for (float& line : lines) line *= length;
  return lines;
}

// A side of the room: from `origin` along unit vectors, cut at lines given in metres; the texture repeats every
// `repeat` metres, its rows counted from the last line of t.
template <class Skip>
void add_side(SceneBuilder& builder, glm::vec3 origin, glm::vec3 along_s, glm::vec3 along_t, std::vector<float> lines_s,
              std::vector<float> lines_t, uint32_t material, glm::vec2 repeat, Skip&& skip) {
  const float width = lines_s.back() + 2 * kOverlap, height = lines_t.back() + 2 * kOverlap;
  for (auto* lines : {&lines_s, &lines_t}) {
    const float length = lines == &lines_s ? width : height;
    for (float& line : *lines) line = (line + kOverlap) / length;
    lines->front() = 0.0f;
    lines->back() = 1.0f;
  }
  builder.grid(origin - (along_s + along_t) * kOverlap, along_s * width, along_t * height, lines_s, lines_t, material,
               {-kOverlap / repeat.x, -kOverlap / repeat.y, width / repeat.x, height / repeat.y}, skip);
}

}  // namespace

void add_shell(SceneBuilder& builder, const RoomMaterials& m) {
  builder.place(glm::vec3(0.0f));
  const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const glm::vec2 wall(kWallRepeat, kWallRepeat);
  const std::vector<float> floor_z = {0.0f, 1.2f, 2.0f, 2.5f, 2.95f, 3.4f, 3.85f, 4.3f, 4.75f, 5.2f, 5.6f, 6.0f, kD};
  add_side(builder, {0, 0, kD}, x, -z, equal_metres(13, kW), floor_z, m.floor, {kPlankRepeat, kPlankLength}, kNoHoles);
  add_side(builder, {0, kH, 0}, x, z, equal_metres(7, kW), equal_metres(6, kD), m.ceiling, wall, kNoHoles);
  // The window's lines are among the heights at which walls are cut.
  const std::vector<float> heights = {0.0f, 0.42f, kWindowSill, 1.32f, 1.78f, kWindowTop, kH};
  // Back wall, open behind the chimney.
  add_side(builder, {0, 0, 0}, x, y, {0, 0.4f, 0.8f, 1.2f, 1.6f, 3.2f, 3.6f, 4.05f, 4.5f, 4.95f, kW}, heights, m.wall,
           wall, [](int i, int) { return i == 4; });
  // Left wall (s runs from the camera's end to the back), open at the window.
  add_side(builder, {0, 0, kD}, -z, y, {0, 1.6f, 2.4f, 3.0f, kD - kWindowNear, 4.13f, 4.67f, kD - kWindowFar, 5.8f, kD},
           heights, m.wall, wall, [](int i, int j) { return i >= 4 && i <= 6 && j >= 2 && j <= 4; });
  add_side(builder, {kW, 0, 0}, z, y, equal_metres(5, kD), equal_metres(3, kH), m.wall, wall, kNoHoles);
  add_side(builder, {kW, 0, kD}, -x, y, equal_metres(2, kW), equal_metres(2, kH), m.wall, wall, kNoHoles);
  // Skirting boards and ceiling beams.
  using B = SceneBuilder;
  builder.box({0, 0, 0}, {0.02f, 0.11f, kD}, m.trim, B::kRight | B::kTop, {1, 1, 4});
  builder.box({kW - 0.02f, 0, 0}, {kW, 0.11f, kD}, m.trim, B::kLeft | B::kTop);
  builder.box({0, 0, 0}, {1.6f, 0.11f, 0.02f}, m.trim, B::kFront | B::kTop, {2, 1, 1});
  builder.box({3.2f, 0, 0}, {kW, 0.11f, 0.02f}, m.trim, B::kFront | B::kTop, {2, 1, 1});
  int beam_cuts = 4;
  for (const float beam : {0.75f, 2.25f, 3.75f, 5.25f}) {
    builder.box({0, kH - 0.2f, beam}, {kW, kH, beam + 0.17f}, m.beam, B::kFront | B::kBack | B::kBottom,
                {beam_cuts, 1, 1}, kTimber);
    if (beam > 2.0f) beam_cuts = 3;  // the farther from the still's view, the fewer
  }
}

void add_window(SceneBuilder& builder, const RoomMaterials& m) {
  using B = SceneBuilder;
  builder.place(glm::vec3(0.0f));
  constexpr float kDepth = 0.16f;  // of the reveal
  const float z0 = kWindowFar, z1 = kWindowNear, y0 = kWindowSill, y1 = kWindowTop;
  // The reveals stand kOverlap behind the opening's rim and reach past the glass.
  constexpr float e = kOverlap;
  const glm::vec3 deep(-kDepth - e, 0, 0), along(0, 0, z1 - z0 + 2 * e), up(0, y1 - y0 + 2 * e, 0);
  builder.patch({-kDepth, y0 - e, z1 + e}, -along, up, 2, 2, m.glass);
  builder.patch({0, y0 - e, z0 - e}, up, deep, 1, 1, m.trim);     // far reveal
  builder.patch({0, y0 - e, z1 + e}, deep, up, 1, 1, m.trim);     // near reveal
  builder.patch({0, y1 + e, z0 - e}, along, deep, 1, 1, m.trim);  // lintel
  builder.box({-kDepth, y0 - 0.04f, z0 - 0.06f}, {0.12f, y0, z1 + 0.06f}, m.trim,
              B::kTop | B::kRight | B::kBottom | B::kFront | B::kBack, {1, 1, 2});
  // Frame and glazing bars, a little in front of the glass.
  const float b0 = -kDepth, b1 = -kDepth + 0.05f, middle = 0.5f * (z0 + z1), bar = y0 + 0.66f * (y1 - y0);
  builder.box({b0, y0, z0}, {b1, y1, z0 + 0.06f}, m.trim, B::kRight | B::kFront);
  builder.box({b0, y0, z1 - 0.06f}, {b1, y1, z1}, m.trim, B::kRight | B::kBack);
  builder.box({b0, y0, z0 + 0.06f}, {b1, y0 + 0.06f, z1 - 0.06f}, m.trim, B::kRight | B::kTop);
  builder.box({b0, y1 - 0.06f, z0 + 0.06f}, {b1, y1, z1 - 0.06f}, m.trim, B::kRight | B::kBottom);
  builder.box({b0, y0 + 0.06f, middle - 0.03f}, {b1, y1 - 0.06f, middle + 0.03f}, m.trim,
              B::kRight | B::kFront | B::kBack);
  builder.box({b0, bar - 0.025f, z0 + 0.06f}, {b1, bar + 0.025f, z1 - 0.06f}, m.trim, B::kRight | B::kTop | B::kBottom);
  // Curtains in folds, drawn aside, and their rod.
  for (const bool near : {false, true}) {
    constexpr int kFolds = 12, kRows = 2;
    const float from = near ? z1 + 0.42f : z0 + 0.06f, width = 0.48f;
    std::vector<uint32_t> vertices;
    for (int r = 0; r <= kRows; ++r) {
      for (int f = 0; f <= kFolds; ++f) {
        const float s = static_cast<float>(f) / kFolds, t = static_cast<float>(r) / kRows;
        // Folds of varying depth; the normal of a zigzag is straight out at its ridges and turned in between.
        const int phase = f & 3;
        const float depth = phase == 1 ? 0.07f : (phase == 3 ? -0.05f : 0.0f);
        const float tilt = phase == 0 ? 0.75f : (phase == 2 ? -0.75f : 0.0f);
        const float flare = 0.8f + 0.2f * (1.0f - t);
        const glm::vec3 position(0.10f + depth * flare, 0.06f + t * (y1 + 0.20f - 0.06f), from - s * width * flare);
        const glm::vec3 normal = glm::normalize(glm::vec3(1.0f, 0.0f, tilt));
        vertices.push_back(builder.add_vertex(position, normal, {s * 0.75f, 1.5f * (1.0f - t)}));
      }
    }
    for (int r = 0; r < kRows; ++r) {
      for (int f = 0; f < kFolds; ++f) {
        const auto a = static_cast<size_t>(r * (kFolds + 1) + f);
        builder.add_face({vertices[a], vertices[a + 1], vertices[a + kFolds + 2], vertices[a + kFolds + 1]}, m.curtain);
      }
    }
  }
  builder.box({0.09f, y1 + 0.19f, z0 - 0.6f}, {0.12f, y1 + 0.22f, z1 + 0.6f}, m.brass,
              B::kRight | B::kTop | B::kBottom | B::kFront);
}

void add_fireplace(SceneBuilder& builder, const RoomMaterials& m) {
  using B = SceneBuilder;
  builder.place({1.6f, 0.0f, 0.0f});
  constexpr float kWide = 1.6f, kDeep = 0.46f, kOpenLow = 0.4f, kOpenHigh = 1.2f, kOpenTop = 0.82f, kBrick = 0.96f;
  // The chimney breast: front with an opening, two cheeks.
  const std::vector<float> xs = scaled({0, kOpenLow, 0.8f, kOpenHigh, kWide}, kWide);
  const std::vector<float> ys = scaled({0, 0.41f, kOpenTop, 1.28f, 1.7f, 2.2f, kH}, kH);
  builder.grid({0, 0, kDeep}, {kWide, 0, 0}, {0, kH, 0}, xs, ys, m.brick, repeats(kWide, kH, kBrick),
               [](int i, int j) { return (i == 1 || i == 2) && j < 2; });
  builder.grid({kWide, 0, kDeep}, {0, 0, -kDeep - kOverlap}, {0, kH, 0}, equal_lines(1), ys, m.brick,
               repeats(kDeep, kH, kBrick), kNoHoles);
  builder.grid({0, 0, -kOverlap}, {0, 0, kDeep + kOverlap}, {0, kH, 0}, equal_lines(1), equal_lines(2), m.brick,
               repeats(kDeep, kH, kBrick), kNoHoles);
  // The firebox, with its logs on the embers.
  const float w = kOpenHigh - kOpenLow, back = 0.08f, d = kDeep - back;
  builder.patch({kOpenLow, 0, back}, {w, 0, 0}, {0, kOpenTop, 0}, 2, 2, m.brick, repeats(w, kOpenTop, kBrick));
  builder.patch({kOpenLow, 0, kDeep}, {0, 0, -d}, {0, kOpenTop, 0}, 1, 2, m.brick, repeats(d, kOpenTop, kBrick));
  builder.patch({kOpenHigh, 0, back}, {0, 0, d}, {0, kOpenTop, 0}, 1, 2, m.brick, repeats(d, kOpenTop, kBrick));
  builder.patch({kOpenLow, kOpenTop, back}, {w, 0, 0}, {0, 0, d}, 1, 1, m.soot);
  builder.patch({kOpenLow, 0.062f, kDeep}, {w, 0, 0}, {0, 0, -d}, 1, 1, m.soot);
  builder.patch({0.55f, 0.085f, 0.38f}, {0.5f, 0, 0}, {0, 0.02f, -0.22f}, 1, 1, m.ember);
  builder.box({0.52f, 0.10f, 0.30f}, {1.10f, 0.19f, 0.39f}, m.beam, B::kAll & ~B::kBottom & ~B::kBack, {1, 1, 1},
              kTimber);
  builder.box({0.60f, 0.12f, 0.16f}, {1.06f, 0.21f, 0.25f}, m.beam, B::kAll & ~B::kBottom & ~B::kBack, {1, 1, 1},
              kTimber);
  // Hearth slab and mantelpiece with two brackets.
  builder.box({-0.2f, 0, 0.0f}, {kWide + 0.2f, 0.06f, 0.95f}, m.stone, B::kTop | B::kFront | B::kLeft | B::kRight,
              {3, 1, 1}, {0.9f, 0.9f});
  builder.box({-0.14f, 1.24f, 0.3f}, {kWide + 0.14f, 1.33f, 0.72f}, m.walnut, B::kAll & ~B::kBack, {3, 1, 1}, kTimber);
  for (const float x : {0.12f, kWide - 0.24f})
    builder.box({x, 1.04f, kDeep}, {x + 0.12f, 1.24f, 0.64f}, m.walnut, B::kFront | B::kLeft | B::kRight | B::kBottom);
}

namespace {

using Polygon = std::vector<glm::vec2>;  // (x, z) on the floor

// Keeps the part of a convex polygon where sign * (coordinate[axis] - limit) <= 0 (Sutherland and Hodgman).
Polygon clip(const Polygon& polygon, int axis, float limit, float sign) {
  Polygon kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const glm::vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const float da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
    if (da <= 0.0f) kept.push_back(a);
    if ((da < 0.0f && db > 0.0f) || (da > 0.0f && db < 0.0f)) kept.push_back(a + (b - a) * (da / (da - db)));
  }
  return kept;
}

struct RugPlace {
  float x0 = 1.75f, x1 = 4.05f, z0 = 2.35f, z1 = 3.9f, y = 0.012f;
};

// One pane's light on the plane at height y: the pane's corners moved along the sun's way.
Polygon sun_patch(float z_low, float z_high, float y_low, float y_high, float plane) {
  constexpr float kGlass = -0.11f;  // the frame's inner side is what cuts the light
  const auto land = [&](float z, float y) {
    const float run = (y - plane) / kSunDown;
    return glm::vec2(kGlass + run, z + kSunForward * run);
  };
  return {land(z_low, y_low), land(z_high, y_low), land(z_high, y_high), land(z_low, y_high)};
}

}  // namespace

size_t add_rug_and_sun(SceneBuilder& builder, const RoomMaterials& m) {
  builder.place(glm::vec3(0.0f));
  const RugPlace rug;
  const float w = rug.x1 - rug.x0, d = rug.z1 - rug.z0;
  builder.patch({rug.x0, rug.y, rug.z1}, {w, 0, 0}, {0, 0, -d}, 6, 5, m.rug);
  using B = SceneBuilder;
  builder.box({rug.x0, 0, rug.z0}, {rug.x1, rug.y, rug.z1}, m.cushion, B::kFront | B::kLeft | B::kRight);

  const size_t first = builder.face_count();
  const auto add = [&](const Polygon& outline, float y, bool on_rug) {
    if (outline.size() < 3) return;
    std::vector<glm::vec3> corners;
    std::vector<glm::vec2> texture;
    for (const glm::vec2& p : outline) {
      corners.push_back({p.x, y + 0.0015f, p.y});
      texture.push_back(on_rug ? glm::vec2((p.x - rug.x0) / w, (p.y - rug.z0) / d)
                               : glm::vec2(p.x / kPlankRepeat, p.y / kPlankLength));
    }
    builder.polygon(corners, texture, on_rug ? m.rug : m.floor);
  };
  const float middle = 0.5f * (kWindowFar + kWindowNear);
  const float bar = kWindowSill + 0.66f * (kWindowTop - kWindowSill);
  const float panes_z[2][2] = {{kWindowFar + 0.06f, middle - 0.03f}, {middle + 0.03f, kWindowNear - 0.06f}};
  const float panes_y[2][2] = {{kWindowSill + 0.06f, bar - 0.025f}, {bar + 0.025f, kWindowTop - 0.06f}};
  for (const auto& pz : panes_z) {
    for (const auto& py : panes_y) {
      const Polygon on_floor = sun_patch(pz[0], pz[1], py[0], py[1], 0.0f);
      add(clip(on_floor, 0, rug.x0, 1.0f), 0.0f, false);
      const Polygon beside = clip(clip(on_floor, 0, rug.x0, -1.0f), 0, rug.x1, 1.0f);
      add(clip(beside, 1, rug.z0, 1.0f), 0.0f, false);
      add(clip(beside, 1, rug.z1, -1.0f), 0.0f, false);
      add(clip(on_floor, 0, rug.x1, -1.0f), 0.0f, false);
      const Polygon raised = sun_patch(pz[0], pz[1], py[0], py[1], rug.y);
      add(clip(clip(clip(clip(raised, 0, rug.x0, -1.0f), 0, rug.x1, 1.0f), 1, rug.z0, -1.0f), 1, rug.z1, 1.0f), rug.y,
          true);
    }
  }
  return first;
}

}  // namespace pac::sim
