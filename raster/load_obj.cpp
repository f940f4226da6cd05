#include "raster/load_obj.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "raster/fit_camera.h"
#include "raster/load_mtl.h"
#include "raster/load_normals.h"
#include "raster/load_obj_file.h"
#include "raster/load_texture.h"

namespace pac::raster {
namespace {

// The libraries that the file names, one after the other; the first definition of a name counts.
class Libraries {
 public:
  Libraries(const std::vector<std::string>& names, const AssetSource& assets, std::vector<Warning>& warnings) {
    for (const std::string& name : names) load(name, assets, warnings);
  }
  const MtlMaterial* find(const std::string& name) const {
    const auto entry = number_.find(name);
    return entry == number_.end() ? nullptr : &materials_[entry->second];
  }

 private:
  void load(const std::string& statement, const AssetSource& assets, std::vector<Warning>& warnings) {
    if (try_load(statement, assets, warnings)) return;
    // Several names in one statement, or one that is missing.
    size_t begin = 0;
    bool found_any = false;
    while (begin < statement.size() && statement.find(' ') != std::string::npos) {
      const size_t end = std::min(statement.find(' ', begin), statement.size());
      if (end > begin) found_any = try_load(statement.substr(begin, end - begin), assets, warnings) || found_any;
      begin = end + 1;
    }
    if (!found_any) warnings.push_back({"material library is missing", statement, 0});
  }
  bool try_load(std::string name, const AssetSource& assets, std::vector<Warning>& warnings) {
    std::replace(name.begin(), name.end(), '\\', '/');
    while (name.starts_with("./")) name.erase(0, 2);
    if (std::find(loaded_.begin(), loaded_.end(), name) != loaded_.end()) return true;
    if (!assets.read) return false;
    const auto bytes = assets.read(name);
    if (!bytes) return false;
    loaded_.push_back(name);
    for (MtlMaterial& material : parse_mtl(*bytes, name, warnings)) {
      number_.try_emplace(material.material.name, materials_.size());
      materials_.push_back(std::move(material));
    }
    return true;
  }

  std::vector<MtlMaterial> materials_;
  std::vector<std::string> loaded_;
  std::unordered_map<std::string, size_t> number_;
};

// What distinguishes two vertices of the mesh: the bits of all that corners give them.
struct VertexKey {
  uint32_t position, color_of_material;
  uint32_t normal[3], texcoord[2];
  bool operator==(const VertexKey&) const = default;
};
struct VertexKeyHash {
  size_t operator()(const VertexKey& key) const {
    uint64_t hash = 0x9E3779B97F4A7C15u;
    for (const uint32_t part : {key.position, key.color_of_material, key.normal[0], key.normal[1], key.normal[2],
                                key.texcoord[0], key.texcoord[1]})
      hash = (hash ^ part) * 0xFF51AFD7ED558CCDu, hash ^= hash >> 32;
    return static_cast<size_t>(hash);
  }
};

class SceneBuilder {
 public:
  SceneBuilder(const ObjFile& file, const AssetSource& assets, LoadedScene& loaded)
      : file_(file), assets_(assets), loaded_(loaded), textures_(assets, loaded.scene, loaded.warnings) {}
  void run();

 private:
  void add_materials();
  void load_maps(MtlMaterial& source);
  void generate_normals();
  void add_face(const ObjFace& face);
  uint32_t vertex_of(uint32_t corner, uint32_t material);
  Vertex make_vertex(uint32_t corner, uint32_t material) const;

