// The GLB container [glTF 2.0 s.4.4], the JSON's top level, buffers from files, data URIs and the container.
#include "raster/load_gltf_file.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pac::raster {
namespace {

constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr size_t kHeaderBytes = 12, kChunkBytes = 8;

uint32_t u32_at(std::span<const uint8_t> bytes, size_t at) {
  return uint32_t{bytes[at]} | uint32_t{bytes[at + 1]} << 8 | uint32_t{bytes[at + 2]} << 16 |
         uint32_t{bytes[at + 3]} << 24;
}

struct Container {
  std::span<const uint8_t> json, binary;
  uint64_t json_offset = 0;
};

Result<Container> open_container(std::span<const uint8_t> bytes) {
  Container out;
  if (bytes.size() < 4 || u32_at(bytes, 0) != kGlbMagic) {
    out.json = bytes;
    return out;
  }
  if (bytes.size() < kHeaderBytes + kChunkBytes)
    return Failure{Error::truncated, bytes.size(), "GLB file ends inside its header"};
  if (u32_at(bytes, 4) != 2) return Failure{Error::unsupported, 4, "version of the GLB container is not 2"};
  const uint64_t length = u32_at(bytes, 8);
  if (length > bytes.size()) return Failure{Error::truncated, 8, "GLB file is shorter than its header says"};
  if (length < kHeaderBytes + kChunkBytes) return Failure{Error::corrupt, 8, "GLB length is less than its headers"};
  bool first = true;
  for (uint64_t at = kHeaderBytes; length - at >= kChunkBytes;) {
    const uint64_t size = u32_at(bytes, at);
    const uint32_t type = u32_at(bytes, at + 4);
    if (size > length - at - kChunkBytes) return Failure{Error::truncated, at, "GLB chunk is longer than the file"};
    const auto body = bytes.subspan(at + kChunkBytes, size);
    if (first && type != kJsonChunk) return Failure{Error::corrupt, at + 4, "first GLB chunk is not JSON"};
    if (first) {
      out.json = body;
      out.json_offset = at + kChunkBytes;
    } else if (type == kBinaryChunk && out.binary.data() == nullptr) {
      out.binary = body;
    }
    first = false;
    at += kChunkBytes + size;
  }
  return out;
}

// Extensions that change nothing where they are not understood, or that are.
constexpr std::string_view kUnderstood[] = {"KHR_lights_punctual", "KHR_materials_unlit", "KHR_mesh_quantization",
                                            "KHR_texture_transform"};

// Failures carry static texts: one for each extension that files require.
struct Refusal {
  std::string_view name;
  const char* text;
};
#define PAC_REFUSAL(name) \
  { name, "requires the extension " name }
constexpr Refusal kRefusals[] = {
    PAC_REFUSAL("KHR_draco_mesh_compression"),
    PAC_REFUSAL("EXT_meshopt_compression"),
    PAC_REFUSAL("KHR_meshopt_compression"),
    PAC_REFUSAL("KHR_texture_basisu"),
    PAC_REFUSAL("EXT_texture_webp"),
    PAC_REFUSAL("EXT_texture_avif"),
    PAC_REFUSAL("MSFT_texture_dds"),
    PAC_REFUSAL("KHR_materials_pbrSpecularGlossiness"),
    PAC_REFUSAL("KHR_techniques_webgl"),
    PAC_REFUSAL("KHR_materials_variants"),
    PAC_REFUSAL("KHR_materials_transmission"),
    PAC_REFUSAL("KHR_materials_clearcoat"),
    PAC_REFUSAL("KHR_materials_emissive_strength"),
    PAC_REFUSAL("KHR_animation_pointer"),
    PAC_REFUSAL("KHR_node_visibility"),
    PAC_REFUSAL("EXT_mesh_gpu_instancing"),
    PAC_REFUSAL("EXT_mesh_features"),
    PAC_REFUSAL("MSFT_lod"),
};
#undef PAC_REFUSAL

Result<void> check_extensions(const GltfFile& file) {
  for (const Json& name : file.root()["extensionsRequired"].elements()) {
    if (std::find(std::begin(kUnderstood), std::end(kUnderstood), name.text()) != std::end(kUnderstood)) continue;
    for (const Refusal& refusal : kRefusals)
      if (refusal.name == name.text()) return file.failure(Error::unsupported, name, refusal.text);
    return file.failure(Error::unsupported, name, "requires an unknown extension");
  }
  return {};
}

Result<void> list(const GltfFile& file, const char* key, std::vector<Json>& out) {
  const Json array = file.root()[key];
  if (!array.exists()) return {};
  if (!array.is_array()) return file.failure(Error::corrupt, array, "top-level property is not an array");
  out = array.elements();
  for (const Json& element : out)
    if (!element.is_object()) return file.failure(Error::corrupt, element, "element of a top-level array is no object");
  return {};
}

Result<void> load_buffer(GltfFile& file, const Json& buffer, bool first, const AssetSource& assets,
                         const Limits& limits) {
  PAC_TRY(const uint64_t length, get_integer(file, buffer, "byteLength", 0));
  if (length > limits.max_bytes) return file.failure(Error::limit_exceeded, buffer, "buffer is longer than the limit");
  std::span<const uint8_t> bytes;
  const Json uri = buffer["uri"];
  if (!uri.exists() && first && file.binary.data() != nullptr) {
    bytes = file.binary;
  } else if (!uri.is_string()) {
    return file.failure(Error::corrupt, buffer, "buffer without a URI");
  } else if (uri.text().starts_with("data:")) {
    file.loaded.push_back(decode_data_uri(uri.text()));
    bytes = file.loaded.back();
    if (bytes.empty() && length > 0) return file.failure(Error::corrupt, uri, "data URI is not base64");
  } else {
    if (!assets.read) return file.failure(Error::io, uri, "buffer's file cannot be read here");
    auto read = assets.read(decode_uri(uri.text()));
    if (!read.ok()) return file.failure(read.failure().error, uri, "buffer's file cannot be read");
    file.loaded.push_back(std::move(*read));
    bytes = file.loaded.back();
  }
  if (bytes.size() < length) return file.failure(Error::truncated, buffer, "buffer is shorter than its byteLength");
  file.buffers.push_back(bytes.first(length));
  return {};
}

int base64_value(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  return c == '+' ? 62 : c == '/' ? 63 : -1;
}

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

}  // namespace

