// The encoder's stages in order: coefficients -> tables -> levels -> tokens -> file.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "jpeg/byte_sink.h"
#include "jpeg/coefficients.h"
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
  Histogram count_symbols(const QuantTables& tables, double quality);

  // The whole file with those tables. `quality`: the one that made them, for what else depends on it.
  void write_file(const QuantTables& tables, double quality, ByteSink& sink);

 private:
  // MCU rows that are coded by one thread: all of them, or those between two restart markers.
  struct Band {
    int first_row = 0, end_row = 0;
    CoefficientSource source;
    Levels levels;
    Tokenizer tokenizer;
    BlockWalker walker;
    ScanWriter writer;
    std::vector<uint8_t> bytes;  // of its rows, where there are other bands
  };

  ScanTables known_tables() const;
  void set_up(const QuantTables& tables, double quality);
  void split(const Frame& frame);
  template <class Fn>
  void for_each_band(Fn&& fn);
  void quantize(Band& band, int mcu_row);
  void tokenize(Band& band);
  Histogram histogram();
  void write_entropy_coded(const ScanTables& tables, bool direct, ByteSink& sink);
  void write_band(Band& band, const ScanTables& tables, bool direct, ByteSink& sink);
  void prepare(const QuantTables& tables, double quality);
  void measure_costs();
  void measure_visibility();
  double importance_of(int c, const int16_t* coefficients) const;

  EncodeOptions options_;
  const Kernels* kernels_ = nullptr;
  std::vector<Band> bands_;  // at least one
  std::optional<ThreadPool> pool_;
  TableDesigner designer_;
  BlockQuantizer quantizers_[2];
  TrellisWeights weights_[2];
  AcCosts costs_[2];
  double mean_visibility_ = 0;  // of the luma blocks; 0: all blocks count the same
  bool use_trellis_ = false;    // costs_ are known
};

}  // namespace pac::jpeg