  const ObjFile& file_;
  const AssetSource& assets_;
  LoadedScene& loaded_;
  TextureLoader textures_;
  std::vector<MtlMaterial> sources_;  // parallel to the scene's materials
  std::vector<float> generated_;      // 3 a corner of the file; empty if every corner has its own
  std::unordered_map<VertexKey, uint32_t, VertexKeyHash> vertices_;
};

void SceneBuilder::run() {
  add_materials();
  generate_normals();
  for (const ObjFace& face : file_.faces) add_face(face);
  set_default_lights(loaded_.scene);
}

void SceneBuilder::add_materials() {
  const Libraries libraries(file_.libraries, assets_, loaded_.warnings);
  for (const std::string& name : file_.materials) {
    MtlMaterial source;
    if (const MtlMaterial* found = libraries.find(name); found != nullptr) {
      source = *found;
      load_maps(source);
    } else {
      source.material.ambient = source.material.diffuse = glm::vec3(file_.colors.empty() ? 0.8f : 1.0f);
      if (!name.empty()) {
        loaded_.warnings.push_back({"material is not defined: checker instead", name, 0});
        source.material.texture = textures_.missing();
      }
    }
    source.material.name = name;
    loaded_.scene.materials.push_back(source.material);
    sources_.push_back(std::move(source));
  }
}

// Maps other than the base texture are left out where they are missing.
void SceneBuilder::load_maps(MtlMaterial& source) {
  Material& material = source.material;
  const auto load = [&](const MtlMap& map) {
    const int32_t number = map.name.empty() ? -1 : textures_.load(map.name, map.offset);
    return number >= 0 && number == textures_.known_missing() ? -1 : number;
  };
  if (!source.base.name.empty()) material.texture = textures_.load(source.base.name, source.base.offset);
  material.specular_texture = load(source.specular);
  material.emission_texture = load(source.emission);
  if (!source.emission.name.empty() && material.emission_texture < 0) material.emission = glm::vec3(0.0f);
  if (!source.bump.name.empty()) {
    material.normal_texture = textures_.load_bump(source.bump.name, source.bump_scale, source.bump.offset);
    material.normal_scale = 1;
  }
  if (source.opacity.name.empty()) return;
  const int32_t with_alpha = textures_.load_opacity(material.texture, source.opacity.name, source.opacity.offset);
  if (with_alpha == material.texture) return;
  material.texture = with_alpha;
  const bool sharp = material.opacity == 1.0f && is_mask(loaded_.scene.textures[static_cast<size_t>(with_alpha)]);
  material.alpha = sharp ? AlphaMode::mask : AlphaMode::blend;
}

void SceneBuilder::generate_normals() {
  const bool needed = std::any_of(file_.corners.begin(), file_.corners.end(),
                                  [](const ObjCorner& corner) { return corner.normal == ObjCorner::kAbsent; });
  if (!needed) return;
  std::vector<uint32_t> corner_position;
  for (const ObjCorner& corner : file_.corners) corner_position.push_back(corner.position);
  std::vector<SmoothFace> faces;
  for (const ObjFace& face : file_.faces) faces.push_back({face.first, face.count, face.smoothing_group});
  generated_ = smooth_normals(file_.positions, corner_position, faces, file_.has_smoothing);
}

Vertex SceneBuilder::make_vertex(uint32_t corner, uint32_t material) const {
  const ObjCorner& source = file_.corners[corner];
  const MtlMaterial& look = sources_[material];
  Vertex vertex;
  std::copy_n(&file_.positions[size_t{3} * source.position], 3, vertex.position);
  if (source.normal == ObjCorner::kAbsent) {
    std::copy_n(&generated_[size_t{3} * corner], 3, vertex.normal);
  } else {
    const float* n = &file_.normals[size_t{3} * source.normal];
    const double length = std::sqrt(double{n[0]} * n[0] + double{n[1]} * n[1] + double{n[2]} * n[2]);
    for (int axis = 0; axis < 3 && length > 0; ++axis) vertex.normal[axis] = static_cast<float>(n[axis] / length);
  }
  if (source.texcoord != ObjCorner::kAbsent) {
    const float* t = &file_.texcoords[size_t{2} * source.texcoord];
    vertex.texcoord[0] = t[0] * look.texcoord_scale[0] + look.texcoord_offset[0];
    vertex.texcoord[1] = 1.0f - (t[1] * look.texcoord_scale[1] + look.texcoord_offset[1]);
    for (float& t_out : vertex.texcoord)
      if (!std::isfinite(t_out)) t_out = 0;
  }
  if (!file_.colors.empty()) std::copy_n(&file_.colors[size_t{4} * source.position], 4, vertex.color);
  if (!look.material.lit)  // unlit: the vertex color is final, so the material's goes into it
    for (int c = 0; c < 3; ++c)
      vertex.color[c] = static_cast<uint8_t>(vertex.color[c] * std::clamp(look.material.diffuse[c], 0.0f, 1.0f) + 0.5f);
  return vertex;
}

uint32_t SceneBuilder::vertex_of(uint32_t corner, uint32_t material) {
  const Vertex vertex = make_vertex(corner, material);
  VertexKey key = {};
  key.position = file_.corners[corner].position;
  key.color_of_material = loaded_.scene.materials[material].lit ? 0 : 1 + material;
  for (size_t i = 0; i < 3; ++i) key.normal[i] = std::bit_cast<uint32_t>(vertex.normal[i]);
  for (size_t i = 0; i < 2; ++i) key.texcoord[i] = std::bit_cast<uint32_t>(vertex.texcoord[i]);
  Mesh& mesh = loaded_.scene.mesh;
  const auto [entry, is_new] = vertices_.try_emplace(key, static_cast<uint32_t>(mesh.vertices.size()));
  if (is_new) mesh.vertices.push_back(vertex);
  return entry->second;
}

void SceneBuilder::add_face(const ObjFace& face) {
  Mesh& mesh = loaded_.scene.mesh;
  mesh.faces.push_back({static_cast<uint32_t>(mesh.indices.size()), face.count, face.material});
  for (uint32_t k = 0; k < face.count; ++k) mesh.indices.push_back(vertex_of(face.first + k, face.material));
}

}  // namespace

Result<LoadedScene> load_obj(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits) {
  LoadedScene loaded;
  PAC_TRY(const ObjFile file, parse_obj(bytes, limits, loaded.warnings));
  SceneBuilder(file, assets, loaded).run();
  return loaded;
}

}  // namespace pac::raster
