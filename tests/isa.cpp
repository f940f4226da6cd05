#include "base/isa.h"

#include <doctest/doctest.h>

#include <cstdlib>
#include <string>

#include "base/kernels/kernels.h"

namespace {

using pac::Isa;

TEST_CASE("every name parses to the instruction set that prints it, and nothing else does") {
  for (int i = 0; i < pac::kIsaCount; ++i) {
    Isa isa = Isa::scalar;
    REQUIRE(pac::parse_isa(pac::isa_name(static_cast<Isa>(i)), isa));
    CHECK(isa == static_cast<Isa>(i));
  }
  Isa untouched = Isa::avx2;
  CHECK_FALSE(pac::parse_isa("sse9", untouched));
  CHECK_FALSE(pac::parse_isa("", untouched));
  CHECK(untouched == Isa::avx2);
}

TEST_CASE("scalar kernels exist everywhere, and the best table is one that this processor runs") {
  REQUIRE(pac::kernels_for(Isa::scalar) != nullptr);
  CHECK(pac::isa_is_built(pac::best_isa()));
  CHECK(pac::isa_is_supported(pac::best_isa()));
  CHECK(pac::kernels().isa == pac::best_isa());
  CHECK(&pac::kernels() == pac::kernels_for(pac::best_isa()));
}

TEST_CASE("a table exists exactly for the instruction sets that are built and supported") {
  for (int i = 0; i < pac::kIsaCount; ++i) {
    const auto isa = static_cast<Isa>(i);
    CHECK((pac::kernels_for(isa) != nullptr) == (pac::isa_is_built(isa) && pac::isa_is_supported(isa)));
  }
}

TEST_CASE("PAC_ISA chooses the instruction set of the whole run") {
  const char* name = std::getenv("PAC_ISA");
  if (name == nullptr || *name == '\0') return;
  CHECK(std::string(pac::isa_name(pac::kernels().isa)) == name);
}

}  // namespace
