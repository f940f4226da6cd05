#include "sim/packet.h"

#include <algorithm>
#include <cmath>

#include "base/checksum.h"
#include "sim/byte_stream.h"
#include "sim/camera_code.h"
#include "sim/object_code.h"

namespace pac::sim {

namespace {

constexpr uint32_t kFrameMagic = 0x46434150;    // "PACF"
constexpr uint32_t kSessionMagic = 0x4D434150;  // "PACM"
constexpr size_t kCrcBytes = 4;
constexpr uint8_t kHasModel = 1, kMovesObjects = 2;
constexpr uint8_t kShortMagic = 0xF1;
// Less than 256, so that the next whole packet's number differs in its low 8 bits.
constexpr uint32_t kMostFramesSince = 250;
constexpr size_t kShortHead = 7;  // bytes before the camera

Bytes with_crc(ByteWriter& writer) {
  writer.u32(crc32(writer.bytes()));
  return writer.take();
}

// The bytes that the checksum covers, once magic, version and checksum are right.
Result<std::span<const uint8_t>> checked_body(std::span<const uint8_t> bytes, uint32_t magic) {
  if (bytes.size() < 6 + kCrcBytes) return Failure{Error::truncated, bytes.size(), "message shorter than its header"};
  ByteReader head(bytes);
  if (head.u32() != magic) return Failure{Error::corrupt, 0, "not a message of this kind"};
  if (head.u16() != kProtocolVersion) return Failure{Error::unsupported, 4, "unknown protocol version"};
  const auto body = bytes.first(bytes.size() - kCrcBytes);
  if (ByteReader(bytes.last(kCrcBytes)).u32() != crc32(body))
    return Failure{Error::corrupt, body.size(), "checksum does not match"};
  return body;
}

void write_camera(ByteWriter& writer, const raster::Camera& camera) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) writer.f32(camera.clip_from_world[column][row]);
  for (int axis = 0; axis < 3; ++axis) writer.f32(camera.eye[axis]);
}

// False where a number is not finite.
bool read_camera(ByteReader& reader, raster::Camera& camera) {
  bool finite = true;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) {
      camera.clip_from_world[column][row] = reader.f32();
      finite = finite && std::isfinite(camera.clip_from_world[column][row]);
    }
  for (int axis = 0; axis < 3; ++axis) {
    camera.eye[axis] = reader.f32();
    finite = finite && std::isfinite(camera.eye[axis]);
  }
  return finite;
}

Result<raster::RenderQuality> read_render_quality(ByteReader& reader) {
  const size_t at = reader.position();
  const uint8_t shading = reader.u8(), texture = reader.u8(), samples = reader.u8(), cull = reader.u8();
  if (shading > static_cast<uint8_t>(raster::Shading::phong))
    return Failure{Error::corrupt, at, "unknown kind of shading"};
  const int shading_samples = cull >> 1;
  if (texture > 1) return Failure{Error::corrupt, at + 1, "flag is neither 0 nor 1"};
  if (samples != 1 && samples != 4 && samples != 16 && samples != 64)
    return Failure{Error::corrupt, at + 2, "samples a pixel are not 1, 4, 16 or 64"};
  if (shading_samples != 0 && ((shading_samples != 1 && shading_samples != 4) || shading_samples >= samples))
    return Failure{Error::corrupt, at + 3, "shading samples a pixel are not 0, or 1 or 4 and fewer than samples"};
  raster::RenderQuality quality;
  quality.shading = static_cast<raster::Shading>(shading);
  quality.texture = texture != 0;
  quality.samples = samples;
  quality.cull_back_faces = (cull & 1) != 0;
  quality.shading_samples = shading_samples;
  return quality;
}

bool same_transforms(std::span<const glm::mat4> a, std::span<const glm::mat4> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_transform);
}

// False where one is none that a model can have.
bool are_transforms(const Transforms& objects) {
  return std::all_of(objects.begin(), objects.end(), is_transform);
}

// What `packet` says of objects, `rest` where it says nothing.
std::span<const glm::mat4> objects_of(const FramePacket& packet, std::span<const glm::mat4> rest) {
  PAC_ASSERT(packet.objects.empty() || packet.objects.size() == rest.size());
  return packet.objects.empty() ? rest : packet.objects;
}

