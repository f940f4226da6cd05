// Which quantization tables code H and D, and the search for the quality whose file has a wanted size.
//
// Two notations of quality, both on the IJG scale (scale factor s = 5000/q percent below 50, 200 - 2q from 50 on):
//   coded quality       tables(q) are the ones in the file. For H this is plain JPEG's quality. For D it is the paper's
//                       notation (q41 and q55 in Table I): D holds the features of H - L at half height, so the tables
//                       that treat them as tables(15) treats H are half as coarse: s = 333 % / 2 = 167 %, q = 30. The
//                       factor is "even higher than is required to compensate for the division by 2" [Levoy95 s.4.1].
//   equivalent quality  the division by two undone: the q of H's own domain whose tables are twice those in D's file.
//                       41 -> 20.5, 55 -> 27.8, 30 -> 15. For H both notations agree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/image.h"
#include "base/isa.h"
#include "base/result.h"
#include "jpeg/jpeg.h"

namespace pac::sim {

// What a picture that is being coded holds.
enum class Content : uint8_t { image, difference };

// annex_k: T.81's example tables, scaled. adapted: tables designed for the statistics of the very picture, scaled
// the same way; they travel in the file, so the decoder needs to know nothing.
enum class TableFamily : uint8_t { annex_k, adapted };

// Everything besides quality; equal on both arms of a comparison.
struct CodingOptions {
  TableFamily tables = TableFamily::annex_k;
  // standard: the paper's IJG v4 default. difference: fixed tables made for difference images code D, standard ones H.
  jpeg::Huffman huffman = jpeg::Huffman::standard;
  // Where tables are adapted: ssim or visual let a trellis choose the levels of both arms, which puts errors where H is
  // busy: in D too, by `seen`. psnr: no trellis. A client decodes the same way whatever this is.
  jpeg::Tune masking = jpeg::Tune::psnr;
  // Where tables are adapted: how many times an error in each 8x8 block of pixels counts (sim/block_importance.h), for
  // the tables and for a trellis, as jpeg::EncodeOptions::importance. Empty: alike.
  std::span<const float> importance = {};
  jpeg::Subsampling subsampling = jpeg::Subsampling::yuv420;  // the paper's "4:1:1"
  int threads = 1;       // encodes tried at once; never changes the result. 0 = all
  Isa isa = best_isa();  // never changes the result
};

// IJG scale factor in percent of a quality in (0, 100], and back (scale in (0, 500000]).
double scale_from_quality(double quality);
double quality_from_scale(double scale_percent);

// Between the two notations. Inverse of each other; both are the identity for Content::image.
double equivalent_quality(double coded_quality, Content content);
double coded_quality(double equivalent_quality, Content content);

// One finished file.
struct CodedImage {
  std::vector<uint8_t> bytes;     // a complete JFIF file, headers included
  double quality = 0;             // coded quality: encoding again at it gives the same bytes
  double equivalent_quality = 0;  // see above
  jpeg::QuantTables tables;       // as written
  int encodes = 0;                // how many encodes the search took
};

// Codes `image` at a coded quality in (0, 100]. seen: for a difference, H, which `masking` looks at (empty: at D
// itself); an image is looked at itself. Fails with bad_argument as jpeg::encode.
Result<CodedImage> code_at_quality(ConstRgbView image, Content content, double quality, const CodingOptions& options,
                                   ConstRgbView seen = {});

// Codes `image` so that the whole file's size is as near to `target_bytes` as any scaling of the tables brings it.
//
// Rounding makes the tables a step function of quality, so there are finitely many files; the search works on the
// list of those steps. Size need not fall with coarser tables: after bisecting for a place where the sizes cross the
// target it codes every step in a window around that place, and stops early only at an exact hit.
// Ties: of two sizes equally far from the target the smaller wins; of equal sizes the finer tables win.
// `quality` comes back as the shortest decimal that selects the same tables.
// A target below the smallest or above the largest file gives that file. seen: as above.
Result<CodedImage> code_at_size(ConstRgbView image, Content content, uint64_t target_bytes,
                                const CodingOptions& options, ConstRgbView seen = {});

}  // namespace pac::sim
