// `pac jpeg transcode`: another file of the same coefficients.
#include <cstdio>

#include "jpeg/coefficient_io.h"
#include "jpeg/metadata.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"

namespace pac::cli {
namespace {

int print_summary(const Options& options, const std::string& out, uint64_t before, uint64_t after, int warnings) {
  if (options.json) {
    sim::JsonWriter json;
    json.begin_object();
    json.field("bytes_in", before);
    json.field("bytes", after);
    json.field("warnings", warnings);
    json.end_object();
    return print_json(json);
  }
  if (!options.quiet)
    std::fprintf(stderr, "%s: %s bytes, were %s\n", out.c_str(), grouped(after).c_str(), grouped(before).c_str());
  return kDone;
}

}  // namespace

int run_jpeg_transcode(Args args) {
  Options options("jpeg transcode", "writes a JPEG file again as baseline, without going to pixels",
                  "pac jpeg transcode room.jpg --restart 8 -o room-restarts.jpg");
  std::string in, out;
  bool drop_metadata = false, lenient = false;
  double quality = 75;
  jpeg::CoefficientWriteOptions write;
  options.positional("IN.jpg", in, "baseline or progressive; - is stdin");
  options.text("-o|--output", "OUT.jpg", out, "the file, of exactly the same picture; - is stdout", true);
  options.real("-q|--quality", "Q", quality, 0.01, 100, "requantize to Annex K's tables at that quality: not lossless");
  options.choice<jpeg::Huffman>("--huffman", write.huffman,
                                {{"standard", jpeg::Huffman::standard},
                                 {"optimal", jpeg::Huffman::optimal},
                                 {"difference", jpeg::Huffman::difference}},
                                "Annex K.3's tables, made for the picture, or fixed ones for difference images "
                                "(optimal)");
  options.integer("--restart", "MCUS", write.restart_interval_mcus, 0, 65535, "restart interval (0 = none)");
  options.flag("--drop-metadata", drop_metadata, "leave out profile, Exif, XMP, comments and density");
  options.flag("--lenient", lenient, "make a sound file of what a damaged one holds; the exit code is 1 still");
  if (const auto code = options.parse(args)) return *code;
  if (options.json && out == "-") return options.usage_error("--json and -o - both want stdout");
  const auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  jpeg::DecodeOptions decode;
  decode.isa = options.isa;
  auto read = jpeg::read_coefficients(*bytes, decode, lenient);
  if (!read.ok()) return data_error(in, read.failure());
  const auto found = jpeg::read_metadata(*bytes);
  if (!found.ok()) return data_error(in, found.failure());
  if (!drop_metadata) write.metadata = &found->metadata;
  if (options.given("--quality")) jpeg::requantize(read->image, jpeg::annex_k_tables(quality));
  const auto file = jpeg::write_coefficients(read->image, write);
  if (!file.ok()) return data_error(in, file.failure());
  if (const int code = write_output(out, *file); code != kDone) return code;
  if (read->failure) return data_error(in, *read->failure);
  return print_summary(options, out, bytes->size(), file->size(), read->warnings + found->warnings);
}

}  // namespace pac::cli
