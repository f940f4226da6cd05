// The encoder's state, for the files that its parts are in: options and start, quantizers of a picture, pictures in
// order.
#pragma once

#include <vector>

#include "base/parallel.h"
#include "mpeg1/adapted_matrices.h"
#include "mpeg1/coarse_motion.h"
#include "mpeg1/headers.h"
#include "mpeg1/lookahead.h"
#include "mpeg1/macroblock_coder.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/rate_control.h"
#include "mpeg1/slice_writer.h"

namespace pac::mpeg1 {

constexpr int kMaxGroupLength = 132;  // no macroblock may be predicted more often [2.4.4.2]

// What is wrong with the options, or null.
const char* problem_with(const SequenceOptions& options);

struct Encoder::State {
  State(const SequenceOptions& o, Isa isa);

  Result<PictureReport> add(const Frame420& frame, std::vector<uint8_t>& out, const PictureOptions& picture);
  const char* problem_with_picture(const Frame420& frame, const PictureOptions& picture) const;
  PictureType choose_type(const PictureOptions& picture) const;
  void start_group(std::vector<uint8_t>& out);
  double set_quantizers(PictureType type, const PictureOptions& picture, double scale);
  double set_wanted(PictureType type, const float* scales, double scale);
  double reuse() const;
  double intra_scale(size_t macroblock) const;
  void watch_stillness(PictureType type);
  PictureReport code_at(PictureType type, const PictureOptions& picture, double scale, std::vector<uint8_t>& out);
  PictureReport code_at_rate(PictureType type, const PictureOptions& picture, std::vector<uint8_t>& out);
  PictureReport code_as_told(PictureType type, const PictureOptions& picture, double scale, std::vector<uint8_t>& out);
  void skip_macroblocks();
  PictureReport skip_everything(const PictureOptions& picture, std::vector<uint8_t>& out);
  void account(size_t before, std::vector<uint8_t>& out);
  void age_macroblocks();
  void force_intra();
  void make_lambdas();
  void look_ahead(const Frame420& frame, const PictureOptions& picture);
  void set_rate();
  void set_matrices(const QuantizerMatrix& intra_matrix, const QuantizerMatrix& non_intra_matrix);
  void flatten_intra_matrix();
  void adapt_matrices();
  PictureTask make_task(PictureType type, const PictureOptions& picture);
  void code_picture(const PictureTask& task);
  PictureReport write_picture(PictureType type, std::vector<uint8_t>& out);
  void finish_picture(PictureType type);
  void note_kept(PictureType type);

  SequenceOptions options;
  const Kernels& kernels;
  ThreadPool pool;
  int columns, rows;
  SequenceHeader sequence;
  QuantizerSet intra, non_intra;
  double lambda_of_one = 0;                              // of P at quantizer_scale 1
  int64_t lambda[2][32] = {};                            // of P and I, each quantizer_scale; see ResidualTask
  Frame420 source, reconstruction, reference, replaced;  // whole macroblocks
  Planes source_planes;                                  // of `source`, or of the caller's frame during add()
  std::vector<Macroblock> macroblocks;
  CoarseMotion coarse;  // not at Effort::fast
  std::vector<MotionVector> last_vectors;
  bool has_last_vectors = false;
  std::vector<uint8_t> quantizers;
  Lookahead lookahead;
  std::vector<float> wanted;     // quantizer_scale of each macroblock by the lookahead; empty: `quantizers` alone
  std::vector<int64_t> lambdas;  // with them
  std::vector<uint8_t> bits_of_difference;
  std::vector<Band> bands;
  std::vector<int> band_rows;                     // of each band, how many
  std::vector<RowBits> bits;                      // of each row
  std::vector<CoefficientStatistics> statistics;  // of each band; empty: matrices stay
  bool has_rate = false;
  RateControl rate;
  double rated_scale = 0;       // what the picture's size says something about; 0: nothing
  size_t header_bytes = 0;      // of the sequence and group headers before the picture being coded
  std::vector<uint8_t> ages;    // codings of each macroblock since it was intra
  std::vector<uint8_t> still;   // P pictures of the group that left each macroblock without coefficients
  int n_watched = 0;            // P pictures that `still` counts
  std::vector<uint8_t> forced;  // must be intra
  // Of each macroblock: the picture before last, which `reconstruction` holds until a picture is coded, has the samples
  // of the last one, `reference`.
  std::vector<uint8_t> kept;
  bool is_touched = true;      // `reconstruction` has been written to since
  bool was_replaced = false;   // the picture in work is predicted from the caller's reference
  bool in_sequence = false;    // a sequence header was written and no end
  int64_t picture_count = 0;   // of the sequence, for the time code
  int temporal_reference = 0;  // of the next picture in its group
  int frame_in_group = 0;      // the same without repeated pictures
};

}  // namespace pac::mpeg1
