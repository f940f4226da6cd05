// Buffer views and accessors [glTF 2.0 s.3.6]: typed numbers out of bytes, with sparse replacements.
#include <cmath>
#include <cstring>

#include "raster/load_gltf_file.h"

namespace pac::raster {
namespace {

enum class Component : uint16_t {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126
};

size_t size_of(Component type) {
  switch (type) {
    case Component::int8:
    case Component::uint8:
      return 1;
    case Component::int16:
    case Component::uint16:
      return 2;
    default:
      return 4;
  }
}

Result<Component> get_component(const GltfFile& file, const Json& object) {
  PAC_TRY(const uint64_t code, get_integer(file, object, "componentType", 0));
  if (code < 5120 || code > 5126 || code == 5124) return file.failure(Error::corrupt, object, "unknown component type");
  return static_cast<Component>(code);
}

uint32_t little_endian(const uint8_t* p, size_t n) {
  uint32_t value = 0;
  for (size_t i = 0; i < n; ++i) value |= uint32_t{p[i]} << (8 * i);
  return value;
}

float component_value(const uint8_t* p, Component type, bool normalized) {
  const uint32_t bits = little_endian(p, size_of(type));
  switch (type) {
    case Component::int8:
      return normalized ? std::fmax(static_cast<float>(static_cast<int8_t>(bits)) / 127.0f, -1.0f)
                        : static_cast<float>(static_cast<int8_t>(bits));
    case Component::uint8:
      return static_cast<float>(bits) / (normalized ? 255.0f : 1.0f);
    case Component::int16:
      return normalized ? std::fmax(static_cast<float>(static_cast<int16_t>(bits)) / 32767.0f, -1.0f)
                        : static_cast<float>(static_cast<int16_t>(bits));
    case Component::uint16:
      return static_cast<float>(bits) / (normalized ? 65535.0f : 1.0f);
    case Component::uint32:
      return static_cast<float>(bits);
    default: {
      float value;
      std::memcpy(&value, &bits, sizeof value);
      return value;
    }
  }
}

struct Accessor {
  Json json;
  Component type = Component::float32;
  bool normalized = false;
  size_t width = 0, count = 0;
  size_t element_bytes() const { return width * size_of(type); }
};

size_t width_of(std::string_view type) {
  constexpr std::string_view kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  for (size_t i = 0; i < 4; ++i)
    if (type == kTypes[i]) return i + 1;
  return 0;
}

// `count` elements of `element_bytes` at a byte offset of a view; the distance between them goes to `stride`.
Result<const uint8_t*> locate(const GltfFile& file, const Json& where, uint32_t view_number, uint64_t offset,
                              uint64_t element_bytes, uint64_t count, size_t& stride) {
  PAC_TRY(const GltfView view, get_view(file, view_number));
  stride = view.stride != 0 ? view.stride : static_cast<size_t>(element_bytes);
  const uint64_t size = view.bytes.size();
  if (offset > size ||
      (count > 0 && (element_bytes > size - offset || (count - 1) > (size - offset - element_bytes) / stride)))
    return file.failure(Error::corrupt, where, "accessor reaches outside its buffer view");
  return view.bytes.data() + offset;
}

constexpr uint64_t kMostZeros = uint64_t{1} << 24;

Result<Accessor> get_accessor(const GltfFile& file, uint32_t number, const Limits& limits) {
  Accessor accessor;
  accessor.json = file.accessors[number];
  PAC_TRY(accessor.type, get_component(file, accessor.json));
  accessor.normalized = accessor.json["normalized"].boolean(false);
  accessor.width = width_of(accessor.json["type"].text());
  if (accessor.width == 0) return file.failure(Error::corrupt, accessor.json, "accessor has an unknown type");
  PAC_TRY(const uint64_t count, get_integer(file, accessor.json, "count", 0));
  // Before anything is allocated: no more elements than the bytes of the limit hold, and where there are bytes, no more
  // than those.
  if (count > kNoIndex || count > limits.max_bytes / 16)
    return file.failure(Error::limit_exceeded, accessor.json, "accessor has more elements than the limit");
  PAC_TRY(const uint32_t view, get_index(file, accessor.json, "bufferView", file.views.size()));
  PAC_TRY(const uint64_t offset, get_integer(file, accessor.json, "byteOffset", 0));
  size_t stride = 0;
  if (view != kNoIndex)
    PAC_CHECK(locate(file, accessor.json, view, offset, accessor.element_bytes(), count, stride));
  else if (count > kMostZeros)
    return file.failure(Error::limit_exceeded, accessor.json, "accessor without a buffer view has too many elements");
  accessor.count = static_cast<size_t>(count);
  return accessor;
}

// The sparse part [s.3.6.2.3]: for each replaced element its number and bytes.
template <class Store>
Result<void> replace_sparse(const GltfFile& file, const Accessor& accessor, Store store) {
  const Json sparse = accessor.json["sparse"];
  if (!sparse.exists()) return {};
  PAC_TRY(const uint64_t count, get_integer(file, sparse, "count", 0));
  if (count > accessor.count) return file.failure(Error::corrupt, sparse, "sparse accessor replaces more than it has");
  const Json indices = sparse["indices"], values = sparse["values"];
  PAC_TRY(const Component type, get_component(file, indices));
  if (type != Component::uint8 && type != Component::uint16 && type != Component::uint32)
    return file.failure(Error::corrupt, indices, "indices are not unsigned integers");
  PAC_TRY(const uint32_t index_view, get_index(file, indices, "bufferView", file.views.size()));
  PAC_TRY(const uint32_t value_view, get_index(file, values, "bufferView", file.views.size()));
  PAC_TRY(const uint64_t index_offset, get_integer(file, indices, "byteOffset", 0));
  PAC_TRY(const uint64_t value_offset, get_integer(file, values, "byteOffset", 0));
  if (index_view == kNoIndex || value_view == kNoIndex)
    return file.failure(Error::corrupt, sparse, "sparse accessor without a buffer view");
  size_t index_stride = 0, value_stride = 0;
  PAC_TRY(const uint8_t* index, locate(file, indices, index_view, index_offset, size_of(type), count, index_stride));
  PAC_TRY(const uint8_t* value,
          locate(file, values, value_view, value_offset, accessor.element_bytes(), count, value_stride));
  for (uint64_t i = 0; i < count; ++i) {
    const uint32_t at = little_endian(index + i * index_stride, size_of(type));
    if (at >= accessor.count) return file.failure(Error::corrupt, indices, "index out of range");
    store(at, value + i * value_stride);
  }
  return {};
}

// Calls store(element, bytes) for all elements; those of an accessor without a view stay as they are.
template <class Store>
Result<void> for_each_element(const GltfFile& file, const Accessor& accessor, Store store) {
  PAC_TRY(const uint32_t view, get_index(file, accessor.json, "bufferView", file.views.size()));
  PAC_TRY(const uint64_t offset, get_integer(file, accessor.json, "byteOffset", 0));
  if (view != kNoIndex) {
    size_t stride = 0;
    PAC_TRY(const uint8_t* bytes,
            locate(file, accessor.json, view, offset, accessor.element_bytes(), accessor.count, stride));
    for (size_t i = 0; i < accessor.count; ++i) store(i, bytes + i * stride);
  }
  return replace_sparse(file, accessor, store);
}

}  // namespace

Result<GltfView> get_view(const GltfFile& file, uint32_t number) {
  const Json json = file.views[number];
  for (const char* extension : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
    if (json["extensions"][extension].exists())
      return file.failure(Error::unsupported, json, "buffer view is compressed by EXT_meshopt_compression");
  PAC_TRY(const uint32_t buffer, get_index(file, json, "buffer", file.buffers.size()));
  if (buffer == kNoIndex) return file.failure(Error::corrupt, json, "buffer view without a buffer");
  PAC_TRY(const uint64_t offset, get_integer(file, json, "byteOffset", 0));
  PAC_TRY(const uint64_t length, get_integer(file, json, "byteLength", 0));
  PAC_TRY(const uint64_t stride, get_integer(file, json, "byteStride", 0));
  const auto bytes = file.buffers[buffer];
  if (offset > bytes.size() || length > bytes.size() - offset)
    return file.failure(Error::corrupt, json, "buffer view reaches outside its buffer");
  if (stride > 252) return file.failure(Error::corrupt, json, "stride is more than 252 bytes");
  return GltfView{bytes.subspan(offset, length), static_cast<size_t>(stride)};
}

Result<GltfFloats> read_floats(const GltfFile& file, uint32_t number, size_t least, size_t most, const Limits& limits) {
  PAC_TRY(const Accessor accessor, get_accessor(file, number, limits));
  if (accessor.width < least || accessor.width > most)
    return file.failure(Error::corrupt, accessor.json, "accessor has the wrong number of components");
  GltfFloats out{accessor.width, accessor.count, std::vector<float>(accessor.width * accessor.count)};
  bool finite = true;
  PAC_CHECK(for_each_element(file, accessor, [&](size_t element, const uint8_t* bytes) {
    for (size_t c = 0; c < accessor.width; ++c) {
      const float value = component_value(bytes + c * size_of(accessor.type), accessor.type, accessor.normalized);
      finite = finite && std::isfinite(value);
      out.values[element * accessor.width + c] = value;
    }
  }));
  if (!finite) return file.failure(Error::corrupt, accessor.json, "number is not finite");
  return out;
}

Result<std::vector<uint32_t>> read_indices(const GltfFile& file, uint32_t number, const Limits& limits) {
  PAC_TRY(const Accessor accessor, get_accessor(file, number, limits));
  if (accessor.width != 1 ||
      (accessor.type != Component::uint8 && accessor.type != Component::uint16 && accessor.type != Component::uint32))
    return file.failure(Error::corrupt, accessor.json, "indices are not unsigned integers");
  std::vector<uint32_t> out(accessor.count);
  PAC_CHECK(for_each_element(file, accessor, [&](size_t element, const uint8_t* bytes) {
    out[element] = little_endian(bytes, size_of(accessor.type));
  }));
  return out;
}

}  // namespace pac::raster
