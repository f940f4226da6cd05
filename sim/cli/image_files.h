// Pictures from and to files, by content when reading and by extension when writing.
#pragma once

#include <optional>
#include <string>

#include "base/file_io.h"
#include "base/image.h"
#include "base/isa.h"

namespace pac::cli {

// PNG, PNM or JPEG, told apart by the first bytes. Decoders fail as their own headers say.
Result<RgbImage> decode_picture(std::span<const uint8_t> bytes, Isa isa);
Result<RgbaImage> decode_picture_rgba(std::span<const uint8_t> bytes, Isa isa);

bool is_jpeg(std::span<const uint8_t> bytes);

// The picture in `path`, or empty after the message.
std::optional<RgbImage> read_picture(const std::string& path, Isa isa);

// Writes .png, .ppm or .pgm (.pgm: luma); "-" writes PNG. kDone or kBadData after the message.
int write_picture(const std::string& path, ConstRgbView image);

// Whether write_picture knows the name's extension; the sentence that says so where not.
std::string picture_name_problem(const std::string& path);

}  // namespace pac::cli
