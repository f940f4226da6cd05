// What the room is made of.
#include "sim/scene_room.h"
#include "sim/textures.h"
#include "sim/textures_noise.h"

namespace pac::sim {

RoomMaterials add_room_materials(SceneBuilder& builder, uint32_t seed) {
  using raster::Wrap;
  RoomMaterials m{};
  m.floor = builder.add_texture("oak planks", oak_planks(512, 512, seed + 1u));
  m.wall = builder.add_texture("plaster", plaster(256, 256, rgb8(236, 218, 182), seed + 2u));
  m.ceiling = builder.add_color("ceiling", rgb8(238, 232, 220));
  m.beam = builder.add_texture("old timber", wood_grain(128, 256, rgb8(134, 92, 58), rgb8(66, 42, 26), seed + 3u));
  m.trim = builder.add_color("white trim", rgb8(232, 226, 212));
  m.brick = builder.add_texture("brick", brick_wall(512, 512, seed + 4u));
  m.stone = builder.add_texture("flagstone", flagstones(256, 256, seed + 5u));
  m.soot = builder.add_color("soot", rgb8(58, 48, 44));
  m.ember = builder.add_color("embers", rgb8(255, 150, 60));
  m.glass = builder.add_texture("garden", garden_view(256, 256, seed + 6u), Wrap::clamp);
  m.curtain = builder.add_texture("curtain", striped_curtain(256, 256, seed + 7u));
  m.brass = builder.add_color("brass", rgb8(188, 148, 74));
  m.rug = builder.add_texture("persian rug", persian_rug(512, 344, seed + 8u), Wrap::clamp);
  m.walnut = builder.add_texture("walnut", wood_grain(256, 512, rgb8(158, 104, 62), rgb8(78, 46, 26), seed + 9u));
  m.oak = builder.add_texture("cherry", wood_grain(128, 256, rgb8(186, 116, 66), rgb8(116, 62, 32), seed + 10u));
  m.fabric = builder.add_texture("twill", woven_fabric(256, 256, rgb8(96, 132, 118), rgb8(62, 98, 92), seed + 11u));
  m.tartan = builder.add_texture("tartan", tartan(256, 256, seed + 12u));
  m.cushion =
      builder.add_texture("cushion", woven_fabric(128, 128, rgb8(206, 178, 120), rgb8(178, 136, 78), seed + 13u));
  m.books = builder.add_texture("books", book_spines(512, 256, 16, seed + 14u));
  m.paper = builder.add_color("paper", rgb8(222, 210, 180));
  m.landscape = builder.add_texture("landscape", painted_landscape(320, 240, seed + 15u), Wrap::clamp);
  m.seascape = builder.add_texture("seascape", painted_seascape(256, 192, seed + 16u), Wrap::clamp);
  m.still_life = builder.add_texture("still life", painted_still_life(256, 224, seed + 17u), Wrap::clamp);
  m.abstract = builder.add_texture("composition", painted_abstract(192, 256, seed + 18u), Wrap::clamp);
  m.frame = builder.add_color("gilt frame", rgb8(176, 132, 62));
  m.shade = builder.add_texture("parchment", parchment(128, 128, seed + 19u));
  m.bulb = builder.add_color("lamp's inside", rgb8(255, 236, 190));
  m.porcelain = builder.add_texture("porcelain", marble(128, 128, rgb8(214, 222, 232), rgb8(58, 86, 160), seed + 20u));
  m.apple = builder.add_color("apple", rgb8(186, 44, 32));
  m.orange = builder.add_color("orange", rgb8(232, 136, 36));

  // Radiosity that the emitters give off, in units in which a white sheet in the shade of the room is near 0.3.
  builder.set_emission(m.glass, glm::vec3(5.0f, 5.6f, 6.4f));
  builder.set_emission(m.shade, glm::vec3(3.4f, 2.3f, 1.15f));
  builder.set_emission(m.bulb, glm::vec3(26.0f, 18.0f, 9.0f));
  builder.set_emission(m.ember, glm::vec3(14.0f, 5.0f, 1.2f));
  builder.set_thin(m.curtain);
  return m;
}

}  // namespace pac::sim
