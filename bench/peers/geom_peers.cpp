// Bytes and speed of the geometry codec beside Draco (levels 7 and 10) and meshoptimizer + zstd -19, on the same
// integers. usage: geom_peers [--large] [--speed REPEATS] [--bits N] [--only TEXT] [FILE...]
//   --large   also meshes of 75,000 triangles and more    --speed   also times, each the shortest of REPEATS runs
//   --bits    only this position precision                --only    only variants whose name contains TEXT
#include "bench/peers/geom_peers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

using pac::geomcodec::QuantizedMesh;
using pac::peers::Attributes;
using pac::peers::Measured;
using pac::peers::NamedMesh;

struct Variant {
  const char* name;
  int bits;  // 0: 16-bit screen space
  Attributes attributes;
};
constexpr Variant kVariants[] = {
    {"11 bits, positions", 11, {}},
    {"11 bits, colors", 11, {true, false, false}},
    {"14 bits, positions", 14, {}},
    {"14 bits, colors", 14, {true, false, false}},
    {"14 bits, normals (10) and texture (12)", 14, {false, true, true}},
    {"16 bits, positions", 16, {}},
    {"16 bits, colors", 16, {true, false, false}},
    {"screen, 16 bits, colors", 0, {true, false, false}},
};

// Seen from a corner of its bounding box, 640 x 480, a field of view of about 50 degrees: x, y in 1/16 pixel, depth in
// 16 bits.
pac::Mesh on_screen(const pac::Mesh& mesh) {
  double low[3] = {1e30, 1e30, 1e30}, high[3] = {-1e30, -1e30, -1e30};
  for (const pac::Vertex& vertex : mesh.vertices) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], double{vertex.position[i]});
      high[i] = std::max(high[i], double{vertex.position[i]});
    }
  }
  double size = 0;
  for (int i = 0; i < 3; ++i) size = std::max(size, high[i] - low[i]);
  if (!(size > 0)) size = 1;
  pac::Mesh result = mesh;
  for (pac::Vertex& vertex : result.vertices) {
    double p[3];
    for (int i = 0; i < 3; ++i) p[i] = (vertex.position[i] - 0.5 * (low[i] + high[i])) / size;
    const double right = 0.8 * p[0] - 0.6 * p[1], ahead = 0.6 * p[0] + 0.8 * p[1];
    const double up = 0.9 * p[2] + 0.43 * ahead, depth = 1.9 + 0.9 * ahead - 0.43 * p[2];
    vertex.position[0] = static_cast<float>(16 * (320 + 480 * right / depth));
    vertex.position[1] = static_cast<float>(16 * (240 - 480 * up / depth));
    vertex.position[2] = static_cast<float>(65535 * std::clamp((1 / 0.9 - 1 / depth) / (1 / 0.9 - 1 / 2.9), 0.0, 1.0));
  }
  return result;
}

bool quantized(const NamedMesh& named, const Variant& variant, QuantizedMesh& out) {
  if (variant.attributes.texcoords && !named.has_texcoords) return false;
  pac::geomcodec::AttributeBits bits;
  bits.position = variant.bits;
  bits.normal = variant.attributes.normals ? 10 : 0;
  bits.texcoord = variant.attributes.texcoords ? 12 : 0;
  const auto result = variant.bits == 0 ? pac::geomcodec::quantize(on_screen(named.mesh), pac::geomcodec::Grid{})
                                        : pac::geomcodec::quantize(named.mesh, bits);
  if (!result.ok()) return false;
  out = *result;
  if (!variant.attributes.colors)
    for (auto& vertex : out.vertices) std::fill(vertex.color, vertex.color + 4, uint8_t{255});
  for (pac::Face& face : out.faces) face.material = 0;
  out = pac::geomcodec::merge_equal_vertices(out);
  return true;
}

struct Means {
  double log_bytes = 0, log_encode = 0, log_decode = 0, worst = 0;
  int n = 0, n_above_meshoptimizer = 0;
};

// Meshes below this many vertices and the others have means of their own: encoders take more time over the former.
constexpr size_t kLarge = 16384;

