#include "raster/load_ply.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "raster/fit_camera.h"
#include "raster/load_gltf.h"
#include "raster/load_normals.h"
#include "raster/load_ply_header.h"
#include "raster/load_text.h"
#include "raster/load_texture.h"

namespace pac::raster {
namespace {

// One number after the other from the data of either format. Sticky: after a fault it delivers zeros.
class Values {
 public:
  Values(std::span<const uint8_t> bytes, size_t at, PlyFormat format) : bytes_(bytes), at_(at), format_(format) {}

  double next(PlyType type) { return format_ == PlyFormat::ascii ? next_word() : next_binary(type); }
  bool ok() const { return ok_; }
  const Failure& failure() const { return failure_; }
  size_t offset() const { return at_; }
  uint64_t bytes_left() const { return bytes_.size() - at_; }
  void fail(Error error, const char* text, size_t offset) {
    if (ok_) failure_ = {error, offset, text};
    ok_ = false;
  }

 private:
  double next_word() {
    const auto is_space = [](uint8_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
    while (at_ < bytes_.size() && is_space(bytes_[at_])) ++at_;
    const size_t begin = at_;
    while (at_ < bytes_.size() && !is_space(bytes_[at_])) ++at_;
    if (!ok_) return 0;
    if (begin == at_) return fail(Error::truncated, "data ends too early", begin), 0.0;
    const std::string_view word(reinterpret_cast<const char*>(bytes_.data()) + begin, at_ - begin);
    int64_t integer = 0;
    if (parse_integer(word, integer)) return static_cast<double>(integer);
    float number = 0;
    switch (parse_float(word, number)) {
      case NumberKind::finite:
        return number;
      case NumberKind::not_finite:
        return std::numeric_limits<double>::quiet_NaN();
      case NumberKind::malformed:
        break;
    }
    fail(Error::corrupt, "malformed number", begin);
    return 0;
  }

  double next_binary(PlyType type) {
    const size_t size = size_of(type);
    if (bytes_left() < size) return fail(Error::truncated, "data ends too early", at_), 0.0;
    uint64_t bits = 0;
    for (size_t i = 0; i < size; ++i)
      bits |= uint64_t{bytes_[at_ + i]} << 8 * (format_ == PlyFormat::big_endian ? size - 1 - i : i);
    at_ += size;
    switch (type) {
      case PlyType::int8:
        return static_cast<int8_t>(bits);
      case PlyType::int16:
        return static_cast<int16_t>(bits);
      case PlyType::int32:
        return static_cast<int32_t>(bits);
      case PlyType::float32:
        return std::bit_cast<float>(static_cast<uint32_t>(bits));
      case PlyType::float64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  std::span<const uint8_t> bytes_;
  size_t at_;
  const PlyFormat format_;
  bool ok_ = true;
  Failure failure_;
};

// A float from any number; not finite (or beyond float's range) = NaN.
float to_float(double value) {
  return std::fabs(value) <= double{std::numeric_limits<float>::max()} ? static_cast<float>(value)
                                                                       : std::numeric_limits<float>::quiet_NaN();
}

uint8_t color_from(double value, PlyType type) {
  if (!(value > 0)) return 0;
  if (type >= PlyType::float32) value *= 255;
  if (type == PlyType::int16 || type == PlyType::uint16) value /= 257;
  return static_cast<uint8_t>(std::min(value, 255.0) + 0.5);
}

class Loader {
 public:
  Loader(std::span<const uint8_t> bytes, PlyHeader header, const Limits& limits)
      : header_(std::move(header)), values_(bytes, header_.data_offset, header_.format), limits_(limits) {}
  Result<void> run(LoadedScene& loaded);
  bool has_colors() const { return has_colors_; }
  const std::string& texture_name() const { return header_.texture_name; }

 private:
  Result<void> read_vertices(const PlyElement& element, Mesh& mesh);
  Result<void> read_faces(const PlyElement& element, Mesh& mesh);
  Result<void> skip(const PlyElement& element);
  Result<void> check_indices(const Mesh& mesh) const;
  // A list's length, which the rest of the data can hold.
  uint64_t read_count(const PlyProperty& property);
  void skip_value(const PlyProperty& property);
  void make_normals(Mesh& mesh) const;

  const PlyHeader header_;
  Values values_;
  const Limits& limits_;
  std::vector<uint64_t> face_offset_;
  uint64_t n_small_faces_ = 0, n_triangles_ = 0;
  bool has_colors_ = false, has_normals_ = false;
};

uint64_t Loader::read_count(const PlyProperty& property) {
  const size_t offset = values_.offset();
  const double count = values_.next(property.count_type);
  if (!values_.ok()) return 0;
  if (!(count >= 0)) return values_.fail(Error::corrupt, "list with a negative length", offset), uint64_t{0};
  const double least = count * (header_.format == PlyFormat::ascii ? 1.0 : static_cast<double>(size_of(property.type)));
  if (least > static_cast<double>(values_.bytes_left()))
    return values_.fail(Error::truncated, "data ends too early", offset), uint64_t{0};
  return static_cast<uint64_t>(count);
}

void Loader::skip_value(const PlyProperty& property) {
  const uint64_t count = property.is_list() ? read_count(property) : 1;
  for (uint64_t i = 0; i < count && values_.ok(); ++i) values_.next(property.type);
}

Result<void> Loader::skip(const PlyElement& element) {
  if (element.properties.empty()) return {};
  for (uint64_t i = 0; i < element.count && values_.ok(); ++i)
    for (const PlyProperty& property : element.properties) skip_value(property);
  if (!values_.ok()) return values_.failure();
  return {};
}

// Where a vertex property goes: -1 = nowhere.
enum Slot : int { kPosition = 0, kNormal = 3, kTexcoord = 6, kColor = 8, kSlots = 12 };
int slot_of(const std::string& name) {
  struct Entry {
    const char* name;
    int slot;
  };
  constexpr Entry kEntries[] = {{"x", 0},
                                {"y", 1},
                                {"z", 2},
                                {"nx", 3},
                                {"ny", 4},
                                {"nz", 5},
                                {"s", 6},
                                {"t", 7},
                                {"u", 6},
                                {"v", 7},
                                {"red", 8},
                                {"green", 9},
                                {"blue", 10},
                                {"alpha", 11},
                                {"diffuse_red", 8},
                                {"diffuse_green", 9},
                                {"diffuse_blue", 10},
                                {"texture_u", 6},
                                {"texture_v", 7},
                                {"diffuse_alpha", 11}};
  for (const Entry& entry : kEntries)
    if (name == entry.name) return entry.slot;
  return -1;
}

Result<void> Loader::read_vertices(const PlyElement& element, Mesh& mesh) {
  for (const char* axis : {"x", "y", "z"}) {
    const int property = element.find(axis);
    if (property < 0 || element.properties[static_cast<size_t>(property)].is_list())
      return Failure{Error::corrupt, 0, "header without x, y and z"};
  }
  std::vector<int> slot;
  for (const PlyProperty& property : element.properties)
    slot.push_back(property.is_list() ? -1 : slot_of(property.name));
  has_normals_ = std::count(slot.begin(), slot.end(), kNormal) > 0;
  has_colors_ = std::count(slot.begin(), slot.end(), kColor) > 0;

  for (uint64_t i = 0; i < element.count; ++i) {
    const size_t offset = values_.offset();
    Vertex vertex;
    float value[kColor] = {0, 0, 0, 0, 0, 0, 0, 1};
    for (size_t p = 0; p < slot.size(); ++p) {
      if (slot[p] < 0) {
        skip_value(element.properties[p]);
        continue;
      }
      const PlyType type = element.properties[p].type;
      const double read = values_.next(type);
      if (slot[p] >= kColor)
        vertex.color[slot[p] - kColor] = color_from(read, type);
      else
        value[slot[p]] = to_float(read);
    }
    if (!values_.ok()) return values_.failure();
    for (int k = 0; k < kColor; ++k) {
      if (std::isfinite(value[k])) continue;
      if (k < kNormal) return Failure{Error::corrupt, offset, "number is not finite"};
      value[k] = 0;  // a normal or texture coordinate
    }
    std::copy_n(value, 3, vertex.position);
    const double length =
        std::sqrt(double{value[3]} * value[3] + double{value[4]} * value[4] + double{value[5]} * value[5]);
    for (int k = 0; k < 3 && length > 0; ++k) vertex.normal[k] = static_cast<float>(value[kNormal + k] / length);
    vertex.texcoord[0] = value[kTexcoord];
    vertex.texcoord[1] = 1.0f - value[kTexcoord + 1];
    mesh.vertices.push_back(vertex);
  }
  return {};
}

Result<void> Loader::read_faces(const PlyElement& element, Mesh& mesh) {
  int list = element.find("vertex_indices");
  if (list < 0) list = element.find("vertex_index");
  if (list < 0 || !element.properties[static_cast<size_t>(list)].is_list()) return skip(element);
  for (uint64_t i = 0; i < element.count; ++i) {
    const size_t offset = values_.offset();
    const size_t first = mesh.indices.size();
    for (size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (static_cast<int>(p) != list) {
        skip_value(property);
        continue;
      }
      const uint64_t count = read_count(property);
      for (uint64_t k = 0; k < count && values_.ok(); ++k) {
        const double index = values_.next(property.type);
        if (!(index >= 0 && index < 4294967295.0) && values_.ok())
          values_.fail(Error::corrupt, "index out of range", offset);
        if (values_.ok()) mesh.indices.push_back(static_cast<uint32_t>(index));
      }
    }
    if (!values_.ok()) return values_.failure();
    const size_t count = mesh.indices.size() - first;
    if (count < 3) {
      ++n_small_faces_;
      mesh.indices.resize(first);
      continue;
    }
    n_triangles_ += count - 2;
    if (n_triangles_ > limits_.max_triangles || mesh.indices.size() > 0xFFFFFFFFu)
      return Failure{Error::limit_exceeded, offset, "model has more triangles than the limit"};
    mesh.faces.push_back({static_cast<uint32_t>(first), static_cast<uint32_t>(count), 0});
    face_offset_.push_back(offset);
  }
  return {};
}

Result<void> Loader::check_indices(const Mesh& mesh) const {
  for (size_t f = 0; f < mesh.faces.size(); ++f)
    for (uint32_t k = 0; k < mesh.faces[f].count; ++k)
      if (mesh.indices[mesh.faces[f].first + k] >= mesh.vertices.size())
        return Failure{Error::corrupt, face_offset_[f], "index out of range"};
  return {};
}

// Corners at one vertex may get different normals: the vertex is then split.
void Loader::make_normals(Mesh& mesh) const {
  std::vector<float> positions;
  for (const Vertex& vertex : mesh.vertices) positions.insert(positions.end(), vertex.position, vertex.position + 3);
  std::vector<SmoothFace> faces;
  for (const Face& face : mesh.faces) faces.push_back({face.first, face.count, 0});
  const std::vector<float> normals = smooth_normals(positions, mesh.indices, faces, false);
  const auto n_vertices = static_cast<uint32_t>(mesh.vertices.size());
  std::vector<uint32_t> next_split(n_vertices, 0xFFFFFFFFu);  // the next vertex at the same position
  std::vector<uint8_t> has_normal(n_vertices, 0);
  for (size_t corner = 0; corner < mesh.indices.size(); ++corner) {
    const float* normal = &normals[3 * corner];
    uint32_t vertex = mesh.indices[corner];
    if (has_normal[vertex] == 0) {
      has_normal[vertex] = 1;
      std::copy_n(normal, 3, mesh.vertices[vertex].normal);
    }
    while (!std::equal(normal, normal + 3, mesh.vertices[vertex].normal) && next_split[vertex] != 0xFFFFFFFFu)
      vertex = next_split[vertex];
    if (!std::equal(normal, normal + 3, mesh.vertices[vertex].normal)) {
      next_split[vertex] = static_cast<uint32_t>(mesh.vertices.size());
      next_split.push_back(0xFFFFFFFFu);
      has_normal.push_back(1);
      Vertex split = mesh.vertices[vertex];
      std::copy_n(normal, 3, split.normal);
      vertex = next_split[vertex];
      mesh.vertices.push_back(split);
    }
    mesh.indices[corner] = vertex;
  }
}

Result<void> Loader::run(LoadedScene& loaded) {
  const bool has_faces = std::any_of(header_.elements.begin(), header_.elements.end(), [](const PlyElement& element) {
    return element.name == "face" && element.count > 0;
  });
  if (!has_faces) return Failure{Error::unsupported, 0, "no faces: point clouds are not drawn"};
  uint64_t least_bytes = 0;
  for (const PlyElement& element : header_.elements) {
    const uint64_t each = element.least_bytes(header_.format);
    if (each > 0 && element.count > (values_.bytes_left() - least_bytes) / each)
      return Failure{Error::truncated, header_.data_offset, "data ends too early"};
    least_bytes += each * element.count;
  }
  Mesh& mesh = loaded.scene.mesh;
  for (const PlyElement& element : header_.elements) {
    if (element.name == "vertex") {
      PAC_CHECK(read_vertices(element, mesh));
    } else if (element.name == "face") {
      PAC_CHECK(read_faces(element, mesh));
    } else {
      PAC_CHECK(skip(element));
    }
  }
  PAC_CHECK(check_indices(mesh));
  if (mesh.faces.empty()) return Failure{Error::unsupported, 0, "no faces: point clouds are not drawn"};
  if (n_small_faces_ > 0)
    loaded.warnings.push_back({"faces with fewer than three corners", std::to_string(n_small_faces_), 0});
  if (!has_normals_) make_normals(mesh);
  return {};
}

}  // namespace

Result<LoadedScene> load_ply(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits) {
  if (bytes.size() > limits.max_bytes) return Failure{Error::limit_exceeded, 0, "file is larger than the limit"};
  PAC_TRY(PlyHeader header, parse_ply_header(bytes));
  LoadedScene loaded;
  Loader loader(bytes, std::move(header), limits);
  PAC_CHECK(loader.run(loaded));
  Material material;
  material.name = "ply";
  if (!loader.texture_name().empty())
    material.texture = TextureLoader(assets, loaded.scene, loaded.warnings).load(loader.texture_name(), 0);
  if (loader.has_colors() || material.texture >= 0) material.diffuse = glm::vec3(1.0f);
  material.ambient = material.diffuse;
  loaded.scene.materials.push_back(material);
  set_default_lights(loaded.scene);
  return loaded;
}

Result<LoadedScene> load_model(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits) {
  if (bytes.size() >= 4 && bytes[0] == 'p' && bytes[1] == 'l' && bytes[2] == 'y' && bytes[3] <= ' ')
    return load_ply(bytes, assets, limits);
  if (is_gltf(bytes)) return load_gltf(bytes, assets, limits);
  return load_obj(bytes, assets, limits);
}

}  // namespace pac::raster
