#include "jpeg/marker_writer.h"

#include "base/kernels/block_kernels.h"
#include "jpeg/markers.h"

namespace pac::jpeg {
namespace {

void write_app0(ByteSink& sink) {
  constexpr uint8_t kJfif[] = {0xFF, kApp0, 0, 16, 'J', 'F', 'I', 'F', 0,
                               1,    1,     0, 0,  1,   0,   1,   0,   0};  // 1.01, aspect 1:1
  sink.append(kJfif);
}

void write_dqt(const QuantTable& steps, int id, ByteSink& sink) {
  sink.put16(0xFF00 | kDqt);
  sink.put16(2 + 1 + 64);
  sink.put(id);  // Pq = 0: 8 bits
  for (const uint8_t natural : kNaturalFromZigzag) sink.put(steps[natural]);
}

void write_sof0(const Frame& frame, ByteSink& sink) {
  sink.put16(0xFF00 | kSof0);
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

void write_sos(const Frame& frame, ByteSink& sink) {
  sink.put16(0xFF00 | kSos);
  sink.put16(6 + 2 * frame.n_components);
  sink.put(frame.n_components);
  for (int i = 0; i < frame.n_components; ++i) {
    sink.put(frame.components[i].id);
    sink.put(i == 0 ? 0x00 : 0x11);
  }
  sink.put(0);   // Ss
  sink.put(63);  // Se
  sink.put(0);   // Ah, Al
}

}  // namespace

void write_headers(const Frame& frame, const QuantTables& steps, const ScanTables& tables, int restart_interval_mcus,
                   ByteSink& sink) {
  const int n_sets = frame.n_components > 1 ? 2 : 1;
  sink.put16(0xFF00 | kSoi);
  write_app0(sink);
  for (int id = 0; id < n_sets; ++id) write_dqt(id == 0 ? steps.luma : steps.chroma, id, sink);
  write_sof0(frame, sink);
  for (int id = 0; id < n_sets; ++id)
    for (int table_class = 0; table_class < 2; ++table_class)
      write_dht(tables.spec[2 * id + table_class], table_class, id, sink);
  if (restart_interval_mcus > 0) {
    sink.put16(0xFF00 | kDri);
    sink.put16(4);
    sink.put16(restart_interval_mcus);
  }
  write_sos(frame, sink);
}

void write_end_of_image(ByteSink& sink) {
  sink.put16(0xFF00 | kEoi);
}

}  // namespace pac::jpeg