Result<uint64_t> get_integer(const GltfFile& file, const Json& object, std::string_view key, uint64_t otherwise) {
  const Json value = object[key];
  if (!value.exists()) return otherwise;
  const double number = value.number(-1);
  if (!(number >= 0 && number <= 0x1p53) || number != std::floor(number))
    return file.failure(Error::corrupt, value, "not a whole number of at least 0");
  return static_cast<uint64_t>(number);
}

Result<uint32_t> get_index(const GltfFile& file, const Json& object, std::string_view key, size_t count) {
  PAC_TRY(const uint64_t number, get_integer(file, object, key, kNoIndex));
  if (!object[key].exists()) return kNoIndex;
  if (number >= count || number >= kNoIndex)
    return file.failure(Error::corrupt, object[key], "names something that the file does not have");
  return static_cast<uint32_t>(number);
}

Result<void> get_numbers(const GltfFile& file, const Json& object, std::string_view key, double* values, size_t count) {
  const Json array = object[key];
  if (!array.exists()) return {};
  const std::vector<Json> elements = array.elements();
  if (elements.size() != count) return file.failure(Error::corrupt, array, "array has another length than it must");
  for (size_t i = 0; i < count; ++i) {
    if (!elements[i].is_number()) return file.failure(Error::corrupt, elements[i], "not a number");
    values[i] = elements[i].number(0);
    if (!(std::fabs(values[i]) <= 1e30)) return file.failure(Error::corrupt, elements[i], "number is too large");
  }
  return {};
}

Bytes decode_data_uri(std::string_view uri) {
  constexpr std::string_view kMark = ";base64,";
  const size_t mark = uri.substr(0, 256).find(kMark);
  if (!uri.starts_with("data:") || mark == std::string_view::npos) return {};
  uri.remove_prefix(mark + kMark.size());
  while (uri.ends_with('=')) uri.remove_suffix(1);
  Bytes bytes;
  bytes.reserve(uri.size() / 4 * 3 + 3);
  uint32_t window = 0;
  int n_bits = 0;
  for (const char c : uri) {
    const int value = base64_value(c);
    if (value < 0) return {};
    window = (window << 6 | static_cast<uint32_t>(value)) & 0xFFFFFF;
    n_bits += 6;
    if (n_bits < 8) continue;
    n_bits -= 8;
    bytes.push_back(static_cast<uint8_t>(window >> n_bits & 0xFF));
  }
  return bytes;
}

std::string decode_uri(std::string_view uri) {
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_value(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_value(uri[i + 2]) : -1;
    if (low >= 0) i += 2;
    out += low >= 0 ? static_cast<char>(high * 16 + low) : uri[i];
  }
  return out;
}

Result<GltfFile> read_gltf_file(std::span<const uint8_t> bytes, const AssetSource& assets, const Limits& limits) {
  if (bytes.size() > limits.max_bytes) return Failure{Error::limit_exceeded, 0, "file is longer than the limit"};
  PAC_TRY(const Container container, open_container(bytes));
  GltfFile file;
  file.json_offset = container.json_offset;
  file.binary = container.binary;
  auto tree = parse_json(container.json);
  if (!tree.ok()) {
    Failure failure = tree.failure();
    failure.byte_offset += container.json_offset;
    return failure;
  }
  file.json = std::make_unique<const JsonTree>(std::move(*tree));
  if (!file.root().is_object()) return file.failure(Error::corrupt, file.root(), "JSON is not an object");
  const Json asset = file.root()["asset"];
  if (!asset["version"].is_string()) return file.failure(Error::corrupt, file.root(), "no asset version: not glTF 2.0");
  if (!asset["version"].text().starts_with("2."))
    return file.failure(Error::unsupported, asset["version"], "version of glTF is not 2");
  PAC_CHECK(check_extensions(file));
  std::vector<Json> buffers;
  PAC_CHECK(list(file, "buffers", buffers));
  PAC_CHECK(list(file, "bufferViews", file.views));
  PAC_CHECK(list(file, "accessors", file.accessors));
  PAC_CHECK(list(file, "meshes", file.meshes));
  PAC_CHECK(list(file, "nodes", file.nodes));
  PAC_CHECK(list(file, "materials", file.materials));
  PAC_CHECK(list(file, "textures", file.textures));
  PAC_CHECK(list(file, "images", file.images));
  PAC_CHECK(list(file, "samplers", file.samplers));
  PAC_CHECK(list(file, "cameras", file.cameras));
  file.loaded.reserve(buffers.size());  // spans into its elements stay valid
  for (size_t i = 0; i < buffers.size(); ++i) PAC_CHECK(load_buffer(file, buffers[i], i == 0, assets, limits));
  return file;
}

}  // namespace pac::raster
