// Table, chairs, armchair, bookshelf, cabinet, floor lamp.
#include <algorithm>

#include "sim/scene_room.h"
#include "sim/textures_noise.h"

namespace pac::sim {

namespace {
using B = SceneBuilder;
const glm::vec2 kCloth(0.5f, 0.5f);  // metres a repeat of the woven textures
constexpr unsigned kSides = B::kLeft | B::kRight | B::kFront | B::kBack;
}  // namespace

void add_table(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kX = 0.62f, kZ = 0.42f, kTop = 0.75f;
  builder.box({-kX, kTop - 0.035f, -kZ}, {kX, kTop, kZ}, m.walnut, B::kAll & ~B::kTop, {2, 1, 1});
  builder.patch({-kX, kTop, kZ}, {2 * kX, 0, 0}, {0, 0, -2 * kZ}, 6, 4, m.walnut, {0, 0, 1.1f, 1.6f, true});
  // The apron runs between the legs.
  builder.box({-kX + 0.07f, kTop - 0.12f, -kZ + 0.12f}, {kX - 0.07f, kTop - 0.035f, kZ - 0.12f}, m.walnut,
              B::kLeft | B::kRight);
  builder.box({-kX + 0.12f, kTop - 0.12f, -kZ + 0.07f}, {kX - 0.12f, kTop - 0.035f, kZ - 0.07f}, m.walnut,
              B::kFront | B::kBack);
  for (const float x : {-kX + 0.06f, kX - 0.12f})
    for (const float z : {-kZ + 0.06f, kZ - 0.12f})
      builder.box({x, 0, z}, {x + 0.06f, kTop - 0.035f, z + 0.06f}, m.walnut, kSides);
}

void add_chair(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kHalf = 0.21f, kSeat = 0.45f, kBack = 0.95f, kPost = 0.04f;
  builder.box({-kHalf, kSeat - 0.05f, -kHalf}, {kHalf, kSeat, kHalf}, m.oak, B::kAll & ~B::kTop);
  builder.patch({-kHalf, kSeat, kHalf}, {2 * kHalf, 0, 0}, {0, 0, -2 * kHalf}, 2, 2, m.tartan, {0, 0, 0.5f, 0.5f});
  for (const float x : {-kHalf, kHalf - kPost}) {
    builder.box({x, 0, kHalf - kPost}, {x + kPost, kSeat - 0.05f, kHalf}, m.oak, kSides);
    builder.box({x, 0, -kHalf}, {x + kPost, kBack, -kHalf + kPost}, m.oak, kSides | B::kTop);
  }
  for (const float y : {0.58f, 0.72f, 0.86f})
    builder.box({-kHalf + kPost, y, -kHalf + 0.01f}, {kHalf - kPost, y + 0.07f, -kHalf + 0.03f}, m.oak,
                B::kFront | B::kBack | B::kTop);
}

void add_armchair(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kX = 0.43f, kArm = 0.17f, kDeep = 0.42f, kSeat = 0.43f, kArmTop = 0.60f, kBackTop = 0.98f;
  // Base and seat cushion.
  builder.box({-kX, 0.06f, -kDeep}, {kX, 0.26f, kDeep - 0.04f}, m.fabric, kSides, {2, 1, 2}, kCloth);
  builder.box({-kX + kArm, 0.26f, -kDeep + 0.2f}, {kX - kArm, kSeat - 0.03f, kDeep - 0.04f}, m.fabric, B::kFront,
              {2, 1, 1}, kCloth);
  builder.patch({-kX + kArm, kSeat - 0.03f, kDeep - 0.04f}, {2 * (kX - kArm), 0, 0}, {0, 0.03f, -0.06f}, 2, 1, m.fabric,
                {0, 0, 1, 0.15f});
  builder.patch({-kX + kArm, kSeat, kDeep - 0.10f}, {2 * (kX - kArm), 0, 0}, {0, 0.0f, -0.50f}, 2, 2, m.fabric,
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
  for (const float side : {1.0f, -1.0f}) {
    const float x = side * (kX - 0.02f);
    std::vector<glm::vec3> outline = {{x, 0.2f, inner},        {x, 0.2f, rear},
                                      {x, high + 0.06f, rear}, {x, high + 0.06f, front - 0.05f},
                                      {x, high, front},        {x, kSeat - 0.04f, inner}};
    if (side < 0.0f) std::reverse(outline.begin(), outline.end());
    std::vector<glm::vec2> texture;
    for (const glm::vec3& p : outline) texture.push_back({p.z * 2.0f, -p.y * 2.0f});
    builder.polygon(outline, texture, m.fabric);
  }
  // A cushion leans in the corner.
  builder.patch({-0.20f, kSeat, inner + 0.14f}, {0.40f, 0, 0}, {0, 0.34f, -0.14f}, 2, 2, m.cushion);
  builder.patch({-0.20f, kSeat + 0.34f, inner}, {0.40f, 0, 0}, {0, 0.02f, -0.08f}, 1, 1, m.cushion);
}

namespace {

// A run of books of one height, side by side.
struct BookRun {
  int n_books;
  float x, width, height;
};

constexpr int kRuns = 9;  // a shelf
constexpr float kBookDepth = 0.22f;

// One shelf's books between x0 and x1 with one gap among them: always the same number of polygons. The taller of two
// neighbours shows its side; tops only where they can be seen.
void add_books(SceneBuilder& builder, const RoomMaterials& m, float x0, float x1, float floor, bool tops,
               Random& random) {
  BookRun runs[kRuns];
  int n_books = 0;
  for (BookRun& run : runs) {
    run.n_books = 3 + random.below(4);
    run.height = random.range(0.22f, 0.34f);
    n_books += run.n_books;
  }
  const int gap_after = 1 + random.below(kRuns - 2);
  const float gap = random.range(0.05f, 0.13f);
  const float spine = (x1 - x0 - gap) / static_cast<float>(n_books);
  float x = x0;
  for (int k = 0; k < kRuns; ++k) {
    runs[k].x = x;
    runs[k].width = spine * static_cast<float>(runs[k].n_books);
    x += runs[k].width + (k == gap_after ? gap : 0.0f);
  }
  for (int k = 0; k < kRuns; ++k) {
    const BookRun& run = runs[k];
    const float slot = static_cast<float>(random.below(16 - run.n_books)) / 16.0f;
    const glm::vec3 width(run.width, 0, 0), up(0, run.height, 0), back(0, 0, -kBookDepth);
    const glm::vec3 corner(run.x, floor, 0.02f + kBookDepth);
    builder.patch(corner, width, up, 1, 1, m.books, {slot, 0, static_cast<float>(run.n_books) / 16.0f, 1});
    if (tops) builder.patch(corner + up, width, back, 1, 1, m.paper);
    const TextureWindow cover{slot + 0.45f / 16.0f, 0.3f, 0.1f / 16.0f, 0.02f};
    const bool left = k > 0 && (k - 1 == gap_after || run.height > runs[k - 1].height);
    const bool right = k + 1 < kRuns && (k == gap_after || run.height >= runs[k + 1].height);
    if (left) builder.patch(corner + back, -back, up, 1, 1, m.books, cover);
    if (right) builder.patch(corner + width, back, up, 1, 1, m.books, cover);
  }
}

}  // namespace

void add_bookshelf(SceneBuilder& builder, const RoomMaterials& m, uint32_t seed) {
  constexpr float kWide = 1.60f, kHigh = 2.16f, kDeep = 0.30f, kBoard = 0.03f, kPitch = 0.416f;
  constexpr int kShelves = 5;
  for (const float x : {0.0f, kWide - kBoard})
    builder.box({x, 0, 0}, {x + kBoard, kHigh, kDeep}, m.walnut, B::kLeft | B::kRight | B::kFront, {1, 2, 1});
  builder.box({-0.03f, kHigh, 0}, {kWide + 0.03f, kHigh + 0.05f, kDeep + 0.03f}, m.walnut,
              B::kFront | B::kLeft | B::kBottom, {2, 1, 1});
  builder.patch({kBoard, 0, 0.01f}, {kWide - 2 * kBoard, 0, 0}, {0, kHigh, 0}, 1, kShelves, m.walnut,
                {0, 0, 6.4f, 2.1f});
  Random random(seed);
  for (int shelf = 0; shelf < kShelves; ++shelf) {
    const float floor = 0.08f + static_cast<float>(shelf) * kPitch;
    builder.box({kBoard, floor - kBoard, 0.01f}, {kWide - kBoard, floor, kDeep - 0.01f}, m.walnut,
                B::kTop | B::kFront | B::kBottom);
    constexpr int kBelowEyes = 3;
    add_books(builder, m, kBoard + 0.01f, kWide - kBoard - 0.01f, floor, shelf < kBelowEyes, random);
  }
}

void add_cabinet(SceneBuilder& builder, const RoomMaterials& m) {
  constexpr float kWide = 0.96f, kHigh = 0.78f, kDeep = 0.38f;
  builder.box({0, 0.08f, 0}, {kWide, kHigh - 0.03f, kDeep}, m.walnut, B::kLeft | B::kRight, {1, 2, 1});
  for (const float x : {0.0f, 0.5f * kWide}) {
    builder.patch({x, 0.08f, kDeep}, {0.5f * kWide, 0, 0}, {0, kHigh - 0.11f, 0}, 1, 2, m.walnut, {x, 0, 0.9f, 1.0f});
    builder.box({x + 0.06f, 0.14f, kDeep}, {x + 0.42f, kHigh - 0.09f, kDeep + 0.012f}, m.oak, B::kAll & ~B::kBack,
                {1, 1, 1});
  }
  builder.box({-0.02f, kHigh - 0.03f, 0}, {kWide + 0.02f, kHigh, kDeep + 0.02f}, m.walnut,
              B::kAll & ~B::kBack & ~B::kBottom, {3, 1, 1});
}

void add_lamp(SceneBuilder& builder, const RoomMaterials& m) {
  builder.revolve({0, 0, 0}, {{0.15f, 0.0f}, {0.15f, 0.02f}, {0.03f, 0.05f}}, 8, m.brass);
  builder.box({-0.012f, 0.04f, -0.012f}, {0.012f, 1.42f, 0.012f}, m.brass, kSides);
  builder.revolve({0, 0, 0}, {{0.24f, 1.34f}, {0.14f, 1.64f}}, 10, m.shade, false, 4.0f);
  builder.revolve({0, 0, 0}, {{0.235f, 1.341f}, {0.135f, 1.639f}}, 10, m.bulb, true);
}

}  // namespace pac::sim
