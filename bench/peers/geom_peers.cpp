// Bytes of the geometry codec beside Draco's, on the same integers: positions on our grid, RGBA8, triangles for Draco
// (it has no polygons). usage: geom_peers [--bits N] [FILE.obj|FILE.ply ...]; without files the built-in room and pins.
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "base/file_io.h"
#include "geomcodec/geomcodec.h"
#include "raster/load_ply.h"
#include "raster/triangulate.h"
#include "sim/scenes.h"

namespace {

using pac::geomcodec::EncodedSize;
using pac::geomcodec::QuantizedMesh;

// What a mesh takes in Draco at a compression level (0..10), or 0 if Draco refuses it.
size_t draco_bytes(const QuantizedMesh& mesh, int level) {
  draco::Mesh out;
  const auto n_points = static_cast<uint32_t>(mesh.vertices.size());
  out.set_num_points(n_points);
  const auto add = [&](draco::GeometryAttribute::Type type, int8_t n_components, draco::DataType data_type,
                       size_t size) {
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, static_cast<uint8_t>(n_components), data_type,
                   type == draco::GeometryAttribute::COLOR, static_cast<int64_t>(size), 0);
    return out.attribute(out.AddAttribute(attribute, true, n_points));
  };
  draco::PointAttribute* position = add(draco::GeometryAttribute::POSITION, 3, draco::DT_INT32, 12);
  draco::PointAttribute* color = add(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8, 4);
  for (uint32_t v = 0; v < n_points; ++v) {
    const int32_t p[3] = {mesh.vertices[v].position[0], mesh.vertices[v].position[1], mesh.vertices[v].position[2]};
    position->SetAttributeValue(draco::AttributeValueIndex(v), p);
    color->SetAttributeValue(draco::AttributeValueIndex(v), mesh.vertices[v].color);
  }
  pac::Mesh floats = pac::geomcodec::dequantize(mesh);
  pac::raster::PolygonCutter cutter;
  for (const pac::Face& face : mesh.faces) {
    for (const pac::raster::CornerTriple& triangle : cutter.cut(floats, face)) {
      draco::Mesh::Face f;
      for (size_t k = 0; k < 3; ++k) f[k] = draco::PointIndex(mesh.indices[face.first + triangle.corner[k]]);
      out.AddFace(f);
    }
  }
  out.DeduplicateAttributeValues();
  out.DeduplicatePointIds();
  draco::Encoder encoder;
  encoder.SetSpeedOptions(10 - level, 10 - level);
  draco::EncoderBuffer buffer;
  return encoder.EncodeMeshToBuffer(out, &buffer).ok() ? buffer.size() : 0;
}

void report(const std::string& name, const QuantizedMesh& mesh) {
  EncodedSize size;
  const auto bytes = pac::geomcodec::encode(mesh, {}, &size);
  if (!bytes) {
    std::printf("%-16s %s\n", name.c_str(), bytes.failure().text);
    return;
  }
  const auto n_vertices = static_cast<double>(mesh.vertices.size()), n_faces = static_cast<double>(mesh.faces.size());
  const size_t cl7 = draco_bytes(mesh, 7), cl10 = draco_bytes(mesh, 10);
  const auto total = static_cast<double>(bytes->size());
  std::printf("%-16s %8.0f %8.0f | %7llu %7llu %7llu %8.0f | %6.2f %6.2f | %8zu %8zu %6.3f\n", name.c_str(), n_vertices,
              n_faces, static_cast<unsigned long long>(size.connectivity_bytes),
              static_cast<unsigned long long>(size.position_bytes), static_cast<unsigned long long>(size.color_bytes),
              total, total / n_vertices, total / n_faces, cl7, cl10, total / static_cast<double>(std::min(cl7, cl10)));
}

// A plausible shading, where a model has no colors: two lights and a slow pattern, quantized to 8 bits.
void shade(pac::Mesh& mesh) {
  for (pac::Vertex& vertex : mesh.vertices) {
    const float* n = vertex.normal;
    const float key = std::max(0.0f, 0.5f * n[0] + 0.6f * n[1] + 0.62f * n[2]);
    const float fill = std::max(0.0f, -0.8f * n[0] + 0.2f * n[1] + 0.5f * n[2]), gloss = key * key * key * key;
    const float light[3] = {0.2f + 0.6f * key + 0.1f * fill, 0.2f + 0.58f * key + 0.12f * fill,
                            0.22f + 0.5f * key + 0.2f * fill};
    const float albedo[3] = {0.8f, 0.6f, 0.5f};
    for (int c = 0; c < 3; ++c)
      vertex.color[c] = static_cast<uint8_t>(255 * std::min(1.0f, light[c] * albedo[c] + 0.25f * gloss * gloss) + 0.5f);
  }
}

}  // namespace

int main(int argc, char** argv) {
  int bits = 14;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--bits") == 0 && i + 1 < argc)
      bits = std::atoi(argv[++i]);
    else
      files.emplace_back(argv[i]);
  }
  std::printf("%d-bit positions, RGBA8; bytes\n%-16s %8s %8s | %7s %7s %7s %8s | %6s %6s | %8s %8s %6s\n", bits, "mesh",
              "vertices", "polygons", "connect", "pos", "color", "total", "B/vtx", "B/poly", "Draco 7", "Draco 10",
              "ratio");
  const auto run = [&](const std::string& name, const pac::Mesh& mesh) {
    const auto quantized = pac::geomcodec::quantize(mesh, bits);
    if (quantized) report(name, *quantized);
  };
  for (const std::string& file : files) {
    const auto bytes = pac::read_file(file);
    if (!bytes) continue;
    auto loaded = pac::raster::load_model(*bytes, {});
    if (!loaded) {
      std::printf("%s: %s\n", file.c_str(), loaded.failure().text);
      continue;
    }
    shade(loaded->scene.mesh);
    run(file.substr(file.find_last_of('/') + 1), loaded->scene.mesh);
  }
  for (const char* name : {"room", "pin"}) {
    if (files.size() > 1) break;
    const pac::sim::BuiltinScene* scene = pac::sim::find_scene(name);
    if (scene == nullptr) continue;
    const pac::sim::SceneSet set = scene->build(1);
    run(name, set.fine.mesh);
    if (!set.coarse.mesh.faces.empty()) run(std::string(name) + " coarse", set.coarse.mesh);
  }
}
