// Frames of a sequence against a reference: the same mesh back, what each kind of change costs, what is refused.
#include <doctest/doctest.h>

#include <string>

#include "base/exact_math.h"
#include "geomcodec/frames.h"
#include "tests/support/mesh_zoo.h"
#include "tests/support/peer.h"
#include "tests/support/reference_decoder.h"

namespace {

using pac::Error;
using pac::geomcodec::decode;
using pac::geomcodec::decode_frame;
using pac::geomcodec::encode;
using pac::geomcodec::encode_frame;
using pac::geomcodec::frame_motion;
using pac::geomcodec::FrameMotion;
using pac::geomcodec::FrameSize;
using pac::geomcodec::Grid;
using pac::geomcodec::grid_of;
using pac::geomcodec::moved;
using pac::geomcodec::QuantizedMesh;
using pac::geomcodec::reorder;
using pac::test::mesh_zoo;
using pac::test::NamedMesh;
using pac::test::same;
using pac::test::summary;
using pac::test::TempDir;

using Bytes = std::vector<uint8_t>;

class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed * 2 + 1) {}
  uint32_t below(uint32_t bound) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<uint32_t>(state_ >> 33) % bound;
  }

 private:
  uint64_t state_;
};

// Every third vertex somewhere near, with other attributes.
QuantizedMesh disturbed(QuantizedMesh mesh, uint64_t seed) {
  Random random(seed);
  const uint32_t highest = (1u << mesh.position_bits) - 1;
  for (auto& vertex : mesh.vertices) {
    if (random.below(3) != 0) continue;
    for (uint16_t& coordinate : vertex.position)
      coordinate = static_cast<uint16_t>((coordinate + random.below(17)) & highest);
    for (uint8_t& channel : vertex.color) channel = static_cast<uint8_t>(channel + random.below(5));
    if (mesh.normal_bits != 0)
      for (uint16_t& component : vertex.normal)
        component = static_cast<uint16_t>(random.below((1u << mesh.normal_bits) - 1));
    if (mesh.texcoord_bits != 0)
      for (uint16_t& component : vertex.texcoord)
        component = static_cast<uint16_t>(random.below(1u << mesh.texcoord_bits));
  }
  return mesh;
}

// A camera that turned by `degrees` around the up axis and stepped aside: last frame's screen to this one's, by way of
// the model. Screen: 1/16 pixel of 640 x 480 and a depth of 16 bits.
struct Camera {
  double angle, x;
  void matrix(double (&m)[4][4]) const {
    const double c = pac::exact_cos(angle), s = pac::exact_sin(angle);
    const double depth[4] = {s, 0, c, 4.0}, right[4] = {c, 0, -s, x};
    for (int j = 0; j < 4; ++j) {
      m[3][j] = depth[j];
      m[0][j] = 16 * (480 * right[j] + 320 * depth[j]);
      m[1][j] = 16 * 240 * depth[j];
      m[2][j] = 65535 * (1.2 * depth[j]);
    }
    m[1][1] -= 16 * 480.0;
    m[2][3] -= 65535 * 2.4;  // 0 at depth 2
  }
};

FrameMotion to_screen(const Camera& camera, const QuantizedMesh& model) {
  double m[4][4];
  camera.matrix(m);
  Grid unit = grid_of(model);  // the model's grid as -1 .. 1
  for (int axis = 0; axis < 3; ++axis) {
    unit.origin[axis] = -1;
    unit.step[axis] = 2.0f / 65535;
  }
  return frame_motion(m, unit, Grid{}).value();
}

TEST_CASE("every mesh of the zoo, disturbed, comes back bit for bit from its frame") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    const QuantizedMesh reference = decode(encode(entry.mesh).value()).value();
    const QuantizedMesh frame = disturbed(reference, entry.mesh.faces.size());
    FrameSize size;
    const auto bytes = encode_frame(frame, reference, {}, &size);
    REQUIRE(bytes.ok());
    REQUIRE(size.header_bytes + size.position_bytes + size.color_bytes + size.normal_bytes + size.texcoord_bytes ==
            bytes->size());
    const auto decoded = decode_frame(*bytes, reference);
    REQUIRE(decoded.ok());
    REQUIRE(same(*decoded, frame));
  }
}

