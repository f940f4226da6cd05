// encode_frame(): the motion, then each group as the best of a few choices leaves it.
#include <algorithm>

#include "geomcodec/frame_coder.h"
#include "geomcodec/frame_motion.h"
#include "geomcodec/mesh_check.h"

namespace pac::geomcodec {
namespace {

Result<void> check_pair(const QuantizedMesh& mesh, const QuantizedMesh& reference, const FrameOptions& options) {
  PAC_CHECK(check_mesh(mesh));
  PAC_CHECK(check_mesh(reference));
  if (mesh.vertices.size() != reference.vertices.size() || mesh.faces.size() != reference.faces.size())
    return Failure{Error::bad_argument, 0, "frame and reference have not as many vertices and faces"};
  if (mesh.normal_bits != reference.normal_bits || mesh.texcoord_bits != reference.texcoord_bits ||
      mesh.texcoord_step != reference.texcoord_step ||
      !std::equal(mesh.texcoord_origin, mesh.texcoord_origin + 2, reference.texcoord_origin))
    return Failure{Error::bad_argument, 0, "frame and reference differ in the grids of normals or texture"};
  if (mesh.face_bits != reference.face_bits || mesh.face_components != reference.face_components ||
      mesh.face_values != reference.face_values)
    return Failure{Error::bad_argument, 0, "frame and reference differ in the values of faces"};
  for (size_t f = 0; f < mesh.faces.size(); ++f) {
    const Face &one = mesh.faces[f], &other = reference.faces[f];
    const uint32_t* corners = mesh.indices.data() + one.first;
    if (one.count != other.count || one.material != other.material ||
        !std::equal(corners, corners + one.count, reference.indices.data() + other.first))
      return Failure{Error::bad_argument, f, "frame and reference differ in a face"};
  }
  if (options.motion != nullptr && !within_bounds(*options.motion))
    return Failure{Error::bad_argument, 0, "motion is out of bounds"};
  if (options.decoder_has_motion && options.motion == nullptr)
    return Failure{Error::bad_argument, 0, "no motion for the decoder to have"};
  return {};
}

// Everything that the groups of one frame share.
struct FrameSource {
  const QuantizedMesh& mesh;
  const QuantizedMesh& reference;
  FrameNeighbors neighbors;
  std::vector<uint32_t> sibling;
};

std::vector<uint8_t> encode_group(const FrameSource& source, FrameGroup group, const FrameValues& expected,
                                  FrameValues& values, const FrameChoice& choice) {
  RangeEncoder range_coder;
  const std::span<const uint32_t> sibling = group == kFramePositions ? source.sibling : std::span<const uint32_t>{};
  FrameCoder<RangeEncoder> coder(source.neighbors, sibling, expected, frame_shape(group, source.mesh), range_coder);
  coder.begin(choice);
  for (uint32_t v = 0; v < values.size(); ++v) coder.code(v, values);
  return range_coder.finish();
}

// The shortest over how far vertices follow their neighbors and components the first one.
std::vector<uint8_t> encode_best(const FrameSource& source, FrameGroup group, const FrameValues& expected,
                                 FrameValues& values) {
  FrameChoice best{0, group == kFrameColors};
  std::vector<uint8_t> best_bytes = encode_group(source, group, expected, values, best);
  const auto try_choice = [&](const FrameChoice& choice) {
    std::vector<uint8_t> bytes = encode_group(source, group, expected, values, choice);
    if (bytes.size() >= best_bytes.size()) return;
    best_bytes = std::move(bytes);
    best = choice;
  };
  for (const uint32_t share : {FrameChoice::kWhole, FrameChoice::kWhole / 2}) try_choice({share, best.follows_first});
  if (group == kFrameColors) try_choice({best.share, false});
  return best_bytes;
}

struct CodedPositions {
  MotionKind kind = MotionKind::still;
  FrameMotion motion;
  bool changed = false;
  std::vector<uint8_t> bytes;
  uint64_t cost = 0;  // with the motion
};

CodedPositions encode_moved(const FrameSource& source, MotionKind kind, const FrameMotion& motion) {
  constexpr uint64_t kMotionBytes = 100;  // an estimate
  CodedPositions coded;
  coded.kind = kind;
  coded.motion = motion;
  const QuantizedMesh expected = moved(source.reference, motion, grid_of(source.mesh));
  const FrameValues expected_values = frame_values(kFramePositions, expected.vertices);
  FrameValues values = frame_values(kFramePositions, source.mesh.vertices);
  coded.changed = values != expected_values;
  if (coded.changed) coded.bytes = encode_best(source, kFramePositions, expected_values, values);
  coded.cost = coded.bytes.size() + (kind == MotionKind::in_stream ? kMotionBytes : 0);
  return coded;
}

CodedPositions encode_positions_of_frame(const FrameSource& source, const FrameOptions& options) {
  CodedPositions best = encode_moved(source, MotionKind::still, FrameMotion{});
  const auto try_motion = [&](MotionKind kind, const FrameMotion& motion) {
    if (best.cost == 0) return;
    CodedPositions coded = encode_moved(source, kind, motion);
    if (coded.cost < best.cost) best = std::move(coded);
  };
  if (options.motion != nullptr)
    try_motion(options.decoder_has_motion ? MotionKind::callers : MotionKind::in_stream, *options.motion);
  FrameMotion fitted;
  if (best.cost > 100 && fit_motion(source.reference.vertices, source.reference.position_bits, source.mesh.vertices,
                                    source.mesh.position_bits, fitted))
    try_motion(MotionKind::in_stream, fitted);
  return best;
}

bool same_grid(const QuantizedMesh& mesh, const QuantizedMesh& reference) {
  return mesh.position_bits == reference.position_bits && std::equal(mesh.origin, mesh.origin + 3, reference.origin) &&
         std::equal(mesh.step, mesh.step + 3, reference.step);
}

}  // namespace

Result<std::vector<uint8_t>> encode_frame(const QuantizedMesh& mesh, const QuantizedMesh& reference,
                                          const FrameOptions& options, FrameSize* size) {
  PAC_CHECK(check_pair(mesh, reference, options));
  const FrameSource source{mesh, reference, FrameNeighbors(reference), frame_siblings(reference.vertices)};
  FrameHeader header;
  header.own_grid = !same_grid(mesh, reference);
  header.grid = grid_of(mesh);
  header.n_vertices = static_cast<uint32_t>(mesh.vertices.size());

  std::array<std::vector<uint8_t>, kFrameGroups> sections;
  CodedPositions positions = encode_positions_of_frame(source, options);
  header.motion_kind = positions.kind;
  header.motion = positions.motion;
  header.changed[kFramePositions] = positions.changed;
  sections[kFramePositions] = std::move(positions.bytes);
  for (const FrameGroup group : {kFrameColors, kFrameNormals, kFrameTexcoords}) {
    const FrameValues expected = frame_values(group, reference.vertices);
    FrameValues values = frame_values(group, mesh.vertices);
    header.changed[group] = values != expected;
    if (header.changed[group]) sections[group] = encode_best(source, group, expected, values);
  }
  header.reference_checksum =
      reference_checksum(reference, header.motion_kind == MotionKind::callers ? &header.motion : nullptr);

  uint64_t header_bytes = 0;
  std::vector<uint8_t> stream = write_frame(header, sections, header_bytes);
  if (size != nullptr)
    *size = {header_bytes, sections[kFramePositions].size(), sections[kFrameColors].size(),
             sections[kFrameNormals].size(), sections[kFrameTexcoords].size()};
  return stream;
}

}  // namespace pac::geomcodec
