// Packed pictures: the MPEG-1 bits come back, in fewer bytes, from damage nothing but a refusal or another picture.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "base/bd_rate.h"
#include "mpeg1/mpeg1.h"
#include "sim/client.h"
#include "sim/difference.h"
#include "sim/picture_packing.h"
#include "sim/picture_syntax.h"
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
  IdImage surface((kWidth + 15) / 16 * 4, (kHeight + 15) / 16 * 4);
  for (int y = 0; y < surface.height(); ++y)
    for (int x = 0; x < surface.width(); ++x) surface.row(y)[x] = static_cast<uint32_t>(x / 5 + 100 * (y / 7));
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
  int refused = 0, cut = 0, cut_refused = 0;
  for (size_t i = 0; i < packed.size(); i += 7) {
    Bytes damaged = packed, out;
    damaged[i] ^= 0x55;
    refused += packer.unpack(damaged, true, {}, out).ok() ? 0 : 1;
    // An arithmetic code may end by chance where it was cut; the packet's length and CRC see to the rest.
    Bytes shorter;
    const bool is_refused = !packer.unpack(std::span(packed).first(i), true, {}, shorter).ok();
    CHECK(shorter.empty() == is_refused);
    cut_refused += is_refused ? 1 : 0;
    ++cut;
  }
  CHECK(cut_refused > cut * 9 / 10);
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
std::pair<uint64_t, uint64_t> served(bool is_packed, mpeg1::Effort effort) {
  sim::SceneSet scene = test::small_scene(false);
  const auto split = sim::make_split("texture", scene, {4});
  REQUIRE(split.ok());
  sim::ServerOptions options;
  options.width = 160;
  options.height = 128;
  options.codec = sim::Codec::mpeg1;
  options.video.quantizer_scale = 8;
  options.video.is_packed = is_packed;
  options.video.effort = effort;
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
  const auto packed = served(true, mpeg1::Effort::fast), plain = served(false, mpeg1::Effort::fast);
  MESSAGE("packed " << packed.first << " bytes, else " << plain.first);
  CHECK(packed.second == plain.second);
  CHECK(10 * packed.first < 9 * plain.first);
}

TEST_CASE("above effort fast pictures are coded for being packed, and the client shows what the server does") {
  const auto packed = served(true, mpeg1::Effort::normal), plain = served(false, mpeg1::Effort::normal);
  MESSAGE("packed " << packed.first << " bytes, else " << plain.first);
  CHECK(packed.second != plain.second);  // other levels
  CHECK(20 * packed.first < 19 * plain.first);
}

// Noise that changes over a reference of one color: every kind of level, hardly a vector.
Frame420 noise_at(int number) {
  Frame420 frame = frame_at(0);
  uint32_t state = static_cast<uint32_t>(77 + number);
  for (GrayImage* plane : {&frame.cb, &frame.cr})
    for (int y = 0; y < plane->height(); ++y)
      for (int x = 0; x < plane->width(); ++x) plane->row(y)[x] = static_cast<uint8_t>(124 + (plane->row(y)[x] & 7));
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      state = state * 1664525u + 1013904223u;
      const int swing = (x / 16 + y / 16) % 4 * 12;
      frame.y.row(y)[x] = static_cast<uint8_t>(128 + (static_cast<int>(state >> 24) - 128) * swing / 128);
    }
  return frame;
}

struct OnePicture {
  Bytes mpeg1;
  int64_t squared_error = 0;
};

// P, predicted from gray, at the prices of its own first coding or at none.
OnePicture code_noise(sim::PicturePacker& packer, double quantizer, bool is_priced) {
  Frame420 gray(kWidth, kHeight);
  for (GrayImage* plane : {&gray.y, &gray.cb, &gray.cr})
    for (int y = 0; y < plane->height(); ++y) std::fill_n(plane->row(y), plane->width(), uint8_t{128});
  mpeg1::SequenceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.effort = mpeg1::Effort::best;
  auto encoder = mpeg1::Encoder::create(options);
  REQUIRE(encoder.ok());
  struct Caller {
    sim::PicturePacker& packer;
    OnePicture& out;
    mpeg1::PictureOptions& picture;
    std::vector<mpeg1::MacroblockPrices> prices;
  };
  OnePicture result;
  mpeg1::PictureOptions picture;
  Caller caller{packer, result, picture, {}};
  picture.reference = &gray;
  picture.type = mpeg1::PictureType::P;
  picture.quantizer_scale = quantizer;
  picture.code_again_context = &caller;
  picture.code_again = [](void* context, double scale, uint64_t) -> double {
    Caller& c = *static_cast<Caller*>(context);
    if (!c.picture.prices.empty() || !c.packer.prices(c.out.mpeg1, true, {}, c.prices)) return 0;
    c.picture.prices = c.prices;
    return scale;
  };
  if (!is_priced) picture.code_again = nullptr;
  const Frame420 frame = noise_at(1);
  REQUIRE(encoder->add(frame, result.mpeg1, picture).ok());
  const mpeg1::FrameView shown = encoder->reconstruction();
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int difference = shown.y.row(y)[x] - frame.y.row(y)[x];
      result.squared_error += difference * difference;
    }
  return result;
}

