// Our codec against libjpeg-turbo, side by side in one process: thread CPU time, best of interleaved runs, one thread.
//   jpeg_peers [PICTURE.ppm|.png ...]     without an argument: the synthetic picture of bench/jpeg_images.h
// Prints megapixels a second of both and their ratio (above 1: ours is faster), for standard and optimal Huffman tables
// (4:2:0, Annex K tables, the same bytes from both encoders in the first case) and for decoding (their file, both).
#include <time.h>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "base/file_io.h"
#include "base/image_io.h"
#include "bench/jpeg_images.h"
#include "jpeg/jpeg.h"

// clang-format off: jpeglib.h needs size_t and FILE from above
#include <jpeglib.h>
// clang-format on

namespace {

using namespace pac;

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Output buffer and decoded picture are kept from run to run, as ours are.
class LibjpegTurbo {
 public:
  LibjpegTurbo() : file_(nullptr), capacity_(0) {}
  ~LibjpegTurbo() { std::free(file_); }

  size_t encode(const RgbImage& image, int quality, bool optimize) {
    jpeg_compress_struct c;
    jpeg_error_mgr errors;
    c.err = jpeg_std_error(&errors);
    jpeg_create_compress(&c);
    unsigned long size = capacity_;
    unsigned char* buffer = file_;
    jpeg_mem_dest(&c, &buffer, &size);
    c.image_width = static_cast<JDIMENSION>(image.width());
    c.image_height = static_cast<JDIMENSION>(image.height());
    c.input_components = 3;
    c.in_color_space = JCS_RGB;
    jpeg_set_defaults(&c);
    jpeg_set_quality(&c, quality, TRUE);
    c.optimize_coding = optimize ? TRUE : FALSE;
    jpeg_start_compress(&c, TRUE);
    while (c.next_scanline < c.image_height) {
      JSAMPROW row = const_cast<uint8_t*>(image.row(static_cast<int>(c.next_scanline)));
      jpeg_write_scanlines(&c, &row, 1);
    }
    jpeg_finish_compress(&c);
    jpeg_destroy_compress(&c);
    if (buffer != file_) {  // it grew: keep the larger one
      std::free(file_);
      file_ = buffer;
      capacity_ = size;
    }
    return size_ = size;
  }

  std::span<const uint8_t> file() const { return {file_, size_}; }

  static void decode(std::span<const uint8_t> bytes, RgbImage& out) {
    jpeg_decompress_struct d;
    jpeg_error_mgr errors;
    d.err = jpeg_std_error(&errors);
    jpeg_create_decompress(&d);
    jpeg_mem_src(&d, bytes.data(), bytes.size());
    jpeg_read_header(&d, TRUE);
    jpeg_start_decompress(&d);
    while (d.output_scanline < d.output_height) {
      JSAMPROW row = out.row(static_cast<int>(d.output_scanline));
      jpeg_read_scanlines(&d, &row, 1);
    }
    jpeg_finish_decompress(&d);
    jpeg_destroy_decompress(&d);
  }

 private:
  unsigned char* file_;
  unsigned long capacity_, size_ = 0;
};

struct Best {
  double ours = 1e9, theirs = 1e9;
};

template <class Ours, class Theirs>
Best measure(Ours&& ours, Theirs&& theirs) {
  constexpr int kRuns = 15;
  Best best;
  for (int i = 0; i < kRuns; ++i) {
    const double a = cpu_seconds();
    ours();
    const double b = cpu_seconds();
    theirs();
    const double c = cpu_seconds();
    best.ours = std::min(best.ours, b - a);
    best.theirs = std::min(best.theirs, c - b);
  }
  return best;
}

void report(const char* what, int quality, double megapixels, const Best& best, size_t our_bytes, size_t their_bytes) {
  std::printf("  %-22s q%-3d ours %7.1f MP/s   libjpeg-turbo %7.1f MP/s   ratio %5.2f   bytes %zu / %zu\n", what,
              quality, megapixels / best.ours, megapixels / best.theirs, best.theirs / best.ours, our_bytes,
              their_bytes);
}

void compare(const char* name, const RgbImage& image) {
  const double megapixels = image.width() * 1e-6 * image.height();
  std::printf("%s, %d x %d, 4:2:0\n", name, image.width(), image.height());
  LibjpegTurbo peer;
  jpeg::Encoder encoder;
  jpeg::Decoder decoder;
  std::vector<uint8_t> out;
  RgbImage ours(image.width(), image.height()), theirs(image.width(), image.height());
  for (const int quality : {15, 50, 75, 90}) {
    for (const bool optimize : {false, true}) {
      jpeg::EncodeOptions options;
      options.quality = quality;
      options.huffman = optimize ? jpeg::Huffman::optimal : jpeg::Huffman::standard;
      size_t their_bytes = 0;
      const Best best = measure(
          [&] {
            out.clear();
            if (!encoder.encode_append(image.view(), options, out).ok()) std::abort();
          },
          [&] { their_bytes = peer.encode(image, quality, optimize); });
      report(optimize ? "encode, optimal" : "encode, standard", quality, megapixels, best, out.size(), their_bytes);
    }
    const Best best = measure(
        [&] {
          if (!decoder.decode_into(peer.file(), ours.view()).ok()) std::abort();
        },
        [&] { LibjpegTurbo::decode(peer.file(), theirs); });
    report("decode", quality, megapixels, best, peer.file().size(), peer.file().size());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 1) compare("synthetic", bench::photograph_like(1920, 1080));
  for (int i = 1; i < argc; ++i) {
    const auto bytes = read_file(argv[i]);
    const Result<RgbImage> image = bytes.ok() ? decode_rgb(*bytes) : bytes.failure();
    if (!image.ok()) {
      std::fprintf(stderr, "%s: %s\n", argv[i], image.failure().text);
      return 1;
    }
    compare(argv[i], *image);
  }
}
