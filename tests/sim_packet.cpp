#include <doctest/doctest.h>

#include <cstring>
#include <limits>
#include <string>

#include "base/checksum.h"
#include "sim/camera_code.h"
#include "sim/client.h"
#include "sim/packet.h"
#include "sim/scenes.h"
#include "sim/server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

sim::Server make_server(bool transmit) {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {1});
  sim::ServerOptions options;
  options.width = options.height = 32;
  options.transmit_model = transmit;
  auto server = sim::Server::create(std::move(scene), *split, options);
  REQUIRE(server.ok());
  return std::move(*server);
}

Bytes one_packet(sim::Server& server) {
  auto packet = server.frame(7, test::small_camera(0, 1));
  REQUIRE(packet.ok());
  return std::move(*packet);
}

// The packet with some bytes replaced and a checksum that is right again.
Bytes patched(Bytes packet, size_t offset, std::initializer_list<uint8_t> bytes) {
  std::copy(bytes.begin(), bytes.end(), packet.begin() + static_cast<ptrdiff_t>(offset));
  const uint32_t crc = crc32(std::span(packet).first(packet.size() - 4));
  for (size_t i = 0; i < 4; ++i) packet[packet.size() - 4 + i] = static_cast<uint8_t>(crc >> (8 * i));
  return packet;
}

Failure frame_failure(const Bytes& bytes) {
  const auto result = sim::read_frame_packet(bytes);
  REQUIRE(!result.ok());
  return result.failure();
}

TEST_CASE("a frame packet comes back field by field, camera bits unchanged") {
  sim::FramePacket packet;
  packet.frame = 0xFEDCBA98;
  packet.has_model = true;
  packet.camera = test::small_camera(5, 1.25f);
  packet.camera.eye.x = std::numeric_limits<float>::denorm_min();
  packet.quality = 41.25;
  packet.low_hash = 0x0123456789ABCDEFu;
  const Bytes model = {1, 2, 3}, difference = {4, 5};
  packet.model = model;
  packet.difference = difference;
  const Bytes bytes = sim::write_frame_packet(packet);
  CHECK(bytes.size() == sim::kFramePacketOverhead + 5);
  const auto back = sim::read_frame_packet(bytes);
  REQUIRE(back.ok());
  CHECK(back->frame == packet.frame);
  CHECK(back->has_model);
  CHECK(std::memcmp(&back->camera.clip_from_world, &packet.camera.clip_from_world, sizeof(glm::mat4)) == 0);
  CHECK(std::memcmp(&back->camera.eye, &packet.camera.eye, sizeof(glm::vec3)) == 0);
  CHECK(back->quality == packet.quality);
  CHECK(back->low_hash == packet.low_hash);
  CHECK(Bytes(back->model.begin(), back->model.end()) == model);
  CHECK(Bytes(back->difference.begin(), back->difference.end()) == difference);
}

// The camera through a change against `base`; its size in bits.
uint64_t camera_round_trip(const raster::Camera& camera, const raster::Camera& base) {
  BitWriter writer;
  sim::write_camera_change(writer, camera, base);
  const uint64_t bits = writer.size_bits();
  const Bytes bytes = writer.take();
  BitReader reader(bytes);
  const raster::Camera back = sim::read_camera_change(reader, base);
  CHECK(std::memcmp(&back.clip_from_world, &camera.clip_from_world, sizeof(glm::mat4)) == 0);
  CHECK(std::memcmp(&back.eye, &camera.eye, sizeof(glm::vec3)) == 0);
  CHECK(reader.position_bits() == bits);
  CHECK(!reader.overrun());
  return bits;
}

TEST_CASE("a moved camera comes back bit for bit in 40 bytes of 76, a resting one in 14") {
  for (const sim::BuiltinScene& builtin : sim::builtin_scenes())
    for (const int frame : {1, 7, 60, 131}) {
      INFO(builtin.name << " " << frame);
      const uint64_t bits = camera_round_trip(builtin.camera(frame, 1.25f), builtin.camera(0, 1.25f));
      CHECK(bits <= 8 * 40);
    }
  CHECK(camera_round_trip(test::small_camera(3, 1), test::small_camera(3, 1)) <= 8 * 14);
}

TEST_CASE("any 19 numbers come back as a camera's change against any others") {
  uint32_t state = 1;
  for (int round = 0; round < 500; ++round) {
    raster::Camera cameras[2];
    for (raster::Camera& camera : cameras) {
      uint32_t bits[19];
      for (uint32_t& word : bits) {
        state = state * 1664525u + 1013904223u;
        const uint32_t odd[] = {0, 0x80000000u, 0x7FC00000u, 0xFF800000u, 1, 0x7F7FFFFFu};
        word = round % 3 == 0 ? odd[(state >> 8) % 6] : state ^ state >> 15;
      }
      std::memcpy(&camera.clip_from_world, bits, 64);
      std::memcpy(&camera.eye, bits + 16, 12);
    }
    CHECK(camera_round_trip(cameras[0], cameras[1]) <= 8 * 88);
  }
}

