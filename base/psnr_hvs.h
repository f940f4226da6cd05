// PSNR-HVS and PSNR-HVS-M: PSNR that counts an error in each DCT coefficient as much as the eye does.
//
// Egiazarian et al., "New full-reference quality metrics based on HVS", VPQM 2006 (PSNR-HVS); Ponomarenko et al., "On
// between-coefficient contrast masking of DCT basis functions", VPQM 2007 (PSNR-HVS-M). Blocks of 8x8 samples, side by
// side, are transformed; differences of coefficients are weighted by the contrast sensitivity that lies in JPEG's table
// K.1 [T.81 K.1]. PSNR-HVS-M first takes off what the block's own texture masks, but leaves the DC difference whole.
#pragma once

#include "base/image.h"

namespace pac {

struct PsnrHvs {
  double psnr_hvs_db = 0, psnr_hvs_m_db = 0;  // +infinity where no (visible) difference is left; m is never less
};

// Gray pictures of equal, nonzero size (else PAC_ASSERT). A last row or column of blocks that would lie partly outside
// is left out, as in the authors' program; sides below 8 are extended to 8 by repeating the last row or column.
PsnrHvs psnr_hvs(PlaneView<const uint8_t> reference, PlaneView<const uint8_t> test);

// Of luma_bt601. The metric is blind to color.
PsnrHvs psnr_hvs_luma(ConstRgbView reference, ConstRgbView test);

}  // namespace pac
