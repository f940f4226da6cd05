// Moving objects from server to client: their bits, equal pictures on both sides, prediction by each object's own
// transform.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "base/exact_math.h"
#include "base/metrics.h"
#include "raster/sample_pattern.h"
#include "sim/animation.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/frame420.h"
#include "sim/frame_renderer.h"
#include "sim/model_prediction.h"
#include "sim/object_code.h"
#include "sim/packet.h"
#include "sim/scene_parts.h"
#include "sim/scene_room.h"
#include "sim/server.h"
#include "tests/support/client_server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;
using test::make_client;
using test::shows_the_same;

constexpr uint32_t kBallFrom = 98;  // vertices of floor and wall, in the fine and in the coarse model

// The small scene, its ball textured and an object of its own.
sim::SceneSet ball_scene(bool lit) {
  sim::SceneSet set = test::small_scene(lit);
  for (raster::Scene* scene : {&set.fine, &set.coarse}) {
    scene->materials[1].texture = 0;
    raster::Object ball;
    ball.first_vertex = kBallFrom;
    ball.vertex_count = static_cast<uint32_t>(scene->mesh.vertices.size()) - kBallFrom;
    scene->objects = {ball};
  }
  return set;
}

// The ball turns and drifts.
glm::mat4 ball_at(int frame) {
  const double shift[3] = {0.05 * frame - 0.2, 0.01 * frame, 0};
  return sim::turned_about_y(glm::vec3(0), 0.08 * frame, shift);
}

sim::Server make_server(const char* split_name, bool transmit, bool is_video, bool lit = false, Isa isa = best_isa()) {
  sim::SceneSet scene = ball_scene(lit);
  const auto split = sim::make_split(split_name, scene, {4});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.transmit_model = transmit;
  options.codec = is_video ? sim::Codec::mpeg1 : sim::Codec::jpeg;
  options.video.quantizer_scale = 6;
  options.isa = options.coding.isa = isa;
  return test::make_server(std::move(scene), *split, options);
}

Bytes send(sim::Server& server, int number) {
  const glm::mat4 ball[] = {ball_at(number)};
  REQUIRE(server.move_objects(ball).ok());
  auto packet = server.frame(static_cast<uint32_t>(number), test::small_camera(0, 90.0f / 71.0f));
  REQUIRE(packet.ok());
  return std::move(*packet);
}

// The transforms through a change against `before`; its size in bits.
uint64_t round_trip(const sim::Transforms& now, const sim::Transforms& before) {
  BitWriter writer;
  sim::write_object_changes(writer, now, before);
  const uint64_t bits = writer.size_bits();
  const Bytes bytes = writer.take();
  BitReader reader(bytes);
  const sim::Transforms back = sim::read_object_changes(reader, before);
  REQUIRE(back.size() == now.size());
  for (size_t i = 0; i < now.size(); ++i) CHECK(sim::same_transform(back[i], now[i]));
  CHECK(reader.position_bits() == bits);
  CHECK(!reader.overrun());
  return bits;
}

TEST_CASE("objects at rest take one bit, a shift 14 bytes, a turn with a shift 24, of 48; all come back bit for bit") {
  CHECK(round_trip({}, {}) == 0);
  const sim::Transforms rest = {ball_at(0), ball_at(3), ball_at(50)};
  CHECK(round_trip(rest, rest) == 1);
  for (const int frame : {1, 9, 40}) {
    const double shift[3] = {0.31 * frame, -0.17 * frame, 0.05};
    const glm::mat4 here = sim::turned_about_y(glm::vec3(1, 2, 3), 0.4, shift);
    glm::mat4 there = here;
    there[3] += glm::vec4(0.01f * static_cast<float>(frame), 0.2f, -0.3f, 0);
    CHECK(round_trip({there}, {here}) <= 8 * 14);
    CHECK(round_trip({ball_at(frame)}, {ball_at(0)}) <= 8 * 24);
  }
}

TEST_CASE("any twelve numbers come back as a transform's change against any others") {
  uint32_t state = 7;
  for (int round = 0; round < 500; ++round) {
    sim::Transforms sides[2];
    for (sim::Transforms& side : sides) {
      glm::mat4 m(1.0f);
      for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 3; ++row) {
          state = state * 1664525u + 1013904223u;
          const float odd[] = {0.0f, -0.0f, 1.0f, 0x1p60f, -0x1p60f, 0x1p-149f, 0x1p-60f};
          m[column][row] = round % 2 == 0 ? odd[(state >> 8) % 7] : static_cast<float>(state >> 8) * 0x1p-23f - 1.0f;
        }
      side = {m};
    }
    CHECK(round_trip(sides[0], sides[1]) <= 8 * 60);
  }
}