TEST_CASE("geometry that stands still costs less than 50 bytes a frame, whatever its size") {
  for (const NamedMesh& entry : mesh_zoo()) {
    CAPTURE(entry.name);
    const QuantizedMesh reference = reorder(entry.mesh);
    const Bytes bytes = encode_frame(reference, reference).value();
    REQUIRE(bytes.size() < 50);
    REQUIRE(same(decode_frame(bytes, reference).value(), reference));
  }
}

TEST_CASE("a view of the model by a camera that the decoder knows costs less than 50 bytes, 150 where it does not") {
  const QuantizedMesh model = reorder(pac::test::pin_mesh(32, 47, 16));
  const FrameMotion motion = to_screen({0.3, 0.1}, model);
  const QuantizedMesh view = moved(model, motion, Grid{});
  const Bytes known = encode_frame(view, model, {&motion, true}).value();
  REQUIRE(known.size() < 50);
  REQUIRE(same(decode_frame(known, model, &motion).value(), view));
  const Bytes sent = encode_frame(view, model, {&motion, false}).value();
  REQUIRE(sent.size() < 150);
  REQUIRE(same(decode_frame(sent, model).value(), view));
}

TEST_CASE("screen coordinates under a moving camera cost less than half of a new mesh") {
  const QuantizedMesh model = reorder(pac::test::pin_mesh(32, 47, 16));
  const QuantizedMesh before = moved(model, to_screen({0.30, 0.10}, model), Grid{});
  const QuantizedMesh after = moved(model, to_screen({0.32, 0.11}, model), Grid{});
  FrameSize alone;
  const Bytes frame = encode_frame(after, before, {}, &alone).value();
  REQUIRE(same(decode_frame(frame, before).value(), after));
  pac::geomcodec::EncodedSize anew;
  REQUIRE(encode(after, {}, &anew).ok());
  REQUIRE(2 * alone.position_bytes < anew.position_bytes);
}

TEST_CASE("a part that moves costs in proportion to it, not to the mesh") {
  const QuantizedMesh reference = reorder(pac::test::wave_mesh(60, 60, true));
  QuantizedMesh frame = reference;
  for (size_t v = 1000; v < 1100; ++v)
    frame.vertices[v].position[2] = static_cast<uint16_t>(frame.vertices[v].position[2] ^ 5);
  const Bytes bytes = encode_frame(frame, reference).value();
  REQUIRE(bytes.size() < 350);
  REQUIRE(same(decode_frame(bytes, reference).value(), frame));
}

TEST_CASE("a sequence of frames, each against the one before, stays exact") {
  QuantizedMesh sender = reorder(pac::test::pin_mesh(16, 20, 12)), receiver = sender;
  for (uint64_t frame = 1; frame <= 10; ++frame) {
    const QuantizedMesh next = disturbed(sender, frame);
    const Bytes bytes = encode_frame(next, sender).value();
    receiver = decode_frame(bytes, receiver).value();
    REQUIRE(same(receiver, next));
    sender = next;
  }
}

TEST_CASE("a frame is refused against another reference, another motion, without its motion, cut or lengthened") {
  const QuantizedMesh reference = reorder(pac::test::wave_mesh(12, 9, true));
  QuantizedMesh other = reference;
  other.vertices[7].color[1] ^= 1;
  const QuantizedMesh frame = disturbed(reference, 5);
  Bytes bytes = encode_frame(frame, reference).value();
  REQUIRE(decode_frame(bytes, other).failure().error == Error::corrupt);
  REQUIRE(decode_frame(bytes, {}).failure().error == Error::corrupt);
  for (size_t size = 0; size < bytes.size(); ++size)
    REQUIRE(
        decode_frame(Bytes(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size)), reference).failure().error ==
        Error::truncated);
  bytes.push_back(0);
  REQUIRE(decode_frame(bytes, reference).failure().error == Error::corrupt);

  FrameMotion motion;
  motion.row[0][3] = int64_t{3} << 30;
  const Bytes known = encode_frame(moved(reference, motion, grid_of(reference)), reference, {&motion, true}).value();
  REQUIRE(decode_frame(known, reference).failure().error == Error::bad_argument);
  FrameMotion wrong = motion;
  wrong.row[1][3] = 1;
  REQUIRE(decode_frame(known, reference, &wrong).failure().error == Error::corrupt);
  REQUIRE(decode_frame(known, reference, &motion).ok());
}

