// Pictures a second of the MPEG-1 codec, by effort and instruction set, on one thread: 640x480, group of 15.
//   build/release/bench/pac_bench --benchmark_filter=mpeg1
#include "mpeg1/mpeg1.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace pac;

constexpr int kWidth = 640, kHeight = 480, kFrames = 15;

// A textured ground that pans by fractions of a sample, a disc that crosses it.
Frame420 make_frame(int time) {
  Frame420 frame(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double u = x + 1.3 * time, v = y + 0.4 * time;
      double value = 120 + 40 * std::sin(u * 0.07) * std::cos(v * 0.05) + 15 * std::sin(u * 0.9 + v * 0.7);
      const double dx = x - 12.5 * time - 100, dy = y - 240;
      if (dx * dx + dy * dy < 3600) value = 200 - dx * 0.5;
      frame.y.row(y)[x] = static_cast<uint8_t>(value);
    }
  for (int y = 0; y < kHeight / 2; ++y)
    for (int x = 0; x < kWidth / 2; ++x) {
      frame.cb.row(y)[x] = static_cast<uint8_t>(128 + 20 * std::sin((x + 0.65 * time) * 0.03));
      frame.cr.row(y)[x] = static_cast<uint8_t>(128 + 20 * std::cos((y + 0.2 * time) * 0.04));
    }
  return frame;
}
std::vector<Frame420> make_clip() {
  std::vector<Frame420> clip;
  for (int i = 0; i < kFrames; ++i) clip.push_back(make_frame(i));
  return clip;
}

bool encode_clip(const std::vector<Frame420>& clip, mpeg1::Effort effort, Isa isa, double quantizer,
                 std::vector<uint8_t>& out) {
  mpeg1::SequenceOptions options;
  options.width = kWidth;
  options.height = kHeight;
  options.quantizer_scale = quantizer;
  options.effort = effort;
  out.clear();
  auto encoder = mpeg1::Encoder::create(options, isa);
  if (!encoder.ok()) return false;
  for (const Frame420& frame : clip)
    if (!encoder->add(frame, out).ok()) return false;
  encoder->finish(out);
  return true;
}

void set_rate(benchmark::State& state, size_t bytes) {
  state.counters["pictures/s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kFrames, benchmark::Counter::kIsRate);
  state.counters["bytes"] = static_cast<double>(bytes);
}

void encode(benchmark::State& state, mpeg1::Effort effort, Isa isa) {
  const std::vector<Frame420> clip = make_clip();
  std::vector<uint8_t> out;
  for (auto _ : state)
    if (!encode_clip(clip, effort, isa, static_cast<double>(state.range(0)), out)) state.SkipWithError("encode failed");
  set_rate(state, out.size());
}

void decode(benchmark::State& state, Isa isa) {
  std::vector<uint8_t> bytes;
  encode_clip(make_clip(), mpeg1::Effort::normal, best_isa(), static_cast<double>(state.range(0)), bytes);
  for (auto _ : state) {
    mpeg1::Decoder decoder({}, isa);
    decoder.feed(bytes);
    decoder.finish();
    int n = 0;
    for (;; ++n) {
      const auto picture = decoder.next();
      if (!picture.ok() || *picture == nullptr) break;
      benchmark::DoNotOptimize((*picture)->view.y.data);
    }
    if (n != kFrames) state.SkipWithError("pictures are missing");
  }
  set_rate(state, bytes.size());
}

const bool registered = [] {
  const std::pair<mpeg1::Effort, const char*> efforts[] = {
      {mpeg1::Effort::fast, "fast"}, {mpeg1::Effort::normal, "default"}, {mpeg1::Effort::best, "best"}};
  for (int i = 0; i < kIsaCount; ++i) {
    const auto isa = static_cast<Isa>(i);
    if (!isa_is_built(isa) || !isa_is_supported(isa)) continue;
    for (const auto& [effort, name] : efforts)
      benchmark::RegisterBenchmark(("mpeg1/encode/" + std::string(name) + "/" + isa_name(isa)).c_str(), encode, effort,
                                   isa)
          ->Arg(3)
          ->Arg(8)
          ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((std::string("mpeg1/decode/") + isa_name(isa)).c_str(), decode, isa)
        ->Arg(3)
        ->Arg(8)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
