// Marker codes: the byte after 0xFF [T.81 table B.1].
#pragma once

#include <cstdint>

namespace pac::jpeg {

constexpr uint8_t kSof0 = 0xC0, kSof1 = 0xC1, kSof2 = 0xC2, kSof3 = 0xC3, kDht = 0xC4, kSof5 = 0xC5, kSof9 = 0xC9,
                  kSof11 = 0xCB, kDac = 0xCC, kSof15 = 0xCF, kRst0 = 0xD0, kRst7 = 0xD7, kSoi = 0xD8, kEoi = 0xD9,
                  kSos = 0xDA, kDqt = 0xDB, kDnl = 0xDC, kDri = 0xDD, kDhp = 0xDE, kExp = 0xDF, kApp0 = 0xE0,
                  kApp1 = 0xE1, kApp2 = 0xE2, kApp14 = 0xEE, kCom = 0xFE, kTem = 0x01;

constexpr bool is_start_of_frame(int code) {
  return code >= kSof0 && code <= kSof15 && code != kDht && code != kDac && code != 0xC8;
}
constexpr bool is_restart(int code) {
  return code >= kRst0 && code <= kRst7;
}

}  // namespace pac::jpeg
