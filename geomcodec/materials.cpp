#include "geomcodec/materials.h"

#include <algorithm>

#include "geomcodec/models.h"

namespace pac::geomcodec {
namespace {

// The material of the face that this one was entered from; for the first face of a part, of the face before.
uint32_t expected_material(const Topology& topology, const std::vector<uint32_t>& material, uint32_t face) {
  const uint32_t gate = topology.twin[topology.face_first[face]];
  if (gate != kNone && topology.face_at(gate) < face) return material[topology.face_at(gate)];
  return face > 0 ? material[face - 1] : 0;
}

template <class Coder>
class MaterialCoder {
 public:
  explicit MaterialCoder(Coder& coder) : coder_(coder) {}
  uint32_t code(uint32_t expected, uint32_t wanted) {
    same_ = coder_.bit(is_same_[same_], wanted == expected ? 1 : 0);
    return same_ != 0 ? expected : code_number(coder_, number_, wanted);
  }

 private:
  Coder& coder_;
  AdaptiveBit is_same_[2];
  NumberModel number_;
  uint32_t same_ = 1;
};

// A permutation as steps from each number to the next; the context is the length of the step before.
template <class Coder>
class StepCoder {
 public:
  explicit StepCoder(Coder& coder) : coder_(coder), models_(34) {}
  uint32_t code(uint32_t wanted) {
    const uint32_t expected = last_ + 1;
    const uint32_t step = code_number(coder_, models_[context_], zigzag(static_cast<int32_t>(wanted - expected)));
    context_ = static_cast<size_t>(std::bit_width(step));
    last_ = expected + static_cast<uint32_t>(unzigzag(step));
    return last_;
  }

 private:
  Coder& coder_;
  std::vector<NumberModel> models_;
  size_t context_ = 33;  // at first: no step before
  uint32_t last_ = kNone;
};

// Reads a permutation of 0 .. count - 1; false if it is none.
bool decode_permutation(RangeDecoder& coder, uint32_t count, std::vector<uint32_t>& permutation) {
  StepCoder<RangeDecoder> steps(coder);
  std::vector<uint8_t> seen(count);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t number = steps.code(0);
    if (number >= count || seen[number] != 0 || coder.failed()) return false;
    seen[number] = 1;
    permutation.push_back(number);
  }
  return true;
}

}  // namespace

std::vector<uint8_t> encode_materials(const Topology& topology, std::span<const uint32_t> material) {
  if (std::all_of(material.begin(), material.end(), [](uint32_t m) { return m == 0; })) return {};
  RangeEncoder coder;
  MaterialCoder<RangeEncoder> materials(coder);
  const std::vector<uint32_t> all(material.begin(), material.end());
  for (uint32_t face = 0; face < topology.n_faces(); ++face)
    materials.code(expected_material(topology, all, face), all[face]);
  return coder.finish();
}

Result<std::vector<uint32_t>> decode_materials(std::span<const uint8_t> bytes, const Topology& topology,
                                               uint32_t highest) {
  if (highest == 0) return std::vector<uint32_t>(topology.n_faces());
  std::vector<uint32_t> material;
  material.reserve(topology.n_faces());
  RangeDecoder coder(bytes);
  MaterialCoder<RangeDecoder> materials(coder);
  for (uint32_t face = 0; face < topology.n_faces(); ++face) {
    material.push_back(materials.code(expected_material(topology, material, face), 0));
    if (material.back() > highest) return Failure{Error::corrupt, 0, "material above the highest of the header"};
    if (coder.failed()) return Failure{Error::corrupt, 0, "materials end too early"};
  }
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "materials do not end where the header says"};
  return material;
}

std::vector<uint8_t> encode_order(const Topology& topology, const WalkOrder& order) {
  RangeEncoder coder;
  StepCoder<RangeEncoder> vertices(coder), faces(coder);
  for (const uint32_t vertex : order.vertex) vertices.code(vertex);
  for (const uint32_t face : order.face) faces.code(face);
  std::vector<NumberModel> rotation(1);
  for (uint32_t face = 0; face < topology.n_faces(); ++face) code_number(coder, rotation[0], order.first_corner[face]);
  return coder.finish();
}

Result<WalkOrder> decode_order(std::span<const uint8_t> bytes, const Topology& topology, uint32_t n_vertices) {
  RangeDecoder coder(bytes);
  WalkOrder order;
  if (!decode_permutation(coder, n_vertices, order.vertex))
    return Failure{Error::corrupt, 0, "vertex order is damaged"};
  if (!decode_permutation(coder, topology.n_faces(), order.face))
    return Failure{Error::corrupt, 0, "face order is damaged"};
  std::vector<NumberModel> rotation(1);
  for (uint32_t face = 0; face < topology.n_faces(); ++face) {
    const uint32_t first = code_number(coder, rotation[0], 0);
    if (first >= topology.face_size(face) || coder.failed()) return Failure{Error::corrupt, 0, "face order is damaged"};
    order.first_corner.push_back(first);
  }
  if (!coder.ends_exactly()) return Failure{Error::corrupt, 0, "order does not end where the header says"};
  return order;
}

}  // namespace pac::geomcodec
