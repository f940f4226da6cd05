// Other programs decode our streams as we do, and we decode theirs as they do.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "base/y4m.h"
#include "mpeg1/repeats.h"
#include "mpeg1/system.h"
#include "tests/support/mpeg1_clip.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

void write_y4m(const std::string& path, const std::vector<Frame420>& frames) {
  std::vector<uint8_t> bytes;
  Y4mHeader header;
  header.width = frames[0].width();
  header.height = frames[0].height();
  header.rate_numerator = 30;
  header.rate_denominator = 1;
  append_y4m_header(bytes, header);
  for (const Frame420& frame : frames) append_y4m_frame(bytes, frame);
  write_bytes(path, bytes);
}

void require_alike(const std::vector<Frame420>& ours, const std::vector<Frame420>& theirs) {
  REQUIRE(ours.size() == theirs.size());
  for (size_t i = 0; i < ours.size(); ++i) REQUIRE(psnr(mpeg1::view_of(ours[i]), mpeg1::view_of(theirs[i])) > 50);
}

TEST_CASE("ffmpeg decodes our elementary and system streams as we do") {
  if (!have_peer("ffmpeg")) return;
  TempDir dir;
  const std::vector<Frame420> frames = clip(176, 144, 20);
  for (const mpeg1::Effort effort : {mpeg1::Effort::fast, mpeg1::Effort::best})
    for (const double quantizer : {1.0, 5.5, 31.0}) {
      mpeg1::SequenceOptions options;
      options.width = 176;
      options.height = 144;
      options.effort = effort;
      options.quantizer_scale = quantizer;
      options.slice_rows = quantizer > 5 ? 2 : 0;
      const std::vector<uint8_t> bytes = encode_clip(frames, options);
      write_bytes(dir.file("ours.m1v"), bytes);
      const std::vector<Frame420> decoded = decode_all(bytes);
      require_alike(decoded, ffmpeg_decodes(dir, dir.file("ours.m1v")));
      const auto system = mpeg1::multiplex(bytes);
      REQUIRE(system.ok());
      write_bytes(dir.file("ours.mpg"), *system);
      require_alike(decoded, ffmpeg_decodes(dir, dir.file("ours.mpg")));
    }
}

TEST_CASE("we decode ffmpeg's streams as it does: B pictures, odd sizes, many slices, its own matrices") {
  if (!have_peer("ffmpeg")) return;
  TempDir dir;
  struct Variant {
    int width, height;
    const char* options;
  };
  for (const Variant& variant : {Variant{176, 144, "-bf 2 -q:v 3"},
                                 {98, 50, "-bf 3 -q:v 2 -g 9 -mbd rd -trellis 1"},
                                 {64, 64, "-bf 0 -q:v 31"},
                                 {176, 144, "-bf 2 -q:v 6 -slices 4 -strict_gop 1"},
                                 {320, 160, "-q:v 2 -qmin 1 -bf 1 -me_range 200"},
                                 {176, 144, "-b:v 200k -maxrate 200k -bufsize 100k -bf 2"}}) {
    write_y4m(dir.file("in.y4m"), clip(variant.width, variant.height, 15));
    REQUIRE(run("ffmpeg -v error -y -i " + dir.file("in.y4m") + " -c:v mpeg1video " + variant.options + " " +
                dir.file("theirs.m1v")) == 0);
    const std::vector<uint8_t> bytes = read_bytes(dir.file("theirs.m1v"));
    mpeg1::DecoderOptions strict;
    strict.strict = true;
    require_alike(decode_all(bytes, strict), ffmpeg_decodes(dir, dir.file("theirs.m1v")));
  }
}

TEST_CASE("at 20 frames a second pictures are repeated, and ffmpeg decodes each as often as we do") {
  if (!have_peer("ffmpeg")) return;
  TempDir dir;
  mpeg1::SequenceOptions options;
  options.width = 100;
  options.height = 60;
  options.picture_rate_code = mpeg1::picture_rate_code(20000);
  options.gop_length = 7;
  const std::vector<uint8_t> slow = encode_clip(clip(100, 60, 20), options);
  const auto bytes = mpeg1::with_repeats(slow, 20000);
  REQUIRE(bytes.ok());
  const auto info = mpeg1::read_info(*bytes);
  REQUIRE(info.ok());
  CHECK(info->repeated_pictures == 4);  // 20 / 20 seconds at 23.976 a second
  CHECK(bytes->size() < slow.size() + 4 * 40);
  mpeg1::ErrorReport report;
  const std::vector<Frame420> ours = decode_all(*bytes, {}, &report);
  CHECK(report.errors == 0);
  CHECK(ours.size() == 24);
  size_t n_new = 1;
  for (size_t i = 1; i < ours.size(); ++i)
    if (!equal(mpeg1::view_of(ours[i - 1]), mpeg1::view_of(ours[i]))) ++n_new;
  CHECK(n_new == 20);
  write_bytes(dir.file("ours.m1v"), *bytes);
  require_alike(ours, ffmpeg_decodes(dir, dir.file("ours.m1v")));
  const auto system = mpeg1::multiplex(*bytes);
  REQUIRE(system.ok());
  write_bytes(dir.file("ours.mpg"), *system);
  require_alike(ours, ffmpeg_decodes(dir, dir.file("ours.mpg")));
  const auto alone = mpeg1::with_repeats(slow, 23976);
  REQUIRE(alone.ok());
  CHECK(*alone == slow);
}

TEST_CASE("ffmpeg's system streams demultiplex") {
  if (!have_peer("ffmpeg")) return;
  TempDir dir;
  write_y4m(dir.file("in.y4m"), clip(176, 144, 12));
  for (const char* format : {"mpeg", "vob"}) {
    REQUIRE(run("ffmpeg -v error -y -i " + dir.file("in.y4m") + " -c:v mpeg1video -q:v 4 -f " + format + " " +
                dir.file("theirs.mpg")) == 0);
    const auto system = mpeg1::demultiplex(read_bytes(dir.file("theirs.mpg")));
    REQUIRE(system.ok());
    CHECK(decode_all(system->video).size() == 12);
  }
}

TEST_CASE("libmpeg2's player decodes our streams to the same number of pictures") {
  if (!have_peer("mpeg2dec")) return;
  TempDir dir;
  mpeg1::SequenceOptions options;
  options.width = 176;
  options.height = 144;
  write_bytes(dir.file("ours.m1v"), encode_clip(clip(176, 144, 9), options));
  const std::string said = output_of("mpeg2dec -o null " + dir.file("ours.m1v"));
  CHECK(said.find("9 frames decoded") != std::string::npos);
}

}  // namespace
}  // namespace pac::test
