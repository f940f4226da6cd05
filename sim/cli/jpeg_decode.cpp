// `pac jpeg decode`.
#include <cstdio>
#include <optional>

#include "jpeg/jpeg.h"
#include "jpeg/metadata.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"

namespace pac::cli {
namespace {

// "640x480+16+32" as X geometries have it: width, height, and where the left upper pixel is.
std::optional<jpeg::Crop> parse_crop(const std::string& text) {
  jpeg::Crop crop;
  char rest = 0;
  const int n = std::sscanf(text.c_str(), "%6dx%6d+%6d+%6d%c", &crop.width, &crop.height, &crop.x, &crop.y, &rest);
  if (n != 4 || crop.width < 1 || crop.height < 1 || crop.x < 0 || crop.y < 0) return {};
  return crop;
}

int print_summary(const Options& options, const RgbImage& image) {
  if (!options.json) return kDone;
  sim::JsonWriter json;
  json.begin_object();
  json.field("width", image.width());
  json.field("height", image.height());
  json.end_object();
  return print_json(json);
}

int write_profile(const std::string& in, const std::string& out, std::span<const uint8_t> bytes) {
  const auto found = jpeg::read_metadata(bytes);
  if (!found.ok()) return data_error(in, found.failure());
  if (found->metadata.icc_profile.empty()) return data_error(in, "holds no whole color profile");
  return write_output(out, found->metadata.icc_profile);
}

// What could be read is written, then the damage is reported as in strict mode.
int decode_damaged(const Options& options, const std::string& in, const std::string& out,
                   std::span<const uint8_t> bytes, const jpeg::DecodeOptions& decode) {
  const auto decoded = jpeg::decode_lenient(bytes, decode);
  if (!decoded.ok()) return data_error(in, decoded.failure());
  if (const int code = write_picture(out, decoded->image.view()); code != kDone) return code;
  if (decoded->failure) return data_error(in, *decoded->failure);
  return print_summary(options, decoded->image);
}

}  // namespace

int run_jpeg_decode(Args args) {
  Options options("jpeg decode", "writes a JPEG file's picture as PNG, PPM or PGM",
                  "pac jpeg decode room.jpg -o room-decoded.png");
  std::string in, out, crop, icc;
  bool lenient = false;
  jpeg::DecodeOptions decode;
  options.positional("IN.jpg", in, "- is stdin");
  options.text("-o|--output", "OUT", out, ".ppm, .pgm (luma) or .png; - is stdout (PNG)", true);
  options.flag("--lenient", lenient, "write what a damaged file holds; the exit code is 1 still");
  options.choice<int>("--scale", decode.scale_denominator, {{"1", 1}, {"1/2", 2}, {"1/4", 4}, {"1/8", 8}},
                      "of the sides, rounded up (1)");
  options.text("--icc", "FILE", icc, "write the color profile, too");
  options.text("--crop", "WxH+X+Y", crop, "only that part of the (scaled) picture; what follows it is not read");
  if (const auto code = options.parse(args)) return *code;
  decode.isa = options.isa;
  decode.threads = options.threads;
  if (options.given("--crop")) {
    decode.crop = parse_crop(crop);
    if (!decode.crop) return options.usage_error("--crop is WxH+X+Y, for example 640x480+16+32");
  }
  if (options.json && out == "-") return options.usage_error("--json and -o - both want stdout");
  if (const std::string problem = picture_name_problem(out); !problem.empty()) return options.usage_error(problem);
  const auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  if (!icc.empty())
    if (const int code = write_profile(in, icc, *bytes); code != kDone) return code;
  if (lenient) return decode_damaged(options, in, out, *bytes, decode);
  const auto image = jpeg::decode(*bytes, decode);
  if (!image.ok()) return data_error(in, image.failure());
  if (const int code = write_picture(out, image->view()); code != kDone) return code;
  return print_summary(options, *image);
}

}  // namespace pac::cli
