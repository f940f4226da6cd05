#include "raster/load_gltf.h"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "raster/load_ply.h"
#include "raster/node_animation.h"
#include "tests/support/model_files.h"

namespace {

using pac::Error;
using pac::raster::LoadedScene;
using pac::test::assets_from;
using pac::test::bytes_of;

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t window = 0;
    for (size_t k = 0; k < 3; ++k)
      window = window << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[window >> (18 - 6 * k) & 63];
  }
  return out;
}

template <class T>
std::string raw(const std::vector<T>& values) {
  std::string out(values.size() * sizeof(T), '\0');
  std::memcpy(out.data(), values.data(), out.size());
  return out;
}

std::string uri_of(const std::string& bytes) {
  return "data:application/octet-stream;base64," + base64(bytes);
}

// Single quotes stand for double ones, to keep the JSON readable.
std::string json(std::string text) {
  for (char& c : text) c = c == '\'' ? '"' : c;
  return text;
}

// A unit right triangle in the plane z = 0, facing +z; 36 bytes of positions, then 3 16-bit indices.
std::string triangle_bytes() {
  return raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw<uint16_t>({0, 1, 2});
}

struct Parts {
  std::string nodes = "[{'mesh':0}]";
  std::string primitive = "{'attributes':{'POSITION':0},'indices':1}";
  std::string accessors =
      "[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
      "{'bufferView':1,'componentType':5123,'count':3,'type':'SCALAR'}]";
  std::string views = "[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36,'byteLength':6}]";
  std::string buffers = "[{'byteLength':42,'uri':'" + uri_of(triangle_bytes()) + "'}]";
  std::string more;  // further top-level members, each with a comma before it
};

std::string file_of(const Parts& parts) {
  return json("{'asset':{'version':'2.0'},'nodes':" + parts.nodes + ",'meshes':[{'primitives':[" + parts.primitive +
              "]}],'accessors':" + parts.accessors + ",'bufferViews':" + parts.views + ",'buffers':" + parts.buffers +
              parts.more + "}");
}

pac::Result<LoadedScene> load(const std::string& text, std::map<std::string, std::string> files = {}) {
  return pac::raster::load_model(bytes_of(text), assets_from(std::move(files)));
}

// A build without the JSON parser refuses all of this file's models by name; that is tested below.
bool cannot_read() {
  if (pac::raster::has_gltf()) return false;
  MESSAGE("built without RapidJSON: skipped");
  return true;
}

void require_position(const pac::Vertex& vertex, float x, float y, float z) {
  REQUIRE(vertex.position[0] == doctest::Approx(x).epsilon(1e-6));
  REQUIRE(vertex.position[1] == doctest::Approx(y).epsilon(1e-6));
  REQUIRE(vertex.position[2] == doctest::Approx(z).epsilon(1e-6));
}

TEST_CASE("without a JSON parser glTF is refused with the name of what is missing") {
  if (pac::raster::has_gltf()) return;
  const auto loaded = load(file_of({}));
  REQUIRE(!loaded.ok());
  REQUIRE(loaded.failure().error == Error::unsupported);
  REQUIRE(std::string(loaded.failure().text) == "built without glTF (Debian: rapidjson-dev)");
}

TEST_CASE("a triangle arrives with its corners and orientation") {
  if (cannot_read()) return;
  const auto loaded = load(file_of({}));
  REQUIRE(loaded.ok());
  const pac::Mesh& mesh = loaded->scene.mesh;
  REQUIRE(mesh.faces.size() == 1);
  require_position(mesh.vertices[mesh.indices[0]], 0, 0, 0);
  require_position(mesh.vertices[mesh.indices[1]], 1, 0, 0);
  require_position(mesh.vertices[mesh.indices[2]], 0, 1, 0);
  REQUIRE(loaded->scene.objects.empty());
  REQUIRE(loaded->animation.empty());
  REQUIRE(!loaded->scene.lights.empty());
}

