// The geometry codec: a shaded body of revolution, 3,008 and 76,000 triangles.
#include "geomcodec/geomcodec.h"

#include <benchmark/benchmark.h>

#include "base/exact_math.h"

namespace {

using pac::geomcodec::QuantizedMesh;

QuantizedMesh body(uint32_t segments, uint32_t rings) {
  pac::Mesh mesh;
  for (uint32_t r = 0; r <= rings; ++r) {
    const double t = static_cast<double>(r) / rings;
    const double radius = pac::exact_sin(pac::kPi * t) * (0.35 + 0.15 * pac::exact_sin(5.5 * t)) + 0.01;
    for (uint32_t s = 0; s < segments; ++s) {
      const double angle = 2 * pac::kPi * s / segments, x = pac::exact_cos(angle), y = pac::exact_sin(angle);
      const double light = 0.5 + 0.3 * x + 0.2 * y;
      pac::Vertex vertex;
      vertex.position[0] = static_cast<float>(radius * x);
      vertex.position[1] = static_cast<float>(radius * y);
      vertex.position[2] = static_cast<float>(2.5 * t);
      for (int c = 0; c < 3; ++c) vertex.color[c] = static_cast<uint8_t>(255 * light * (0.9 - 0.2 * c * t));
      mesh.vertices.push_back(vertex);
    }
  }
  for (uint32_t r = 0; r < rings; ++r) {
    for (uint32_t s = 0; s < segments; ++s) {
      const uint32_t a = r * segments + s, b = r * segments + (s + 1) % segments;
      const auto first = static_cast<uint32_t>(mesh.indices.size());
      mesh.indices.insert(mesh.indices.end(), {a, b, b + segments, a, b + segments, a + segments});
      mesh.faces.push_back({first, 3, 0});
      mesh.faces.push_back({first + 3, 3, 0});
    }
  }
  return pac::geomcodec::quantize(mesh, 14).value();
}

QuantizedMesh body_of(int64_t n_triangles) {
  return n_triangles < 10000 ? body(32, 47) : body(200, 190);
}

void encode(benchmark::State& state) {
  const QuantizedMesh mesh = body_of(state.range(0));
  size_t size = 0;
  for (auto _ : state) size = pac::geomcodec::encode(mesh)->size();
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(mesh.faces.size()));
  state.counters["bytes"] = static_cast<double>(size);
}
BENCHMARK(encode)->Name("geomcodec/encode")->Arg(3008)->Arg(76000)->Unit(benchmark::kMillisecond);

void decode(benchmark::State& state) {
  const QuantizedMesh mesh = body_of(state.range(0));
  const std::vector<uint8_t> bytes = pac::geomcodec::encode(mesh).value();
  for (auto _ : state) benchmark::DoNotOptimize(pac::geomcodec::decode(bytes)->vertices.data());
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(mesh.faces.size()));
}
BENCHMARK(decode)->Name("geomcodec/decode")->Arg(3008)->Arg(76000)->Unit(benchmark::kMillisecond);

}  // namespace