void print_means(const char* which, const Means& means, int repeats) {
  if (means.n == 0) return;
  std::printf("%-16s bytes %.3f x Draco 10, worst %.3f, above meshoptimizer + zstd: %d of %d", which,
              std::exp(means.log_bytes / means.n), means.worst, means.n_above_meshoptimizer, means.n);
  if (repeats > 0)
    std::printf("; encode %.2f x Draco 10, decode %.2f x Draco 7", std::exp(means.log_encode / means.n),
                std::exp(means.log_decode / means.n));
  std::printf("\n");
}

void run(const NamedMesh& named, const Variant& variant, int repeats, Means (&groups)[3]) {
  QuantizedMesh mesh;
  if (!quantized(named, variant, mesh)) return;
  const Measured ours = pac::peers::measure_pac(mesh, repeats);
  const Measured draco7 = pac::peers::measure_draco(mesh, variant.attributes, 7, repeats);
  const Measured draco10 = pac::peers::measure_draco(mesh, variant.attributes, 10, repeats);
  const Measured other = pac::peers::measure_meshoptimizer_zstd(mesh, variant.attributes);
  if (ours.bytes == 0 || draco10.bytes == 0 || draco7.bytes == 0) return;
  const double ratio = static_cast<double>(ours.bytes) / static_cast<double>(draco10.bytes);
  std::printf("%-16s %7zu %7zu | %8zu %8zu %8zu %8zu | %6.3f%s", named.name.c_str(), mesh.vertices.size(),
              mesh.faces.size(), ours.bytes, draco7.bytes, draco10.bytes, other.bytes, ratio,
              ours.bytes > other.bytes ? " > meshopt" : "");
  if (repeats > 0) {
    std::printf(" | encode %5.2f x Draco 10, decode %5.2f x Draco 7 (%.2f, %.2f M faces/s)",
                draco10.encode_seconds / ours.encode_seconds, draco7.decode_seconds / ours.decode_seconds,
                1e-6 * static_cast<double>(mesh.faces.size()) / ours.encode_seconds,
                1e-6 * static_cast<double>(mesh.faces.size()) / ours.decode_seconds);
  }
  std::printf("\n");
  for (Means* means : {&groups[0], &groups[mesh.vertices.size() < kLarge ? 1 : 2]}) {
    if (repeats > 0) {
      means->log_encode += std::log(draco10.encode_seconds / ours.encode_seconds);
      means->log_decode += std::log(draco7.decode_seconds / ours.decode_seconds);
    }
    means->log_bytes += std::log(ratio);
    means->worst = std::max(means->worst, ratio);
    means->n_above_meshoptimizer += ours.bytes > other.bytes ? 1 : 0;
    ++means->n;
  }
}

}  // namespace

int main(int argc, char** argv) {
  int large = 0, repeats = 0, bits = -1;
  const char* only = "";
  std::vector<NamedMesh> meshes;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--large") {
      large = 1;
    } else if (argument == "--speed" && i + 1 < argc) {
      repeats = std::atoi(argv[++i]);
    } else if (argument == "--bits" && i + 1 < argc) {
      bits = std::atoi(argv[++i]);
    } else if (argument == "--only" && i + 1 < argc) {
      only = argv[++i];
    } else {
      NamedMesh mesh;
      if (pac::peers::load_file(argument, mesh)) meshes.push_back(std::move(mesh));
    }
  }
  if (meshes.empty()) meshes = pac::peers::test_meshes(large);
  for (const Variant& variant : kVariants) {
    if ((bits >= 0 && variant.bits != bits) || std::strstr(variant.name, only) == nullptr) continue;
    std::printf("\n%s\n%-16s %7s %7s | %8s %8s %8s %8s | %6s\n", variant.name, "mesh", "vertex", "face", "pac",
                "Draco 7", "Draco 10", "mo+zstd", "pac/10");
    Means groups[3];
    for (const NamedMesh& mesh : meshes) run(mesh, variant, repeats, groups);
    print_means("geometric mean", groups[0], repeats);
    print_means("below 16k", groups[1], repeats);
    print_means("larger", groups[2], repeats);
  }
}