TEST_CASE("a GLB container holds the same scene as the JSON with its buffer beside it") {
  if (cannot_read()) return;
  Parts parts;
  parts.buffers = "[{'byteLength':42}]";
  std::string text = file_of(parts), bytes = triangle_bytes();
  while (text.size() % 4 != 0) text += ' ';
  while (bytes.size() % 4 != 0) bytes += '\0';
  const uint32_t total = static_cast<uint32_t>(12 + 8 + text.size() + 8 + bytes.size());
  const std::string glb = "glTF" + raw<uint32_t>({2, total, static_cast<uint32_t>(text.size())}) + "JSON" + text +
                          raw<uint32_t>({static_cast<uint32_t>(bytes.size())}) + std::string("BIN\0", 4) + bytes;
  const auto from_glb = load(glb);
  parts.buffers = "[{'byteLength':42,'uri':'a%20b.bin'}]";
  const auto from_file = load(file_of(parts), {{"a b.bin", triangle_bytes()}});
  REQUIRE(from_glb.ok());
  REQUIRE(from_file.ok());
  for (size_t i = 0; i < 3; ++i)
    for (size_t k = 0; k < 3; ++k)
      REQUIRE(from_glb->scene.mesh.vertices[i].position[k] == from_file->scene.mesh.vertices[i].position[k]);
  for (size_t n = 0; n < glb.size(); ++n) REQUIRE(!load(glb.substr(0, n)).ok());
}

TEST_CASE("transforms of parents and children multiply; a mirrored one turns the corners around") {
  if (cannot_read()) return;
  Parts parts;
  parts.nodes =
      "[{'mesh':0,'translation':[1,0,0]},{'children':[0],'scale':[2,2,2],'rotation':[0,0,0.70710678,0.70710678]}]";
  const auto turned = load(file_of(parts));
  REQUIRE(turned.ok());
  // (1,0,0) + (1,0,0) = (2,0,0), turned by 90 degrees about z and doubled: (0,4,0).
  require_position(turned->scene.mesh.vertices[1], 0, 4, 0);
  parts.nodes = "[{'mesh':0,'matrix':[-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}]";
  const auto mirrored = load(file_of(parts));
  REQUIRE(mirrored.ok());
  const pac::Mesh& mesh = mirrored->scene.mesh;
  require_position(mesh.vertices[mesh.indices[1]], 5, 1, 0);
  require_position(mesh.vertices[mesh.indices[2]], 4, 0, 0);
}

TEST_CASE("strips and fans are cut into triangles that face one way") {
  if (cannot_read()) return;
  Parts parts;
  parts.views = "[{'buffer':0,'byteLength':48}]";
  parts.accessors = "[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'}]";
  const std::string zigzag = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  const std::string around = raw<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  for (const bool strip : {true, false}) {
    CAPTURE(strip);
    parts.primitive = "{'attributes':{'POSITION':0},'mode':" + std::string(strip ? "5" : "6") + "}";
    parts.buffers = "[{'byteLength':48,'uri':'" + uri_of(strip ? zigzag : around) + "'}]";
    const auto loaded = load(file_of(parts));
    REQUIRE(loaded.ok());
    const pac::Mesh& mesh = loaded->scene.mesh;
    REQUIRE(mesh.faces.size() == 2);
    for (const pac::Face& face : mesh.faces) {
      const auto corner = [&](size_t k) { return mesh.vertices[mesh.indices[face.first + k]].position; };
      const float area = (corner(1)[0] - corner(0)[0]) * (corner(2)[1] - corner(0)[1]) -
                         (corner(2)[0] - corner(0)[0]) * (corner(1)[1] - corner(0)[1]);
      REQUIRE(area == 1);
    }
  }
}