TEST_CASE("a resident model brings its objects; ranges that overlap or leave the mesh and odd transforms are refused") {
  raster::Scene scene = ball_scene(true).fine;
  scene.objects[0].world_from_object = ball_at(5);
  scene.objects.push_back({10, 20, ball_at(2), ball_at(2)});
  const Bytes bytes = sim::serialize_model(scene, true);
  const auto back = sim::parse_model(bytes);
  REQUIRE(back.ok());
  REQUIRE(back->objects.size() == 2);
  for (size_t i = 0; i < 2; ++i) {
    CHECK(back->objects[i].first_vertex == scene.objects[i].first_vertex);
    CHECK(back->objects[i].vertex_count == scene.objects[i].vertex_count);
    CHECK(sim::same_transform(back->objects[i].world_from_object, scene.objects[i].world_from_object));
  }
  CHECK(sim::serialize_model(*back, true) == bytes);
  for (size_t size = bytes.size() - 200; size < bytes.size(); ++size)
    REQUIRE(!sim::parse_model(std::span(bytes).first(size)).ok());
  const auto refusal = [](const raster::Scene& hostile) {
    const auto parsed = sim::parse_model(sim::serialize_model(hostile, true));
    REQUIRE(!parsed.ok());
    return std::string(parsed.failure().text);
  };
  raster::Scene hostile = scene;
  hostile.objects[1].vertex_count = kBallFrom - 10 + 1;
  CHECK(refusal(hostile) == "two objects move the same vertex");
  hostile = scene;
  hostile.objects[0].vertex_count += 1;
  CHECK(refusal(hostile) == "object names vertices that do not exist");
  hostile = scene;
  hostile.objects[0].world_from_object[3][1] = 0x1p61f;
  CHECK(refusal(hostile) == "object's transform is not affine");
}

TEST_CASE("the client shows what the server predicts while the ball moves, in pictures and video, both models alike") {
  struct Case {
    const char* split;
    bool transmit, is_video, lit;
  };
  const Case cases[] = {{"texture", false, false, false},      {"texture", true, false, false},
                        {"tessellation", false, false, false}, {"texture,tessellation", true, false, true},
                        {"texture", false, true, false},       {"tessellation", false, true, false},
                        {"shading", false, true, true},        {"texture", false, true, true}};
  for (const Case& item : cases) {
    INFO(item.split << (item.transmit ? ", transmitted" : ", resident") << (item.is_video ? ", video" : ", pictures"));
    sim::Server server = make_server(item.split, item.transmit, item.is_video, item.lit);
    sim::Client client = make_client(server, Isa::scalar);
    uint64_t first_low = 0;
    for (int number = 0; number < 6; ++number) {
      REQUIRE(shows_the_same(client.receive(send(server, number)), server));
      const uint64_t low = sim::image_hash(client.low().view());
      CHECK(low == sim::image_hash(server.last_frame().low.view()));
      if (number == 0) first_low = low;
      CHECK((low == first_low) == (number == 0));
      CHECK(client.is_exact());
    }
  }
}

TEST_CASE("a lost short packet takes no transform with it: the next L is right, and the next key picture exact") {
  sim::Server server = make_server("texture", false, true);
  sim::Client client = make_client(server);
  for (int number = 0; number < 8; ++number) {
    if (number == 6) server.request_key();
    const Bytes packet = send(server, number);
    if (number == 3) continue;  // lost
    const auto shown = client.receive(packet);
    REQUIRE(shown.ok());
    CHECK(client.is_exact() == (number < 3 || number >= 6));
    if (client.is_exact()) CHECK(shows_the_same(shown, server));
  }
}

TEST_CASE("a ball at rest costs a bit a packet, and nothing where the session message has it so") {
  sim::Server server = make_server("texture", false, false);
  const auto sent = [&](const glm::mat4& place) {
    REQUIRE(server.move_objects({{place}}).ok());
    REQUIRE(server.frame(0, test::small_camera(0, 1)).ok());
    return server.last_frame().object_bytes;
  };
  CHECK(sent(glm::mat4(1.0f)) == 0);
  const uint64_t moved = sent(ball_at(3));
  CHECK(moved > 0);
  CHECK(moved <= 24);
  CHECK(sent(glm::mat4(1.0f)) == 0);
}

