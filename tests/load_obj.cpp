#include "raster/load_obj.h"

#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "raster/load_text.h"
#include "tests/support/model_files.h"

namespace {

using pac::Error;
using pac::raster::LoadedScene;
using pac::raster::Material;
using pac::test::assets_from;
using pac::test::bytes_of;

pac::Result<LoadedScene> load(std::string_view text, std::map<std::string, std::string> files = {}) {
  return pac::raster::load_obj(bytes_of(text), assets_from(std::move(files)));
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

bool has_warning(const LoadedScene& loaded, const std::string& text) {
  for (const pac::raster::Warning& warning : loaded.warnings)
    if (text == warning.text) return true;
  return false;
}

TEST_CASE("numbers are read to the nearest float, whatever their form") {
  const char* words[] = {"0",
                         "-0",
                         "1",
                         "+1.5",
                         ".5",
                         "5.",
                         "1e10",
                         "1E-10",
                         "3.1e+2",
                         "0.1",
                         "123456789",
                         "1e-45",
                         "3.4e38",
                         "16777217",
                         "0.3333333333333333333333",
                         "2.5e-38",
                         "00012.5",
                         "1e-50",
                         "9007199254740993",
                         "0.000000000000000000000000000001"};
  for (const char* word : words) {
    CAPTURE(word);
    float value = 7;
    REQUIRE(pac::raster::parse_float(word, value) == pac::raster::NumberKind::finite);
    REQUIRE(value == std::strtof(word, nullptr));
  }
  float value = 7;
  REQUIRE(pac::raster::parse_float("3.1+e2", value) == pac::raster::NumberKind::finite);
  REQUIRE(value == std::strtof("3.1+e2", nullptr));  // 3.1: the number ends before the sign
  for (const char* word : {"nan", "-NaN", "inf", "Infinity", "1e39", "1.#IND", "-1.#INF00", "1e999999999999999999999"})
    REQUIRE(pac::raster::parse_float(word, value) == pac::raster::NumberKind::not_finite);
  for (const char* word : {"", "-", ".", "e5", "1e", "1e+", "1.5.2", "0x10", "1,5", "3.1+e", "--1", "1f"})
    REQUIRE(pac::raster::parse_float(word, value) == pac::raster::NumberKind::malformed);
}

TEST_CASE("each malformed OBJ gets its named error and the offset of its line") {
  struct Case {
    std::string text;
    Error error;
    const char* message;
    uint64_t byte_offset;
  };
  const std::string utf16("\xFE\xFF\0v\0 ", 6), utf16_no_mark("v\0 \0", 4);
  const Case cases[] = {
      {"", Error::unsupported, "no faces: points and lines alone are not drawn", 0},
      {"v 0 0 0\np 1\n", Error::unsupported, "no faces: points and lines alone are not drawn", 0},
      {utf16, Error::unsupported, "UTF-16 text: save the model as UTF-8", 0},
      {utf16_no_mark, Error::unsupported, "UTF-16 text: save the model as UTF-8", 0},
      {"v 0 0 0\nv 1 0\n", Error::corrupt, "vertex with fewer than three coordinates", 8},
      {"v 0 0 0\r\nv 1 0 nan\r\n", Error::corrupt, "number is not finite", 9},
      {"v 0 0 1e39\n", Error::corrupt, "number is not finite", 0},
      {"v 0 0 0,5\n", Error::corrupt, "malformed number", 0},
      {"vn 0 1\n", Error::corrupt, "normal with fewer than three numbers", 0},
      {"vt\n", Error::corrupt, "texture coordinate without a number", 0},
      {kTriangle + "f 1 2 4\n", Error::corrupt, "index out of range", 24},
      {kTriangle + "f 1 2 -4\n", Error::corrupt, "index out of range", 24},
      {kTriangle + "f 0 1 2\n", Error::corrupt, "index 0: indices start at 1", 24},
      {kTriangle + "f 1 2 x\n", Error::corrupt, "malformed index", 24},
      {kTriangle + "f 1 2 3/\n" + "f 1 2 3/1/1/1\n", Error::corrupt, "malformed index", 33},
      {kTriangle + "f 1 2 3//1\n", Error::corrupt, "index out of range", 24},
      {kTriangle + "f 1/1 2/1 3/1\n", Error::corrupt, "index out of range", 24},
      {kTriangle + "f 1 2 99999999999999999999\n", Error::corrupt, "index out of range", 24},
      {kTriangle + "f 1 2 4294967296\n", Error::corrupt, "index out of range", 24},
      {kTriangle + "f 1 2 -9223372036854775808\n", Error::corrupt, "index out of range", 24},
      {kTriangle + "g x \\\n y\nf 1 \\\n2 9\n", Error::corrupt, "index out of range", 33},
  };
  for (const Case& bad : cases) {
    CAPTURE(bad.text);
    const auto loaded = load(bad.text);
    REQUIRE(!loaded.ok());
    REQUIRE(loaded.failure().error == bad.error);
    REQUIRE(std::string(loaded.failure().text) == bad.message);
    REQUIRE(loaded.failure().byte_offset == bad.byte_offset);
  }
}

TEST_CASE("limits stop a model before it is built") {
  std::string text = kTriangle;
  for (int i = 0; i < 20; ++i) text += "f 1 2 3\n";
  pac::Limits limits;
  limits.max_triangles = 19;
  auto loaded = pac::raster::load_obj(bytes_of(text), {}, limits);
  REQUIRE(!loaded.ok());
  REQUIRE(loaded.failure().error == Error::limit_exceeded);
  REQUIRE(loaded.failure().byte_offset == 24 + 19 * 8);
  limits.max_triangles = 20;
  REQUIRE(pac::raster::load_obj(bytes_of(text), {}, limits).ok());
  limits.max_bytes = text.size() - 1;
  REQUIRE(pac::raster::load_obj(bytes_of(text), {}, limits).failure().error == Error::limit_exceeded);
}

TEST_CASE("line ends, tabs, marks, comments and continued lines change nothing") {
  const auto plain = load(kTriangle + "vt 0 0\nf 1/1 2/1 3/1\n");
  REQUIRE(plain.ok());
  const std::string variants[] = {
      "\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1",
      "v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvt 0 0\r\nf 1/1 2/1 3/1\r\n",
      "v 0 0 0\rv 1 0 0\rv 0 1 0\rvt 0 0\rf 1/1 2/1 3/1",
      "\tv\t0  0 0 # origin\n v 1 0 0  \nv 0 1 0\t\n#f 1 2 3\nvt 0 0 0\nf -3/1 -2/-1 -1/1   # face\n",
      "v 0 0 \\\n 0\nv 1 0 0\nv 0 \\\r\n1 \\\n0\nvt 0 0\nf 1/1 \\\n2/1 3/1\\",
      "f 1/1 2/1 3/1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n# a path\\\n",
  };
  for (const std::string& text : variants) {
    CAPTURE(text);
    const auto loaded = load(text);
    REQUIRE(loaded.ok());
    REQUIRE(loaded->scene.mesh.indices == plain->scene.mesh.indices);
    REQUIRE(loaded->scene.mesh.vertices.size() == 3);
    REQUIRE(std::memcmp(loaded->scene.mesh.vertices.data(), plain->scene.mesh.vertices.data(),
                        3 * sizeof(pac::Vertex)) == 0);
  }
}

TEST_CASE("polygons keep their corners, and what is skipped is counted in a warning") {
  const auto loaded =
      load("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 .5 0\nv 0 2 0\nf 1 2 3 4 5\nf 1 2\nl 1 2\nl 2 3\np 1\nfoo\n");
  REQUIRE(loaded.ok());
  REQUIRE(loaded->scene.mesh.faces.size() == 1);
  REQUIRE(loaded->scene.mesh.faces[0].count == 5);
  REQUIRE(has_warning(*loaded, "face with fewer than three corners"));
  REQUIRE(has_warning(*loaded, "statement is unknown"));
  bool lines = false;
  for (const auto& warning : loaded->warnings) lines = lines || warning.name == "l (2x)";
  REQUIRE(lines);
}

TEST_CASE("vertex colors, texture coordinates from the top, and given normals reach the mesh") {
  const auto loaded =
      load("v 0 0 0 1 0 0.5\nv 1 0 0 0 1 0 0.5\nv 0 1 0 0 0 1\nvt 0.25 1\nvt 1 0\nvn 0 0 3\nf 1/1/1 2/2/1 3/2/1\n");
  REQUIRE(loaded.ok());
  const auto& vertices = loaded->scene.mesh.vertices;
  REQUIRE(vertices.size() == 3);
  REQUIRE(vertices[0].color[0] == 255);
  REQUIRE(vertices[0].color[2] == 128);
  REQUIRE(vertices[1].color[3] == 128);
  REQUIRE(vertices[0].texcoord[0] == 0.25f);
  REQUIRE(vertices[0].texcoord[1] == 0.0f);
  REQUIRE(vertices[1].texcoord[1] == 1.0f);
  REQUIRE(vertices[2].normal[2] == 1.0f);
  REQUIRE(loaded->scene.materials[0].diffuse == glm::vec3(1.0f));
  REQUIRE(loaded->scene.lights.size() == 3);
}

TEST_CASE("normals and texture coordinates that are not finite become 0 with a warning") {
  const auto loaded = load(kTriangle + "vt inf 1\nvn nan 0 1\nf 1/1/1 2/1/1 3/1/1\n");
  REQUIRE(loaded.ok());
  REQUIRE(has_warning(*loaded, "number that is not finite becomes 0"));
  REQUIRE(loaded->scene.mesh.vertices[0].normal[2] == 1.0f);
  REQUIRE(loaded->scene.mesh.vertices[0].texcoord[0] == 0.0f);
}

// Two squares that meet at an angle along the edge 1-2.
std::string roof(const char* height, const char* statements = "") {
  return std::string("v 0 0 0\nv 0 1 0\nv 1 1 ") + height + "\nv 1 0 " + height + "\nv -1 1 " + height + "\nv -1 0 " +
         height + "\n" + statements;
}

TEST_CASE("generated normals are smooth below 60 degrees and creased above; smoothing groups overrule that") {
  const std::string faces = "f 1 4 3 2\nf 1 2 5 6\n";
  const auto smooth = load(roof("-0.5") + faces);  // 53 degrees between the faces
  REQUIRE(smooth.ok());
  REQUIRE(smooth->scene.mesh.vertices.size() == 6);
  REQUIRE(smooth->scene.mesh.vertices[0].normal[2] == doctest::Approx(1));
  const auto creased = load(roof("-2") + faces);
  REQUIRE(creased.ok());
  REQUIRE(creased->scene.mesh.vertices.size() == 8);
  REQUIRE(load(roof("-2", "s 1\n") + faces)->scene.mesh.vertices.size() == 6);
  REQUIRE(load(roof("-0.5", "s off\n") + faces)->scene.mesh.vertices.size() == 8);
  REQUIRE(load(roof("-0.5") + "s 1\nf 1 4 3 2\ns 2\nf 1 2 5 6\n")->scene.mesh.vertices.size() == 8);
}

TEST_CASE("materials: numbers, names with blanks, options of map_Kd, backslashes") {
  const char* mtl =
      "# library\r\nnewmtl Shiny  Red\r\nKa 0.1 0.2 0.3\nKd 0.9 0.1 0.1\nKs 0.5\nKe 0 0.25 0\nNs 250.4\nillum 2\nd "
      "0.5\n"
      "newmtl matte\nKd 1 1 1\nKs 1 1 1\nillum 1\nmap_Kd -clamp on -s 2 3 1 -o .5 0 .\\textures\\my wood.png\n"
      "newmtl sign\nKd 1 .5 0\nillum 0\nnewmtl dark\nKd 0 0 0\nmap_Kd textures/my wood.png\n";
  const auto loaded = load(kTriangle +
                               "vt 0.5 0.5\nmtllib my materials.mtl\nusemtl Shiny  Red \nf 1/1 2/1 3/1\nusemtl matte\n"
                               "f 1/1 2/1 3/1\nusemtl sign\nf 1/1 2/1 3/1\nusemtl dark\nf 1/1 2/1 3/1\n",
                           {{"my materials.mtl", mtl}, {"textures/my wood.png", "image"}});
  REQUIRE(loaded.ok());
  const auto& scene = loaded->scene;
  REQUIRE(scene.materials.size() == 5);
  const Material& red = scene.materials[1];
  REQUIRE(red.name == "Shiny  Red");
  REQUIRE(red.ambient == glm::vec3(0.1f, 0.2f, 0.3f));
  REQUIRE(red.specular == glm::vec3(0.5f));
  REQUIRE(red.emission == glm::vec3(0, 0.25f, 0));
  REQUIRE(red.shininess == 250);
  REQUIRE(red.alpha == pac::raster::AlphaMode::blend);
  REQUIRE(red.opacity == 0.5f);
  const Material& matte = scene.materials[2];
  REQUIRE(matte.specular == glm::vec3(0.0f));
  REQUIRE(matte.wrap == pac::raster::Wrap::clamp);
  REQUIRE(matte.texture == 0);
  REQUIRE(scene.textures[0].name == "textures/my wood.png");
  REQUIRE(scene.textures.size() == 1);
  const auto& corner = scene.mesh.vertices[scene.mesh.indices[scene.mesh.faces[1].first]];
  REQUIRE(corner.texcoord[0] == 1.5f);
  REQUIRE(corner.texcoord[1] == -0.5f);
  REQUIRE(!scene.materials[3].lit);
  REQUIRE(scene.mesh.vertices[scene.mesh.indices[scene.mesh.faces[2].first]].color[1] == 128);
  REQUIRE(scene.materials[4].diffuse == glm::vec3(1.0f));
}

TEST_CASE("what is missing is warned about and shows as a magenta and white checker") {
  const auto loaded =
      load(kTriangle + "mtllib a.mtl b.mtl\nusemtl one\nf 1 2 3\nusemtl two\nf 1 2 3\nusemtl three\nf 3 2 1\n",
           {{"b.mtl", "newmtl one\nmap_Kd nowhere.png\nnewmtl three\nmap_Kd b.mtl\n"}});
  REQUIRE(loaded.ok());
  REQUIRE(has_warning(*loaded, "texture is missing: checker instead"));
  REQUIRE(has_warning(*loaded, "material is not defined: checker instead"));
  REQUIRE(has_warning(*loaded, "not an image"));
  REQUIRE(loaded->scene.textures.size() == 1);
  for (size_t m = 1; m < 4; ++m) REQUIRE(loaded->scene.materials[m].texture == 0);
  const uint8_t* pixel = &loaded->scene.textures[0].texels[0];
  REQUIRE((pixel[0] == 255 && pixel[1] == 0 && pixel[2] == 255));
  REQUIRE(has_warning(*load(kTriangle + "mtllib gone.mtl\nf 1 2 3\n"), "material library is missing"));
  REQUIRE(load(kTriangle + "f 1 2 3\n")->scene.materials[0].texture == -1);
}

TEST_CASE("nonsense in a material library never stops the loading") {
  const char* mtl =
      "Kd 1 0 0\nnewmtl m\nKd x\nKd\nKd 1 2\nNs much\nillum nan\nmap_Kd\nmap_Kd -s\nmap_Kd -s 1\nmap_Kd -s 1 2 3 4 "
      "5\nd\nTr\n"
      "newmtl\nnewmtl m\nKd 0 1 0\n";
  const auto loaded = load(kTriangle + "mtllib m.mtl\nusemtl m\nf 1 2 3\n", {{"m.mtl", mtl}});
  REQUIRE(loaded.ok());
  REQUIRE(loaded->warnings.size() > 5);
}

// Images of 8 x 2 texels: "ramp" grows from left to right, "mask" is black and then white, "colored" is (200, 10, 128).
pac::raster::AssetSource drawn_assets(const char* mtl) {
  auto assets = assets_from({{"m.mtl", mtl}, {"ramp", "r"}, {"mask", "m"}, {"colored", "c"}});
  assets.decode_image = [](std::span<const uint8_t> bytes) -> pac::Result<pac::RgbaImage> {
    pac::RgbaImage image(8, 2);
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 8; ++x) {
        uint8_t* p = image.pixel(x, y);
        const auto grey = static_cast<uint8_t>(bytes[0] == 'r' ? 20 * x : x < 4 ? 0 : 255);
        p[0] = bytes[0] == 'c' ? 200 : grey;
        p[1] = bytes[0] == 'c' ? 10 : grey;
        p[2] = bytes[0] == 'c' ? 128 : grey;
        p[3] = 255;
      }
    return image;
  };
  return assets;
}

TEST_CASE("specular, emission, opacity and bump maps become the material's; heights become slopes") {
  const char* mtl =
      "newmtl a\nmap_Kd -s 2 2 2 colored\nmap_Ks -s 9 9 9 ramp\nmap_Ke mask\nmap_d mask\nmap_Bump -bm 8 ramp\n"
      "newmtl b\nKd 1 1 1\nmap_d ramp\nnorm colored\nd 0.5\n"
      "newmtl c\nKd 1 1 1\nmap_Ks nothing\nmap_d nothing\nbump nothing\nmap_Ke nothing\n";
  const std::string text = kTriangle +
                           "vt 0.5 0.5\nmtllib m.mtl\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 2/1 3/1\n"
                           "usemtl c\nf 1/1 2/1 3/1\n";
  const auto loaded = pac::raster::load_obj(bytes_of(text), drawn_assets(mtl));
  REQUIRE(loaded.ok());
  const auto& scene = loaded->scene;
  REQUIRE(scene.materials.size() == 4);
  const auto texel = [&](int32_t texture, int x) {
    return scene.textures.at(static_cast<size_t>(texture)).level(0).pixel(x, 0);
  };
  const Material& a = scene.materials[1];
  REQUIRE(a.specular == glm::vec3(1.0f));
  REQUIRE(a.emission == glm::vec3(1.0f));
  REQUIRE(texel(a.specular_texture, 3)[0] == 60);
  REQUIRE(texel(a.emission_texture, 7)[2] == 255);
  REQUIRE(a.alpha == pac::raster::AlphaMode::mask);
  REQUIRE(texel(a.texture, 1)[0] == 200);
  REQUIRE(texel(a.texture, 1)[3] == 0);
  REQUIRE(texel(a.texture, 6)[3] == 255);
  const uint8_t* slope = texel(a.normal_texture, 3);  // it rises to the right: the normal leans to the left
  // Heights of 8 / 64 of the width, 1 texel: 20 / 255 of a texel rise each.
  REQUIRE(std::abs(slope[0] - (128 - 127 * 20 / 255.0)) < 1.5);
  REQUIRE(slope[1] == 128);
  REQUIRE(scene.mesh.vertices[0].texcoord[0] == 1.0f);  // map_Kd's scale alone
  const Material& b = scene.materials[2];
  REQUIRE(b.alpha == pac::raster::AlphaMode::blend);
  REQUIRE(b.opacity == 0.5f);
  REQUIRE(texel(b.texture, 2)[0] == 255);
  REQUIRE(texel(b.texture, 2)[3] == 40);
  REQUIRE(texel(b.normal_texture, 0)[1] == 10);
  const Material& c = scene.materials[3];
  REQUIRE(c.specular_texture == -1);
  REQUIRE(c.normal_texture == -1);
  REQUIRE(c.emission_texture == -1);
  REQUIRE(c.texture == -1);
  REQUIRE(c.alpha == pac::raster::AlphaMode::opaque);
  REQUIRE(has_warning(*loaded, "texture is missing: checker instead"));
}

}  // namespace