TEST_CASE("at the packer's prices a picture takes fewer packed bytes at equal error") {
  sim::PicturePacker packer(kWidth, kHeight);
  std::vector<RatePoint> curves[2];
  for (const double quantizer : {3.0, 6.0, 12.0, 24.0})
    for (const bool is_priced : {false, true}) {
      const OnePicture coded = code_noise(packer, quantizer, is_priced);
      curves[is_priced].push_back({static_cast<double>(packer.packed_size(coded.mpeg1, true, {})),
                                   -std::log2(static_cast<double>(coded.squared_error))});
    }
  const auto gain = bd_rate(curves[0], curves[1]);
  REQUIRE(gain.ok());
  MESSAGE("bytes at equal error: " << gain->percent << " %");
  CHECK(gain->percent < -0.2);
}

TEST_CASE("the prices of what a picture consists of add up to its packed size") {
  sim::PicturePacker packer(kWidth, kHeight);
  const OnePicture coded = code_noise(packer, 5, false);
  std::vector<mpeg1::MacroblockPrices> prices;
  REQUIRE(packer.prices(coded.mpeg1, true, {}, prices));
  constexpr uint8_t kStart[] = {0, 0, 1, 0};
  const auto start = std::search(coded.mpeg1.begin(), coded.mpeg1.end(), std::begin(kStart), std::end(kStart));
  sim::PictureSyntax syntax;
  REQUIRE(sim::read_picture(std::span(coded.mpeg1).subspan(static_cast<size_t>(start - coded.mpeg1.begin())), 6, 5,
                            syntax));
  uint64_t paid = 0;  // / 256 bit
  for (size_t i = 0; i < syntax.macroblocks.size(); ++i) {
    const mpeg1::Macroblock& m = syntax.macroblocks[i];
    REQUIRE(m.kind != mpeg1::MacroblockKind::intra);
    REQUIRE(m.vector == mpeg1::MotionVector{});
    if (m.kind == mpeg1::MacroblockKind::skipped) {
      paid += prices[i].skipped;
      continue;
    }
    paid += prices[i].inter + prices[i].still;
    uint32_t token = m.first_token;
    for (int block = 0; block < 6; ++block) {
      const mpeg1::BlockPrices& price = prices[i].blocks[block];
      const bool is_coded = (m.pattern & 32 >> block) != 0;
      paid += is_coded ? price.coded : price.left_out;
      size_t position = 0;
      for (int left = m.counts[block]; left > 0; --left, ++token, ++position) {
        for (int run = syntax.levels[token].run; run > 0; --run) paid += price.zero[position++];
        const int size = std::abs(syntax.levels[token].level), listed = std::min(size, 4);
        paid += price.level[position] + price.size[position][listed - 1] +
                static_cast<uint64_t>(size - listed) * price.step[position];
        paid += left > 1 ? price.more[position] : price.last[position];
      }
    }
  }
  const double bits = static_cast<double>(paid) / 256,
               size_bits = 8 * static_cast<double>(packer.packed_size(coded.mpeg1, true, {}));
  MESSAGE("priced " << bits << " bits, packed " << size_bits);
  CHECK(bits > 0.93 * size_bits);  // headers, steps of large levels
  CHECK(bits < 1.02 * size_bits);
}

TEST_CASE("what is no picture has no prices") {
  sim::PicturePacker packer(kWidth, kHeight);
  std::vector<mpeg1::MacroblockPrices> prices;
  CHECK(!packer.prices(Bytes(40, 7), true, {}, prices));
}

}  // namespace
