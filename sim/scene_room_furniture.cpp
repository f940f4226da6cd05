// Table, chairs, armchair, bookshelf, cabinet, floor lamp.
#include "sim/scene_room.h"
#include "sim/textures_noise.h"

namespace pac::sim {

namespace {
using B = SceneBuilder;
constexpr unsigned kSides = B::kLeft | B::kRight | B::kFront | B::kBack;
}  // namespace

void add_table(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kX = 0.62f, kZ = 0.42f, kTop = 0.75f;
  builder.box({-kX, kTop - 0.035f, -kZ}, {kX, kTop, kZ}, m.walnut, B::kAll & ~B::kTop, {2, 1, 1}, 0.8f);
  builder.patch({-kX, kTop, kZ}, {2 * kX, 0, 0}, {0, 0, -2 * kZ}, 6, 4, m.walnut, {0, 0, 1.1f, 1.6f, true});
  builder.box({-kX + 0.07f, kTop - 0.12f, -kZ + 0.07f}, {kX - 0.07f, kTop - 0.035f, kZ - 0.07f}, m.walnut, kSides);
  for (const float x : {-kX + 0.06f, kX - 0.12f})
    for (const float z : {-kZ + 0.06f, kZ - 0.12f})
      builder.box({x, 0, z}, {x + 0.06f, kTop - 0.035f, z + 0.06f}, m.walnut, kSides, {1, 2, 1});
}

void add_chair(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kHalf = 0.21f, kSeat = 0.45f, kBack = 0.95f, kPost = 0.04f;
  builder.box({-kHalf, kSeat - 0.05f, -kHalf}, {kHalf, kSeat, kHalf}, m.oak, B::kAll & ~B::kTop);
  builder.patch({-kHalf, kSeat, kHalf}, {2 * kHalf, 0, 0}, {0, 0, -2 * kHalf}, 2, 2, m.tartan, {0, 0, 0.5f, 0.5f});
  for (const float x : {-kHalf, kHalf - kPost}) {
    builder.box({x, 0, kHalf - kPost}, {x + kPost, kSeat - 0.05f, kHalf}, m.oak, kSides);
    builder.box({x, 0, -kHalf}, {x + kPost, kBack, -kHalf + kPost}, m.oak, kSides | B::kTop, {1, 2, 1});
  }
  for (const float y : {0.58f, 0.72f, 0.86f})
    builder.box({-kHalf + kPost, y, -kHalf + 0.01f}, {kHalf - kPost, y + 0.07f, -kHalf + 0.03f}, m.oak,
                B::kFront | B::kBack | B::kTop);
}

void add_armchair(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kX = 0.43f, kArm = 0.17f, kDeep = 0.42f, kSeat = 0.43f, kArmTop = 0.60f, kBackTop = 0.98f;
  // Base and seat cushion.
  builder.box({-kX, 0.06f, -kDeep}, {kX, 0.26f, kDeep - 0.04f}, m.fabric, kSides, {2, 1, 2}, 0.5f);
  builder.box({-kX + kArm, 0.26f, -kDeep + 0.2f}, {kX - kArm, kSeat - 0.03f, kDeep}, m.fabric, B::kFront, {2, 1, 1},
              0.5f);
  builder.patch({-kX + kArm, kSeat - 0.03f, kDeep}, {2 * (kX - kArm), 0, 0}, {0, 0.03f, -0.06f}, 2, 1, m.fabric,
                {0, 0, 1, 0.15f});
  builder.patch({-kX + kArm, kSeat, kDeep - 0.06f}, {2 * (kX - kArm), 0, 0}, {0, 0.0f, -0.54f}, 2, 2, m.fabric,
                {0, 0, 1, 1});
  // Arms: rounded over, as an octagon's upper half.
  for (const float x : {-kX, kX - kArm}) {
    const glm::vec2 profile[] = {{x + kArm, 0.26f},           {x + kArm, kArmTop - 0.05f}, {x + 0.72f * kArm, kArmTop},
                                 {x + 0.28f * kArm, kArmTop}, {x, kArmTop - 0.05f},        {x, 0.26f}};
    std::vector<glm::vec3> end;
    std::vector<glm::vec2> end_texture;
    float along = 0.0f;
    for (int k = 0; k < 6; ++k) {
      end.push_back({profile[k].x, profile[k].y, kDeep - 0.04f});
      end_texture.push_back({profile[k].x * 2.0f, -profile[k].y * 2.0f});
      if (k == 5) break;
      const glm::vec2 step = profile[k + 1] - profile[k];
      const float length = glm::length(step) * 2.0f;
      builder.patch({profile[k].x, profile[k].y, kDeep - 0.04f}, {0, 0, -2 * kDeep + 0.04f}, {step.x, step.y, 0}, 2, 1,
                    m.fabric, {0, along, 1.6f, length});
      along += length;
    }
    builder.polygon(end, end_texture, m.fabric);
  }
  // The back leans; its top is rounded by one slanted strip.
  const float inner = -kDeep + 0.24f;
  builder.patch({-kX + 0.02f, kSeat - 0.04f, inner}, {2 * kX - 0.04f, 0, 0}, {0, kBackTop - kSeat - 0.03f, -0.09f}, 4,
                2, m.fabric, {0, 0, 1.6f, 1});
  const float high = kBackTop - 0.07f, front = inner - 0.09f;
  builder.patch({-kX + 0.02f, high, front}, {2 * kX - 0.04f, 0, 0}, {0, 0.06f, -0.05f}, 4, 1, m.fabric,
                {0, 0, 1.6f, 0.2f});
  builder.patch({-kX + 0.02f, high + 0.06f, front - 0.05f}, {2 * kX - 0.04f, 0, 0}, {0, 0, -0.08f}, 2, 1, m.fabric,
                {0, 0, 1.6f, 0.2f});
  const float rear = front - 0.13f;
  builder.patch({kX - 0.02f, 0.2f, rear}, {-2 * kX + 0.04f, 0, 0}, {0, high - 0.14f, 0}, 2, 2, m.fabric,
                {0, 0, 1.6f, 1.4f});
  builder.polygon({{kX - 0.02f, 0.2f, inner},
                   {kX - 0.02f, 0.2f, rear},
                   {kX - 0.02f, high + 0.06f, rear},
                   {kX - 0.02f, high + 0.06f, front - 0.05f},
                   {kX - 0.02f, high, front}},
                  {{0, 1}, {0.5f, 1}, {0.5f, 0}, {0.25f, 0}, {0.1f, 0.1f}}, m.fabric);
  builder.polygon({{-kX + 0.02f, 0.2f, rear},
                   {-kX + 0.02f, 0.2f, inner},
                   {-kX + 0.02f, high, front},
                   {-kX + 0.02f, high + 0.06f, front - 0.05f},
                   {-kX + 0.02f, high + 0.06f, rear}},
                  {{0.5f, 1}, {0, 1}, {0.1f, 0.1f}, {0.25f, 0}, {0.5f, 0}}, m.fabric);
  // A cushion leans in the corner.
  builder.patch({-0.20f, kSeat, inner + 0.14f}, {0.40f, 0, 0}, {0, 0.34f, -0.14f}, 2, 2, m.cushion);
  builder.patch({-0.20f, kSeat + 0.34f, inner}, {0.40f, 0, 0}, {0, 0.02f, -0.08f}, 1, 1, m.cushion);
}

void add_bookshelf(SceneBuilder& builder, const RoomMaterials& m, uint32_t seed) {
  constexpr float kWide = 1.60f, kHigh = 2.16f, kDeep = 0.30f, kBoard = 0.03f;
  constexpr int kShelves = 5;
  builder.box({0, 0, 0}, {kBoard, kHigh, kDeep}, m.walnut, B::kLeft | B::kRight | B::kFront, {1, 4, 1});
  builder.box({kWide - kBoard, 0, 0}, {kWide, kHigh, kDeep}, m.walnut, B::kLeft | B::kRight | B::kFront, {1, 4, 1});
  builder.box({-0.03f, kHigh, 0}, {kWide + 0.03f, kHigh + 0.05f, kDeep + 0.03f}, m.walnut,
              B::kTop | B::kFront | B::kLeft | B::kRight | B::kBottom, {2, 1, 1});
  builder.patch({kBoard, 0, 0.01f}, {kWide - 2 * kBoard, 0, 0}, {0, kHigh, 0}, 2, kShelves, m.walnut,
                {0, 0, 1.6f, 2.1f});
  Random random(seed);
  for (int shelf = 0; shelf < kShelves; ++shelf) {
    const float floor = 0.08f + static_cast<float>(shelf) * 0.416f;
    builder.box({kBoard, floor - kBoard, 0.01f}, {kWide - kBoard, floor, kDeep - 0.01f}, m.walnut,
                B::kTop | B::kFront | B::kBottom, {2, 1, 1});
    // Runs of one to four books of the same height; the texture's spines are 0.04 m wide.
    float x = kBoard + 0.01f;
    const float end = kWide - kBoard - 0.02f;
    bool tall_before = false;
    while (x < end - 0.05f) {
      const int n_books = 1 + random.below(4);
      const float height = random.range(0.22f, 0.34f), depth = random.range(0.19f, 0.25f);
      const float width = std::fmin(0.042f * static_cast<float>(n_books) + random.range(0.0f, 0.012f), end - x);
      const int slot = random.below(16 - n_books);
      const float gap = random.unit() < 0.12f ? random.range(0.04f, 0.14f) : 0.0f;
      const TextureWindow spine{static_cast<float>(slot) / 16.0f, 0, static_cast<float>(n_books) / 16.0f, 1};
      const float front = 0.02f + depth;
      builder.patch({x, floor, front}, {width, 0, 0}, {0, height, 0}, 1, 1, m.books, spine);
      builder.patch({x, floor + height, front}, {width, 0, 0}, {0, 0, -depth}, 1, 1, m.paper);
      const TextureWindow cover{(static_cast<float>(slot) + 0.45f) / 16.0f, 0.3f, 0.1f / 16.0f, 0.02f};
      if (!tall_before) builder.patch({x, floor, front - depth}, {0, 0, depth}, {0, height, 0}, 1, 1, m.books, cover);
      if (gap > 0.0f || n_books == 1)
        builder.patch({x + width, floor, front}, {0, 0, -depth}, {0, height, 0}, 1, 1, m.books, cover);
      tall_before = gap == 0.0f && n_books != 1;
      x += width + gap;
    }
  }
}

void add_cabinet(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kWide = 0.96f, kHigh = 0.78f, kDeep = 0.38f;
  builder.box({0, 0.08f, 0}, {kWide, kHigh - 0.03f, kDeep}, m.walnut, B::kLeft | B::kRight, {1, 2, 1});
  for (const float x : {0.0f, 0.5f * kWide}) {
    builder.patch({x, 0.08f, kDeep}, {0.5f * kWide, 0, 0}, {0, kHigh - 0.11f, 0}, 1, 2, m.walnut, {x, 0, 0.9f, 1.0f});
    builder.box({x + 0.06f, 0.14f, kDeep}, {x + 0.42f, kHigh - 0.09f, kDeep + 0.012f}, m.oak, B::kAll & ~B::kBack,
                {1, 1, 1}, 0.8f);
  }
  builder.box({-0.02f, kHigh - 0.03f, 0}, {kWide + 0.02f, kHigh, kDeep + 0.02f}, m.walnut,
              B::kAll & ~B::kBack & ~B::kBottom, {3, 1, 1});
}

void add_lamp(SceneBuilder& builder, const RoomMaterials& m) {
  builder.revolve({0, 0, 0}, {{0.15f, 0.0f}, {0.15f, 0.02f}, {0.03f, 0.05f}}, 8, m.brass);
  builder.box({-0.012f, 0.04f, -0.012f}, {0.012f, 1.42f, 0.012f}, m.brass, kSides);
  builder.revolve({0, 0, 0}, {{0.24f, 1.34f}, {0.14f, 1.64f}}, 12, m.shade, false, 4.0f);
  builder.revolve({0, 0, 0}, {{0.235f, 1.341f}, {0.135f, 1.639f}}, 12, m.bulb, true);
}

}  // namespace pac::sim