// Behind the fixed fields of a whole packet.
Result<Transforms> read_objects(ByteReader& reader, std::span<const uint8_t> body, std::span<const glm::mat4> rest) {
  const size_t at = reader.position();
  if (rest.empty()) return Failure{Error::corrupt, 7, "packet moves objects that the model does not have"};
  BitReader bits(body.subspan(at));
  Transforms objects = read_object_changes(bits, rest);
  bits.align_to_byte();
  if (bits.overrun()) return Failure{Error::truncated, body.size(), "packet ends inside its objects"};
  if (!are_transforms(objects)) return Failure{Error::corrupt, at, "object's transform is not finite"};
  reader.raw(bits.byte_offset());
  return objects;
}

}  // namespace

Bytes write_frame_packet(const FramePacket& packet, std::span<const glm::mat4> rest) {
  const std::span<const glm::mat4> objects = objects_of(packet, rest);
  const bool moves = !same_transforms(objects, rest);
  ByteWriter writer;
  writer.u32(kFrameMagic);
  writer.u16(kProtocolVersion);
  writer.u8(static_cast<uint8_t>(packet.codec));
  writer.u8(static_cast<uint8_t>((packet.has_model ? kHasModel : 0) | (moves ? kMovesObjects : 0)));
  writer.u32(packet.frame);
  write_camera(writer, packet.camera);
  writer.f64(packet.quality);
  writer.u64(packet.low_hash);
  writer.u32(static_cast<uint32_t>(packet.model.size()));
  writer.u32(static_cast<uint32_t>(packet.difference.size()));
  if (moves) {
    BitWriter changes;
    write_object_changes(changes, objects, rest);
    writer.raw(changes.take());
  }
  writer.raw(packet.model);
  writer.raw(packet.difference);
  return with_crc(writer);
}

Result<FramePacket> read_frame_packet(std::span<const uint8_t> bytes, std::span<const glm::mat4> rest) {
  PAC_TRY(const auto body, checked_body(bytes, kFrameMagic));
  ByteReader reader(body);
  reader.raw(6);
  FramePacket packet;
  const uint8_t codec = reader.u8(), flags = reader.u8();
  if (codec < static_cast<uint8_t>(Codec::jpeg) || codec > static_cast<uint8_t>(Codec::predicted_jpeg))
    return Failure{Error::unsupported, 6, "unknown codec"};
  if ((flags & ~(kHasModel | kMovesObjects)) != 0) return Failure{Error::unsupported, 7, "unknown flag"};
  packet.codec = static_cast<Codec>(codec);
  packet.has_model = (flags & kHasModel) != 0;
  packet.frame = reader.u32();
  if (!read_camera(reader, packet.camera)) return Failure{Error::corrupt, 12, "camera is not finite"};
  packet.quality = reader.f64();
  packet.low_hash = reader.u64();
  const size_t lengths_at = reader.position();
  const uint64_t model_bytes = reader.u32(), difference_bytes = reader.u32();
  if (reader.overrun()) return Failure{Error::truncated, body.size(), "packet ends inside its header"};
  packet.objects.assign(rest.begin(), rest.end());
  if ((flags & kMovesObjects) != 0) {
    PAC_TRY(packet.objects, read_objects(reader, body, rest));
  }
  if (model_bytes + difference_bytes > reader.remaining())
    return Failure{Error::truncated, lengths_at, "packet is shorter than its parts"};
  if (model_bytes + difference_bytes < reader.remaining())
    return Failure{Error::corrupt, lengths_at, "packet is longer than its parts"};
  if (!packet.has_model && model_bytes != 0)
    return Failure{Error::corrupt, lengths_at, "packet without a model has bytes of one"};
  packet.model = reader.raw(model_bytes);
  packet.difference = reader.raw(difference_bytes);
  return packet;
}

namespace {

bool is_finite(const raster::Camera& camera) {
  bool finite = true;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) finite = finite && std::isfinite(camera.clip_from_world[column][row]);
  for (int axis = 0; axis < 3; ++axis) finite = finite && std::isfinite(camera.eye[axis]);
  return finite;
}

FramePacket without_bytes(FramePacket packet) {
  packet.model = packet.difference = {};
  return packet;
}

