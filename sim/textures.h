// Procedural textures of the built-in scenes. Each is a function of its size and a seed; colors are sRGB-encoded, alpha
// 255. Those marked "tiles" repeat seamlessly in both directions.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "base/image.h"

namespace pac::sim {

// Surfaces (textures_surfaces.cpp).
RgbaImage oak_planks(int width, int height, uint32_t seed);  // tiles; 6 boards across, grain along v
RgbaImage wood_grain(int width, int height, glm::vec3 light, glm::vec3 dark,
                     uint32_t seed);                         // tiles; grain along v, one repeat 4 times as long as wide
RgbaImage brick_wall(int width, int height, uint32_t seed);  // tiles; 4 bricks by 12 courses
RgbaImage plaster(int width, int height, glm::vec3 color, uint32_t seed);                      // tiles
RgbaImage marble(int width, int height, glm::vec3 ground, glm::vec3 vein, uint32_t seed);      // tiles
RgbaImage flagstones(int width, int height, uint32_t seed);                                    // tiles; irregular slabs
RgbaImage woven_fabric(int width, int height, glm::vec3 warp, glm::vec3 weft, uint32_t seed);  // tiles
RgbaImage tartan(int width, int height, uint32_t seed);                                        // tiles
RgbaImage striped_curtain(int width, int height, uint32_t seed);                               // tiles
RgbaImage persian_rug(int width, int height, uint32_t seed);  // one whole rug, long side along u
RgbaImage parchment(int width, int height, uint32_t seed);    // tiles

// Pictures (textures_pictures.cpp).
RgbaImage painted_landscape(int width, int height, uint32_t seed);
RgbaImage painted_seascape(int width, int height, uint32_t seed);
RgbaImage painted_still_life(int width, int height, uint32_t seed);
RgbaImage painted_abstract(int width, int height, uint32_t seed);
RgbaImage garden_view(int width, int height, uint32_t seed);  // what the window shows
// `n_books` spines side by side, each width / n_books wide.
RgbaImage book_spines(int width, int height, int n_books, uint32_t seed);

}  // namespace pac::sim
