// Start codes and the headers above the slice: sequence, group of pictures, picture [11172-2 2.4.2.2 to 2.4.2.5].
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "mpeg1/mpeg1.h"

namespace pac::mpeg1 {

// Last byte of 00 00 01 xx [2.4.1, table 2].
constexpr uint8_t kPictureStart = 0x00, kSliceStartFirst = 0x01, kSliceStartLast = 0xAF, kUserDataStart = 0xB2,
                  kSequenceHeader = 0xB3, kSequenceError = 0xB4, kExtensionStart = 0xB5, kSequenceEnd = 0xB7,
                  kGroupStart = 0xB8, kSystemStartFirst = 0xB9;

// group_of_pictures_header [2.4.2.4].
struct GroupHeader {
  bool drop_frame = false;
  int hours = 0, minutes = 0, seconds = 0, pictures = 0;
  bool closed = true, broken_link = false;
};

// `bytes` begin after the start code. Offsets of failures count from there.
Result<SequenceHeader> parse_sequence_header(std::span<const uint8_t> bytes);
Result<GroupHeader> parse_group_header(std::span<const uint8_t> bytes);
Result<PictureHeader> parse_picture_header(std::span<const uint8_t> bytes);

// Append the start code and the header.
void write_sequence_header(const SequenceHeader& header, std::vector<uint8_t>& out);
void write_group_header(const GroupHeader& header, std::vector<uint8_t>& out);
void write_picture_header(const PictureHeader& header, std::vector<uint8_t>& out);
void write_start_code(uint8_t code, std::vector<uint8_t>& out);

// The constrained parameters of 2.4.3.2 hold (f_code is the pictures' own matter).
bool is_constrained(const SequenceHeader& header);

}  // namespace pac::mpeg1
