// serialize_model and parse_model: the resident model as plain little-endian fields.
//
//   flags u8 (1 normals, 2 texture coordinates) | vertices, faces, materials, textures, lights: u32 each | ambient 3
//   f32 | background 3 f32 | vertex: position 3 f32 [normal 3 f32] [texcoord 2 f32] color 4 u8 | face: corners u32,
//   material u32, vertex numbers u32... | material | texture: levels u8, level: w u32 h u32 RGBA | light
// and, where flag 4 says that any of it departs from its default: fog kind u8, color 3 f32, start, end, density f32 |
//   environment u32 | of each material: anisotropy u8, alpha u8, cutoff f32, opacity f32, normal u32, its scale f32,
//   specular u32, emission u32, reflection 3 f32, its blur f32
// and, where flag 8 says that parts can move: objects u32 | object: first vertex u32, vertices u32, columns of its
//   transform 4 x 3 f32
// and, where flag 16 says that lights move: of each light u32, 1 + the object it moves with, 0 none
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <utility>

#include "sim/byte_stream.h"
#include "sim/packet.h"

namespace pac::sim {

namespace {

constexpr uint8_t kNormals = 1, kTexcoords = 2, kLooks = 4, kObjects = 8, kCarriedLights = 16;
constexpr size_t kMaterialBytes = 60, kLightBytes = 56, kVertexBytes = 16, kFaceBytes = 8, kTextureBytes = 12,
                 kObjectBytes = 56;

void write_vec3(ByteWriter& writer, const glm::vec3& v) {
  for (int axis = 0; axis < 3; ++axis) writer.f32(v[axis]);
}

glm::vec3 read_vec3(ByteReader& reader) {
  const float x = reader.f32(), y = reader.f32(), z = reader.f32();
  return {x, y, z};
}

void write_mesh(ByteWriter& writer, const Mesh& mesh, uint8_t fields) {
  for (const Vertex& vertex : mesh.vertices) {
    for (const float p : vertex.position) writer.f32(p);
    if ((fields & kNormals) != 0)
      for (const float n : vertex.normal) writer.f32(n);
    if ((fields & kTexcoords) != 0)
      for (const float t : vertex.texcoord) writer.f32(t);
    writer.raw(vertex.color);
  }
  for (const Face& face : mesh.faces) {
    writer.u32(face.count);
    writer.u32(face.material);
    for (uint32_t k = 0; k < face.count; ++k) writer.u32(mesh.indices[face.first + k]);
  }
}

void read_vertices(ByteReader& reader, Mesh& mesh, uint8_t fields) {
  for (Vertex& vertex : mesh.vertices) {
    for (float& p : vertex.position) p = reader.f32();
    if ((fields & kNormals) != 0)
      for (float& n : vertex.normal) n = reader.f32();
    if ((fields & kTexcoords) != 0)
      for (float& t : vertex.texcoord) t = reader.f32();
    for (uint8_t& c : vertex.color) c = reader.u8();
  }
}

Result<void> read_faces(ByteReader& reader, Mesh& mesh) {
  for (Face& face : mesh.faces) {
    const size_t at = reader.position();
    face.first = static_cast<uint32_t>(mesh.indices.size());
    face.count = reader.u32();
    face.material = reader.u32();
    if (face.count > reader.remaining() / 4) return Failure{Error::truncated, at, "face has more corners than bytes"};
    if (mesh.indices.size() + face.count > UINT32_MAX)
      return Failure{Error::limit_exceeded, at, "model has more corners than can be numbered"};
    for (uint32_t k = 0; k < face.count; ++k) mesh.indices.push_back(reader.u32());
  }
  return {};
}

void write_material(ByteWriter& writer, const raster::Material& material) {
  write_vec3(writer, material.ambient);
  write_vec3(writer, material.diffuse);
  write_vec3(writer, material.specular);
  write_vec3(writer, material.emission);
  writer.u32(static_cast<uint32_t>(material.shininess));
  writer.u32(static_cast<uint32_t>(material.texture));
  writer.u8(static_cast<uint8_t>(material.wrap));
  writer.u8(static_cast<uint8_t>(material.filter));
  writer.u8(material.lit ? 1 : 0);
  writer.u8(material.two_sided ? 1 : 0);
}

Result<raster::Material> read_material(ByteReader& reader, uint32_t n_textures) {
  const size_t at = reader.position();
  raster::Material material;
  material.ambient = read_vec3(reader);
  material.diffuse = read_vec3(reader);
  material.specular = read_vec3(reader);
  material.emission = read_vec3(reader);
  material.shininess = static_cast<int32_t>(reader.u32());
  material.texture = static_cast<int32_t>(reader.u32());
  const uint8_t wrap = reader.u8(), filter = reader.u8(), lit = reader.u8(), two_sided = reader.u8();
  if (material.shininess < 0 || material.shininess > 1000)
    return Failure{Error::corrupt, at + 48, "shininess outside 0..1000"};
  if (material.texture < -1 || (material.texture >= 0 && static_cast<uint32_t>(material.texture) >= n_textures))
    return Failure{Error::corrupt, at + 52, "material names a texture that does not exist"};
  if (wrap > 1 || filter > 2 || lit > 1 || two_sided > 1)
    return Failure{Error::corrupt, at + 56, "material flag out of range"};
  material.wrap = static_cast<raster::Wrap>(wrap);
  material.filter = static_cast<raster::Filter>(filter);
  material.lit = lit != 0;
  material.two_sided = two_sided != 0;
  return material;
}

// Level 0 alone, or the mean color as a texture of one pixel: make_texture gives the same mip chain everywhere.
void write_texture(ByteWriter& writer, const raster::Texture& texture, bool textured) {
  const bool whole = textured && !texture.empty();
  writer.u32(whole ? static_cast<uint32_t>(texture.width()) : 1);
  writer.u32(whole ? static_cast<uint32_t>(texture.height()) : 1);
  if (!whole) return writer.raw(texture.mean_color());
  const ConstRgbaView level = texture.level(0);
  for (int y = 0; y < level.height; ++y) writer.raw({level.row(y), static_cast<size_t>(level.width) * 4});
}

Result<raster::Texture> read_texture(ByteReader& reader, const Limits& limits) {
  constexpr uint64_t kMaxSide = 32768;  // the rasterizer's
  const size_t at = reader.position();
  const uint64_t width = reader.u32(), height = reader.u32();
  if (width < 1 || width > kMaxSide || height < 1 || height > kMaxSide)
    return Failure{Error::corrupt, at, "texture side outside 1..32768"};
  if (width * height > reader.remaining() / 4) return Failure{Error::truncated, at, "texture ends early"};
  PAC_TRY(RgbaImage image, RgbaImage::create(static_cast<int64_t>(width), static_cast<int64_t>(height), limits));
  for (int y = 0; y < image.height(); ++y)
    std::memcpy(image.row(y), reader.raw(width * 4).data(), static_cast<size_t>(width) * 4);
  return raster::make_texture("", std::move(image));
}

void write_light(ByteWriter& writer, const raster::Light& light) {
  writer.u32(static_cast<uint32_t>(light.kind));
  write_vec3(writer, light.direction);
  write_vec3(writer, light.position);
  write_vec3(writer, light.color);
  writer.f32(light.range);
  writer.f32(light.cone_inner);
  writer.f32(light.cone_outer);
  writer.f32(light.radius);
}

Result<raster::Light> read_light(ByteReader& reader) {
  const size_t at = reader.position();
  raster::Light light;
  const uint32_t kind = reader.u32();
  if (kind > 2) return Failure{Error::corrupt, at, "unknown kind of light"};
  light.kind = static_cast<raster::Light::Kind>(kind);
  light.direction = read_vec3(reader);
  light.position = read_vec3(reader);
  light.color = read_vec3(reader);
  light.range = reader.f32();
  light.cone_inner = reader.f32();
  light.cone_outer = reader.f32();
  light.radius = reader.f32();
  return light;
}

bool has_looks(const raster::Scene& scene) {
  if (scene.fog.kind != raster::Fog::Kind::none || scene.environment >= 0) return true;
  for (const raster::Material& m : scene.materials)
    if (m.anisotropy != 1 || m.alpha != raster::AlphaMode::opaque || m.normal_texture >= 0 || m.specular_texture >= 0 ||
        m.emission_texture >= 0)
      return true;
  return false;
}

// Masks cut where texturing is off, too.
bool has_masks(const raster::Scene& scene) {
  for (const raster::Material& material : scene.materials)
    if (material.alpha == raster::AlphaMode::mask) return true;
  return false;
}

void write_looks(ByteWriter& writer, const raster::Scene& scene) {
  // An empty texture counts as none there, and travels as a grey one.
  const auto number = [&](int32_t texture) {
    const bool empty = texture >= 0 && scene.textures[static_cast<size_t>(texture)].empty();
    return static_cast<uint32_t>(empty ? -1 : texture);
  };
  writer.u8(static_cast<uint8_t>(scene.fog.kind));
  write_vec3(writer, scene.fog.color);
  for (const float f : {scene.fog.start, scene.fog.end, scene.fog.density}) writer.f32(f);
  writer.u32(number(scene.environment));
  for (const raster::Material& m : scene.materials) {
    writer.u8(static_cast<uint8_t>(std::clamp(m.anisotropy, 1, 8)));
    writer.u8(static_cast<uint8_t>(m.alpha));
    writer.f32(m.alpha_cutoff);
    writer.f32(m.opacity);
    writer.u32(number(m.normal_texture));
    writer.f32(m.normal_scale);
    writer.u32(number(m.specular_texture));
    writer.u32(number(m.emission_texture));
    write_vec3(writer, m.reflection);
    writer.f32(m.reflection_blur);
  }
}

Result<int32_t> read_texture_number(ByteReader& reader, uint32_t n_textures) {
  const size_t at = reader.position();
  const uint32_t number = reader.u32();
  if (number != UINT32_MAX && (number >= n_textures || number > INT32_MAX))
    return Failure{Error::corrupt, at, "material names a texture that does not exist"};
  return static_cast<int32_t>(number);
}

Result<void> read_looks(ByteReader& reader, uint32_t n_textures, raster::Scene& scene) {
  const uint8_t fog = reader.u8();
  if (fog > 3) return Failure{Error::corrupt, reader.position(), "unknown kind of fog"};
  scene.fog.kind = static_cast<raster::Fog::Kind>(fog);
  scene.fog.color = read_vec3(reader);
  for (float* f : {&scene.fog.start, &scene.fog.end, &scene.fog.density}) *f = reader.f32();
  PAC_TRY(scene.environment, read_texture_number(reader, n_textures));
  for (raster::Material& m : scene.materials) {
    m.anisotropy = reader.u8();
    const uint8_t alpha = reader.u8();
    if (alpha > 2) return Failure{Error::corrupt, reader.position(), "material flag out of range"};
    m.alpha = static_cast<raster::AlphaMode>(alpha);
    m.alpha_cutoff = reader.f32();
    m.opacity = reader.f32();
    PAC_TRY(m.normal_texture, read_texture_number(reader, n_textures));
    m.normal_scale = reader.f32();
    PAC_TRY(m.specular_texture, read_texture_number(reader, n_textures));
    PAC_TRY(m.emission_texture, read_texture_number(reader, n_textures));
    m.reflection = read_vec3(reader);
    m.reflection_blur = reader.f32();
  }
  return {};
}

void write_objects(ByteWriter& writer, const raster::Scene& scene) {
  writer.u32(static_cast<uint32_t>(scene.objects.size()));
  for (const raster::Object& object : scene.objects) {
    writer.u32(object.first_vertex);
    writer.u32(object.vertex_count);
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) writer.f32(object.world_from_object[column][row]);
  }
}

Result<void> read_objects(ByteReader& reader, raster::Scene& scene) {
  const size_t at = reader.position();
  const uint64_t n_objects = reader.u32();
  if (n_objects * kObjectBytes > reader.remaining())
    return Failure{Error::truncated, at, "model is shorter than its objects"};
  for (uint64_t i = 0; i < n_objects; ++i) {
    raster::Object object;
    object.first_vertex = reader.u32();
    object.vertex_count = reader.u32();
    for (int column = 0; column < 4; ++column)
      for (int row = 0; row < 3; ++row) object.world_from_object[column][row] = reader.f32();
    object.previous_world_from_object = object.world_from_object;
    scene.objects.push_back(object);
  }
  const Result<void> checked = check_objects(scene);
  if (!checked.ok()) return Failure{Error::corrupt, at, checked.failure().text};
  return {};
}

bool any_lit(const raster::Scene& scene) {
  for (const raster::Material& material : scene.materials)
    if (material.lit) return true;
  return false;
}

bool any_carried(const raster::Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(), [](const raster::Light& l) { return l.object >= 0; });
}

