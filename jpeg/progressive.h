// Blocks of progressive scans [T.81 G.1.2, G.2].
#pragma once

#include <cstdint>

#include "jpeg/scan_reader.h"

namespace pac::jpeg {

// What a scan brings of each coefficient [T.81 G.1.1.1]: zigzag positions first..last (Ss, Se), bits from `low` (Al)
// up; `high` (Ah): the bits above which earlier scans have brought, 0 = this is the first.
struct Progression {
  int first = 0, last = 63, high = 0, low = 0;
  bool is_dc() const { return first == 0; }
  bool refines() const { return high != 0; }
};

// One block; `levels` are 64 in natural order, as earlier scans left them. dc: PRED. eob_run: blocks that are known to
// hold nothing new (EOBRUN). Tables may be null where the scan needs none. Values wrap modulo 2^16.
BlockError read_progressive_block(EntropyReader& reader, const Progression& progression, const HuffmanDecoder* dc_table,
                                  const HuffmanDecoder* ac_table, int& dc, uint32_t& eob_run, int16_t* levels);

}  // namespace pac::jpeg
