#include "base/png.h"

#include <doctest/doctest.h>

#include <cstring>
#include <string>

#include "base/deflate.h"
#include "base/image_io.h"
#include "base/png_filter.h"
#include "tests/support/generators.h"
#include "tests/support/peer.h"
#include "tests/support/png_builder.h"

namespace pac::test {
namespace {

struct Kind {
  int color_type, bit_depth;
};
constexpr Kind kKinds[] = {{0, 1}, {0, 2}, {0, 4}, {0, 8}, {0, 16}, {2, 8}, {2, 16}, {3, 1},
                           {3, 2}, {3, 4}, {3, 8}, {4, 8}, {4, 16}, {6, 8}, {6, 16}};

// Colors for a palette of up to 2^depth entries, less one, so that some indices are illegal.
Bytes make_palette(int bit_depth) {
  Bytes palette;
  for (int i = 0; i < (1 << bit_depth) - (bit_depth == 1 ? 0 : 1); ++i)
    for (int c = 0; c < 3; ++c) palette.push_back(static_cast<uint8_t>(i * (37 + 20 * c) + 5 * c));
  return palette;
}

PngSpec make_spec(Kind kind, int width, int height) {
  PngSpec spec;
  spec.width = width;
  spec.height = height;
  spec.color_type = kind.color_type;
  spec.bit_depth = kind.bit_depth;
  if (kind.color_type == 3) spec.palette = make_palette(kind.bit_depth);
  return spec;
}

// What the decoder must deliver, straight from the rule for the samples.
void expected_rgba(const PngSpec& spec, int x, int y, uint8_t (&out)[4]) {
  const auto reduced = [&](int c) {
    const double max = (1 << spec.bit_depth) - 1;
    return static_cast<uint8_t>(sample_of(spec, x, y, c) * 255 / max + 0.5);
  };
  out[3] = 255;
  switch (spec.color_type) {
    case 3:
      for (size_t c = 0; c < 3; ++c) out[c] = spec.palette[3 * static_cast<size_t>(sample_of(spec, x, y, 0)) + c];
      if (const auto i = static_cast<size_t>(sample_of(spec, x, y, 0)); i < spec.transparency.size())
        out[3] = spec.transparency[i];
      break;
    case 0:
    case 4:
      out[0] = out[1] = out[2] = reduced(0);
      if (spec.color_type == 4) out[3] = reduced(1);
      break;
    default:
      for (int c = 0; c < channels_of(spec.color_type); ++c) out[c] = reduced(c);
  }
}

void require_pixels(const PngSpec& spec, const RgbaImage& image) {
  REQUIRE(image.width() == spec.width);
  REQUIRE(image.height() == spec.height);
  for (int y = 0; y < spec.height; ++y)
    for (int x = 0; x < spec.width; ++x) {
      uint8_t expected[4];
      expected_rgba(spec, x, y, expected);
      CAPTURE(x);
      CAPTURE(y);
      if (std::memcmp(image.pixel(x, y), expected, 4) != 0) FAIL("wrong pixel");
    }
}

Failure failure_of(std::span<const uint8_t> file, const Limits& limits = {}) {
  const auto image = decode_png_rgba(file, limits);
  REQUIRE_FALSE(image.ok());
  return image.failure();
}
void check_fails(std::span<const uint8_t> file, Error error, const std::string& text) {
  const Failure failure = failure_of(file);
  CHECK(failure.error == error);
  CHECK(std::string(failure.text) == text);
  CHECK(failure.byte_offset <= file.size());
}

TEST_CASE("every color type and depth, interlaced or not, decodes to its samples") {
  for (const Kind kind : kKinds)
    for (const bool interlaced : {false, true})
      for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {3, 2}, {5, 9}, {8, 8}, {17, 6}, {33, 31}}) {
        PngSpec spec = make_spec(kind, width, height);
        spec.interlaced = interlaced;
        CAPTURE(kind.color_type);
        CAPTURE(kind.bit_depth);
        CAPTURE(interlaced);
        CAPTURE(spec.width);
        const auto image = decode_png_rgba(png_file(spec));
        REQUIRE_MESSAGE(image.ok(), image.failure().text);
        require_pixels(spec, *image);
      }
}

