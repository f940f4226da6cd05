// The bytes between server and client: a session message (once) and one packet a frame. Little-endian throughout.
//
//   session  "PACM" version u16 flags u16 | width u32 height u32 | RenderQuality 4 x u8 | background 3 x f32
//            (the fourth: 1 where back faces are culled, and twice RenderQuality::shading_samples)
//            | resident model (to the end; absent where the model is transmitted) | CRC-32 u32
//   frame    "PACF" version u16 codec u8 flags u8 | frame u32 | camera 19 x f32 | coded quality f64 | hash of L u64
//            | model length u32 difference length u32 | where flag 2 says so: the objects' transforms against the
//            resident model's (sim/object_code.h), to a whole byte | model bytes | difference bytes | CRC-32 u32
//   short    0xF1 | low 8 bits of the frame number of the last "PACF" u8 | frames since then u8 | low 32 bits of the
//            hash of L u32 | camera against that packet's (sim/camera_code.h), then the objects' transforms (a model
//            without objects: no bits), to a whole byte | difference bytes | CRC-32 u32
// Short packets carry the video pictures between two that stand alone. Each leans on the whole packet before it only: a
// short one that is lost takes no other with it.
// The CRC [ISO 3309, as in PNG] covers all bytes before it. Floats travel as their raw bits, so that both sides draw
// with the same numbers.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/file_io.h"
#include "base/result.h"
#include "raster/renderer.h"
#include "raster/scene.h"
#include "sim/object_motion.h"

namespace pac::sim {

enum class Codec : uint8_t { jpeg = 1, mpeg1 = 2, predicted_jpeg = 3 };  // the last: sim/predicted_stills.h

constexpr uint16_t kProtocolVersion = 1;
constexpr size_t kFramePacketOverhead = 116;  // bytes of a frame packet beside objects, model and difference

// Decoded form of one frame packet. The spans point into the packet.
struct FramePacket {
  uint32_t frame = 0;
  Codec codec = Codec::jpeg;
  bool has_model = false;  // the low-quality model travels with the frame
  raster::Camera camera;
  double quality = 0;     // coded quality of the difference image, for display only
  uint64_t low_hash = 0;  // image_hash of the L that the server subtracted
  bool is_short = false;  // codec mpeg1, no model; of low_hash the low 32 bits only, quality 0
  std::span<const uint8_t> model;
  std::span<const uint8_t> difference;
  Transforms objects;  // of the resident model; to be written, empty: as in the session message
};

// `rest`: the objects of the resident model as the session message has them. packet.objects are as many, or none.
Bytes write_frame_packet(const FramePacket& packet, std::span<const glm::mat4> rest = {});

// Fails with truncated (shorter than it says), corrupt (magic, CRC, lengths, bytes after the end, camera or transforms
// not finite, transforms of objects that the model has not) or unsupported (version, codec). Failure::byte_offset is
// the offending field's.
Result<FramePacket> read_frame_packet(std::span<const uint8_t> bytes, std::span<const glm::mat4> rest = {});

// The frame packets of one session, in order of sending.
class PacketWriter {
 public:
  PacketWriter() = default;
  explicit PacketWriter(Transforms rest) : rest_(std::move(rest)) {}

  // A short packet where it may be: codec mpeg1, not `stands_alone`, at most 250 frames after the last whole one.
  Bytes write(const FramePacket& packet, bool stands_alone);

  // Of what write() would make, without model and difference.
  uint64_t overhead_bytes(FramePacket packet, bool stands_alone) const;

 private:
  Transforms rest_;
  std::optional<FramePacket> whole_;  // the last; camera, number and objects only
};

class PacketReader {
 public:
  PacketReader() = default;
  explicit PacketReader(Transforms rest) : rest_(std::move(rest)) {}

  // As read_frame_packet; corrupt where a short packet leans on a whole one that did not arrive: only a picture that
  // stands alone helps then.
  Result<FramePacket> read(std::span<const uint8_t> bytes);

 private:
  Transforms rest_;
  std::optional<FramePacket> whole_;
};

struct SessionMessage {
  int width = 0, height = 0;  // pixels, 1..65535
  raster::RenderQuality low;  // how the client draws L
  glm::vec3 background{0};
  bool has_model = false;          // the model is resident
  std::span<const uint8_t> model;  // serialize_model()'s bytes
};

Bytes write_session_message(const SessionMessage& message);
Result<SessionMessage> read_session_message(std::span<const uint8_t> bytes);

// A Scene without loss, in the fewest plain fields that its drawing needs: normals only where a material is lit,
// texture coordinates and mip level 0 only where `textured` (else each texture is its mean color). Vertices keep their
// order, so that the objects' ranges hold.
Bytes serialize_model(const raster::Scene& scene, bool textured);

// Fails with truncated, corrupt or limit_exceeded; the scene that comes back passes validate().
Result<raster::Scene> parse_model(std::span<const uint8_t> bytes, const Limits& limits = {});

}  // namespace pac::sim
