// Baseline sequential JPEG [ITU-T T.81], JFIF files: the public face of the codec.
// Every function and object here: one object, one thread at a time; distinct objects are independent. Nothing keeps a
// caller's pointer after it returns. The same bytes and pixels come out on every instruction set and compiler.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"

namespace pac::jpeg {

// ---- Quantization tables ------------------------------------------------------------------------------------------

// Samples of Y a sample of Cb and Cr: the paper's "4:1:1" (4 Y to 1 Cr and 1 Cb) is today's 4:2:0.
enum class Subsampling : uint8_t { yuv444, yuv422, yuv420, gray };
// Huffman tables: Annex K.3's; made for the image, which takes a second look at it; fixed ones that suit the difference
// images of rendered scenes (many blocks of nothing but EOB), for one pass over those.
enum class Huffman : uint8_t { standard, optimal, difference };
enum class Effort : uint8_t { fast, normal, best };
enum class Tune : uint8_t { psnr, ssim, visual, hvs };

// Steps of the uniform quantizers, natural (row) order, 1..255 where an encoder takes them (a decoder: 1..65535).
using QuantTable = std::array<uint16_t, 64>;
struct QuantTables {
  QuantTable luma{}, chroma{};
};

// Annex K.1 tables scaled as the IJG software does, for a real-valued quality in (0, 100] (outside: clamped).
// scale = q < 50 ? 5000 / q : 200 - 2 q; step = floor((base * scale + 50) / 100) within 1..255. Integer qualities
// give exactly the IJG's (force_baseline) tables.
QuantTables annex_k_tables(double quality);

// Tables of a tuning at a quality in (0, 100] on the IJG scale. At quality 50:
//   psnr    nearly flat, 28 to 34, chroma 15 rising to 43 as 4:2:0 decoders blur it: least squared error of RGB
//   ssim    flat 28, chroma 73 to 115: structure of luma
//   visual  18 to 80, rising with frequency, chroma alike: what SSIMULACRA 2.1 sees
//   hvs     8 for DC, then 9 to 163 as Annex K's rise, chroma 51 to 81: what PSNR-HVS-M sees, of luma
QuantTables tuned_tables(Tune tune, double quality);

// Tables for the difference image D = 127 + (H - L) / 2 [Levoy95 s.3]: every step halved, rounded up from .5, at
// least 1. Coding D with them costs as many bytes and loses as much of H - L as coding H - L itself with `tables`
// would.
QuantTables halved(const QuantTables& tables);

// ---- Encoding -----------------------------------------------------------------------------------------------------

// Sampling factors [T.81 A.1.1] of Y, Cb and Cr: how many samples of one stand beside those of another. 2x2, 1x1, 1x1
// is 4:2:0. Each 1..4, and at most 10 blocks in all: the sum of h * v.
struct SamplingFactors {
  std::array<uint8_t, 3> h{1, 1, 1}, v{1, 1, 1};
};

struct Metadata;     // jpeg/metadata.h
class StreamTables;  // jpeg/abbreviated.h

// Where the quantization tables come from when EncodeOptions::tables does not give them.
enum class TableSource : uint8_t {
  annex_k,  // annex_k_tables(quality)
  tuned,    // tuned_tables(tune, quality)
  fitted,   // the same but for the DC steps, which are chosen for this image's flat areas from a sample of its rows
  adapted,  // adapted_tables(image, ..., tune, quality): rate-distortion optimal for this image; a pass more
};

struct EncodeOptions {
  double quality = 75;                // (0, 100], IJG scale, real-valued
  std::optional<QuantTables> tables;  // instead of those that `quality` gives; steps 1..255
  TableSource table_source = TableSource::annex_k;
  Tune tune = Tune::visual;  // for TableSource::tuned and adapted
  Subsampling subsampling = Subsampling::yuv420;
  std::optional<SamplingFactors> sampling = {};  // instead of `subsampling` (unless that is gray), averaging boxes
  Huffman huffman = Huffman::optimal;
  int restart_interval_mcus = 0;  // 0..65535; 0 = none
  double dead_zone = 0.0;         // 0 rounds to nearest; d rounds |x|/q at 0.5 + d (0..0.49) for AC
  bool trellis = false;           // rate-distortion choice of levels (then dead_zone only serves the first estimate)
  int threads = 1;                // 0 = all processors, at most 1024. Work is shared only where restart markers stand
                                  // between rows of MCUs (see row_restart_interval); results never depend on it
  // For a difference image, whose errors will be seen in the composite: the picture that shall be seen, H. For ssim and
  // visual with the trellis, errors then hide where H is busy, not where the difference is. Same size, or empty.
  ConstRgbView seen{};
  // Which errors hide, for the trellis: psnr: none; the others: those in busy luma blocks, as those tunings have it.
  // Empty: as `tune` says where tables are tuned, else psnr.
  std::optional<Tune> masking = {};
  // How many times the trellis counts an error in each 8x8 block of pixels, for whatever reason the caller has: above
  // 0, ceil(height / 8) rows of ceil(width / 8). A block that covers several of them takes their mean. Empty: once.
  std::span<const float> importance = {};
  Isa isa = best_isa();                  // results never depend on it
  const Metadata* metadata = nullptr;    // written behind the JFIF segment, whose density it tells
  const StreamTables* stream = nullptr;  // tables that the decoder has already: `tables`, `table_source` and `huffman`
                                         // do not count, the file holds none [T.81 B.4]
};

// The restart interval of one row of MCUs, so that rows can be coded and decoded side by side.
int row_restart_interval(int width, Subsampling subsampling);
int row_restart_interval(int width, const SamplingFactors& sampling);

// Presets. fast: tuned tables, standard Huffman tables, no dead zone. normal: fitted tables, optimal Huffman tables,
// dead zone 0.18. best: adapted tables and the trellis, which but for psnr lets errors hide in busy blocks.
EncodeOptions options_for(Effort effort, Tune tune, double quality);

// A complete JFIF file. Image sides 1..65535. Errors: bad_argument (an option or a side out of range).
Result<std::vector<uint8_t>> encode(ConstRgbView image, const EncodeOptions& options = {});
// The same of one component; options.subsampling is taken as gray.
Result<std::vector<uint8_t>> encode_gray(PlaneView<const uint8_t> image, const EncodeOptions& options = {});

// No file of such an image is longer than this, whatever the pixels and the other options. Sides 1..65535.
// Metadata come on top: metadata_bytes().
uint64_t encode_bound(int width, int height, Subsampling subsampling, int restart_interval_mcus = 0);
uint64_t encode_bound(int width, int height, const SamplingFactors& sampling, int restart_interval_mcus = 0);

// As encode(), into the caller's buffer: the number of bytes written. Errors: also out_of_space (contents of `out` are
// then unspecified). encode_bound() bytes always suffice.
Result<size_t> encode_into(ConstRgbView image, const EncodeOptions& options, std::span<uint8_t> out);

// The same, reusable: keeps its working memory from image to image.
class Encoder {
 public:
  Encoder();
  ~Encoder();
  Encoder(Encoder&&) noexcept;
  Encoder& operator=(Encoder&&) noexcept;
  Result<size_t> encode_into(ConstRgbView image, const EncodeOptions& options, std::span<uint8_t> out);
  // Appends the file to `out` (which keeps its capacity when the caller clears it).
  Result<void> encode_append(ConstRgbView image, const EncodeOptions& options, std::vector<uint8_t>& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Tables with the least rate for their distortion, chosen step by step from the histograms of the image's DCT
// coefficients (RD-OPT: Ratnakar and Livny, DCC 1995): minimal D + lambda R, R the entropy of the levels at each
// frequency, D the squared error, weighted by the steps of `tune`. lambda follows from `quality`
// so that the bytes come near those of tuned_tables(tune, quality). encode() with the trellis then moves each step to
// the one that fits the levels chosen best. Errors: as encode.
Result<QuantTables> adapted_tables(ConstRgbView image, Subsampling subsampling, Tune tune, double quality);

// The largest quality whose file, headers and all, has at most target_bytes.
struct SizedFile {
  std::vector<uint8_t> bytes;
  double quality = 0;                 // real-valued
  QuantTables tables;                 // in the file
  bool is_between_qualities = false;  // finer than encode() at `quality`
};
// Fails with bad_argument where options.stream gives the tables: they do not depend on a quality. Searches real-valued
// quality in hundredths (quarters with adapted tables); options.quality is ignored. Where
// options.tables are given they count as the tables of quality 50 and are scaled as annex_k_tables scales. Size is
// *not* assumed to fall with quality: after bisection, all further table sets whose size comes within 1/32 above the
// target, and 24 beyond the last one that fits, are tried, and the largest quality that fits wins. Where it leaves more
// than a hundredth of the target, single steps of the next tables and a bias of levels towards 0 fill the rest. Errors:
// as encode; out_of_space (even the lowest quality is longer; byte_offset holds its size).
Result<SizedFile> encode_to_size(ConstRgbView image, const EncodeOptions& options, uint64_t target_bytes);

// ---- Decoding -----------------------------------------------------------------------------------------------------

struct ComponentInfo {
  uint8_t id = 0, horizontal_sampling = 1, vertical_sampling = 1, quant_table = 0;
};

// How the components become RGB (the IJG software's rule, see README.md).
enum class ColorModel : uint8_t { gray, ycc, rgb, cmyk, ycck, unknown };

struct MarkerInfo {
  uint8_t code = 0;         // second byte of the marker: 0xD8 = SOI, 0xDB = DQT, ...
  uint64_t offset = 0;      // of its 0xFF, bytes from the start of the file
  uint32_t size_bytes = 0;  // of the parameters, without the length field; 0 for markers that have none
};

struct ByteRange {
  uint64_t offset = 0, size = 0;  // bytes of the file
};

struct Info {
  int width = 0, height = 0;  // pixels
  int precision_bits = 8;
  uint8_t start_of_frame = 0;  // 0xC0 baseline, 0xC1 extended sequential, 0xC2 progressive, ...
  std::vector<ComponentInfo> components;
  ColorModel color = ColorModel::unknown;
  const char* unsupported = nullptr;  // why decode() will refuse this file although it is legal, or null

  std::vector<MarkerInfo> markers;  // SOI to the first SOS, in file order
  std::array<std::optional<QuantTable>, 4> quant_tables;
  double estimated_quality = 0;  // real-valued IJG quality whose Annex K luma table comes nearest; 0: no table
  int restart_interval_mcus = 0;
  bool default_huffman = false;  // no DHT at all before the scan: Annex K.3 tables are meant, as in motion JPEG

  bool jfif = false;
  int density_units = 0, density_x = 1, density_y = 1;  // JFIF: 0 aspect ratio only, 1 dots per inch, 2 per cm
  int adobe_transform = -1;                             // APP14: 0, 1 YCbCr, 2 YCCK; -1: no such marker
  int exif_orientation = 0;                             // 1..8; 0: not stated. Never applied by decode()
  bool has_icc_profile = false;
  std::vector<ByteRange> comments;  // texts of COM segments
  uint64_t header_bytes = 0;        // offset of the first entropy-coded byte
};

// Headers only, up to and with the first SOS; never touches entropy-coded data. Also reads files that decode() refuses
// as unsupported. Errors: truncated, corrupt, limit_exceeded (with the offset of the segment at fault).
Result<Info> read_info(std::span<const uint8_t> bytes, const Limits& limits = {});

// A rectangle of a picture: pixels [x, x + width) x [y, y + height), not empty.
struct Crop {
  int x = 0, y = 0, width = 0, height = 0;
};

// How to decode. All results but speed are the same for every isa and number of threads.
struct DecodeOptions {
  Limits limits = {};
  Isa isa = best_isa();
  int threads = 1;  // 0 = all processors, at most 1024; more than one serve where restart markers stand between rows of
                    // MCUs and the whole picture is wanted at its own size
  // 1, 2, 4 or 8: each side divided by it, rounded up, by transforms that make fewer samples. As djpeg -scale 1/N.
  int scale_denominator = 1;
  // Of the scaled picture: exactly those pixels of the whole one. Data of a file's only scan that come after the crop
  // are not read, nor, where restart markers stand in order, those of intervals before it; damage in them is not seen.
  std::optional<Crop> crop = {};
};

// RGB of a complete, sound file (gray is spread to three channels). Errors: truncated, corrupt, unsupported,
// limit_exceeded; then no picture at all.
Result<RgbImage> decode(std::span<const uint8_t> bytes, const Limits& limits = {}, Isa isa = best_isa());
Result<RgbImage> decode(std::span<const uint8_t> bytes, const DecodeOptions& options);  // bad_argument: scale or crop

// Width and height of the whole picture at a scale.
struct PictureSize {
  int width = 0, height = 0;
};
PictureSize scaled_size(const Info& info, int scale_denominator);

// What a damaged file still holds.
struct LenientImage {
  RgbImage image;                  // samples that the file does not hold are gray (128 in each component)
  std::optional<Failure> failure;  // the first thing wrong; empty: the file is sound
  int errors = 0;                  // things wrong: damaged intervals, missing scans, ...
  int warnings = 0;                // oddities that harm nothing and that strict decoding tolerates
};
// As decode(), but keeps what is there when the entropy-coded data or what follows it is damaged or missing; damage
// between restart markers costs only those intervals. Errors: as decode, in the headers before the first scan.
Result<LenientImage> decode_lenient(std::span<const uint8_t> bytes, const Limits& limits = {}, Isa isa = best_isa());
Result<LenientImage> decode_lenient(std::span<const uint8_t> bytes, const DecodeOptions& options);

// Strict decoding, reusable: keeps its working memory from file to file.
class Decoder {
 public:
  explicit Decoder(const Limits& limits = {}, Isa isa = best_isa());
  explicit Decoder(const DecodeOptions& options);  // threads 0..1024
  ~Decoder();
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;
  // Writes to `out`, which must have the crop's size or what scaled_size() tells (else bad_argument). On failure the
  // contents of `out` are unspecified.
  Result<void> decode_into(std::span<const uint8_t> bytes, RgbView out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pac::jpeg
