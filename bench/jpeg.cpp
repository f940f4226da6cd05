// Megapixels a second of the JPEG codec, by effort and instruction set, on one thread.
#include "jpeg/jpeg.h"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <vector>

#include "bench/jpeg_images.h"

namespace {

using namespace pac;

constexpr int kWidth = 1920, kHeight = 1080;

void set_rate(benchmark::State& state) {
  const double pixels = static_cast<double>(state.iterations()) * kWidth * kHeight;
  state.counters["MP/s"] = benchmark::Counter(pixels / 1e6, benchmark::Counter::kIsRate);
}

void encode(benchmark::State& state, jpeg::Effort effort, Isa isa) {
  const RgbImage image = bench::photograph_like(kWidth, kHeight);
  jpeg::EncodeOptions options = jpeg::options_for(effort, jpeg::Tune::visual, static_cast<double>(state.range(0)));
  options.isa = isa;
  jpeg::Encoder encoder;
  std::vector<uint8_t> out;
  for (auto _ : state) {
    out.clear();
    if (!encoder.encode_append(image.view(), options, out).ok()) state.SkipWithError("encode failed");
    benchmark::DoNotOptimize(out.data());
  }
  set_rate(state);
  state.counters["bytes"] = static_cast<double>(out.size());
}

void decode(benchmark::State& state, Isa isa) {
  const RgbImage image = bench::photograph_like(kWidth, kHeight);
  jpeg::EncodeOptions options =
      jpeg::options_for(jpeg::Effort::normal, jpeg::Tune::visual, static_cast<double>(state.range(0)));
  const auto bytes = *jpeg::encode(image.view(), options);
  jpeg::Decoder decoder({}, isa);
  RgbImage out(kWidth, kHeight);
  for (auto _ : state) {
    if (!decoder.decode_into(bytes, out.view()).ok()) state.SkipWithError("decode failed");
    benchmark::DoNotOptimize(out.row(0));
  }
  set_rate(state);
}

const bool registered = [] {
  const std::pair<jpeg::Effort, const char*> efforts[] = {
      {jpeg::Effort::fast, "fast"}, {jpeg::Effort::normal, "normal"}, {jpeg::Effort::best, "best"}};
  for (int i = 0; i < kIsaCount; ++i) {
    const auto isa = static_cast<Isa>(i);
    if (!isa_is_built(isa) || !isa_is_supported(isa)) continue;
    for (const auto& [effort, name] : efforts)
      benchmark::RegisterBenchmark(("jpeg/encode/" + std::string(name) + "/" + isa_name(isa)).c_str(), encode, effort,
                                   isa)
          ->Arg(50)
          ->Arg(75)
          ->Arg(90)
          ->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark((std::string("jpeg/decode/") + isa_name(isa)).c_str(), decode, isa)
        ->Arg(50)
        ->Arg(75)
        ->Arg(90)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
