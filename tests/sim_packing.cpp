// Packed pictures: the MPEG-1 bits come back, in fewer bytes, from damage nothing but a refusal or another picture.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "mpeg1/mpeg1.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/picture_packing.h"
#include "sim/server.h"
#include "tests/support/small_scene.h"

namespace {

using namespace pac;

constexpr int kWidth = 90, kHeight = 71;  // no multiples of 16

// A pattern that slides, over noise that stands: vectors, intra macroblocks, all kinds of levels.
Frame420 frame_at(int number) {
  Frame420 frame(kWidth, kHeight);
  uint32_t state = 5;
  const auto fill = [&](GrayImage& plane, int scale) {
    for (int y = 0; y < plane.height(); ++y)
      for (int x = 0; x < plane.width(); ++x) {
        state = state * 1664525u + 1013904223u;
        const int slide = (x * scale + 3 * number) / 11 * 37 % 160 + (y * scale / 9) * 29 % 60;
        plane.row(y)[x] = static_cast<uint8_t>(slide + static_cast<int>(state >> 24) / 8);
      }
  };
  fill(frame.y, 1);
  fill(frame.cb, 2);
  fill(frame.cr, 2);
  return frame;
}

// Each picture of a sequence by itself; the first has headers of sequence and group.
std::vector<Bytes> coded_pictures(int count, double quantizer) {
  mpeg1::SequenceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.quantizer_scale = quantizer;
  options.gop_length = 4;
  auto encoder = mpeg1::Encoder::create(options);
  REQUIRE(encoder.ok());
  std::vector<Bytes> pictures;
  for (int number = 0; number < count; ++number) {
    Bytes bytes;
    REQUIRE(encoder->add(frame_at(number), bytes).ok());
    pictures.push_back(std::move(bytes));
  }
  return pictures;
}

IdImage stripes() {
  IdImage surface(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) surface.row(y)[x] = static_cast<uint32_t>(x / 20 + 100 * (y / 30));
  return surface;
}

TEST_CASE("every picture comes back bit for bit, at every quantizer, with and without surfaces") {
  const IdImage surface = stripes();
  for (const double quantizer : {1.0, 4.0, 11.0, 31.0})
    for (const bool has_surface : {false, true}) {
      const PlaneView<const uint32_t> view = has_surface ? surface.view() : PlaneView<const uint32_t>{};
      sim::PicturePacker packer(kWidth, kHeight), unpacker(kWidth, kHeight);
      int number = 0;
      for (const Bytes& picture : coded_pictures(7, quantizer)) {
        INFO("quantizer " << quantizer << ", picture " << number);
        const bool alone = number++ % 4 == 0;
        CHECK(packer.packed_size(picture, alone, view) < picture.size());
        const Bytes packed = packer.pack(picture, alone, view);
        REQUIRE(!packed.empty());
        Bytes back = {1, 2, 3};
        REQUIRE(unpacker.unpack(packed, alone, view, back).ok());
        REQUIRE(back.size() == picture.size() + 3);
        CHECK(std::equal(picture.begin(), picture.end(), back.begin() + 3));
      }
    }
}

TEST_CASE("a lost picture between two that stand alone takes no other with it") {
  sim::PicturePacker packer(kWidth, kHeight), unpacker(kWidth, kHeight);
  const std::vector<Bytes> pictures = coded_pictures(4, 6);
  for (size_t i = 0; i < pictures.size(); ++i) {
    const Bytes packed = packer.pack(pictures[i], i == 0, {});
    if (i == 2) continue;  // lost
    Bytes back;
    REQUIRE(unpacker.unpack(packed, i == 0, {}, back).ok());
    CHECK(back == pictures[i]);
  }
}

TEST_CASE("what is no picture of that size is not packed") {
  const Bytes picture = coded_pictures(1, 8)[0];
  sim::PicturePacker other(kWidth + 16, kHeight), same(kWidth, kHeight);
  CHECK(other.pack(picture, true, {}).empty());
  CHECK(other.packed_size(picture, true, {}) == picture.size());
  CHECK(same.pack({}, true, {}).empty());
  CHECK(same.pack(std::span(picture).first(picture.size() - 9), true, {}).empty());
  Bytes longer = picture;
  longer.insert(longer.end(), picture.begin(), picture.end());
  CHECK(same.pack(longer, true, {}).empty());
}

TEST_CASE("damaged and truncated bytes are refused or unpack to some picture") {
  const Bytes picture = coded_pictures(1, 8)[0];
  sim::PicturePacker packer(kWidth, kHeight);
  const Bytes packed = packer.pack(picture, true, {});
  REQUIRE(!packed.empty());
  int refused = 0;
  for (size_t i = 0; i < packed.size(); i += 7) {
    Bytes damaged = packed, out;
    damaged[i] ^= 0x55;
    refused += packer.unpack(damaged, true, {}, out).ok() ? 0 : 1;
    Bytes none;
    CHECK(packer.unpack(std::span(packed).first(i), true, {}, none).ok() == false);
    CHECK(none.empty());
  }
  CHECK(refused > 0);
  Bytes back;
  REQUIRE(packer.unpack(packed, true, {}, back).ok());
  CHECK(back == picture);
}

TEST_CASE("a refused picture teaches nothing: what the last one that stood alone taught still serves") {
  sim::PicturePacker packer(kWidth, kHeight), unpacker(kWidth, kHeight);
  const std::vector<Bytes> pictures = coded_pictures(3, 6);
  const Bytes key = packer.pack(pictures[0], true, {}), next = packer.pack(pictures[1], false, {});
  Bytes back;
  REQUIRE(unpacker.unpack(key, true, {}, back).ok());
  Bytes none;
  CHECK(!unpacker.unpack(std::span(key).first(key.size() / 2), true, {}, none).ok());
  back.clear();
  REQUIRE(unpacker.unpack(next, false, {}, back).ok());
  CHECK(back == pictures[1]);
}

TEST_CASE("where a picture that stands alone could not be packed, both sides begin anew") {
  sim::PicturePacker packer(kWidth, kHeight), unpacker(kWidth, kHeight), forgetful(kWidth, kHeight);
  const std::vector<Bytes> pictures = coded_pictures(2, 6);
  const Bytes key = packer.pack(pictures[0], true, {});
  Bytes back;
  REQUIRE(unpacker.unpack(key, true, {}, back).ok());
  const Bytes taught = packer.pack(pictures[1], false, {});
  CHECK(packer.pack(Bytes(40, 7), true, {}).empty());  // no picture: it would be sent as it is
  const Bytes untaught = packer.pack(pictures[1], false, {});
  CHECK(untaught.size() > taught.size());
  unpacker.forget();
  back.clear();
  REQUIRE(unpacker.unpack(untaught, false, {}, back).ok());
  CHECK(back == pictures[1]);
  back.clear();
  REQUIRE(forgetful.unpack(untaught, false, {}, back).ok());
  CHECK(back == pictures[1]);
}

TEST_CASE("surfaces decide the size alone: with others than the packer's nothing but a refusal or another picture") {
  const IdImage surface = stripes();
  const Bytes picture = coded_pictures(1, 4)[0];
  sim::PicturePacker packer(kWidth, kHeight), unpacker(kWidth, kHeight);
  const Bytes packed = packer.pack(picture, true, surface.view());
  Bytes back;
  CHECK((!unpacker.unpack(packed, true, {}, back).ok() || back != picture));
  back.clear();
  REQUIRE(unpacker.unpack(packed, true, surface.view(), back).ok());
  CHECK(back == picture);
}

TEST_CASE("bytes without end and bytes of one value are refused or unpack to one picture of bounded size") {
  for (const int value : {0, 1, 127, 128, 255})
    for (const size_t size : {0u, 1u, 7u, 8u, 9u, 64u, 4000u}) {
      sim::PicturePacker packer(kWidth, kHeight);
      const Bytes bytes(size, static_cast<uint8_t>(value));
      Bytes out;
      if (!packer.unpack(bytes, true, {}, out).ok()) CHECK(out.empty());
      // 30 macroblocks of 384 coefficients of at most 28 bits, and what is before them.
      CHECK(out.size() < 30 * (384 * 4 + 32) + 300);
    }
}

// Bytes of `frames` pictures, and the hash of what was shown last.
std::pair<uint64_t, uint64_t> served(bool is_packed) {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.width = 160;
  options.height = 128;
  options.codec = sim::Codec::mpeg1;
  options.video.quantizer_scale = 8;
  options.video.is_packed = is_packed;
  auto server = sim::Server::create(std::move(scene), *split, options);
  REQUIRE(server.ok());
  auto client = sim::Client::create(server->session(), {});
  REQUIRE(client.ok());
  uint64_t bytes = 0, hash = 0;
  for (int number = 0; number < 8; ++number) {
    const auto packet = server->frame(static_cast<uint32_t>(number), test::small_camera(number, 1.25f));
    REQUIRE(packet.ok());
    bytes += packet->size();
    const auto shown = client->receive(*packet);
    REQUIRE(shown.ok());
    hash = sim::image_hash(shown->view());
    CHECK(hash == sim::image_hash(server->last_frame().composite.view()));
  }
  return {bytes, hash};
}

TEST_CASE("server and client: the same pictures, a tenth fewer bytes at least, packets included") {
  const auto packed = served(true), plain = served(false);
  MESSAGE("packed " << packed.first << " bytes, else " << plain.first);
  CHECK(packed.second == plain.second);
  CHECK(10 * packed.first < 9 * plain.first);
}

}  // namespace
