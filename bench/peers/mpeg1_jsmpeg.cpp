// Our streams through jsmpeg's decoder (JavaScript, what browsers without a video element play): how near its pictures
// are to ours, how many times faster our decoder is.
//   mpeg1_jsmpeg FOLDER_WITH_NODE_MODULES jsmpeg_decode.mjs CLIP.y4m...
// Needs node and, in that folder, `npm install @cycjimmy/jsmpeg-player`; says so and stops where they are missing.
//
// jsmpeg shifts negative products right when it dequantizes, which rounds them away from zero, where the standard
// truncates [2.4.4.1]. With matrices of multiples of 16 there is nothing to round: both are measured.
#include <sys/wait.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/file_io.h"
#include "base/metrics.h"
#include "bench/peers/y4m_clip.h"
#include "mpeg1/mpeg1.h"

namespace {

using namespace pac;
using bench::Clip;
using bench::read_clip;

constexpr double kQuantizers[] = {2, 4, 8, 16};
constexpr int kMissing = 3;  // the script's exit code

double cpu_milliseconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

std::vector<uint8_t> encode(const Clip& clip, double quantizer, bool has_flat_matrix) {
  mpeg1::SequenceOptions options;
  options.width = clip[0].width();
  options.height = clip[0].height();
  options.quantizer_scale = quantizer;
  if (has_flat_matrix) {
    options.intra_matrix.emplace().fill(16);
    (*options.intra_matrix)[0] = 8;
  }
  std::vector<uint8_t> bytes;
  auto encoder = mpeg1::Encoder::create(options);
  if (!encoder.ok()) return bytes;
  for (const Frame420& frame : clip)
    if (!encoder->add(frame, bytes).ok()) return {};
  encoder->finish(bytes);
  return bytes;
}

Clip decode_ours(const std::vector<uint8_t>& bytes, double& milliseconds) {
  Clip clip;
  mpeg1::Decoder decoder;
  const double start = cpu_milliseconds();
  decoder.feed(bytes);
  decoder.finish();
  for (;;) {
    const auto picture = decoder.next();
    if (!picture.ok() || *picture == nullptr) break;
    clip.push_back(mpeg1::copy_of((*picture)->view));
  }
  milliseconds = cpu_milliseconds() - start;
  return clip;
}

struct Paths {
  std::string folder, script, stream, pictures, said;
};

std::string quoted(const std::string& path) {
  std::string text = "'";
  text += path;
  text += '\'';
  return text;
}

// The script's exit code; -1 where it could not run.
int run_jsmpeg(const Paths& paths) {
  std::string command = "cd ";
  command += quoted(paths.folder);
  command += " && node ";
  for (const std::string* argument : {&paths.script, &paths.stream, &paths.pictures}) {
    command += quoted(*argument);
    command += ' ';
  }
  command += "> ";
  command += quoted(paths.said);
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

double worst_psnr(const Clip& a, const Clip& b) {
  double worst = 999;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::min(worst, psnr_from_mse(mean_squared_error(a[i].y.view(), b[i].y.view())));
  return worst;
}

// False where jsmpeg is missing.
bool compare(const Paths& paths, const Clip& clip, double quantizer, bool has_flat_matrix) {
  const std::vector<uint8_t> bytes = encode(clip, quantizer, has_flat_matrix);
  if (!write_file(paths.stream, bytes).ok()) return false;
  const int code = run_jsmpeg(paths);
  if (code == kMissing) std::printf("skipped: no @cycjimmy/jsmpeg-player in %s\n", paths.folder.c_str());
  if (code == 127) std::printf("skipped: no node\n");
  if (code != 0) return false;
  const auto said = read_file(paths.said);
  int pictures = 0;
  double theirs = 0, ours = 0;
  if (said.ok()) {
    const std::string text(said->begin(), said->end());
    if (std::sscanf(text.c_str(), "%d %lf", &pictures, &theirs) != 2) return false;
  }
  const Clip expected = decode_ours(bytes, ours);
  const Clip actual = read_clip(paths.pictures);
  std::printf("  q%-4g %-14s %9zu bytes  %zu of %zu pictures, worst %6.2f dB to ours, ours x%.1f as fast\n", quantizer,
              has_flat_matrix ? "flat matrix" : "default matrix", bytes.size(), actual.size(), expected.size(),
              worst_psnr(expected, actual), theirs / ours);
  std::fflush(stdout);
  return true;
}

std::string absolute(const char* path) {
  char* resolved = realpath(path, nullptr);
  std::string text = resolved != nullptr ? resolved : path;
  std::free(resolved);
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::printf("usage: mpeg1_jsmpeg FOLDER_WITH_NODE_MODULES jsmpeg_decode.mjs CLIP.y4m...\n");
    return 0;
  }
  char folder[] = "/tmp/mpeg1_jsmpeg_XXXXXX";
  if (mkdtemp(folder) == nullptr) return 1;
  Paths paths{absolute(argv[1]), absolute(argv[2]), folder, folder, folder};
  paths.stream += "/clip.m1v";
  paths.pictures += "/clip.y4m";
  paths.said += "/said.txt";
  bool goes_on = true;
  for (int i = 3; i < argc && goes_on; ++i) {
    const Clip clip = read_clip(argv[i]);
    if (clip.empty()) {
      std::printf("%s: no clip\n", argv[i]);
      continue;
    }
    std::printf("%s: %zu frames of %dx%d\n", argv[i], clip.size(), clip[0].width(), clip[0].height());
    for (const double quantizer : kQuantizers)
      for (const bool flat : {false, true}) goes_on = goes_on && compare(paths, clip, quantizer, flat);
  }
  for (const std::string* file : {&paths.stream, &paths.pictures, &paths.said}) std::remove(file->c_str());
  std::remove(folder);
  return 0;
}
