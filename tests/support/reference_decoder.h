// The decoders in Python that were written from FORMAT.md: what they print of a mesh, and running them.
#pragma once

#include <cstdint>
#include <string>

#include "geomcodec/geomcodec.h"

namespace pac::test {

// FNV-1a over 32-bit values.
class Fnv {
 public:
  void add(uint32_t value) { hash_ = (hash_ ^ value) * 1099511628211u; }
  uint64_t hash() const { return hash_; }

 private:
  uint64_t hash_ = 1469598103934665603u;
};

// A line: vertices, faces, hash of everything decoded.
std::string summary(const geomcodec::QuantizedMesh& mesh);

// Runs `script` of tests/ with these arguments; a failure of the running test unless it succeeds and prints `expected`.
void require_decoded(const std::string& script, const std::string& arguments, const std::string& expected);

}  // namespace pac::test