TEST_CASE("a packet with another place of the ball is corrupt, and the right one is shown after it") {
  sim::Server server = make_server("texture", false, true);
  sim::Client client = make_client(server);
  const auto session = sim::read_session_message(server.session());
  REQUIRE(session.ok());
  const auto model = sim::parse_model(session->model);
  REQUIRE(model.ok());
  sim::PacketReader reader(sim::transforms_of(*model));
  sim::PacketWriter writer(sim::transforms_of(*model));
  for (int number = 0; number < 3; ++number) {
    const Bytes packet = send(server, number);
    auto fields = reader.read(packet);
    REQUIRE(fields.ok());
    REQUIRE(fields->objects.size() == 1);
    CHECK(sim::same_transform(fields->objects[0], ball_at(number)));
    CHECK(sim::PacketWriter(writer).write(*fields, number == 0) == packet);
    sim::FramePacket wrong = *fields;
    wrong.objects[0][3][0] += 0.3f;
    const auto refused = client.receive(sim::PacketWriter(writer).write(wrong, number == 0));
    REQUIRE(!refused.ok());
    CHECK(std::string(refused.failure().text) == "low-quality rendering differs from the server's");
    wrong.objects[0][3][0] = 0x1p61f;
    const auto huge = client.receive(sim::PacketWriter(writer).write(wrong, number == 0));
    REQUIRE(!huge.ok());
    CHECK(std::string(huge.failure().text) == "object's transform is not finite");
    writer.write(*fields, number == 0);
    CHECK(shows_the_same(client.receive(packet), server));
  }
  REQUIRE(!sim::PacketReader().read(send(server, 300)).ok());  // moves what a model without objects has not
}

TEST_CASE("transforms that are not affine, and too many of them, move nothing") {
  raster::Scene scene = ball_scene(false).fine;
  glm::mat4 projective(1.0f), endless(1.0f);
  projective[0][3] = 0.5f;
  endless[3][0] = 0x1p61f;
  for (const glm::mat4& odd : {projective, endless})
    CHECK(sim::move_objects({{odd}}, scene).failure().error == Error::bad_argument);
  CHECK(sim::move_objects({{glm::mat4(1.0f), glm::mat4(1.0f)}}, scene).failure().error == Error::bad_argument);
  CHECK(sim::move_objects({}, scene).failure().error == Error::bad_argument);
  CHECK(sim::same_transform(scene.objects[0].world_from_object, glm::mat4(1.0f)));
}

TEST_CASE("faces know what moves them, and one between two objects that none does") {
  raster::Scene scene = ball_scene(false).fine;
  scene.objects.push_back({0, 7, glm::mat4(1.0f), glm::mat4(1.0f)});  // one row of the floor's vertices
  const std::vector<uint32_t> movers = sim::movers_of(scene), surfaces = sim::surfaces_of(scene);
  REQUIRE(movers.size() == scene.mesh.faces.size() + 1);
  CHECK(movers[0] == sim::kStands);
  CHECK(movers[1] == sim::kTorn);
  CHECK(movers[1 + 6] == sim::kStands);
  CHECK(movers.back() == 1);
  CHECK(surfaces[0] == 0);
  CHECK(surfaces[1] != surfaces[1 + 6]);
  CHECK(surfaces[1 + 6] == surfaces[1 + 2 * 6]);
}

// PSNR of the luma of H against its prediction, the worst of some frames from a camera at rest.
double worst_prediction(bool knows_objects, Isa isa, std::vector<uint64_t>* hashes = nullptr) {
  sim::SceneSet scene = ball_scene(false);
  const auto split = sim::make_split("texture", scene, {16});
  REQUIRE(split.ok());
  constexpr int kSide = 128;
  auto renderer = sim::FrameRenderer::create(scene, *split, false, kSide, kSide, 1, isa);
  REQUIRE(renderer.ok());
  const raster::SampleOffset sample = raster::sample_pattern(split->low.samples)[0];
  const raster::Scene& low_scene = renderer->low_scene();
  sim::ModelPredictor model(kSide, kSide, sim::surfaces_of(low_scene), sample.x / 256.0, sample.y / 256.0, isa,
                            knows_objects ? sim::movers_of(low_scene) : std::vector<uint32_t>{});
  Frame420 high(kSide, kSide), low(kSide, kSide);
  double worst = 100;
  for (int number = 0; number < 4; ++number) {
    const raster::Camera camera = test::small_camera(0, 1.0f);
    REQUIRE(sim::move_objects({{ball_at(number)}}, scene.fine).ok());
    const auto images = renderer->render(scene, camera, true);
    REQUIRE(images.ok());
    sim::frame420_from_rgb(images->low.view(), low);
    sim::frame420_from_rgb(images->high.view(), high);
    const Frame420& reference = model.reference(low, images->depth.view(), images->id.view(), camera, images->objects);
    if (number > 0) worst = std::min(worst, psnr_from_mse(mean_squared_error(reference.y.view(), high.y.view())));
    if (hashes != nullptr) {
      uint64_t hash = 0;
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) hash = hash * 0x9E3779B97F4A7C15u + reference.y.row(y)[x];
      hashes->push_back(hash);
    }
    model.keep(high.y.view(), high.cb.view(), high.cr.view());
  }
  return worst;
}

