// The encoder's stages in order: coefficients -> tables -> levels -> tokens -> file.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "jpeg/byte_sink.h"
#include "jpeg/coefficients.h"
#include "jpeg/dc_trellis.h"
#include "jpeg/jpeg.h"
#include "jpeg/table_design.h"
#include "jpeg/tokenizer.h"
#include "jpeg/trellis.h"

namespace pac::jpeg {

Result<void> check_options(const SourceImage& image, const EncodeOptions& options);

// Keeps its buffers from image to image.
class ImageEncoder {
 public:
  // Both arguments have passed check_options; the image's pixels are read until the last write_file().
  // keep_coefficients: write_file() will be called more than once.
  void start(const SourceImage& image, const EncodeOptions& options, bool keep_coefficients);

  // The tables that options ask for, at that quality. options.tables count as the tables of quality 50 if
  // `scale_tables`.
  QuantTables tables_at(double quality, bool scale_tables) const;

  // How often each symbol occurs with those tables.
  Histogram count_symbols(QuantTables tables, double quality);

  // Of the next files, 0..1: levels are rounded further down, and errors count less for the trellis. 0 at start().
  void set_bias(double bias) { bias_ = bias; }

  // The whole file with those tables. `quality`: the one that made them, for what else depends on it. Returns the
  // tables in the file: where they are adapted, the trellis's choice of levels moves them a little.
  QuantTables write_file(QuantTables tables, double quality, ByteSink& sink);

 private:
  // For each set of tables and zigzag position: sums of level * coefficient and of squared levels.
  struct LevelSums {
    int64_t products[2][64] = {}, squares[2][64] = {};
  };

  // MCU rows that are coded by one thread: all of them, or those between two restart markers.
  struct Band {
    int first_row = 0, end_row = 0;
    CoefficientSource source;
    LevelSums sums;
    Levels levels;
    std::vector<float> importance;  // of a component's blocks in an MCU row, for the trellis
    DcTrellis dc_trellis;
    Tokenizer tokenizer;
    BlockWalker walker;
    ScanWriter writer;
    std::vector<uint8_t> bytes;  // of its rows, where there are other bands
  };

  ScanTables known_tables() const;
  bool is_tuned() const {
    return !options_.tables && options_.stream == nullptr && options_.table_source != TableSource::annex_k;
  }
  bool is_adapted() const { return is_tuned() && options_.table_source == TableSource::adapted; }
  double dead_zone() const { return options_.dead_zone + bias_ * (kMaxDeadZone - options_.dead_zone); }
  void measure_seen();
  void spread_importance(const Frame& frame);
  float importance_of(const Band& band, int c, int mcu_row, size_t i) const;
  float visibility_of(const Band& band, int mcu_row, size_t i) const;
  void design(bool dc_only);
  void set_tables(const QuantTables& tables, double dead_zone);
  void reserve_levels();
  void split(const Frame& frame);
  template <class Fn>
  void for_each_band(Fn&& fn);
  int sample_period(int64_t max_blocks) const;
  void quantize(Band& band, int mcu_row);
  void optimize_levels(Band& band, int mcu_row);
  void add_sums(Band& band, int mcu_row) const;
  void tokenize(Band& band, int period);
  Histogram histogram(int period);
  void order_bands();
  void write_entropy_coded(const ScanTables& tables, bool direct, ByteSink& sink);
  void write_band(Band& band, const ScanTables& tables, bool direct, ByteSink& sink);
  void prepare(QuantTables& tables, double quality);
  void optimize(QuantTables& tables, double quality);
  void measure_costs(int period);
  void measure_visibility(int period);
  void refine(QuantTables& tables) const;

  static constexpr double kMaxDeadZone = 0.49;

  EncodeOptions options_;
  double bias_ = 0;
  const Kernels* kernels_ = nullptr;
  std::vector<Band> bands_;    // at least one
  std::vector<size_t> order_;  // of bands_: those that had most tokens first, so that threads end together
  std::optional<ThreadPool> pool_;
  TableDesigner designer_;
  BlockQuantizer quantizers_[2];
  TrellisWeights weights_[2];
  AcCosts costs_[2];
  DcCosts dc_costs_[2];
  ReferenceSteps reference_;            // of the trellis
  ChromaGain chroma_gain_;              // 1 where tables are not tuned
  Tune masking_ = Tune::psnr;           // options_.masking, or options_.tune where tables are tuned
  std::vector<float> seen_visibility_;  // empty: a block's own
  std::vector<float> importance_[3];    // options_.importance of each component's blocks; empty: 1
  float mean_visibility_ = 1;           // of the luma blocks
  bool use_trellis_ = false;            // costs_ are known
};

}  // namespace pac::jpeg