TEST_CASE("RGB decoding drops alpha and spreads gray; gray decoding takes gray only") {
  for (const Kind kind : kKinds) {
    CAPTURE(kind.color_type);
    const PngSpec spec = make_spec(kind, 9, 5);
    const Bytes file = png_file(spec);
    const auto rgb = decode_png_rgb(file);
    const auto gray = decode_png_gray(file);
    REQUIRE(rgb.ok());
    const bool is_gray = kind.color_type == 0 || kind.color_type == 4;
    REQUIRE(gray.ok() == is_gray);
    if (!is_gray) CHECK(gray.failure().error == Error::unsupported);
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 9; ++x) {
        uint8_t expected[4];
        expected_rgba(spec, x, y, expected);
        REQUIRE(std::memcmp(rgb->pixel(x, y), expected, 3) == 0);
        if (is_gray) REQUIRE(*gray->pixel(x, y) == expected[0]);
      }
  }
}

TEST_CASE("each filter alone is undone, for each pixel size") {
  for (const Kind kind : {Kind{0, 1}, {0, 16}, {2, 8}, {2, 16}, {4, 8}, {6, 8}, {6, 16}})
    for (int filter = 0; filter < 5; ++filter) {
      PngSpec spec = make_spec(kind, 13, 7);
      spec.filter = filter;
      const auto image = decode_png_rgba(png_file(spec));
      REQUIRE(image.ok());
      require_pixels(spec, *image);
    }
}

TEST_CASE("tRNS: one transparent color of gray and RGB, compared before reduction; alpha of palette entries") {
  for (const Kind kind : {Kind{0, 2}, {0, 8}, {0, 16}, {2, 8}, {2, 16}}) {
    PngSpec spec = make_spec(kind, 4, 1);
    const int key = kind.bit_depth == 2 ? 2 : kind.bit_depth == 8 ? 77 : 0x1234;
    // The second pixel differs from the key by one step: at 16 bits that is lost by the reduction, but not transparent.
    spec.sample = [=](int x, int, int) { return x == 0 ? key : x == 1 ? key + 1 : 0; };
    for (int c = 0; c < channels_of(kind.color_type); ++c) {
      spec.transparency.push_back(static_cast<uint8_t>(key >> 8));
      spec.transparency.push_back(static_cast<uint8_t>(key));
    }
    const auto image = decode_png_rgba(png_file(spec));
    REQUIRE_MESSAGE(image.ok(), image.failure().text);
    CHECK(image->pixel(0, 0)[3] == 0);
    CHECK(image->pixel(1, 0)[3] == 255);
    CHECK(image->pixel(2, 0)[3] == 255);
  }
  PngSpec spec = make_spec({3, 4}, 15, 1);
  spec.sample = [](int x, int, int) { return x; };
  spec.transparency = {0, 128, 255, 3};
  const auto image = decode_png_rgba(png_file(spec));
  REQUIRE(image.ok());
  require_pixels(spec, *image);
}

TEST_CASE("a written PNG decodes to the same pixels: RGB, RGBA and gray, odd strides") {
  Random random(5);
  for (const int width : {1, 2, 3, 7, 64, 257}) {
    const int height = 23;
    RgbImage rgb(width, height);
    RgbaImage rgba(width + 3, height);
    GrayImage gray(width, height);
    for (int y = 0; y < height; ++y) {
      for (int i = 0; i < 3 * width; ++i) rgb.row(y)[i] = static_cast<uint8_t>(i * 2 + y + random.in(0, 3));
      for (int i = 0; i < 4 * (width + 3); ++i) rgba.row(y)[i] = static_cast<uint8_t>(random.in(0, 255));
      for (int i = 0; i < width; ++i) gray.row(y)[i] = static_cast<uint8_t>(i / 5 * 9 + y);
    }
    const ConstRgbaView part{rgba.pixel(1, 0), width, height, rgba.stride()};
    const auto rgb_again = decode_png_rgb(encode_png(rgb.view()));
    const auto rgba_again = decode_png_rgba(encode_png(part));
    const auto gray_again = decode_png_gray(encode_png(gray.view()));
    REQUIRE(rgb_again.ok());
    REQUIRE(rgba_again.ok());
    REQUIRE(gray_again.ok());
    for (int y = 0; y < height; ++y) {
      const auto n = static_cast<size_t>(width);
      REQUIRE(std::memcmp(rgb.row(y), rgb_again->row(y), 3 * n) == 0);
      REQUIRE(std::memcmp(part.row(y), rgba_again->row(y), 4 * n) == 0);
      REQUIRE(std::memcmp(gray.row(y), gray_again->row(y), n) == 0);
    }
  }
}

