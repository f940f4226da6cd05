// Vase, fruit, books, paintings.
#include "sim/scene_room.h"

namespace pac::sim {

void add_vase(SceneBuilder& builder, const RoomMaterials& m, glm::vec3 foot) {
  builder.revolve(foot,
                  {{0.05f, 0.0f}, {0.105f, 0.08f}, {0.115f, 0.16f}, {0.06f, 0.25f}, {0.045f, 0.29f}, {0.07f, 0.34f}},
                  10, m.porcelain, false, 2.0f);
}

void add_fruit(SceneBuilder& builder, glm::vec3 center, float radius, uint32_t material) {
  std::vector<glm::vec2> profile;
  for (const glm::vec2 p : {glm::vec2(0.0f, -0.95f), glm::vec2(0.80f, -0.55f), glm::vec2(0.98f, 0.20f),
                            glm::vec2(0.55f, 0.82f), glm::vec2(0.0f, 0.86f)})
    profile.push_back(p * radius);
  builder.revolve(center, profile, 7, material);
}

void add_book(SceneBuilder& builder, const RoomMaterials& m, glm::vec3 low, glm::vec3 high) {
  using B = SceneBuilder;
  const glm::vec3 cover(0, 0.006f, 0);
  builder.box({low.x, low.y, low.z}, high - cover, m.paper, B::kRight | B::kFront | B::kBack | B::kLeft);
  builder.patch({low.x - 0.005f, high.y, high.z + 0.005f}, {high.x - low.x + 0.01f, 0, 0},
                {0, 0, low.z - high.z - 0.01f}, 1, 1, m.books, {0.13f, 0.62f, 0.04f, 0.1f});
}

void add_painting(SceneBuilder& builder, const RoomMaterials& m, uint32_t canvas, glm::vec3 center, glm::vec3 right,
                  glm::vec3 out, float width, float height) {
  const glm::vec3 up(0, 1, 0);
  constexpr float kBorder = 0.07f, kDepth = 0.05f, kRecess = 0.02f;
  const auto at = [&](float x, float y, float z) { return center + right * x + up * y + out * z; };
  const float w = 0.5f * width, h = 0.5f * height, ow = w + kBorder, oh = h + kBorder;
  builder.patch(at(-w, -h, kRecess), right * width, up * height, 1, 1, canvas);
  // A molding that slopes from its outer edge down to the canvas, and its sides.
  const glm::vec2 inner[4] = {{-w, -h}, {w, -h}, {w, h}, {-w, h}},
                  outer[4] = {{-ow, -oh}, {ow, -oh}, {ow, oh}, {-ow, oh}};
  for (int k = 0; k < 4; ++k) {
    const int n = (k + 1) % 4;
    builder.polygon({at(outer[k].x, outer[k].y, kDepth), at(outer[n].x, outer[n].y, kDepth),
                     at(inner[n].x, inner[n].y, kRecess), at(inner[k].x, inner[k].y, kRecess)},
                    {{0, 1}, {1, 1}, {1, 0}, {0, 0}}, m.frame);
    builder.polygon({at(outer[k].x, outer[k].y, 0), at(outer[n].x, outer[n].y, 0), at(outer[n].x, outer[n].y, kDepth),
                     at(outer[k].x, outer[k].y, kDepth)},
                    {{0, 1}, {1, 1}, {1, 0}, {0, 0}}, m.frame);
  }
}

}  // namespace pac::sim
