// `pac jpeg info`: what the headers say.
#include <cstdio>

#include "jpeg/jpeg.h"
#include "jpeg/metadata.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"

namespace pac::cli {
namespace {

const char* marker_name(uint8_t code) {
  switch (code) {
    case 0xD8:
      return "SOI";
    case 0xD9:
      return "EOI";
    case 0xDA:
      return "SOS";
    case 0xDB:
      return "DQT";
    case 0xC4:
      return "DHT";
    case 0xCC:
      return "DAC";
    case 0xDD:
      return "DRI";
    case 0xDC:
      return "DNL";
    case 0xFE:
      return "COM";
    default:
      return code >= 0xE0 && code <= 0xEF ? "APP" : code >= 0xC0 && code <= 0xCF ? "SOF" : "?";
  }
}

std::string marker_text(uint8_t code) {
  std::string text = marker_name(code);
  if (text == "APP") text += std::to_string(code - 0xE0);
  if (text == "SOF") text += std::to_string(code - 0xC0);
  return text;
}

const char* color_name(jpeg::ColorModel color) {
  constexpr const char* kNames[] = {"gray", "YCbCr", "RGB", "CMYK", "YCCK", "unknown"};
  return kNames[static_cast<size_t>(color)];
}

const char* process_name(uint8_t start_of_frame) {
  switch (start_of_frame) {
    case 0xC0:
      return "baseline sequential";
    case 0xC1:
      return "extended sequential, Huffman";
    case 0xC2:
      return "progressive, Huffman";
    case 0xC3:
      return "lossless, Huffman";
    case 0xC9:
      return "extended sequential, arithmetic";
    case 0xCA:
      return "progressive, arithmetic";
    case 0xCB:
      return "lossless, arithmetic";
    default:
      return "hierarchical";
  }
}

// The bytes of a comment as printable text.
std::string comment_text(std::span<const uint8_t> file, const jpeg::ByteRange& range) {
  std::string text;
  for (const uint8_t byte : file.subspan(range.offset, range.size))
    text += byte >= 0x20 && byte < 0x7F ? static_cast<char>(byte) : '.';
  return text;
}

void print_table(int index, const jpeg::QuantTable& table) {
  std::printf("quantization table %d\n", index);
  for (size_t row = 0; row < 8; ++row) {
    std::printf("   ");
    for (size_t column = 0; column < 8; ++column) std::printf(" %4d", table[8 * row + column]);
    std::printf("\n");
  }
}

void print_info(const jpeg::Info& info, const jpeg::Metadata& metadata, std::span<const uint8_t> file) {
  std::printf("size              %d x %d pixels, %zu bytes\n", info.width, info.height, file.size());
  std::printf("process           %s, %d bits\n", process_name(info.start_of_frame), info.precision_bits);
  std::printf("color             %s", color_name(info.color));
  for (const jpeg::ComponentInfo& component : info.components)
    std::printf("  %d: %dx%d, table %d", component.id, component.horizontal_sampling, component.vertical_sampling,
                component.quant_table);
  std::printf("\nestimated quality %.1f\n", info.estimated_quality);
  if (info.restart_interval_mcus > 0) std::printf("restart interval  %d MCUs\n", info.restart_interval_mcus);
  if (info.default_huffman) std::printf("Huffman tables    none: Annex K.3's are meant\n");
  if (info.jfif)
    std::printf("JFIF density      %d x %d %s\n", info.density_x, info.density_y,
                info.density_units == 1   ? "per inch"
                : info.density_units == 2 ? "per cm"
                                          : "(aspect ratio)");
  if (info.adobe_transform >= 0) std::printf("Adobe transform   %d\n", info.adobe_transform);
  if (info.exif_orientation > 0) std::printf("Exif orientation  %d (not applied)\n", info.exif_orientation);
  if (!metadata.icc_profile.empty())
    std::printf("ICC profile       %s bytes (not applied)\n", grouped(metadata.icc_profile.size()).c_str());
  else if (info.has_icc_profile)
    std::printf("ICC profile       broken\n");
  if (!metadata.exif.empty()) std::printf("Exif              %s bytes\n", grouped(metadata.exif.size()).c_str());
  if (!metadata.xmp.empty()) std::printf("XMP               %s bytes\n", grouped(metadata.xmp.size()).c_str());
  for (const jpeg::ByteRange& comment : info.comments)
    std::printf("comment           %s\n", comment_text(file, comment).c_str());
  if (info.unsupported != nullptr) std::printf("cannot be decoded %s\n", info.unsupported);
  std::printf("headers           %s bytes\n\nmarker  offset  parameter bytes\n", grouped(info.header_bytes).c_str());
  for (const jpeg::MarkerInfo& marker : info.markers)
    std::printf("%-6s %7llu  %u\n", marker_text(marker.code).c_str(), static_cast<unsigned long long>(marker.offset),
                marker.size_bytes);
  std::printf("\n");
  for (int i = 0; i < 4; ++i)
    if (info.quant_tables[static_cast<size_t>(i)]) print_table(i, *info.quant_tables[static_cast<size_t>(i)]);
}

void json_components(sim::JsonWriter& json, const jpeg::Info& info) {
  json.begin_array("components");
  for (const jpeg::ComponentInfo& component : info.components) {
    json.begin_object();
    json.field("id", int{component.id});
    json.field("horizontal_sampling", int{component.horizontal_sampling});
    json.field("vertical_sampling", int{component.vertical_sampling});
    json.field("quant_table", int{component.quant_table});
    json.end_object();
  }
  json.end_array();
}

void json_tables_and_markers(sim::JsonWriter& json, const jpeg::Info& info) {
  json.begin_array("quant_tables");
  for (const auto& table : info.quant_tables) {
    if (!table) {
      json.null();
      continue;
    }
    json.begin_array();
    for (const uint16_t step : *table) json.value(int{step});
    json.end_array();
  }
  json.end_array();
  json.begin_array("markers");
  for (const jpeg::MarkerInfo& marker : info.markers) {
    json.begin_object();
    json.field("name", marker_text(marker.code));
    json.field("offset", marker.offset);
    json.field("size_bytes", marker.size_bytes);
    json.end_object();
  }
  json.end_array();
}

int print_info_json(const jpeg::Info& info, const jpeg::Metadata& metadata, std::span<const uint8_t> file) {
  sim::JsonWriter json;
  json.begin_object();
  json.field("bytes", uint64_t{file.size()});
  json.field("width", info.width);
  json.field("height", info.height);
  json.field("precision_bits", info.precision_bits);
  json.field("process", process_name(info.start_of_frame));
  json.field("color", color_name(info.color));
  json_components(json, info);
  json.field("estimated_quality", info.estimated_quality);
  json.field("restart_interval_mcus", info.restart_interval_mcus);
  json.field("default_huffman", info.default_huffman);
  json.field("jfif", info.jfif);
  json.field("density_units", info.density_units);
  json.field("density_x", info.density_x);
  json.field("density_y", info.density_y);
  json.field("adobe_transform", info.adobe_transform);
  json.field("exif_orientation", info.exif_orientation);
  json.field("has_icc_profile", info.has_icc_profile);
  json.field("icc_profile_bytes", uint64_t{metadata.icc_profile.size()});
  json.field("exif_bytes", uint64_t{metadata.exif.size()});
  json.field("xmp_bytes", uint64_t{metadata.xmp.size()});
  json.begin_array("comments");
  for (const jpeg::ByteRange& comment : info.comments) json.value(comment_text(file, comment));
  json.end_array();
  json.key("unsupported");
  if (info.unsupported == nullptr)
    json.null();
  else
    json.value(info.unsupported);
  json.field("header_bytes", info.header_bytes);
  json_tables_and_markers(json, info);
  json.end_object();
  return print_json(json);
}

}  // namespace

int run_jpeg_info(Args args) {
  Options options("jpeg info", "markers, frame, tables, estimated quality, metadata; never touches entropy data",
                  "pac jpeg info room.jpg");
  std::string in;
  options.positional("IN.jpg", in, "- is stdin");
  if (const auto code = options.parse(args)) return *code;
  const auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  const auto info = jpeg::read_info(*bytes);
  if (!info.ok()) return data_error(in, info.failure());
  const auto found = jpeg::read_metadata(*bytes);
  if (!found.ok()) return data_error(in, found.failure());
  if (options.json) return print_info_json(*info, found->metadata, *bytes);
  print_info(*info, found->metadata, *bytes);
  return kDone;
}

}  // namespace pac::cli