TEST_CASE("a picture taller and wider than one chunk of data survives") {
  RgbaImage image(700, 600);  // 1.7 MB of noise: several IDAT chunks, stored blocks
  Random random(1);
  for (int y = 0; y < 600; ++y)
    for (int i = 0; i < 2800; ++i) image.row(y)[i] = static_cast<uint8_t>(random.next());
  const auto file = encode_png(image.view());
  CHECK(file.size() < 1.002 * 4 * 700 * 600);
  const auto again = decode_png_rgba(file);
  REQUIRE(again.ok());
  for (int y = 0; y < 600; ++y) REQUIRE(std::memcmp(image.row(y), again->row(y), 2800) == 0);
}

TEST_CASE("a smooth picture shrinks to less than a tenth") {
  RgbImage image(256, 256);
  for (int y = 0; y < 256; ++y)
    for (int i = 0; i < 768; ++i) image.row(y)[i] = static_cast<uint8_t>(i / 3 + y * (i % 3));
  CHECK(encode_png(image.view()).size() < 256 * 256 * 3 / 10);
}

TEST_CASE("every strict prefix is rejected as truncated") {
  for (const Kind kind : {Kind{2, 8}, {3, 4}, {6, 16}}) {
    PngSpec spec = make_spec(kind, 6, 5);
    spec.idat_size = 40;
    const Bytes file = png_file(spec);
    for (size_t n = 0; n < file.size(); ++n) {
      CAPTURE(n);
      const Bytes prefix(file.begin(), file.begin() + static_cast<ptrdiff_t>(n));
      const Failure failure = failure_of(prefix);
      REQUIRE(failure.error == Error::truncated);
      REQUIRE(failure.byte_offset <= n);
    }
  }
}

TEST_CASE("any single damaged byte is noticed: signature, lengths, types, data and checksums are all verified") {
  const Bytes file = png_file(make_spec({2, 8}, 5, 4));
  for (size_t at = 0; at < file.size(); ++at)
    for (const int flip : {0x01, 0x20, 0x80}) {
      CAPTURE(at);
      Bytes damaged = file;
      damaged[at] = static_cast<uint8_t>(damaged[at] ^ flip);
      REQUIRE_FALSE(decode_png_rgba(damaged).ok());
    }
}

TEST_CASE("ancillary chunks are skipped, bytes after IEND ignored") {
  const PngSpec spec = make_spec({2, 8}, 5, 4);
  const Bytes data = deflate_zlib(png_filtered_rows(spec));
  const Bytes note = {'h', 'i'};
  Bytes file = join({png_signature(), png_chunk("IHDR", png_header(spec)), png_chunk("tEXt", note),
                     png_chunk("gAMA", note), png_chunk("IDAT", data), png_chunk("tIME", note), png_chunk("IEND", {})});
  file.insert(file.end(), {'j', 'u', 'n', 'k'});
  const auto image = decode_png_rgba(file);
  REQUIRE(image.ok());
  require_pixels(spec, *image);
}

TEST_CASE("each field of the header: legal values pass, all others are named") {
  const PngSpec spec = make_spec({2, 8}, 3, 3);
  const Bytes data = deflate_zlib(png_filtered_rows(spec));
  const auto with = [&](size_t at, std::initializer_list<int> bytes) {
    Bytes header = png_header(spec);
    for (int byte : bytes) header[at++] = static_cast<uint8_t>(byte);
    return join({png_signature(), png_chunk("IHDR", header), png_chunk("IDAT", data), png_chunk("IEND", {})});
  };
  check_fails(with(0, {0, 0, 0, 0}), Error::corrupt, "PNG width is 0 or over 2^31 - 1");
  check_fails(with(0, {0x80, 0, 0, 0}), Error::corrupt, "PNG width is 0 or over 2^31 - 1");
  check_fails(with(4, {0, 0, 0, 0}), Error::corrupt, "PNG height is 0 or over 2^31 - 1");
  check_fails(with(4, {0xFF, 0xFF, 0xFF, 0xFF}), Error::corrupt, "PNG height is 0 or over 2^31 - 1");
  CHECK(failure_of(with(0, {0x7F, 0xFF, 0xFF, 0xFF})).error == Error::limit_exceeded);
  check_fails(with(10, {1}), Error::corrupt, "PNG compression method is undefined");
  check_fails(with(11, {1}), Error::corrupt, "PNG filter method is undefined");
  check_fails(with(12, {2}), Error::corrupt, "PNG interlace method is undefined");
  for (int type = 0; type < 256; ++type)
    for (int depth = 0; depth < 256; depth += depth < 18 ? 1 : 59) {
      bool is_legal = false;
      for (const Kind kind : kKinds) is_legal = is_legal || (kind.color_type == type && kind.bit_depth == depth);
      const auto header = read_png_header(with(8, {depth, type}));
      REQUIRE(header.ok() == is_legal);
    }
  Bytes longer = png_header(spec);
  longer.push_back(0);
  const Bytes file = join({png_signature(), png_chunk("IHDR", longer), png_chunk("IDAT", data), png_chunk("IEND", {})});
  check_fails(file, Error::corrupt, "PNG header is not 13 bytes long");
}

