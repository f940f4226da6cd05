// Marker segments of a JFIF file, in the order in which the encoder emits them [T.81 B.2, JFIF 1.02].
#pragma once

#include "jpeg/byte_sink.h"
#include "jpeg/frame.h"
#include "jpeg/jpeg.h"
#include "jpeg/scan_writer.h"

namespace pac::jpeg {

// SOI, APP0, DQT, SOF0, DHT, DRI (when the interval is not 0), SOS. One quantization table and two Huffman tables for
// one component, twice as many for three.
void write_headers(const Frame& frame, const QuantTables& steps, const ScanTables& tables, int restart_interval_mcus,
                   ByteSink& sink);
void write_end_of_image(ByteSink& sink);

}  // namespace pac::jpeg
