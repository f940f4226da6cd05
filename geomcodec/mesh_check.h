// What encode() demands of a mesh.
#pragma once

#include "base/result.h"
#include "geomcodec/geomcodec.h"

namespace pac::geomcodec {

// Fails with bad_argument: bits out of range, a grid that is not finite, a value above its grid, a face that reaches
// outside the lists, too many vertices or corners. byte_offset is the number of the vertex or face.
Result<void> check_mesh(const QuantizedMesh& mesh);

}  // namespace pac::geomcodec