TEST_CASE("chunks out of order, repeated, missing or unknown are named") {
  const PngSpec rgb = make_spec({2, 8}, 3, 3), indexed = make_spec({3, 4}, 3, 3), gray = make_spec({0, 8}, 3, 3);
  const Bytes signature = png_signature(), ihdr = png_chunk("IHDR", png_header(rgb)), iend = png_chunk("IEND", {});
  const Bytes idat = png_chunk("IDAT", deflate_zlib(png_filtered_rows(rgb)));
  const Bytes indexed_ihdr = png_chunk("IHDR", png_header(indexed)), plte = png_chunk("PLTE", indexed.palette);
  const Bytes indexed_idat = png_chunk("IDAT", deflate_zlib(png_filtered_rows(indexed)));
  const Bytes six = {0, 1, 0, 2, 0, 3}, empty, one = {7};
  const Bytes trns = png_chunk("tRNS", six);
  const auto corrupt = [&](std::initializer_list<std::span<const uint8_t>> chunks, const std::string& text) {
    check_fails(join(chunks), Error::corrupt, text);
  };
  corrupt({signature, idat, iend}, "PNG does not begin with IHDR");
  corrupt({signature, ihdr, ihdr, idat, iend}, "second IHDR chunk");
  corrupt({signature, ihdr, iend}, "PNG has no IDAT chunk");
  corrupt({signature, ihdr, idat, png_chunk("tEXt", one), idat, iend}, "IDAT chunks are not consecutive");
  corrupt({signature, ihdr, idat, png_chunk("IEND", one)}, "IEND chunk is not empty");
  corrupt({signature, ihdr, plte, plte, idat, iend}, "second PLTE chunk");
  corrupt({signature, ihdr, idat, plte, iend}, "PLTE chunk is out of order");
  corrupt({signature, ihdr, trns, plte, idat, iend}, "PLTE chunk is out of order");
  corrupt({signature, ihdr, png_chunk("PLTE", one), idat, iend}, "PLTE chunk has an illegal length");
  corrupt({signature, ihdr, png_chunk("PLTE", empty), idat, iend}, "PLTE chunk has an illegal length");
  corrupt({signature, indexed_ihdr, png_chunk("PLTE", Bytes(3 * 17)), indexed_idat, iend},
          "PLTE chunk has an illegal length");
  corrupt({signature, png_chunk("IHDR", png_header(gray)), plte, idat, iend}, "PLTE chunk in a gray image");
  corrupt({signature, indexed_ihdr, indexed_idat, iend}, "palette image without PLTE");
  corrupt({signature, indexed_ihdr, trns, plte, indexed_idat, iend}, "tRNS chunk is out of order");
  corrupt({signature, ihdr, idat, trns, iend}, "tRNS chunk is out of order");
  corrupt({signature, ihdr, trns, trns, idat, iend}, "second tRNS chunk");
  corrupt({signature, ihdr, png_chunk("tRNS", one), idat, iend}, "tRNS chunk has an illegal length");
  corrupt({signature, indexed_ihdr, plte, png_chunk("tRNS", Bytes(16)), indexed_idat, iend},
          "tRNS chunk has an illegal length");
  corrupt({signature, png_chunk("IHDR", png_header(make_spec({6, 8}, 3, 3))), trns, idat, iend},
          "tRNS chunk in an image with alpha");
  corrupt({signature, ihdr, png_chunk("ID1T", one), iend}, "PNG chunk type is not four letters");
  check_fails(join({signature, ihdr, png_chunk("CgBI", one), idat, iend}), Error::unsupported,
              "unknown critical PNG chunk");
  Bytes long_chunk = join({signature, ihdr, idat, iend});
  long_chunk[signature.size() + ihdr.size()] = 0x80;
  check_fails(long_chunk, Error::corrupt, "PNG chunk length is over 2^31 - 1");
}

