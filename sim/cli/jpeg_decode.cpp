// `pac jpeg decode`.
#include <cstdio>

#include "jpeg/jpeg.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"

namespace pac::cli {
namespace {

jpeg::DecodeOptions decode_options(const Options& options) {
  jpeg::DecodeOptions decode;
  decode.isa = options.isa;
  decode.threads = options.threads;
  return decode;
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

// What could be read is written, then the damage is reported as in strict mode.
int decode_damaged(const Options& options, const std::string& in, const std::string& out,
                   std::span<const uint8_t> bytes) {
  const auto decoded = jpeg::decode_lenient(bytes, decode_options(options));
  if (!decoded.ok()) return data_error(in, decoded.failure());
  if (const int code = write_picture(out, decoded->image.view()); code != kDone) return code;
  if (decoded->failure) return data_error(in, *decoded->failure);
  return print_summary(options, decoded->image);
}

}  // namespace

int run_jpeg_decode(Args args) {
  Options options("jpeg decode", "writes a JPEG file's picture as PNG, PPM or PGM",
                  "pac jpeg decode room.jpg -o room-decoded.png");
  std::string in, out;
  bool lenient = false;
  options.positional("IN.jpg", in, "- is stdin");
  options.text("-o|--output", "OUT", out, ".ppm, .pgm (luma) or .png; - is stdout (PNG)", true);
  options.flag("--lenient", lenient, "write what a damaged file holds; the exit code is 1 still");
  if (const auto code = options.parse(args)) return *code;
  if (options.json && out == "-") return options.usage_error("--json and -o - both want stdout");
  if (const std::string problem = picture_name_problem(out); !problem.empty()) return options.usage_error(problem);
  const auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  if (lenient) return decode_damaged(options, in, out, *bytes);
  const auto image = jpeg::decode(*bytes, decode_options(options));
  if (!image.ok()) return data_error(in, image.failure());
  if (const int code = write_picture(out, image->view()); code != kDone) return code;
  return print_summary(options, *image);
}

}  // namespace pac::cli