TEST_CASE("strided, normalized and sparse accessors give the numbers they mean") {
  if (cannot_read()) return;
  Parts parts;
  // Positions 16 bytes apart, colors as normalized bytes, a sparse replacement of vertex 2.
  const std::string bytes = raw<float>({0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0, 9}) +
                            raw<uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255}) +
                            raw<uint8_t>({2, 0, 0, 0}) + raw<float>({0, 7, 0});
  parts.primitive = "{'attributes':{'POSITION':0,'COLOR_0':1}}";
  parts.accessors =
      "[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3','sparse':{'count':1,"
      "'indices':{'bufferView':2,'componentType':5121},'values':{'bufferView':3}}},"
      "{'bufferView':1,'componentType':5121,'normalized':true,'count':3,'type':'VEC4'}]";
  parts.views =
      "[{'buffer':0,'byteLength':48,'byteStride':16},{'buffer':0,'byteOffset':48,'byteLength':12},"
      "{'buffer':0,'byteOffset':60,'byteLength':1},{'buffer':0,'byteOffset':64,'byteLength':12}]";
  parts.buffers = "[{'byteLength':76,'uri':'" + uri_of(bytes) + "'}]";
  const auto loaded = load(file_of(parts));
  REQUIRE(loaded.ok());
  require_position(loaded->scene.mesh.vertices[1], 1, 0, 0);
  require_position(loaded->scene.mesh.vertices[2], 0, 7, 0);
  REQUIRE(loaded->scene.mesh.vertices[0].color[0] == 255);
  REQUIRE(loaded->scene.mesh.vertices[0].color[1] == 0);
  REQUIRE(loaded->scene.mesh.vertices[2].color[2] == 255);
}

TEST_CASE("base color becomes display-referred; unlit materials carry it in the vertices") {
  if (cannot_read()) return;
  Parts parts;
  parts.primitive = "{'attributes':{'POSITION':0},'indices':1,'material':0}";
  parts.more = ",'materials':[{'pbrMetallicRoughness':{'baseColorFactor':[0.2158605,1,0,1],'metallicFactor':0}}]";
  const auto lit = load(file_of(parts));
  REQUIRE(lit.ok());
  // 0.2158605 is the linear value of sRGB 128/255.
  REQUIRE(lit->scene.materials[0].diffuse.x == doctest::Approx(128 / 255.0).epsilon(1e-4));
  REQUIRE(lit->scene.materials[0].lit);
  parts.more =
      ",'materials':[{'extensions':{'KHR_materials_unlit':{}},"
      "'pbrMetallicRoughness':{'baseColorFactor':[0.2158605,1,0,1]}}]";
  const auto unlit = load(file_of(parts));
  REQUIRE(unlit.ok());
  REQUIRE(!unlit->scene.materials[0].lit);
  REQUIRE(unlit->scene.mesh.vertices[0].color[0] == 128);
  REQUIRE(unlit->scene.mesh.vertices[0].color[1] == 255);
}

Parts textured(const std::string& info, const std::string& sampler) {
  Parts parts;
  const std::string bytes = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1});
  parts.primitive = "{'attributes':{'POSITION':0,'TEXCOORD_0':1},'material':0}";
  parts.accessors =
      "[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
      "{'bufferView':1,'componentType':5126,'count':3,'type':'VEC2'}]";
  parts.views = "[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36,'byteLength':24}]";
  parts.buffers = "[{'byteLength':60,'uri':'" + uri_of(bytes) + "'}]";
  parts.more = ",'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0" + info +
               "}}}],'textures':[{'source':0,'sampler':0}],'images':[{'uri':'wood.png'}],'samplers':[{" + sampler +
               "}]";
  return parts;
}