Result<void> read_carried_lights(ByteReader& reader, raster::Scene& scene) {
  for (raster::Light& light : scene.lights) {
    const size_t at = reader.position();
    const uint32_t object = reader.u32();
    if (object > scene.objects.size())
      return Failure{Error::corrupt, at, "light moves with an object that is not there"};
    light.object = static_cast<int32_t>(object) - 1;
  }
  return {};
}

}  // namespace

Bytes serialize_model(const raster::Scene& scene, bool wants_texture) {
  const bool textured = wants_texture || has_masks(scene);
  const bool texcoords = textured && !scene.textures.empty();
  const auto fields = static_cast<uint8_t>((any_lit(scene) ? kNormals : 0) | (texcoords ? kTexcoords : 0) |
                                           (has_looks(scene) ? kLooks : 0) | (scene.objects.empty() ? 0 : kObjects) |
                                           (any_carried(scene) ? kCarriedLights : 0));
  ByteWriter writer;
  writer.u8(fields);
  for (const size_t count : {scene.mesh.vertices.size(), scene.mesh.faces.size(), scene.materials.size(),
                             scene.textures.size(), scene.lights.size()})
    writer.u32(static_cast<uint32_t>(count));
  write_vec3(writer, scene.ambient_light);
  write_vec3(writer, scene.background);
  write_mesh(writer, scene.mesh, fields);
  for (const raster::Material& material : scene.materials) write_material(writer, material);
  for (const raster::Texture& texture : scene.textures) write_texture(writer, texture, textured);
  for (const raster::Light& light : scene.lights) write_light(writer, light);
  if ((fields & kLooks) != 0) write_looks(writer, scene);
  if ((fields & kObjects) != 0) write_objects(writer, scene);
  if ((fields & kCarriedLights) != 0)
    for (const raster::Light& light : scene.lights) writer.u32(static_cast<uint32_t>(light.object + 1));
  return writer.take();
}

