// JPEG files put together segment by segment, right or wrong on purpose.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/image.h"

namespace pac::test {

// A component in SOF and in SOS.
struct JpegFrameComponent {
  int id = 1, h = 1, v = 1, tq = 0;
};
struct JpegScanComponent {
  int id = 1, tables = 0x00;  // Td << 4 | Ta
};

class JpegFile {
 public:
  std::vector<uint8_t> bytes;

  JpegFile& raw(std::initializer_list<int> values) {
    for (const int v : values) bytes.push_back(static_cast<uint8_t>(v));
    return *this;
  }
  JpegFile& text(const std::string& s) {
    bytes.insert(bytes.end(), s.begin(), s.end());
    return *this;
  }
  // Bits written as '0' and '1' (other characters are for the reader), filled up with ones, 0xFF stuffed.
  JpegFile& bits(const std::string& s) {
    int value = 0, n = 0;
    const auto put = [&](int bit) {
      value = value << 1 | bit;
      if (++n < 8) return;
      raw({value});
      if (value == 0xFF) raw({0});
      value = n = 0;
    };
    for (const char c : s)
      if (c == '0' || c == '1') put(c - '0');
    while (n != 0) put(1);
    return *this;
  }
  JpegFile& segment(int marker, const std::vector<int>& data) {
    const int length = 2 + static_cast<int>(data.size());
    raw({0xFF, marker, length >> 8, length & 255});
    for (const int v : data) raw({v});
    return *this;
  }

  JpegFile& soi() { return raw({0xFF, 0xD8}); }
  JpegFile& eoi() { return raw({0xFF, 0xD9}); }
  // All steps alike. pq 0: 8 bits, 1: 16 bits.
  JpegFile& dqt(int id = 0, int pq = 0, int step = 16) {
    std::vector<int> data{pq << 4 | id};
    for (int i = 0; i < 64; ++i) {
      if (pq == 1) data.push_back(step >> 8);
      data.push_back(step & 255);
    }
    return segment(0xDB, data);
  }
  JpegFile& sof(int width, int height, const std::vector<JpegFrameComponent>& parts = {{}}, int marker = 0xC0,
                int precision = 8) {
    std::vector<int> data{precision,  height >> 8, height & 255,
                          width >> 8, width & 255, static_cast<int>(parts.size())};
    for (const JpegFrameComponent& p : parts) data.insert(data.end(), {p.id, p.h << 4 | p.v, p.tq});
    return segment(marker, data);
  }
  JpegFile& dht(int table_class, int id, const std::array<int, 16>& counts, const std::vector<int>& symbols) {
    std::vector<int> data{table_class << 4 | id};
    data.insert(data.end(), counts.begin(), counts.end());
    data.insert(data.end(), symbols.begin(), symbols.end());
    return segment(0xC4, data);
  }
  // DC: 0 = category 0, 10 = category 3. AC: 0 = EOB, 10 = run 0 size 1, 110 = ZRL, 1110 = run 15 size 1.
  JpegFile& small_tables(int id = 0) {
    dht(0, id, {1, 1}, {0, 3});
    return dht(1, id, {1, 1, 1, 1}, {0x00, 0x01, 0xF0, 0xF1});
  }
  JpegFile& sos(const std::vector<JpegScanComponent>& parts = {{}}, int ss = 0, int se = 63, int a = 0) {
    std::vector<int> data{static_cast<int>(parts.size())};
    for (const JpegScanComponent& p : parts) data.insert(data.end(), {p.id, p.tables});
    data.insert(data.end(), {ss, se, a});
    return segment(0xDA, data);
  }
  JpegFile& dri(int interval) { return segment(0xDD, {interval >> 8, interval & 255}); }
};

// A sound 8x8 gray file: DC difference 0, EOB.
inline JpegFile sound_gray() {
  return JpegFile().soi().dqt().sof(8, 8).small_tables().sos().bits("0 0").eoi();
}

// Colors with slopes, edges and some noise, the same everywhere.
RgbImage test_image(int width, int height, uint64_t seed = 1);

int max_difference(ConstRgbView a, ConstRgbView b);

}  // namespace pac::test
