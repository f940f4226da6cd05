// Baseline sequential JPEG [ITU-T T.81], JFIF files: the public face of the codec.
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

// Samples of Y a sample of Cb and Cr: the paper's "4:1:1" (4 Y to 1 Cr and 1 Cb) is today's 4:2:0.
enum class Subsampling : uint8_t { yuv444, yuv422, yuv420, gray };
enum class Huffman : uint8_t { standard, optimal };  // Annex K.3 tables, or two passes
enum class Effort : uint8_t { fast, normal, best };
enum class Tune : uint8_t { psnr, ssim, visual };

// Steps of the uniform quantizers, natural (row) order, 1..255.
using QuantTable = std::array<uint16_t, 64>;
struct QuantTables {
  QuantTable luma{}, chroma{};
};

// Annex K.1 tables scaled as the IJG software does, for a real-valued quality in (0, 100].
QuantTables annex_k_tables(double quality);

struct EncodeOptions {
  double quality = 75;                // (0, 100], IJG scale, real-valued
  std::optional<QuantTables> tables;  // instead of those that `quality` gives
  Subsampling subsampling = Subsampling::yuv420;
  Huffman huffman = Huffman::optimal;
  int restart_interval_mcus = 0;  // 0..65535; 0 = none
  double dead_zone = 0.0;         // 0 rounds to nearest; d rounds |x|/q at 0.5 + d (0..0.49) for AC
  bool trellis = false;           // rate-distortion choice of AC levels
  Isa isa = best_isa();
};

// A complete JFIF file. Image sides 1..65535.
Result<std::vector<uint8_t>> encode(ConstRgbView image, const EncodeOptions& options = {});
Result<std::vector<uint8_t>> encode_gray(PlaneView<const uint8_t> image, const EncodeOptions& options = {});

struct ComponentInfo {
  uint8_t id = 0, horizontal_sampling = 1, vertical_sampling = 1, quant_table = 0;
};
struct Info {
  int width = 0, height = 0;
  std::vector<ComponentInfo> components;
  // ... the jpeg/ owner completes this: markers with offsets, tables, estimated quality, metadata
};

// Headers only; never touches entropy-coded data.
Result<Info> read_info(std::span<const uint8_t> bytes, const Limits& limits = {});

// RGB of any file that read_info accepts (gray is spread to three channels).
Result<RgbImage> decode(std::span<const uint8_t> bytes, const Limits& limits = {}, Isa isa = best_isa());

}  // namespace pac::jpeg
