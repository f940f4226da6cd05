// The test runner. PAC_ISA=scalar|sse41|avx2|neon runs everything on that instruction set.
#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include <cstdio>
#include <cstdlib>

#include "base/isa.h"

int main(int argc, char** argv) {
  if (const char* name = std::getenv("PAC_ISA"); name != nullptr && *name != '\0') {
    pac::Isa isa;
    if (!pac::parse_isa(name, isa) || !pac::override_best_isa(isa)) {
      std::fprintf(stderr, "PAC_ISA=%s is not built or not supported here\n", name);
      return 1;
    }
  }
  return doctest::Context(argc, argv).run();
}
