// Values of faces: up to four components of up to 16 bits each, such as a color per face. FORMAT.md section 10.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geomcodec/topology.h"

namespace pac::geomcodec {

// values: of the coded faces, n_components (1..4) each, below 2^bits (1..16).
std::vector<uint8_t> encode_face_values(const Topology& topology, std::span<const uint16_t> values, int n_components,
                                        int bits);
// byte_offset of failures counts from the first byte of the section.
Result<std::vector<uint16_t>> decode_face_values(std::span<const uint8_t> bytes, const Topology& topology,
                                                 int n_components, int bits);

}  // namespace pac::geomcodec
