// `pac jpeg encode`.
#include <cstdio>
#include <optional>

#include "base/metrics.h"
#include "jpeg/jpeg.h"
#include "sim/cli/command.h"
#include "sim/cli/image_files.h"
#include "sim/cli/jpeg_tables.h"
#include "sim/cli/size_search.h"

namespace pac::cli {
namespace {

// What --tune measures when it chooses between families of tables.
enum class TuneChoice : uint8_t { none, psnr, ssim, visual };

struct Request {
  std::string in, out, tables;
  double quality = 75;
  int target_bytes = 0;
  jpeg::Effort effort = jpeg::Effort::normal;
  TuneChoice tune = TuneChoice::none;
  jpeg::EncodeOptions encode;
  std::optional<TableSource> own_tables;  // of the file that `tables` names
};

// A family of tables and the file that it gives.
struct Candidate {
  const char* family = "";
  CodedFile file;
};

double score(TuneChoice tune, ConstRgbView image, const CodedFile& file, Isa isa) {
  const auto decoded = jpeg::decode(file.bytes, {}, isa);
  if (!decoded.ok()) return -1e9;
  if (tune == TuneChoice::psnr) return -mean_squared_error(image, decoded->view());
  return tune == TuneChoice::ssim ? ssim_luma(image, decoded->view()) : ms_ssim_luma(image, decoded->view());
}

EncodeAtQuality encoder_of(const Request& request, const TableSource& tables, ConstRgbView image) {
  return [&request, &tables, image](double quality) {
    jpeg::EncodeOptions options = request.encode;
    options.tables = tables.at_quality(quality);
    return jpeg::encode(image, options);
  };
}

// One family: at the quality asked for, or the best that fits.
Result<CodedFile> code_with(const Request& request, const TableSource& tables, ConstRgbView image, int64_t max_bytes) {
  const EncodeAtQuality encode = encoder_of(request, tables, image);
  if (max_bytes > 0) return finest_that_fits(encode, tables.step_qualities(), static_cast<uint64_t>(max_bytes));
  PAC_TRY(auto bytes, encode(request.quality));
  return CodedFile{std::move(bytes), request.quality};
}

Result<TableSource> tables_for(const Request& request, ConstRgbView image) {
  if (request.own_tables) return *request.own_tables;
  const auto family = request.tables == "adapted" ? sim::TableFamily::adapted : sim::TableFamily::annex_k;
  return TableSource::family(family, image, request.encode.subsampling);
}

// Both families at the size of the first, and the one that scores better.
Result<Candidate> tuned(const Request& request, ConstRgbView image) {
  const auto family = [&](sim::TableFamily which) {
    return TableSource::family(which, image, request.encode.subsampling);
  };
  PAC_TRY(const TableSource annex_k, family(sim::TableFamily::annex_k));
  PAC_TRY(CodedFile plain, code_with(request, annex_k, image, request.target_bytes));
  PAC_TRY(const TableSource adapted, family(sim::TableFamily::adapted));
  auto rival = code_with(request, adapted, image, static_cast<int64_t>(plain.bytes.size()));
  const Isa isa = request.encode.isa;
  if (rival.ok() && score(request.tune, image, *rival, isa) > score(request.tune, image, plain, isa))
    return Candidate{adapted.name(), std::move(rival).value()};
  return Candidate{annex_k.name(), std::move(plain)};
}

Result<Candidate> encode_picture(const Request& request, ConstRgbView image) {
  if (request.tune != TuneChoice::none) return tuned(request, image);
  PAC_TRY(const TableSource tables, tables_for(request, image));
  PAC_TRY(CodedFile file, code_with(request, tables, image, request.target_bytes));
  return Candidate{tables.name(), std::move(file)};
}

int print_summary(const Options& options, const Request& request, const Candidate& made, ConstRgbView image) {
  const double pixels = static_cast<double>(image.width) * image.height;
  const auto size = static_cast<double>(made.file.bytes.size());
  if (options.json) {
    sim::JsonWriter json;
    json.begin_object();
    json.field("bytes", uint64_t{made.file.bytes.size()});
    json.field("width", image.width);
    json.field("height", image.height);
    json.field("quality", made.file.quality);
    json.field("tables", made.family);
    json.field("compression_ratio", 3 * pixels / size);
    json.field("bits_per_pixel", 8 * size / pixels);
    json.end_object();
    return print_json(json);
  }
  if (!options.quiet)
    std::fprintf(stderr, "%s: %s bytes, %.0f:1, %.3f bits a pixel, quality %.4g, %s tables\n", request.out.c_str(),
                 grouped(made.file.bytes.size()).c_str(), 3 * pixels / size, 8 * size / pixels, made.file.quality,
                 made.family);
  return kDone;
}

void declare(Options& options, Request& request) {
  using jpeg::Effort, jpeg::Huffman, jpeg::Subsampling;
  options.positional("IN", request.in, "PNG, PPM, PGM (or JPEG, to code again); - is stdin");
  options.text("-o|--output", "OUT.jpg", request.out, "the file; - is stdout", true);
  options.real("-q|--quality", "Q", request.quality, 0.01, 100, "IJG scale, real-valued (75)");
  options.choice<Subsampling>("--subsampling", request.encode.subsampling,
                              {{"444", Subsampling::yuv444},
                               {"422", Subsampling::yuv422},
                               {"420", Subsampling::yuv420},
                               {"gray", Subsampling::gray}},
                              "of chroma (420)");
  options.choice<TuneChoice>(
      "--tune", request.tune, {{"psnr", TuneChoice::psnr}, {"ssim", TuneChoice::ssim}, {"visual", TuneChoice::visual}},
      "code with each family of tables at the same size and keep the one with the best PSNR, SSIM or MS-SSIM");
  options.choice<Effort>("--effort", request.effort,
                         {{"fast", Effort::fast}, {"default", Effort::normal}, {"best", Effort::best}},
                         "fast: standard Huffman; default: optimal Huffman; best: adapted tables as well");
  options.choice<Huffman>("--huffman", request.encode.huffman,
                          {{"standard", Huffman::standard}, {"optimal", Huffman::optimal}},
                          "Annex K.3's tables, or made for the picture; overrides --effort");
  options.text("--tables", "annex-k|adapted|FILE", request.tables,
               "FILE: 64 numbers for luma and 64 for chroma, row order; -q then scales them");
  options.integer("--restart", "MCUS", request.encode.restart_interval_mcus, 0, 65535, "restart interval (0 = none)");
  options.integer("--target-bytes", "N", request.target_bytes, 1, 2147483647, "the finest quality whose file fits");
}

void apply_effort(const Options& options, Request& request) {
  if (!options.given("--huffman"))
    request.encode.huffman = request.effort == jpeg::Effort::fast ? jpeg::Huffman::standard : jpeg::Huffman::optimal;
  if (request.tables.empty()) request.tables = request.effort == jpeg::Effort::best ? "adapted" : "annex-k";
}

// Reads the file that --tables names; kDone, or the code after the message. Without -q its tables stay as they are.
int read_own_tables(const Options& options, Request& request) {
  if (request.tables == "annex-k" || request.tables == "adapted") return kDone;
  const auto text = read_file(request.tables);
  if (!text.ok()) return data_error(request.tables, text.failure());
  auto tables = TableSource::from_text(*text);
  if (!tables.ok()) return data_error(request.tables, tables.failure());
  request.own_tables = std::move(tables).value();
  if (!options.given("--quality")) request.quality = 50;
  return kDone;
}

}  // namespace

int run_jpeg_encode(Args args) {
  Options options("jpeg encode", "writes a baseline JPEG (JFIF) file", "pac jpeg encode room.png -q 15 -o room.jpg");
  Request request;
  declare(options, request);
  if (const auto code = options.parse(args)) return *code;
  if (options.given("--tune") && options.given("--tables"))
    return options.usage_error("--tune chooses the tables itself: leave --tables out");
  if (options.given("--target-bytes") && options.given("--quality"))
    return options.usage_error("--target-bytes chooses the quality itself: leave -q out");
  if (options.json && request.out == "-") return options.usage_error("--json and -o - both want stdout");
  apply_effort(options, request);
  request.encode.isa = options.isa;
  if (const int code = read_own_tables(options, request); code != kDone) return code;
  const auto image = read_picture(request.in, options.isa);
  if (!image) return kBadData;
  auto made = encode_picture(request, image->view());
  if (!made.ok()) return data_error(request.in, made.failure());
  if (const int code = write_output(request.out, made->file.bytes); code != kDone) return code;
  return print_summary(options, request, *made, image->view());
}

}  // namespace pac::cli