TEST_CASE("H is predicted at least 10 dB better where the ball's own transforms are used") {
  const double with = worst_prediction(true, best_isa()), without = worst_prediction(false, best_isa());
  MESSAGE("with the ball's transforms " << with << " dB, without " << without << " dB");
  CHECK(with > without + 10);
}

TEST_CASE("the prediction of a moving ball is equal on every instruction set") {
  std::vector<uint64_t> scalar;
  worst_prediction(true, Isa::scalar, &scalar);
  for (int number = 0; number < kIsaCount; ++number) {
    const Isa isa = static_cast<Isa>(number);
    if (!isa_is_supported(isa) || !isa_is_built(isa)) continue;
    std::vector<uint64_t> hashes;
    worst_prediction(true, isa, &hashes);
    CHECK(hashes == scalar);
  }
}

TEST_CASE("an animation with a moving ball: matched bytes, packets charged, every frame as the server predicts") {
  for (const sim::VideoCodec codec : {sim::VideoCodec::mjpeg, sim::VideoCodec::mpeg1}) {
    sim::AnimationOptions options;
    options.render.width = 96;
    options.render.height = 80;
    options.render.samples = 4;
    options.frames = 5;
    options.codec = codec;
    options.quantizer_scale = 8;
    options.objects = [](int frame) { return sim::Transforms{ball_at(frame)}; };
    const auto still_camera = [](int, float aspect) { return test::small_camera(0, aspect); };
    std::vector<uint64_t> pictures;
    sim::AnimationSink sink;
    sink.frame = [&](const sim::AnimationFrame& frame) { pictures.push_back(sim::image_hash(frame.high.view())); };
    const auto result = sim::run_animation(ball_scene(false), still_camera, options, sink);
    REQUIRE(result.ok());
    for (size_t i = 1; i < pictures.size(); ++i) CHECK(pictures[i] != pictures[i - 1]);
    if (codec == sim::VideoCodec::mpeg1) {
      CHECK(result->polygon_assisted.bytes == result->packet_bytes);
      CHECK(result->polygon_assisted.bytes <= result->image_based.bytes);
    }
    options.objects = [](int) { return sim::Transforms{}; };
    CHECK(sim::run_animation(ball_scene(false), still_camera, options).failure().error == Error::bad_argument);
  }
}

TEST_CASE("cubes and room: parts rest at frame 0, move later and share no vertex with what stands") {
  sim::SceneSet cubes = sim::build_cubes(1);
  REQUIRE(cubes.parts.size() == 6);
  sim::move_parts(cubes);
  CHECK(sim::check_objects(cubes.fine).ok());
  for (const uint32_t mover : sim::movers_of(cubes.fine)) CHECK(mover != sim::kTorn);
  const sim::Transforms first = sim::cubes_motion(0, cubes.parts), later = sim::cubes_motion(7, cubes.parts);
  for (const glm::mat4& transform : first) CHECK(transform == glm::mat4(1.0f));
  CHECK(later[0] != first[0]);
  CHECK(later[1] == first[1]);
  for (const glm::mat4& transform : later) CHECK(sim::is_transform(transform));

  sim::SceneSet room;  // furnished, but not lit: that takes long
  sim::SceneBuilder builder("room");
  builder.add_color("any", glm::vec3(0.5f));
  sim::furnish_room(builder, sim::RoomMaterials{}, 1, &room.parts);
  room.fine = builder.take();
  REQUIRE(room.parts.size() == 2);
  sim::move_parts(room);
  CHECK(sim::check_objects(room.fine).ok());
  for (const uint32_t mover : sim::movers_of(room.fine)) CHECK(mover != sim::kTorn);
  for (const glm::mat4& transform : sim::room_motion(0, room.parts)) CHECK(transform == glm::mat4(1.0f));
}

}  // namespace
