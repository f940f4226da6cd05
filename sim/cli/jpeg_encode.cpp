// `pac jpeg encode`.
#include <cstdio>
#include <optional>

#include "jpeg/jpeg.h"
#include "jpeg/metadata.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"
#include "sim/cli/jpeg_tables.h"

namespace pac::cli {
namespace {

struct Request {
  std::string in, out, tables, sampling, metadata_from, comment;
  double quality = 75;
  int target_bytes = 0, restart = 0, dots_per_inch = 0;
  jpeg::Effort effort = jpeg::Effort::normal;
  jpeg::Tune tune = jpeg::Tune::visual;
  jpeg::Huffman huffman = jpeg::Huffman::optimal;
  jpeg::Subsampling subsampling = jpeg::Subsampling::yuv420;
};

struct CodedFile {
  Bytes bytes;
  double quality = 0;
};

void declare(Options& options, Request& request) {
  using jpeg::Effort, jpeg::Huffman, jpeg::Subsampling, jpeg::Tune;
  options.positional("IN", request.in, "PNG, PPM, PGM (or JPEG, to code again); - is stdin");
  options.text("-o|--output", "OUT.jpg", request.out, "the file; - is stdout", true);
  options.real("-q|--quality", "Q", request.quality, 0.01, 100, "IJG scale, real-valued (75)");
  options.choice<Subsampling>("--subsampling", request.subsampling,
                              {{"444", Subsampling::yuv444},
                               {"422", Subsampling::yuv422},
                               {"420", Subsampling::yuv420},
                               {"gray", Subsampling::gray}},
                              "of chroma (420)");
  options.choice<Tune>("--tune", request.tune,
                       {{"psnr", Tune::psnr}, {"ssim", Tune::ssim}, {"visual", Tune::visual}, {"hvs", Tune::hvs}},
                       "what the tables are made for (visual)");
  options.choice<Effort>(
      "--effort", request.effort, {{"fast", Effort::fast}, {"default", Effort::normal}, {"best", Effort::best}},
      "fast: standard Huffman; default: optimal Huffman, dead zone; best: tables for the picture, trellis");
  options.choice<Huffman>(
      "--huffman", request.huffman,
      {{"standard", Huffman::standard}, {"optimal", Huffman::optimal}, {"difference", Huffman::difference}},
      "Annex K.3's tables, made for the picture, or fixed ones for difference images; overrides "
      "--effort");
  options.text("--tables", "annex-k|adapted|FILE", request.tables,
               "instead of --effort's; FILE: 64 or 128 numbers, luma first, row order, which -q scales where given");
  options.integer("--restart", "MCUS", request.restart, 0, 65535, "restart interval (0 = none)");
  options.text("--sampling", "HxV,HxV,HxV", request.sampling,
               "sampling factors of Y, Cb and Cr, 1 to 4 each, instead of --subsampling: 4x1,1x1,1x1 is 4:1:1");
  options.text("--metadata-from", "FILE.jpg", request.metadata_from,
               "take over profile, Exif, XMP, comments and density");
  options.text("--comment", "TEXT", request.comment, "add a comment");
  options.integer("--dpi", "N", request.dots_per_inch, 1, 65535, "dots per inch");
  options.integer("--target-bytes", "N", request.target_bytes, 1, 2147483647, "the finest quality whose file fits");
}

// Reads the file that --tables names. kDone, or kBadData after the message.
int read_own_tables(const Options& options, const Request& request, jpeg::EncodeOptions& encode) {
  const auto text = read_file(request.tables);
  if (!text.ok()) return data_error(request.tables, text.failure());
  const auto tables = read_tables(*text);
  if (!tables.ok()) return data_error(request.tables, tables.failure());
  encode.tables = options.given("--quality") ? scale_tables(*tables, request.quality) : *tables;
  return kDone;
}

// "2x2,1x1,1x1".
std::optional<jpeg::SamplingFactors> parse_sampling(const std::string& text) {
  int h[3] = {}, v[3] = {};
  char rest = 0;
  if (std::sscanf(text.c_str(), "%1dx%1d,%1dx%1d,%1dx%1d%c", &h[0], &v[0], &h[1], &v[1], &h[2], &v[2], &rest) != 6)
    return {};
  jpeg::SamplingFactors factors;
  int n_blocks = 0;
  for (size_t i = 0; i < 3; ++i) {
    if (h[i] < 1 || h[i] > 4 || v[i] < 1 || v[i] > 4) return {};
    factors.h[i] = static_cast<uint8_t>(h[i]);
    factors.v[i] = static_cast<uint8_t>(v[i]);
    n_blocks += h[i] * v[i];
  }
  if (n_blocks > 10) return {};
  return factors;
}

// What the options say beside the picture. kDone, or kBadData after the message.
int make_metadata(const Request& request, jpeg::Metadata& metadata) {
  if (!request.metadata_from.empty()) {
    const auto bytes = read_file(request.metadata_from);
    if (!bytes.ok()) return data_error(request.metadata_from, bytes.failure());
    auto found = jpeg::read_metadata(*bytes);
    if (!found.ok()) return data_error(request.metadata_from, found.failure());
    metadata = std::move(found->metadata);
  }
  if (!request.comment.empty()) metadata.comments.push_back(request.comment);
  if (request.dots_per_inch > 0)
    metadata.density = {jpeg::Density::Unit::per_inch, request.dots_per_inch, request.dots_per_inch};
  return kDone;
}

int make_encode_options(const Options& options, const Request& request, jpeg::EncodeOptions& encode) {
  encode = jpeg::options_for(request.effort, request.tune, request.quality);
  encode.subsampling = request.subsampling;
  encode.restart_interval_mcus = request.restart;
  encode.threads = options.threads;
  encode.isa = options.isa;
  if (options.given("--sampling")) encode.sampling = parse_sampling(request.sampling);
  if (options.given("--huffman")) encode.huffman = request.huffman;
  if (request.tables.empty()) return kDone;
  if (request.tables == "annex-k") {
    encode.table_source = jpeg::TableSource::annex_k;
  } else if (request.tables == "adapted") {
    encode.table_source = jpeg::TableSource::adapted;
  } else {
    return read_own_tables(options, request, encode);
  }
  return kDone;
}

Result<CodedFile> code(const Request& request, ConstRgbView image, const jpeg::EncodeOptions& encode) {
  if (request.target_bytes == 0) {
    PAC_TRY(Bytes bytes, jpeg::encode(image, encode));
    return CodedFile{std::move(bytes), encode.quality};
  }
  PAC_TRY(jpeg::SizedFile sized, jpeg::encode_to_size(image, encode, static_cast<uint64_t>(request.target_bytes)));
  return CodedFile{std::move(sized.bytes), sized.quality};
}

int print_summary(const Options& options, const Request& request, const CodedFile& file, ConstRgbView image) {
  const double pixels = static_cast<double>(image.width) * image.height;
  const auto size = static_cast<double>(file.bytes.size());
  if (options.json) {
    sim::JsonWriter json;
    json.begin_object();
    json.field("bytes", uint64_t{file.bytes.size()});
    json.field("width", image.width);
    json.field("height", image.height);
    json.field("quality", file.quality);
    json.field("compression_ratio", 3 * pixels / size);
    json.field("bits_per_pixel", 8 * size / pixels);
    json.end_object();
    return print_json(json);
  }
  if (!options.quiet)
    std::fprintf(stderr, "%s: %s bytes, %.0f:1, %.3f bits a pixel, quality %.4g\n", request.out.c_str(),
                 grouped(file.bytes.size()).c_str(), 3 * pixels / size, 8 * size / pixels, file.quality);
  return kDone;
}

int encode_error(const Request& request, const Failure& failure) {
  if (failure.error == Error::out_of_space)
    return data_error(request.in, std::string("does not fit ") + std::to_string(request.target_bytes) +
                                      " bytes: the coarsest tables take " + std::to_string(failure.byte_offset));
  return data_error(request.in, failure);
}

}  // namespace

int run_jpeg_encode(Args args) {
  Options options("jpeg encode", "writes a baseline JPEG (JFIF) file", "pac jpeg encode room.png -q 15 -o room.jpg");
  Request request;
  declare(options, request);
  if (const auto exit = options.parse(args)) return *exit;
  if (options.given("--target-bytes") && options.given("--quality"))
    return options.usage_error("--target-bytes chooses the quality itself: leave -q out");
  if (options.given("--sampling") && !parse_sampling(request.sampling))
    return options.usage_error("--sampling is three factors HxV of 1..4 with at most 10 blocks in all: 2x2,1x1,1x1");
  if (options.json && request.out == "-") return options.usage_error("--json and -o - both want stdout");
  jpeg::EncodeOptions encode;
  if (const int exit = make_encode_options(options, request, encode); exit != kDone) return exit;
  jpeg::Metadata metadata;
  if (const int exit = make_metadata(request, metadata); exit != kDone) return exit;
  encode.metadata = &metadata;
  const auto image = read_picture(request.in, options.isa);
  if (!image) return kBadData;
  const auto file = code(request, image->view(), encode);
  if (!file.ok()) return encode_error(request, file.failure());
  if (const int exit = write_output(request.out, file->bytes); exit != kDone) return exit;
  return print_summary(options, request, *file, image->view());
}

}  // namespace pac::cli
