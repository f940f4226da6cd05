// Which instruction sets exist, which this build holds, which this processor runs.
#pragma once

#include <cstdint>
#include <string_view>

namespace pac {

// In ascending order: each table starts from the ones before it that apply to the same architecture.
enum class Isa : uint8_t { scalar, sse41, avx2, neon };
constexpr int kIsaCount = 4;

// "scalar", "sse41", "avx2", "neon".
const char* isa_name(Isa isa);

// The Isa of that name, or false with `isa` untouched.
bool parse_isa(std::string_view name, Isa& isa);

// Kernels for it are in this binary.
bool isa_is_built(Isa isa);

// This processor (and operating system) executes it. scalar: always.
bool isa_is_supported(Isa isa);

// The best that is both built and supported, or what override_best_isa() chose.
Isa best_isa();

// For programs that take an --isa option, called once at their start before any kernel is used: from then on best_isa()
// and kernels() answer `isa`. False, with nothing changed, where it is not built or not supported. Libraries never call
// it.
bool override_best_isa(Isa isa);

}  // namespace pac
