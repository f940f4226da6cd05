#include "raster/load_ply_header.h"

#include "raster/load_text.h"

namespace pac::raster {
namespace {

constexpr size_t kMaxElements = 64, kMaxProperties = 256;  // far above any real file

PlyType type_named(std::string_view name) {
  struct Entry {
    std::string_view name;
    PlyType type;
  };
  constexpr Entry kEntries[] = {
      {"char", PlyType::int8},      {"int8", PlyType::int8},       {"uchar", PlyType::uint8},
      {"uint8", PlyType::uint8},    {"short", PlyType::int16},     {"int16", PlyType::int16},
      {"ushort", PlyType::uint16},  {"uint16", PlyType::uint16},   {"int", PlyType::int32},
      {"int32", PlyType::int32},    {"uint", PlyType::uint32},     {"uint32", PlyType::uint32},
      {"float", PlyType::float32},  {"float32", PlyType::float32}, {"double", PlyType::float64},
      {"float64", PlyType::float64}};
  for (const Entry& entry : kEntries)
    if (entry.name == name) return entry.type;
  return PlyType::none;
}

const char* add_property(std::string_view text, PlyElement& element) {
  PlyProperty property;
  std::string_view word = take_word(text);
  if (word == "list") {
    property.count_type = type_named(take_word(text));
    if (property.count_type == PlyType::none || property.count_type >= PlyType::float32)
      return "element or property of an unknown type";
    word = take_word(text);
  }
  property.type = type_named(word);
  if (property.type == PlyType::none) return "element or property of an unknown type";
  property.name = std::string(take_word(text));
  if (property.name.empty() || element.properties.size() == kMaxProperties) return "malformed header line";
  if (element.find(property.name) >= 0) return "property appears twice";
  element.properties.push_back(property);
  return nullptr;
}

const char* add_element(std::string_view text, PlyHeader& header) {
  PlyElement element;
  element.name = std::string(take_word(text));
  int64_t count = 0;
  if (element.name.empty() || !parse_integer(take_word(text), count) || count < 0 ||
      header.elements.size() == kMaxElements)
    return "malformed header line";
  for (const PlyElement& other : header.elements)
    if (other.name == element.name) return "element appears twice";
  element.count = static_cast<uint64_t>(count);
  header.elements.push_back(element);
  return nullptr;
}

const char* set_format(std::string_view text, PlyHeader& header) {
  const std::string_view name = take_word(text);
  if (name == "ascii")
    header.format = PlyFormat::ascii;
  else if (name == "binary_little_endian")
    header.format = PlyFormat::little_endian;
  else if (name == "binary_big_endian")
    header.format = PlyFormat::big_endian;
  else
    return "malformed header line";
  return take_word(text) == "1.0" ? nullptr : "version of the PLY file is unknown";
}

}  // namespace

int PlyElement::find(std::string_view property_name) const {
  for (size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property_name) return static_cast<int>(i);
  return -1;
}

uint64_t PlyElement::least_bytes(PlyFormat format) const {
  uint64_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += format == PlyFormat::ascii ? 1 : size_of(property.is_list() ? property.count_type : property.type);
  return bytes;
}

Result<PlyHeader> parse_ply_header(std::span<const uint8_t> bytes) {
  LineReader lines(bytes, 0, false);
  if (!lines.next() || trimmed(lines.line()) != "ply") return Failure{Error::corrupt, 0, "not a PLY file"};
  PlyHeader header;
  bool has_format = false;
  while (lines.next()) {
    std::string_view rest = lines.line();
    const std::string_view keyword = take_word(rest);
    const char* fault = nullptr;
    if (keyword == "end_header") {
      header.data_offset = lines.end();
      if (!has_format) return Failure{Error::corrupt, lines.offset(), "header without a format"};
      return header;
    }
    if (keyword == "format") {
      fault = set_format(rest, header);
      has_format = true;
      if (fault != nullptr && fault[0] == 'v') return Failure{Error::unsupported, lines.offset(), fault};
    } else if (keyword == "element") {
      fault = add_element(rest, header);
    } else if (keyword == "property") {
      fault = header.elements.empty() ? "malformed header line" : add_property(rest, header.elements.back());
    } else if (keyword == "comment") {
      if (take_word(rest) == "TextureFile") header.texture_name = std::string(trimmed(rest));
    }  // else obj_info, or something that no reader needs: some writers forget "comment"
    if (fault != nullptr) return Failure{Error::corrupt, lines.offset(), fault};
  }
  return Failure{Error::truncated, bytes.size(), "header ends too early"};
}

}  // namespace pac::raster