TEST_CASE("short packets come back against the last whole one, whichever of them are lost between") {
  sim::PacketWriter writer;
  sim::PacketReader reader;
  const Bytes code = {1, 2, 3, 4, 5};
  std::vector<Bytes> packets;
  for (int i = 0; i < 300; ++i) {
    sim::FramePacket packet;
    packet.frame = 1000 + static_cast<uint32_t>(i);
    packet.codec = sim::Codec::mpeg1;
    packet.camera = test::small_camera(i, 1);
    packet.low_hash = 0x1111111122222222u + static_cast<uint64_t>(i);
    packet.difference = code;
    packets.push_back(writer.write(packet, i == 0));
  }
  int n_whole = 0;
  for (int i = 0; i < 300; ++i) {
    if (i % 7 == 3) continue;  // lost, none of them whole
    const auto back = reader.read(packets[static_cast<size_t>(i)]);
    REQUIRE(back.ok());
    CHECK(back->frame == 1000 + static_cast<uint32_t>(i));
    CHECK(back->is_short == (i != 0 && i != 251));
    CHECK(static_cast<uint32_t>(back->low_hash) == 0x22222222u + static_cast<uint32_t>(i));
    CHECK(Bytes(back->difference.begin(), back->difference.end()) == code);
    const raster::Camera camera = test::small_camera(i, 1);
    CHECK(std::memcmp(&back->camera.clip_from_world, &camera.clip_from_world, sizeof(glm::mat4)) == 0);
    n_whole += back->is_short ? 0 : 1;
  }
  CHECK(n_whole == 2);
  const Bytes& last = packets[299];
  for (size_t size = 0; size < last.size(); ++size) REQUIRE(!reader.read(std::span(last).first(size)).ok());
  for (size_t bit = 0; bit < 8 * last.size(); ++bit) {
    Bytes damaged = last;
    damaged[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
    REQUIRE(!reader.read(damaged).ok());
  }
  CHECK(std::string(reader.read(packets[3]).failure().text) == "the packet that this one leans on did not arrive");
  CHECK(!sim::PacketReader().read(last).ok());
  // Right checksum, camera cut off: the bits run out.
  Bytes cut(last.begin(), last.begin() + 12);
  CHECK(reader.read(patched(cut, 0, {0xF1})).failure().error == Error::truncated);
}

TEST_CASE("every strict prefix and every extra byte is refused, by the reader and by the client") {
  sim::Server server = make_server(true);
  auto client = sim::Client::create(server.session());
  REQUIRE(client.ok());
  const Bytes packet = one_packet(server);
  for (size_t size = 0; size < packet.size(); size += size < 200 ? 1 : 37) {
    const Bytes prefix(packet.begin(), packet.begin() + static_cast<ptrdiff_t>(size));
    REQUIRE(!client->receive(prefix).ok());
  }
  Bytes longer = packet;
  longer.push_back(0);
  CHECK(!client->receive(longer).ok());
  CHECK(client->receive(packet).ok());
}

TEST_CASE("one flipped bit anywhere is detected") {
  sim::Server server = make_server(false);
  auto client = sim::Client::create(server.session());
  REQUIRE(client.ok());
  const Bytes packet = one_packet(server);
  for (size_t bit = 0; bit < packet.size() * 8; bit += bit < 116 * 8 ? 3 : 101) {
    Bytes damaged = packet;
    damaged[bit / 8] ^= static_cast<uint8_t>(1 << bit % 8);
    REQUIRE(!client->receive(damaged).ok());
  }
}

TEST_CASE("each rejected field has its own error, although the checksum is right") {
  sim::Server server = make_server(false);
  const Bytes packet = one_packet(server);
  CHECK(std::string(frame_failure(patched(packet, 0, {'X'})).text) == "not a message of this kind");
  CHECK(frame_failure(patched(packet, 4, {9})).error == Error::unsupported);
  CHECK(std::string(frame_failure(patched(packet, 6, {4})).text) == "unknown codec");
  CHECK(std::string(frame_failure(patched(packet, 7, {4})).text) == "unknown flag");
  CHECK(std::string(frame_failure(patched(packet, 7, {2})).text) ==
        "packet moves objects that the model does not have");
  CHECK(std::string(frame_failure(patched(packet, 12, {0, 0, 0xC0, 0x7F})).text) == "camera is not finite");
  CHECK(std::string(frame_failure(patched(packet, 84, {0, 0, 0x80, 0xFF})).text) == "camera is not finite");
  CHECK(std::string(frame_failure(patched(packet, 104, {1})).text) == "packet is shorter than its parts");
  CHECK(std::string(frame_failure(patched(packet, 108, {0, 0})).text) == "packet is longer than its parts");
  CHECK(frame_failure(patched(packet, 108, {0xFF, 0xFF, 0xFF, 0xFF})).error == Error::truncated);
  CHECK(std::string(frame_failure(server.session()).text) == "not a message of this kind");
}

TEST_CASE("a session message with a field out of range is refused by name") {
  const sim::Server server = make_server(false);
  const auto text = [](const Bytes& bytes) {
    const auto client = sim::Client::create(bytes);
    REQUIRE(!client.ok());
    return std::string(client.failure().text);
  };
  const Bytes& session = server.session();
  CHECK(text(patched(session, 8, {0, 0, 0, 0})) == "picture size outside 1..65535");
  CHECK(text(patched(session, 14, {1})) == "picture size outside 1..65535");
  CHECK(text(patched(session, 16, {3})) == "unknown kind of shading");
  CHECK(text(patched(session, 17, {2})) == "flag is neither 0 nor 1");
  CHECK(text(patched(session, 18, {5})) == "samples a pixel are not 1, 4, 16 or 64");
  CHECK(text(patched(session, 19, {4})) == "shading samples a pixel are not 0, or 1 or 4 and fewer than samples");
  CHECK(text(patched(session, 19, {32})) == "shading samples a pixel are not 0, or 1 or 4 and fewer than samples");
  CHECK(text(patched(session, 20, {0, 0, 0x80, 0x7F})) == "background is not finite");
  CHECK(text(patched(session, 6, {0})) == "session without a model has bytes of one");
  sim::ClientOptions small;
  small.limits.max_pixels = 1000;
  const auto limited = sim::Client::create(session, small);
  REQUIRE(!limited.ok());
  CHECK(limited.failure().error == Error::limit_exceeded);
}

TEST_CASE("a resident model comes back without loss, and every strict prefix of it is refused") {
  const sim::SceneSet scene = test::small_scene(true);
  for (const bool textured : {false, true}) {
    const Bytes bytes = sim::serialize_model(scene.fine, textured);
    const auto back = sim::parse_model(bytes);
    REQUIRE(back.ok());
    CHECK(sim::serialize_model(*back, textured) == bytes);
    REQUIRE(back->mesh.vertices.size() == scene.fine.mesh.vertices.size());
    for (size_t i = 0; i < back->mesh.vertices.size(); ++i) {
      const Vertex &a = back->mesh.vertices[i], &b = scene.fine.mesh.vertices[i];
      REQUIRE(std::memcmp(a.position, b.position, sizeof a.position) == 0);
      REQUIRE(std::memcmp(a.normal, b.normal, sizeof a.normal) == 0);
      REQUIRE(std::memcmp(a.color, b.color, sizeof a.color) == 0);
    }
    CHECK(back->mesh.indices == scene.fine.mesh.indices);
    CHECK(back->textures[0].mean_color() == scene.fine.textures[0].mean_color());
    if (textured) CHECK(back->textures[0].texels == scene.fine.textures[0].texels);
    for (size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 300)
      REQUIRE(!sim::parse_model(std::span(bytes).first(size)).ok());
    Bytes longer = bytes;
    longer.push_back(0);
    CHECK(!sim::parse_model(longer).ok());
  }
}

TEST_CASE("masks, panes, maps, fog and environment travel with a resident model; others take no more bytes") {
  raster::Scene scene = test::small_scene(true).fine;
  const size_t plain = sim::serialize_model(scene, true).size();
  scene.materials[0].reflection = {0.1f, 0.2f, 0.3f};
  scene.materials[0].opacity = 0.5f;
  CHECK(sim::serialize_model(scene, true).size() == plain);
  scene.materials[0].alpha = raster::AlphaMode::mask;
  scene.materials[0].normal_texture = 0;
  scene.materials[0].anisotropy = 8;
  scene.environment = 0;
  scene.fog.kind = raster::Fog::Kind::exponential;
  scene.fog.density = 0.25f;
  for (const bool textured : {false, true}) {
    const Bytes bytes = sim::serialize_model(scene, textured);
    const auto back = sim::parse_model(bytes);
    REQUIRE(back.ok());
    CHECK(sim::serialize_model(*back, textured) == bytes);
    CHECK(back->textures[0].texels == scene.textures[0].texels);  // what is masked needs its texture
    CHECK(back->materials[0].alpha == raster::AlphaMode::mask);
    CHECK(back->materials[0].reflection == scene.materials[0].reflection);
    CHECK(back->materials[0].normal_texture == 0);
    CHECK(back->materials[0].anisotropy == 8);
    CHECK(back->environment == 0);
    CHECK(back->fog.density == 0.25f);
    for (size_t size = bytes.size() - 60; size < bytes.size(); ++size)
      REQUIRE(!sim::parse_model(std::span(bytes).first(size)).ok());
    Bytes hostile = bytes;  // the first material's alpha mode
    hostile[bytes.size() - 42 * scene.materials.size() + 1] = 4;
    CHECK(!sim::parse_model(hostile).ok());
  }
}

TEST_CASE("a model's counts are checked before anything is allocated") {
  Bytes bytes = sim::serialize_model(test::small_scene(false).fine, false);
  for (const size_t field : {1u, 5u, 9u, 13u, 17u}) {
    Bytes hostile = bytes;
    for (size_t i = 0; i < 4; ++i) hostile[field + i] = 0xFF;
    CHECK(sim::parse_model(hostile).failure().error == Error::truncated);
  }
  Limits limits;
  limits.max_triangles = 10;
  CHECK(sim::parse_model(bytes, limits).failure().error == Error::limit_exceeded);
}

}  // namespace
