#include "bench/peers/peer_codecs.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "base/file_io.h"
#include "base/image_io.h"
#include "base/y4m.h"
#include "bench/peers/scene_shots.h"
#include "sim/frame420.h"

namespace pac::bench {

namespace {

// IVF: 32 bytes of file header, 12 before each frame.
uint64_t code_bytes(const Bytes& file, const std::string& format, size_t frames) {
  return format == "ivf" ? file.size() - 32 - 12 * frames : file.size();
}

std::string filled(const char* pattern, double setting, bool is_whole) {
  char text[512];
  if (is_whole)
    std::snprintf(text, sizeof text, pattern, static_cast<int>(setting));
  else
    std::snprintf(text, sizeof text, pattern, setting);
  return text;
}

int even(int size) {
  return size + size % 2;
}

// Video codecs of 4:2:0 want even sizes: the last column and row twice where there is an odd one.
RgbImage padded(ConstRgbView picture) {
  RgbImage out(even(picture.width), even(picture.height));
  for (int y = 0; y < out.height(); ++y) {
    const uint8_t* from = picture.row(std::min(y, picture.height - 1));
    std::memcpy(out.row(y), from, 3 * static_cast<size_t>(picture.width));
    if (out.width() > picture.width) std::memcpy(out.pixel(picture.width, y), from + 3 * (picture.width - 1), 3);
  }
  return out;
}

RgbImage cropped(const RgbImage& picture, int width, int height) {
  RgbImage out(width, height);
  for (int y = 0; y < height; ++y) std::memcpy(out.row(y), picture.row(y), 3 * static_cast<size_t>(width));
  return out;
}

}  // namespace

std::string peers_folder() {
  return PAC_PEERS_FOLDER;
}

const std::vector<VideoPeer>& video_peers() {
  static const std::vector<VideoPeer> list = {
      {"x264-low-delay",
       "x264 veryslow, zerolatency",
       "-c:v libx264 -preset veryslow -tune zerolatency -g 600 -crf %d",
       "h264",
       {24, 28, 32, 36, 40}},
      {"svt-av1-low-delay",
       "SVT-AV1 p4, low delay",
       "-c:v libsvtav1 -preset 4 -g 600 -crf %d -svtav1-params pred-struct=1",
       "ivf",
       {30, 38, 46, 54, 60}},
      {"x264-best",
       "x264 veryslow, two-pass, B",
       "-c:v libx264 -preset veryslow -g 600 -b:v %dk",
       "h264",
       {60, 120, 240, 480, 960},
       true},
      {"x265-low-delay",
       "x265 slower, zerolatency",
       "-c:v libx265 -preset slower -tune zerolatency -x265-params log-level=0:keyint=600:info=0 -crf %d",
       "hevc",
       {24, 28, 32, 36, 40}},
      {"svt-av1-best",
       "SVT-AV1 p4, random access",
       "-c:v libsvtav1 -preset 4 -g 600 -crf %d",
       "ivf",
       {30, 38, 46, 54, 60}},
  };
  return list;
}

const std::vector<StillPeer>& still_peers() {
  static const std::vector<StillPeer> list = {
      {"mozjpeg",
       "mozjpeg",
       "folder=$PWD && cd \"$PAC_MOZJPEG\" && node \"$PAC_PEERS/mozjpeg_files.mjs\" --quality %g "
       "\"$folder/source.ppm\" "
       "\"$folder/coded.jpg\" && cd \"$folder\"",
       "djpeg -pnm coded.jpg >shown.ppm",
       "jpg",
       {15, 30, 45, 60, 75}},
      {"webp",
       "WebP",
       "cwebp -quiet -m 6 -sharp_yuv -q %g source.png -o coded.webp",
       "dwebp -quiet -ppm coded.webp -o shown.ppm",
       "webp",
       {5, 20, 40, 60, 80}},
      {"avif",
       "AVIF",
       "avifenc -s 3 -y 420 --min 0 --max 63 -a end-usage=q -a cq-level=%g -a tune=ssim source.png coded.avif",
       "avifdec --png-compress 0 coded.avif shown.png",
       "avif",
       {52, 44, 36, 28, 20}},
      {"jpeg-xl",
       "JPEG XL",
       "cjxl source.ppm coded.jxl -e 8 -d %g",
       "djxl coded.jxl shown.ppm",
       "jxl",
       {12, 8, 5, 3, 1.5}},
  };
  return list;
}

PeerRunner::PeerRunner(std::vector<ConstRgbView> pictures, int frames_per_second) : n_pictures_(pictures.size()) {
  char folder[] = "/tmp/pac_peers_XXXXXX";
  if (mkdtemp(folder) == nullptr) {
    std::fprintf(stderr, "no temporary folder\n");
    std::exit(1);
  }
  folder_ = folder;
  setenv("PAC_PEERS", PAC_PEERS_FOLDER, 1);
  width_ = pictures[0].width;
  height_ = pictures[0].height;
  Bytes y4m;
  append_y4m_header(y4m, {even(width_), even(height_), frames_per_second, 1, 1, 1, ChromaSiting::jpeg});
  Frame420 frame(even(width_), even(height_));
  for (const ConstRgbView& picture : pictures) {
    sim::frame420_from_rgb(padded(picture).view(), frame);
    append_y4m_frame(y4m, frame);
  }
  bool written = write_file(folder_ + "/h.y4m", y4m).ok();
  for (const char* name : {"/source.png", "/source.ppm"})
    written = written && write_file(folder_ + name, need(encode_image(pictures[0], name), name)).ok();
  if (written) return;
  std::fprintf(stderr, "%s: cannot be written\n", folder_.c_str());
  std::exit(1);
}

PeerRunner::~PeerRunner() {
  if (std::system(("rm -r " + folder_).c_str()) != 0) std::fprintf(stderr, "%s: is left over\n", folder_.c_str());
}

bool PeerRunner::run(const std::string& command) const {
  const int status = std::system(("cd " + folder_ + " && { " + command + "; } >/dev/null 2>&1").c_str());
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::optional<PeerCode> PeerRunner::video(const VideoPeer& peer, int setting) {
  const std::string quiet = "ffmpeg -v error -y ", code = std::string("code.") + peer.format;
  const std::string encode =
      "SVT_LOG=0 " + quiet + "-i h.y4m " + filled(peer.options, setting, true) + " -pix_fmt yuv420p ";
  PeerCode out;
  const double begin = children_cpu_ms();
  if (peer.two_pass && !run(encode + "-pass 1 -f null /dev/null")) return std::nullopt;
  // Unit 6 of H.264 is a text about the encoder, 600 bytes: no part of the pictures. (libx265: info=0.)
  const std::string lean = std::strcmp(peer.format, "h264") == 0 ? "-bsf:v filter_units=remove_types=6 " : "";
  if (!run(encode + lean + (peer.two_pass ? "-pass 2 " : "") + "-f " + peer.format + " " + code)) return std::nullopt;
  const double encoded = children_cpu_ms();
  if (!run(quiet + "-i " + code + " -f rawvideo -pix_fmt yuv420p shown.yuv")) return std::nullopt;
  out.encode_ms = encoded - begin;
  out.decode_ms = children_cpu_ms() - encoded;
  const auto raw = read_file(folder_ + "/shown.yuv");
  const auto file = read_file(folder_ + "/" + code);
  Frame420 frame(even(width_), even(height_));
  const auto plane_bytes = [](const GrayImage& plane) {
    return static_cast<size_t>(plane.width()) * static_cast<size_t>(plane.height());
  };
  const size_t frame_bytes = plane_bytes(frame.y) + 2 * plane_bytes(frame.cb);
  if (!raw.ok() || !file.ok() || raw->size() != frame_bytes * n_pictures_) return std::nullopt;
  const uint8_t* at = raw->data();
  for (size_t i = 0; i < n_pictures_; ++i) {
    for (GrayImage* plane : {&frame.y, &frame.cb, &frame.cr})
      for (int y = 0; y < plane->height(); ++y, at += plane->width())
        std::memcpy(plane->row(y), at, static_cast<size_t>(plane->width()));
    RgbImage picture(even(width_), even(height_));
    sim::rgb_from_frame420(frame, picture.view());
    out.shown.push_back(cropped(picture, width_, height_));
  }
  out.bytes = code_bytes(*file, peer.format, n_pictures_);
  return out;
}

std::optional<PeerCode> PeerRunner::still(const StillPeer& peer, double setting) {
  run("rm -f shown.png shown.ppm");
  PeerCode out;
  const double begin = children_cpu_ms();
  if (!run(filled(peer.encode, setting, false))) return std::nullopt;
  const double encoded = children_cpu_ms();
  if (!run(peer.decode)) return std::nullopt;
  out.encode_ms = encoded - begin;
  out.decode_ms = children_cpu_ms() - encoded;
  const auto file = read_file(folder_ + "/coded." + peer.extension);
  auto picture = read_file(folder_ + "/shown.ppm");
  if (!picture.ok()) picture = read_file(folder_ + "/shown.png");
  if (!file.ok() || !picture.ok()) return std::nullopt;
  auto shown = decode_rgb(*picture);
  if (!shown.ok() || shown->width() != width_ || shown->height() != height_) return std::nullopt;
  out.bytes = file->size();
  out.shown.push_back(std::move(*shown));
  return out;
}

}  // namespace pac::bench