TEST_CASE("texture coordinates obey KHR_texture_transform, mirrored repetition and the sampler") {
  if (cannot_read()) return;
  const std::map<std::string, std::string> files = {{"wood.png", "image"}};
  const std::string turned =
      ",'extensions':{'KHR_texture_transform':{'offset':[0.25,0.5],'rotation':1.5707963267948966,'scale':[2,3]}}";
  const auto moved = load(file_of(textured(turned, "'wrapS':33071,'wrapT':33071,'magFilter':9728")), files);
  REQUIRE(moved.ok());
  // (1, 0): scaled (2, 0), a quarter turn counter-clockwise with v down (0, -2), moved (0.25, -1.5).
  REQUIRE(moved->scene.mesh.vertices[1].texcoord[0] == doctest::Approx(0.25));
  REQUIRE(moved->scene.mesh.vertices[1].texcoord[1] == doctest::Approx(-1.5));
  REQUIRE(moved->scene.mesh.vertices[2].texcoord[0] == doctest::Approx(3.25));
  REQUIRE(moved->scene.materials[0].wrap == pac::raster::Wrap::clamp);
  REQUIRE(moved->scene.materials[0].filter == pac::raster::Filter::nearest);
  const auto mirrored = load(file_of(textured("", "'wrapS':33648")), files);
  REQUIRE(mirrored.ok());
  REQUIRE(mirrored->scene.textures[0].width() == 4);
  REQUIRE(mirrored->scene.textures[0].height() == 2);
  REQUIRE(mirrored->scene.mesh.vertices[1].texcoord[0] == 0.5f);
  const auto missing = load(file_of(textured("", "")));
  REQUIRE(missing.ok());
  REQUIRE(!missing->warnings.empty());
}

TEST_CASE("normal, emissive and metallic-roughness textures, alpha modes and opacity arrive") {
  if (cannot_read()) return;
  Parts parts = textured("", "");
  parts.more =
      ",'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0},'baseColorFactor':[1,1,1,0.75],"
      "'metallicRoughnessTexture':{'index':0}},'normalTexture':{'index':0,'scale':0.5},"
      "'emissiveTexture':{'index':0},'emissiveFactor':[1,0,0],'alphaMode':'MASK','alphaCutoff':0.3},"
      "{'alphaMode':'BLEND','emissiveTexture':{'index':0,'texCoord':1},'emissiveFactor':[1,1,1],"
      "'pbrMetallicRoughness':{'baseColorTexture':{'index':0}}}],"
      "'textures':[{'source':0}],'images':[{'uri':'wood.png'}]";
  const auto loaded = load(file_of(parts), {{"wood.png", "image"}});
  REQUIRE(loaded.ok());
  const pac::raster::Material& all = loaded->scene.materials[0];
  REQUIRE(all.alpha == pac::raster::AlphaMode::mask);
  REQUIRE(all.alpha_cutoff == doctest::Approx(0.3));
  REQUIRE(all.opacity == 0.75f);
  REQUIRE(all.normal_texture == all.texture);
  REQUIRE(all.normal_scale == 0.5f);
  REQUIRE(all.emission_texture == all.texture);
  REQUIRE(all.emission == glm::vec3(1, 0, 0));
  REQUIRE(all.specular_texture >= 0);
  REQUIRE(all.specular_texture != all.texture);
  REQUIRE(all.specular == glm::vec3(1.0f));
  const pac::raster::Material& glass = loaded->scene.materials[1];
  REQUIRE(glass.alpha == pac::raster::AlphaMode::blend);
  REQUIRE(glass.emission_texture == -1);  // it asks for texture coordinates of its own
  bool warned = false;
  for (const auto& warning : loaded->warnings)
    warned = warned || std::string(warning.text) == "texture with texture coordinates of its own is not drawn";
  REQUIRE(warned);
}

Parts animated(const std::string& path, const std::string& interpolation, const std::vector<float>& values,
               const std::string& type) {
  Parts parts;
  const std::string bytes = triangle_bytes() + std::string(2, '\0') + raw<float>({0, 2}) + raw(values);
  parts.accessors.pop_back();
  parts.accessors +=
      ",{'bufferView':2,'componentType':5126,'count':2,'type':'SCALAR'},{'bufferView':3,"
      "'componentType':5126,'count':" +
      std::to_string(values.size() / (type == "VEC4" ? 4 : 3)) + ",'type':'" + type + "'}]";
  parts.views.pop_back();
  parts.views += ",{'buffer':0,'byteOffset':44,'byteLength':8},{'buffer':0,'byteOffset':52,'byteLength':" +
                 std::to_string(values.size() * 4) + "}]";
  parts.buffers = "[{'byteLength':" + std::to_string(bytes.size()) + ",'uri':'" + uri_of(bytes) + "'}]";
  parts.nodes = "[{'mesh':0,'translation':[1,0,0]},{'mesh':0}]";
  parts.more = ",'animations':[{'channels':[{'sampler':0,'target':{'node':0,'path':'" + path +
               "'}}],'samplers':[{'input':2,'output':3,'interpolation':'" + interpolation + "'}]}]";
  return parts;
}