Result<FramePacket> read_short(std::span<const uint8_t> bytes, const std::optional<FramePacket>& whole) {
  if (bytes.size() < kShortHead + kCrcBytes)
    return Failure{Error::truncated, bytes.size(), "message shorter than its header"};
  const auto body = bytes.first(bytes.size() - kCrcBytes);
  if (ByteReader(bytes.last(kCrcBytes)).u32() != crc32(body))
    return Failure{Error::corrupt, body.size(), "checksum does not match"};
  ByteReader head(body);
  head.u8();
  const uint8_t tag = head.u8(), distance = head.u8();
  if (!whole || tag != static_cast<uint8_t>(whole->frame) || distance == 0)
    return Failure{Error::corrupt, 1, "the packet that this one leans on did not arrive"};
  FramePacket packet;
  packet.is_short = true;
  packet.codec = Codec::mpeg1;
  packet.frame = whole->frame + distance;
  packet.low_hash = head.u32();
  BitReader bits(body.subspan(kShortHead));
  packet.camera = read_camera_change(bits, whole->camera);
  packet.objects = read_object_changes(bits, whole->objects);
  bits.align_to_byte();
  if (bits.overrun()) return Failure{Error::truncated, body.size(), "packet ends inside its header"};
  if (!is_finite(packet.camera)) return Failure{Error::corrupt, kShortHead, "camera is not finite"};
  if (!are_transforms(packet.objects)) return Failure{Error::corrupt, kShortHead, "object's transform is not finite"};
  packet.difference = body.subspan(kShortHead + static_cast<size_t>(bits.byte_offset()));
  return packet;
}

}  // namespace

Bytes PacketWriter::write(const FramePacket& packet, bool stands_alone) {
  const uint32_t distance = whole_ ? packet.frame - whole_->frame : 0;
  if (stands_alone || packet.codec != Codec::mpeg1 || packet.has_model || distance < 1 || distance > kMostFramesSince) {
    const std::span<const glm::mat4> objects = objects_of(packet, rest_);
    whole_ = without_bytes(packet);
    whole_->objects.assign(objects.begin(), objects.end());
    return write_frame_packet(packet, rest_);
  }
  ByteWriter writer;
  writer.u8(kShortMagic);
  writer.u8(static_cast<uint8_t>(whole_->frame));
  writer.u8(static_cast<uint8_t>(distance));
  writer.u32(static_cast<uint32_t>(packet.low_hash));
  BitWriter changes;
  write_camera_change(changes, packet.camera, whole_->camera);
  write_object_changes(changes, objects_of(packet, rest_), whole_->objects);
  writer.raw(changes.take());
  writer.raw(packet.difference);
  return with_crc(writer);
}

uint64_t PacketWriter::overhead_bytes(FramePacket packet, bool stands_alone) const {
  return PacketWriter(*this).write(without_bytes(std::move(packet)), stands_alone).size();
}

Result<FramePacket> PacketReader::read(std::span<const uint8_t> bytes) {
  if (!bytes.empty() && bytes[0] == kShortMagic) return read_short(bytes, whole_);
  PAC_TRY(const FramePacket packet, read_frame_packet(bytes, rest_));
  whole_ = without_bytes(packet);
  return packet;
}

Bytes write_session_message(const SessionMessage& message) {
  ByteWriter writer;
  writer.u32(kSessionMagic);
  writer.u16(kProtocolVersion);
  writer.u16(message.has_model ? kHasModel : 0);
  writer.u32(static_cast<uint32_t>(message.width));
  writer.u32(static_cast<uint32_t>(message.height));
  writer.u8(static_cast<uint8_t>(message.low.shading));
  writer.u8(message.low.texture ? 1 : 0);
  writer.u8(static_cast<uint8_t>(message.low.samples));
  writer.u8(static_cast<uint8_t>((message.low.cull_back_faces ? 1 : 0) | message.low.shading_samples << 1));
  for (int axis = 0; axis < 3; ++axis) writer.f32(message.background[axis]);
  writer.raw(message.model);
  return with_crc(writer);
}

Result<SessionMessage> read_session_message(std::span<const uint8_t> bytes) {
  PAC_TRY(const auto body, checked_body(bytes, kSessionMagic));
  ByteReader reader(body);
  reader.raw(6);
  SessionMessage message;
  const uint16_t flags = reader.u16();
  if ((flags & ~kHasModel) != 0) return Failure{Error::unsupported, 6, "unknown flag"};
  message.has_model = flags != 0;
  const uint32_t width = reader.u32(), height = reader.u32();
  if (reader.remaining() < 16) return Failure{Error::truncated, body.size(), "session message ends inside its header"};
  if (width < 1 || width > 65535 || height < 1 || height > 65535)
    return Failure{Error::corrupt, 8, "picture size outside 1..65535"};
  message.width = static_cast<int>(width);
  message.height = static_cast<int>(height);
  PAC_TRY(message.low, read_render_quality(reader));
  for (int axis = 0; axis < 3; ++axis) {
    message.background[axis] = reader.f32();
    if (!std::isfinite(message.background[axis])) return Failure{Error::corrupt, 20, "background is not finite"};
  }
  if (!message.has_model && reader.remaining() != 0)
    return Failure{Error::corrupt, reader.position(), "session without a model has bytes of one"};
  message.model = reader.raw(reader.remaining());
  return message;
}

}  // namespace pac::sim