TEST_CASE("wrong image data is named, with its place in the file") {
  const PngSpec spec = make_spec({2, 8}, 3, 3);
  const Bytes rows = png_filtered_rows(spec);
  Bytes bad_adler = deflate_zlib(rows);
  bad_adler.back() ^= 1;
  check_fails(png_file(spec, bad_adler), Error::corrupt, "zlib checksum is wrong");
  const uint64_t idat_data = 8 + 25 + 8;
  CHECK(failure_of(png_file(spec, bad_adler)).byte_offset == idat_data + bad_adler.size() - 4);

  Bytes more = rows, less = rows, filter = rows, after = deflate_zlib(rows);
  more.push_back(0);
  less.pop_back();
  filter[10] = 5;  // the second row's filter
  after.push_back(0);
  check_fails(png_file(spec, deflate_zlib(more)), Error::corrupt, "PNG image data holds more than the header says");
  check_fails(png_file(spec, deflate_zlib(less)), Error::corrupt, "PNG image data holds less than the header says");
  check_fails(png_file(spec, deflate_zlib(filter)), Error::corrupt, "PNG row has an undefined filter");
  check_fails(png_file(spec, after), Error::corrupt, "PNG image data goes on after its end");
  const Bytes cut(after.begin(), after.begin() + 9);
  check_fails(png_file(spec, cut), Error::truncated, "compressed data ends early");

  PngSpec indexed = make_spec({3, 4}, 3, 3);
  indexed.sample = [](int x, int y, int) { return x == 1 && y == 2 ? 15 : 0; };
  check_fails(png_file(indexed), Error::corrupt, "PNG palette index is past the palette");
}

TEST_CASE(
    "limits: a picture at the limit decodes, one pixel more does not, and nothing large is allocated for a bomb") {
  Limits limits;
  limits.max_pixels = 12;
  CHECK(decode_png_rgb(png_file(make_spec({2, 8}, 4, 3)), limits).ok());
  CHECK(failure_of(png_file(make_spec({2, 8}, 13, 1)), limits).error == Error::limit_exceeded);
  limits = {};
  limits.max_bytes = 3 * (1 + 12);
  CHECK(decode_png_rgb(png_file(make_spec({2, 8}, 4, 3)), limits).ok());
  limits.max_bytes -= 1;
  CHECK(failure_of(png_file(make_spec({2, 8}, 4, 3)), limits).error == Error::limit_exceeded);
  // A short file that claims 2^28 pixels; a small picture with ten megabytes in its data.
  PngSpec huge = make_spec({6, 16}, 1 << 14, 1 << 14);
  CHECK(failure_of(png_file(huge, deflate_zlib(Bytes(1000)))).error == Error::limit_exceeded);  // 2 GiB of rows
  huge.bit_depth = 8;
  CHECK(std::string(failure_of(png_file(huge, deflate_zlib(Bytes(1000)))).text) == "PNG image data ends early");
  const PngSpec tiny = make_spec({2, 8}, 1, 1);
  CHECK(std::string(failure_of(png_file(tiny, deflate_zlib(Bytes(10'000'000)))).text) ==
        "PNG image data holds more than the header says");
}

TEST_CASE("image_io tells formats apart by content and by name") {
  const RgbImage image(3, 2);
  const Bytes png = encode_png(image.view()), ppm = encode_ppm(image.view());
  CHECK(decode_rgb(png).ok());
  CHECK(decode_rgb(ppm).ok());
  CHECK(decode_rgba(png).ok());
  const auto rgba = decode_rgba(ppm);
  REQUIRE(rgba.ok());
  CHECK(rgba->pixel(2, 1)[3] == 255);
  CHECK(decode_rgb(Bytes{'G', 'I', 'F'}).failure().error == Error::unsupported);
  CHECK(decode_rgb({}).failure().error == Error::unsupported);
  CHECK(encode_image(image.view(), "a.PNG").value() == png);
  CHECK(encode_image(image.view(), "dir.png/a.ppm").value() == ppm);
  CHECK(encode_image(image.view(), "a.jpg").failure().error == Error::bad_argument);
  CHECK(encode_image(image.view(), "png").failure().error == Error::bad_argument);
  CHECK(encode_image(RgbImage().view(), "a.png").failure().error == Error::bad_argument);
  const auto info = read_image_info(png_file(make_spec({4, 16}, 7, 5)));
  REQUIRE(info.ok());
  CHECK(info->width == 7);
  CHECK(info->is_gray);
  CHECK(info->has_alpha);
}