// Where the first vertex of the animated node's triangle is.
glm::vec3 moved_vertex(LoadedScene& loaded, double time_s, size_t vertex) {
  pac::raster::pose_objects(loaded.animation, time_s, 0, loaded.scene);
  const pac::raster::Object& object = loaded.scene.objects[0];
  const float* p = loaded.scene.mesh.vertices[object.first_vertex + vertex].position;
  return glm::vec3(object.world_from_object * glm::vec4(p[0], p[1], p[2], 1));
}

TEST_CASE("an animated node moves its vertices and no others, at any time of the animation") {
  if (cannot_read()) return;
  auto line = load(file_of(animated("translation", "LINEAR", {1, 0, 0, 5, 4, 0}, "VEC3")));
  REQUIRE(line.ok());
  REQUIRE(line->scene.objects.size() == 1);
  REQUIRE(line->scene.objects[0].vertex_count == 3);
  REQUIRE(line->scene.mesh.vertices.size() == 6);
  REQUIRE(line->animation.duration_s == 2);
  REQUIRE(glm::length(moved_vertex(*line, 0, 0) - glm::vec3(1, 0, 0)) < 1e-5f);
  REQUIRE(glm::length(moved_vertex(*line, 1, 0) - glm::vec3(3, 2, 0)) < 1e-5f);
  REQUIRE(glm::length(moved_vertex(*line, 2, 0) - glm::vec3(5, 4, 0)) < 1e-5f);
  REQUIRE(glm::length(moved_vertex(*line, 2.5, 0) - glm::vec3(2, 1, 0)) < 1e-5f);  // it starts again

  auto step = load(file_of(animated("translation", "STEP", {1, 0, 0, 5, 4, 0}, "VEC3")));
  REQUIRE(step.ok());
  REQUIRE(glm::length(moved_vertex(*step, 1.9, 0) - glm::vec3(1, 0, 0)) < 1e-5f);

  // Tangents of zero: the cubic goes through the middle half way.
  auto curve = load(
      file_of(animated("translation", "CUBICSPLINE", {0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 5, 4, 0, 0, 0, 0}, "VEC3")));
  REQUIRE(curve.ok());
  REQUIRE(glm::length(moved_vertex(*curve, 1, 0) - glm::vec3(3, 2, 0)) < 1e-5f);
  REQUIRE(glm::length(moved_vertex(*curve, 0.5, 0) - glm::vec3(1 + 4 * 0.15625f, 4 * 0.15625f, 0)) < 1e-5f);
}

TEST_CASE("rotations go along the shorter arc at even speed") {
  if (cannot_read()) return;
  const float half = std::sqrt(0.5f);
  auto turn = load(file_of(animated("rotation", "LINEAR", {0, 0, 0, 1, 0, 0, -half, -half}, "VEC4")));
  REQUIRE(turn.ok());
  // A quarter turn in two seconds; vertex 1 starts at (2, 0, 0) about (1, 0, 0).
  for (const double time : {0.5, 1.0, 1.5, 2.0}) {
    const float angle = static_cast<float>(time * 0.7853981633974483);
    REQUIRE(glm::length(moved_vertex(*turn, time, 1) - glm::vec3(1 + std::cos(angle), std::sin(angle), 0)) < 1e-5f);
  }
}

