// Results of the paper's experiments made up from gradients: every field that the page reads, at a small size.
#pragma once

#include "sim/paper_figures.h"

namespace pac::test {

// side: pixels of the square pictures, >= 16.
sim::PaperResults mock_results(int side);

}  // namespace pac::test
