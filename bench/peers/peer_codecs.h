// Other people's codecs on the same pictures, run as programs: Debian's ffmpeg (libx264, libx265, libsvtav1),
// libavif-bin, libjxl-tools, webp; mozjpeg by node (mozjpeg_files.mjs), where the environment's PAC_MOZJPEG is the
// folder in which `npm install @jsquash/jpeg` ran.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image.h"

namespace pac::bench {

struct VideoPeer {
  const char* key;      // of files
  const char* label;    // of tables
  const char* options;  // of ffmpeg; %d: the quality
  const char* format;
  std::vector<int> settings;  // qualities, or kb/s
  bool two_pass = false;
};
const std::vector<VideoPeer>& video_peers();

struct StillPeer {
  const char* key;
  const char* label;
  const char* encode;  // a shell's command: source.png or source.ppm to coded.EXT; %g: the setting
  const char* decode;  // to shown.png
  const char* extension;
  std::vector<double> settings;  // from coarse to fine
};
const std::vector<StillPeer>& still_peers();

// Where the scripts of this folder are.
std::string peers_folder();

// What a viewer of the peer's code sees.
struct PeerCode {
  uint64_t bytes =
      0;  // raw H.264 and H.265 less remarks about the encoder, IVF less its headers; whole files of stills
  std::vector<RgbImage> shown;
  double encode_ms = 0, decode_ms = 0;  // CPU time of the programs, start and files included; 0: not known
};

// A temporary folder with the pictures in it. One object, one thread at a time.
class PeerRunner {
 public:
  // Writes them as a 4:2:0 sequence, an odd column or row doubled, and the first as PNG and PPM.
  PeerRunner(std::vector<ConstRgbView> pictures, int frames_per_second);
  ~PeerRunner();
  PeerRunner(const PeerRunner&) = delete;
  PeerRunner& operator=(const PeerRunner&) = delete;

  // Empty where the program is not there or fails.
  std::optional<PeerCode> video(const VideoPeer& peer, int setting);
  std::optional<PeerCode> still(const StillPeer& peer, double setting);  // of the first picture

 private:
  bool run(const std::string& command) const;

  std::string folder_;
  int width_ = 0, height_ = 0;
  size_t n_pictures_ = 0;
};

}  // namespace pac::bench