TEST_CASE("each wrong file gets its named error and a place in the file") {
  if (cannot_read()) return;
  struct Case {
    const char* message;
    Error error;
    Parts parts;
  };
  std::vector<Case> cases;
  const auto wrong = [&](const char* message, auto change, Error error = Error::corrupt) {
    Parts parts;
    change(parts);
    cases.push_back({message, error, parts});
  };
  wrong("index out of range", [](Parts& p) {
    p.buffers = "[{'byteLength':42,'uri':'" +
                uri_of(raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw<uint16_t>({0, 1, 3})) + "'}]";
  });
  wrong("number is not finite", [](Parts& p) {
    p.buffers = "[{'byteLength':42,'uri':'" +
                uri_of(raw<float>({0, 0, 0, INFINITY, 0, 0, 0, 1, 0}) + raw<uint16_t>({0, 1, 2})) + "'}]";
  });
  wrong("accessor reaches outside its buffer view", [](Parts& p) { p.views.replace(p.views.find("36"), 2, "35"); });
  wrong("nodes form a cycle", [](Parts& p) { p.nodes = "[{'mesh':0,'children':[1]},{'children':[0]}]"; });
  wrong("node has two parents", [](Parts& p) { p.nodes = "[{'children':[2]},{'children':[2]},{'mesh':0}]"; });
  wrong("names something that the file does not have", [](Parts& p) { p.nodes = "[{'mesh':1}]"; });
  wrong("unknown component type", [](Parts& p) { p.accessors.replace(p.accessors.find("5126"), 4, "5127"); });
  wrong("accessor has an unknown type", [](Parts& p) { p.accessors.replace(p.accessors.find("VEC3"), 4, "VEC9"); });
  wrong("not a whole number of at least 0", [](Parts& p) { p.nodes = "[{'mesh':0.5}]"; });
  wrong("data URI is not base64", [](Parts& p) { p.buffers = "[{'byteLength':42,'uri':'data:;base64,!!'}]"; });
  wrong("buffer without a URI", [](Parts& p) { p.buffers = "[{'byteLength':42}]"; });
  wrong(
      "buffer is shorter than its byteLength",
      [](Parts& p) { p.buffers = "[{'byteLength':42,'uri':'data:;base64,AAAA'}]"; }, Error::truncated);
  wrong(
      "requires the extension KHR_draco_mesh_compression",
      [](Parts& p) { p.more = ",'extensionsRequired':['KHR_draco_mesh_compression']"; }, Error::unsupported);
  wrong(
      "mesh is compressed by KHR_draco_mesh_compression",
      [](Parts& p) {
        p.accessors.replace(p.accessors.find("'bufferView':0,"), 15, "");
        p.primitive = "{'attributes':{'POSITION':0},'extensions':{'KHR_draco_mesh_compression':{'bufferView':0}}}";
      },
      Error::unsupported);
  wrong(
      "no triangles: points and lines alone are not drawn",
      [](Parts& p) { p.primitive = "{'attributes':{'POSITION':0},'mode':0}"; }, Error::unsupported);
  wrong(
      "accessor has more elements than the limit",
      [](Parts& p) { p.accessors.replace(p.accessors.find("'count':3"), 9, "'count':4294967295"); },
      Error::limit_exceeded);
  for (const Case& bad : cases) {
    CAPTURE(bad.message);
    const std::string text = file_of(bad.parts);
    const auto loaded = load(text);
    REQUIRE(!loaded.ok());
    REQUIRE(std::string(loaded.failure().text) == bad.message);
    REQUIRE(loaded.failure().error == bad.error);
    REQUIRE(loaded.failure().byte_offset <= text.size());
  }
}

TEST_CASE("JSON that is cut, nests without end or is no object is refused") {
  if (cannot_read()) return;
  const std::string whole = file_of({});
  for (size_t n = 1; n < whole.size(); ++n) REQUIRE(!load(whole.substr(0, n)).ok());
  const auto deep = load("{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}");
  REQUIRE(!deep.ok());
  REQUIRE(deep.failure().error == Error::limit_exceeded);
  REQUIRE(!load("{}").ok());
  REQUIRE(std::string(load("{}").failure().text) == "no asset version: not glTF 2.0");
}

}  // namespace