TEST_CASE("corrupted frames decode to a sound mesh or fail") {
  const QuantizedMesh reference = reorder(pac::test::wave_mesh(12, 9, true));
  const Bytes good = encode_frame(disturbed(reference, 5), reference).value();
  Random random(9);
  for (int i = 0; i < 20000; ++i) {
    Bytes bytes = good;
    for (uint32_t n = 1 + random.below(4); n > 0; --n)
      bytes[random.below(static_cast<uint32_t>(bytes.size()))] ^= static_cast<uint8_t>(1 + random.below(255));
    const auto decoded = decode_frame(bytes, reference);
    if (decoded.ok()) REQUIRE(decoded->vertices.size() == reference.vertices.size());
  }
}

TEST_CASE("encode_frame refuses meshes that do not fit together") {
  const QuantizedMesh reference = reorder(pac::test::wave_mesh(6, 5, true));
  QuantizedMesh frame = reference;
  frame.vertices.emplace_back();
  REQUIRE(encode_frame(frame, reference).failure().error == Error::bad_argument);
  frame = reference;
  std::swap(frame.indices[0], frame.indices[1]);
  REQUIRE(encode_frame(frame, reference).failure().error == Error::bad_argument);
  frame = reference;
  frame.faces[2].material = 9;
  REQUIRE(encode_frame(frame, reference).failure().error == Error::bad_argument);
  frame = reference;
  frame.face_bits = frame.face_components = 1;
  frame.face_values.assign(frame.faces.size(), 1);
  REQUIRE(encode_frame(frame, reference).failure().error == Error::bad_argument);
  QuantizedMesh other = frame;
  other.face_values[0] = 0;
  REQUIRE(encode_frame(frame, other).failure().error == Error::bad_argument);
  const auto still = encode_frame(frame, frame);
  REQUIRE(still.ok());
  REQUIRE(pac::test::same(decode_frame(*still, frame).value(), frame));
  REQUIRE(decode_frame(*still, other).failure().error == Error::corrupt);
  FrameMotion far;
  far.row[0][0] = int64_t{1} << 50;
  REQUIRE(encode_frame(reference, reference, {&far, false}).failure().error == Error::bad_argument);
  REQUIRE(encode_frame(reference, reference, {nullptr, true}).failure().error == Error::bad_argument);
}

TEST_CASE("a decoder of frames written from FORMAT.md alone, in another language, reads ours") {
  if (!pac::test::have_peer("python3")) return;
  const TempDir folder;
  std::string arguments, expected;
  int n_files = 0;
  const auto add = [&](const Bytes& stream, const Bytes& frame, const QuantizedMesh& decoded,
                       const std::string& motion) {
    for (const Bytes* bytes : {&stream, &frame}) {
      const std::string file = folder.file(std::to_string(n_files++));
      pac::test::write_bytes(file, *bytes);
      arguments += " " + file;
    }
    arguments += " " + motion;
    expected += summary(decoded);
  };
  for (const NamedMesh& entry : mesh_zoo()) {
    if (entry.mesh.indices.size() > 1200 || entry.mesh.vertices.size() > 1200) continue;
    const Bytes stream = encode(entry.mesh).value();
    const QuantizedMesh reference = decode(stream).value(), frame = disturbed(reference, 3);
    add(stream, encode_frame(frame, reference).value(), frame, "-");
  }
  const Bytes stream = encode(pac::test::pin_mesh(12, 15, 16)).value();
  const QuantizedMesh model = decode(stream).value();
  const FrameMotion motion = to_screen({0.2, 0.0}, model);
  std::string numbers;
  for (const auto& row : motion.row)
    for (const int64_t entry : row) {
      if (!numbers.empty()) numbers += ',';
      numbers += std::to_string(entry);
    }
  const QuantizedMesh view = disturbed(moved(model, motion, Grid{}), 4);
  add(stream, encode_frame(view, model, {&motion, true}).value(), view, numbers);
  add(stream, encode_frame(view, model, {&motion, false}).value(), view, "-");
  pac::test::require_decoded("pgf_reference_decoder.py", arguments, expected);
}

}  // namespace
