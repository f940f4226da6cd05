// What StreamTables hold.
#pragma once

#include "jpeg/abbreviated.h"
#include "jpeg/scan_writer.h"

namespace pac::jpeg {

struct StreamTables::State {
  QuantTables steps;
  ScanTables huffman;  // every symbol of a baseline file has a code
};

}  // namespace pac::jpeg
