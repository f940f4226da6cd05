// Inverse DCTs that make fewer samples of a block: each is the mean of the samples it stands for.
#pragma once

#include <cstddef>
#include <cstdint>

namespace pac::jpeg {

// As BlockKernels::idct_islow, but `size` x `size` samples a block, size 1, 2 or 4: block i at samples + size * i. The
// results are those of the IJG software's reduced transforms on every file that an encoder made; in damaged ones sums
// wrap modulo 2^32.
void idct_reduced(int size, const int16_t* levels, const uint16_t* steps, size_t n_blocks, uint8_t* samples,
                  ptrdiff_t stride);

}  // namespace pac::jpeg
