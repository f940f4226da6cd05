#include "geomcodec/face_values.h"

#include <algorithm>
#include <memory>

#include "geomcodec/attribute_coder.h"

namespace pac::geomcodec {
namespace {

constexpr size_t kMaxComponents = 4;

// Faces coded before that share an edge with this one.
struct FaceNeighbors {
  static constexpr int kMax = 12;
  uint32_t face[kMax];
  int count = 0;

  FaceNeighbors(const Topology& topology, uint32_t of) {
    for (uint32_t corner = topology.face_first[of]; corner < topology.face_first[of + 1] && count < kMax; ++corner) {
      const uint32_t twin = topology.twin[corner];
      if (twin != kNone && topology.face_at(twin) < of) face[count++] = topology.face_at(twin);
    }
  }
};

// One face after the other: whether it is like the face it was entered from, else residuals from its neighbors' mean.
template <class Coder>
class FaceValueCoder {
 public:
  FaceValueCoder(const Topology& topology, Coder& coder, int n_components, int bits)
      : topology_(topology), coder_(coder), n_(static_cast<size_t>(n_components)), bits_(bits), models_(n_) {}

  // values: those of the faces before are complete.
  void code(uint32_t face, std::span<uint16_t> values) {
    classes_.resize(classes_.size() + n_);
    const FaceNeighbors neighbors(topology_, face);
    const uint16_t* expected = neighbors.count > 0 ? at(values, neighbors.face[0])
                               : face > 0          ? at(values, face - 1)
                                                   : kZeros;
    uint16_t* value = values.data() + face * n_;
    AdaptiveBit& model = is_same_[same_][agreement(neighbors, values)];
    same_ = coder_.bit(model, std::equal(value, value + n_, expected) ? 1 : 0);
    if (same_ != 0)
      std::copy_n(expected, n_, value);
    else
      code_residuals(face, neighbors, expected, values);
  }

 private:
  static constexpr uint16_t kZeros[kMaxComponents] = {};

  const uint16_t* at(std::span<const uint16_t> values, uint32_t face) const { return values.data() + face * n_; }
  // 0 no neighbor, 1 one, 2 several with the same values, 3 several with others.
  size_t agreement(const FaceNeighbors& neighbors, std::span<const uint16_t> values) const {
    if (neighbors.count < 2) return neighbors.count == 0 ? 0 : 1;
    const uint16_t* first = at(values, neighbors.face[0]);
    for (int i = 1; i < neighbors.count; ++i)
      if (!std::equal(first, first + n_, at(values, neighbors.face[i]))) return 3;
    return 2;
  }
  void code_residuals(uint32_t face, const FaceNeighbors& neighbors, const uint16_t* expected,
                      std::span<uint16_t> values);

  const Topology& topology_;
  Coder& coder_;
  const size_t n_;
  const int bits_;
  std::vector<ComponentModel> models_;
  AdaptiveBit is_same_[2][4];
  uint32_t same_ = 1;
  std::vector<uint8_t> classes_;  // of the residuals, 0 where a face was like another
};

template <class Coder>
void FaceValueCoder<Coder>::code_residuals(uint32_t face, const FaceNeighbors& neighbors, const uint16_t* expected,
                                           std::span<uint16_t> values) {
  constexpr AttributeBasis kBasis[4] = {kFromPrevious, kFromOne, kFromTwo, kFromMore};
  const AttributeBasis basis = kBasis[std::min(neighbors.count, 3)];
  const int32_t size = 1 << bits_, half = size >> 1;
  uint32_t other = 0;
  int32_t before = 0;
  for (size_t c = 0; c < n_; ++c) {
    int32_t sum = 0, class_sum = 0;
    for (int i = 0; i < neighbors.count; ++i) {
      sum += values[neighbors.face[i] * n_ + c];
      class_sum += classes_[neighbors.face[i] * n_ + c];
    }
    const bool alone = neighbors.count == 0;
    const int32_t prediction = alone ? expected[c] : std::min(scaled_mean(sum, neighbors.count, 0), size - 1);
    if (alone && face > 0) class_sum = classes_[(face - 1) * n_ + c];
    const auto scale = static_cast<uint32_t>(scaled_mean(class_sum, alone ? 1 : neighbors.count, 1));
    uint16_t& value = values[face * n_ + c];
    int32_t residual = ((value - prediction + half) & (size - 1)) - half;  // modulo 2^bits
    residual = models_[c].code(coder_, basis, scale, other, before, residual);
    value = static_cast<uint16_t>((prediction + residual) & (size - 1));
    const uint32_t magnitude = class_of(residual);
    classes_[face * n_ + c] = static_cast<uint8_t>(magnitude);
    other = std::max(other, magnitude);
    before = residual;
  }
}

}  // namespace

std::vector<uint8_t> encode_face_values(const Topology& topology, std::span<const uint16_t> given, int n_components,
                                        int bits) {
  std::vector<uint16_t> values(given.begin(), given.end());
  RangeEncoder coder;
  FaceValueCoder<RangeEncoder> faces(topology, coder, n_components, bits);
  for (uint32_t face = 0; face < topology.n_faces(); ++face) faces.code(face, values);
  return coder.finish();
}

Result<std::vector<uint16_t>> decode_face_values(std::span<const uint8_t> bytes, const Topology& topology,
                                                 int n_components, int bits) {
  RangeDecoder coder(bytes);
  FaceValueCoder<RangeDecoder> faces(topology, coder, n_components, bits);
  std::vector<uint16_t> values(size_t{topology.n_faces()} * static_cast<size_t>(n_components));
  for (uint32_t face = 0; face < topology.n_faces(); ++face) {
    faces.code(face, values);
    if (coder.failed()) return Failure{Error::corrupt, 0, "values of faces end too early"};
  }
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "values of faces do not end where the header says"};
  return values;
}

}  // namespace pac::geomcodec