TEST_CASE("peer: ImageMagick and netpbm decode every kind of our test files as we do") {
  if (!have_peer("convert") || !have_peer("pngtopnm")) return;
  const TempDir dir;
  bool interlaced = false;
  for (const Kind kind : kKinds) {
    PngSpec spec = make_spec(kind, 19, 11);
    spec.interlaced = interlaced = !interlaced;
    if (kind.color_type == 3) spec.transparency = {10, 200};
    CAPTURE(kind.color_type);
    CAPTURE(kind.bit_depth);
    const Bytes file = png_file(spec);
    write_bytes(dir.file("a.png"), file);
    const auto ours = decode_png_rgba(file);
    REQUIRE(ours.ok());
    REQUIRE(run("convert " + dir.file("a.png") + " -depth 8 rgba:" + dir.file("a.rgba")) == 0);
    const Bytes theirs = read_bytes(dir.file("a.rgba"));
    REQUIRE(theirs.size() == 19 * 11 * 4);
    // 16 bits: their reduction may round a tie the other way.
    const int tolerance = kind.bit_depth == 16 ? 1 : 0;
    for (int y = 0; y < 11; ++y)
      for (int i = 0; i < 19 * 4; ++i)
        REQUIRE(std::abs(ours->row(y)[i] - theirs[static_cast<size_t>(y * 19 * 4 + i)]) <= tolerance);
    REQUIRE(run("pngtopnm " + dir.file("a.png") + " > " + dir.file("a.pnm")) == 0);
    const auto netpbm = decode_rgb(read_bytes(dir.file("a.pnm")));  // 16 bits come through, and are reduced here
    if (kind.color_type == 0 && kind.bit_depth == 1) continue;      // written as PBM
    REQUIRE_MESSAGE(netpbm.ok(), netpbm.failure().text);
    for (int y = 0; y < 11; ++y)
      for (int x = 0; x < 19; ++x) REQUIRE(std::memcmp(ours->pixel(x, y), netpbm->pixel(x, y), 3) == 0);
  }
}

TEST_CASE("peer: what ImageMagick and netpbm write we read, what we write they read") {
  if (!have_peer("convert") || !have_peer("pnmtopng")) return;
  const TempDir dir;
  RgbImage image(61, 47);
  Random random(3);
  for (int y = 0; y < 47; ++y)
    for (int i = 0; i < 183; ++i) image.row(y)[i] = static_cast<uint8_t>(i + 2 * y + random.in(0, 9));
  const auto require_same = [&](const Bytes& file) {
    const auto decoded = decode_rgb(file);
    REQUIRE_MESSAGE(decoded.ok(), decoded.failure().text);
    for (int y = 0; y < 47; ++y) REQUIRE(std::memcmp(image.row(y), decoded->row(y), 183) == 0);
  };
  write_bytes(dir.file("a.ppm"), encode_ppm(image.view()));
  write_bytes(dir.file("ours.png"), encode_png(image.view()));
  const std::string in = dir.file("a.ppm"), out = dir.file("theirs.png");
  const std::string commands[] = {"convert " + in + " " + out,
                                  "convert " + in + " -interlace PNG " + out,
                                  "convert " + in + " -depth 16 -define png:bit-depth=16 " + out,
                                  "convert " + in + " -quality 00 " + out,
                                  "convert " + in + " -quality 91 " + out,
                                  "convert " + in + " -alpha on PNG32:" + out,
                                  "pnmtopng -interlace -gamma 0.45 -text /dev/null " + in + " > " + out,
                                  "pngtopnm " + dir.file("ours.png") + " > " + out,
                                  "convert " + dir.file("ours.png") + " ppm:" + out};
  for (const std::string& command : commands) {
    CAPTURE(command);
    REQUIRE(run(command) == 0);
    require_same(read_bytes(out));
  }
}

}  // namespace
}  // namespace pac::test
