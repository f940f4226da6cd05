// What two threads give the MPEG-1 encoder: wall time of one thread over that of two, for the same bytes.
//   build/release/bench/peers/mpeg1_threads clip.y4m...
// The fastest of several runs each, one and two threads in turn. It needs two idle processors.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "bench/peers/encode_clip.h"

namespace {

using namespace pac;

constexpr int kRounds = 12, kGroup = 15;
constexpr double kQuantizer = 4;

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void compare(const bench::Clip& clip, const char* name, mpeg1::Effort effort, bool looks_ahead) {
  mpeg1::SequenceOptions options;
  options.gop_length = kGroup;
  options.quantizer_scale = kQuantizer;
  options.effort = effort;
  double least[2] = {1e9, 1e9};
  std::vector<uint8_t> bytes[2];
  for (int round = 0; round < kRounds; ++round)
    for (const int threads : {1, 2}) {
      options.threads = threads;
      std::vector<uint8_t>& coded = bytes[threads - 1];
      coded.clear();
      double& seconds = least[threads - 1];
      seconds = std::min(seconds, bench::encode_clip(clip, options, looks_ahead, wall_seconds, coded));
    }
  const auto n = static_cast<double>(clip.size());
  std::printf("  %-15s one thread %6.1f fps, two %6.1f fps: x%.2f%s\n", name, n / least[0], n / least[1],
              least[0] / least[1], bytes[0] == bytes[1] ? "" : "  (other bytes)");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const bench::Clip clip = bench::read_clip(argv[i]);
    if (clip.empty()) {
      std::printf("%s: no clip\n", argv[i]);
      continue;
    }
    std::printf("%s: %zu frames of %dx%d\n", argv[i], clip.size(), clip[0].width(), clip[0].height());
    compare(clip, "fast", mpeg1::Effort::fast, false);
    compare(clip, "default", mpeg1::Effort::normal, false);
    compare(clip, "best", mpeg1::Effort::best, false);
    compare(clip, "default, ahead", mpeg1::Effort::normal, true);
  }
  if (argc < 2) std::printf("usage: mpeg1_threads CLIP.y4m...\n");
  return 0;
}