Result<raster::Scene> parse_model(std::span<const uint8_t> bytes, const Limits& limits) {
  if (bytes.size() > limits.max_bytes) return Failure{Error::limit_exceeded, 0, "model has more bytes than the limit"};
  ByteReader reader(bytes);
  const uint8_t fields = reader.u8();
  if ((fields & ~(kNormals | kTexcoords | kLooks | kObjects | kCarriedLights)) != 0)
    return Failure{Error::unsupported, 0, "unknown vertex fields"};
  const uint64_t n_vertices = reader.u32(), n_faces = reader.u32(), n_materials = reader.u32();
  const uint32_t n_textures = reader.u32(), n_lights = reader.u32();
  // Before anything is allocated: the counts must fit the bytes that are there.
  if (n_vertices * kVertexBytes + n_faces * kFaceBytes + n_materials * kMaterialBytes +
          uint64_t{n_textures} * kTextureBytes + uint64_t{n_lights} * kLightBytes >
      reader.remaining())
    return Failure{Error::truncated, reader.position(), "model is shorter than its counts"};

  raster::Scene scene;
  scene.ambient_light = read_vec3(reader);
  scene.background = read_vec3(reader);
  scene.mesh.vertices.resize(static_cast<size_t>(n_vertices));
  read_vertices(reader, scene.mesh, fields);
  scene.mesh.faces.resize(static_cast<size_t>(n_faces));
  PAC_CHECK(read_faces(reader, scene.mesh));
  for (uint64_t i = 0; i < n_materials; ++i) {
    PAC_TRY(raster::Material material, read_material(reader, n_textures));
    scene.materials.push_back(std::move(material));
  }
  for (uint32_t i = 0; i < n_textures; ++i) {
    PAC_TRY(raster::Texture texture, read_texture(reader, limits));
    scene.textures.push_back(std::move(texture));
  }
  for (uint32_t i = 0; i < n_lights; ++i) {
    PAC_TRY(raster::Light light, read_light(reader));
    scene.lights.push_back(light);
  }
  if ((fields & kLooks) != 0) PAC_CHECK(read_looks(reader, n_textures, scene));
  if ((fields & kObjects) != 0) PAC_CHECK(read_objects(reader, scene));
  if ((fields & kCarriedLights) != 0) PAC_CHECK(read_carried_lights(reader, scene));
  if (reader.overrun()) return Failure{Error::truncated, bytes.size(), "model ends early"};
  if (reader.remaining() != 0) return Failure{Error::corrupt, reader.position(), "bytes after the end of the model"};
  PAC_CHECK(validate(scene.mesh, static_cast<uint32_t>(n_materials), limits));
  return scene;
}

}  // namespace pac::sim
