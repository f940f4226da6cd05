// Marker segments of a JFIF file, in the order in which the encoder emits them [T.81 B.2, JFIF 1.02].
#pragma once

#include "jpeg/byte_sink.h"
#include "jpeg/frame.h"
#include "jpeg/jpeg.h"
#include "jpeg/scan_writer.h"

namespace pac::jpeg {

// Single segments.
void write_start_of_image(ByteSink& sink);
void write_dqt(const QuantTable& steps, int id, ByteSink& sink);  // 16-bit elements where a step is above 255
void write_dht(const HuffmanSpec& spec, int table_class, int id, ByteSink& sink);
void write_dri(int restart_interval_mcus, ByteSink& sink);  // nothing for 0
void write_start_of_frame(int code, const Frame& frame, ByteSink& sink);
// A sequential scan of `n` components from `first` on; the frame's first component has Huffman tables 0, others 1.
void write_start_of_scan(const Frame& frame, int first, int n, ByteSink& sink);
void write_end_of_image(ByteSink& sink);

// SOI, APP0, metadata, DQT, SOF0, DHT, DRI (when the interval is not 0), SOS. One quantization table and two Huffman
// tables for one component, twice as many for three; none if options.stream says that the decoder has them.
void write_headers(const Frame& frame, const QuantTables& steps, const ScanTables& tables, const EncodeOptions& options,
                   ByteSink& sink);

}  // namespace pac::jpeg
