// libjpeg-turbo as a peer: whole pictures in memory, buffers kept from run to run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>

#include "base/image.h"

// clang-format off: jpeglib.h needs size_t and FILE from above
#include <jpeglib.h>
// clang-format on

namespace pac::bench {

class LibjpegTurbo {
 public:
  LibjpegTurbo() = default;
  LibjpegTurbo(const LibjpegTurbo&) = delete;
  LibjpegTurbo& operator=(const LibjpegTurbo&) = delete;
  ~LibjpegTurbo() { std::free(file_); }

  // 4:2:0, Annex K tables; restart_rows: MCU rows between restart markers, 0 = none.
  void encode(const RgbImage& image, int quality, bool optimize, int restart_rows = 0) {
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
    c.restart_in_rows = restart_rows;
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
    size_ = size;
  }

  // The last file that encode() made.
  std::span<const uint8_t> file() const { return {file_, size_}; }

  // Default accuracy, smooth upsampling.
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
  unsigned char* file_ = nullptr;
  unsigned long capacity_ = 0, size_ = 0;
};

}  // namespace pac::bench
