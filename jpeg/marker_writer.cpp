#include "jpeg/marker_writer.h"

#include "base/kernels/block_kernels.h"
#include "jpeg/markers.h"
#include "jpeg/metadata_writer.h"

namespace pac::jpeg {

void write_start_of_image(ByteSink& sink) {
  sink.put16(0xFF00 | kSoi);
}

void write_dqt(const QuantTable& steps, int id, ByteSink& sink) {
  bool is_wide = false;
  for (const uint16_t step : steps) is_wide = is_wide || step > 255;
  sink.put16(0xFF00 | kDqt);
  sink.put16(2 + 1 + (is_wide ? 128 : 64));
  sink.put((is_wide ? 0x10 : 0x00) | id);  // Pq, Tq
  for (const uint8_t natural : kNaturalFromZigzag) {
    if (is_wide)
      sink.put16(steps[natural]);
    else
      sink.put(steps[natural]);
  }
}

void write_start_of_frame(int code, const Frame& frame, ByteSink& sink) {
  sink.put16(0xFF00 | code);
  sink.put16(8 + 3 * frame.n_components);
  sink.put(8);
  sink.put16(frame.height);
  sink.put16(frame.width);
  sink.put(frame.n_components);
  for (int i = 0; i < frame.n_components; ++i) {
    const Component& c = frame.components[i];
    sink.put(c.id);
    sink.put(c.h << 4 | c.v);
    sink.put(c.quant_table);
  }
}

void write_dht(const HuffmanSpec& spec, int table_class, int id, ByteSink& sink) {
  const int n = spec.n_symbols();
  sink.put16(0xFF00 | kDht);
  sink.put16(2 + 1 + 16 + n);
  sink.put(table_class << 4 | id);
  sink.append({spec.count + 1, 16});
  sink.append({spec.symbols, static_cast<size_t>(n)});
}

void write_dri(int restart_interval_mcus, ByteSink& sink) {
  if (restart_interval_mcus == 0) return;
  sink.put16(0xFF00 | kDri);
  sink.put16(4);
  sink.put16(restart_interval_mcus);
}

void write_start_of_scan(const Frame& frame, int first, int n, ByteSink& sink) {
  sink.put16(0xFF00 | kSos);
  sink.put16(6 + 2 * n);
  sink.put(n);
  for (int i = first; i < first + n; ++i) {
    sink.put(frame.components[i].id);
    sink.put(i == 0 ? 0x00 : 0x11);
  }
  sink.put(0);   // Ss
  sink.put(63);  // Se
  sink.put(0);   // Ah, Al
}

void write_end_of_image(ByteSink& sink) {
  sink.put16(0xFF00 | kEoi);
}

void write_headers(const Frame& frame, const QuantTables& steps, const ScanTables& tables, const EncodeOptions& options,
                   ByteSink& sink) {
  const int n_sets = options.stream != nullptr ? 0 : frame.n_components > 1 ? 2 : 1;
  write_start_of_image(sink);
  write_jfif(options.metadata != nullptr ? options.metadata->density : Density{}, sink);
  if (options.metadata != nullptr) write_metadata(*options.metadata, sink);
  for (int id = 0; id < n_sets; ++id) write_dqt(id == 0 ? steps.luma : steps.chroma, id, sink);
  write_start_of_frame(kSof0, frame, sink);
  for (int id = 0; id < n_sets; ++id)
    for (int table_class = 0; table_class < 2; ++table_class)
      write_dht(tables.spec[2 * id + table_class], table_class, id, sink);
  write_dri(options.restart_interval_mcus, sink);
  write_start_of_scan(frame, 0, frame.n_components, sink);
}

}  // namespace pac::jpeg
