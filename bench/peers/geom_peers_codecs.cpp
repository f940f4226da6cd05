// Draco 1.5 and meshoptimizer + zstd on our integers.
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <meshoptimizer.h>
#include <zstd.h>

#include <algorithm>
#include <ctime>
#include <memory>

#include "bench/peers/geom_peers.h"
#include "raster/triangulate.h"

namespace pac::peers {
namespace {

using geomcodec::QuantizedMesh;
using geomcodec::QuantizedVertex;

double cpu_seconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// The shortest of several runs.
template <class Run>
double fastest(int repeats, Run run) {
  double best = 1e9;
  for (int i = 0; i < repeats; ++i) {
    const double start = cpu_seconds();
    run();
    best = std::min(best, cpu_seconds() - start);
  }
  return repeats > 0 ? best : 0;
}

std::vector<uint32_t> triangles_of(const QuantizedMesh& mesh) {
  std::vector<uint32_t> indices;
  const Mesh floats = geomcodec::dequantize(mesh);
  raster::PolygonCutter cutter;
  for (const Face& face : mesh.faces) {
    if (face.count == 3) {
      indices.insert(indices.end(), &mesh.indices[face.first], &mesh.indices[face.first] + 3);
      continue;
    }
    for (const raster::CornerTriple& triangle : cutter.cut(floats, face))
      for (const uint32_t k : triangle.corner) indices.push_back(mesh.indices[face.first + k]);
  }
  return indices;
}

draco::PointAttribute* add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, int n,
                                     draco::DataType data, size_t size, uint32_t n_points) {
  draco::GeometryAttribute attribute;
  attribute.Init(type, nullptr, static_cast<uint8_t>(n), data, type == draco::GeometryAttribute::COLOR,
                 static_cast<int64_t>(size), 0);
  return mesh.attribute(mesh.AddAttribute(attribute, true, n_points));
}

// Positions and texture coordinates as integers; normals as unit vectors, which Draco makes octahedral itself.
std::unique_ptr<draco::Mesh> draco_mesh(const QuantizedMesh& mesh, const Attributes& attributes) {
  auto out = std::make_unique<draco::Mesh>();
  const auto n = static_cast<uint32_t>(mesh.vertices.size());
  const Mesh floats = geomcodec::dequantize(mesh);
  out->set_num_points(n);
  draco::PointAttribute* position = add_attribute(*out, draco::GeometryAttribute::POSITION, 3, draco::DT_INT32, 12, n);
  draco::PointAttribute* color = nullptr;
  draco::PointAttribute* normal = nullptr;
  draco::PointAttribute* texcoord = nullptr;
  if (attributes.colors) color = add_attribute(*out, draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8, 4, n);
  if (attributes.normals) normal = add_attribute(*out, draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32, 12, n);
  if (attributes.texcoords)
    texcoord = add_attribute(*out, draco::GeometryAttribute::TEX_COORD, 2, draco::DT_INT32, 8, n);
  for (uint32_t v = 0; v < n; ++v) {
    const QuantizedVertex& vertex = mesh.vertices[v];
    const draco::AttributeValueIndex index(v);
    const int32_t p[3] = {vertex.position[0], vertex.position[1], vertex.position[2]};
    const int32_t t[2] = {vertex.texcoord[0], vertex.texcoord[1]};
    position->SetAttributeValue(index, p);
    if (color != nullptr) color->SetAttributeValue(index, vertex.color);
    if (normal != nullptr) normal->SetAttributeValue(index, floats.vertices[v].normal);
    if (texcoord != nullptr) texcoord->SetAttributeValue(index, t);
  }
  const std::vector<uint32_t> indices = triangles_of(mesh);
  for (size_t i = 0; i < indices.size(); i += 3)
    out->AddFace({draco::PointIndex(indices[i]), draco::PointIndex(indices[i + 1]), draco::PointIndex(indices[i + 2])});
  out->DeduplicateAttributeValues();
  out->DeduplicatePointIds();
  return out;
}

}  // namespace

Measured measure_pac(const QuantizedMesh& mesh, int repeats) {
  Measured result;
  const auto bytes = geomcodec::encode(mesh);
  if (!bytes.ok()) return result;
  result.bytes = bytes->size();
  result.encode_seconds = fastest(repeats, [&] { PAC_ASSERT(geomcodec::encode(mesh).ok()); });
  result.decode_seconds = fastest(repeats, [&] { PAC_ASSERT(geomcodec::decode(*bytes).ok()); });
  return result;
}

Measured measure_draco(const QuantizedMesh& mesh, const Attributes& attributes, int level, int repeats) {
  Measured result;
  const std::unique_ptr<draco::Mesh> input = draco_mesh(mesh, attributes);
  draco::EncoderBuffer buffer;
  const auto encode = [&] {
    draco::Encoder encoder;
    encoder.SetSpeedOptions(10 - level, 10 - level);
    if (attributes.normals) encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, mesh.normal_bits);
    buffer.Clear();
    return encoder.EncodeMeshToBuffer(*input, &buffer).ok();
  };
  if (!encode()) return result;
  result.bytes = buffer.size();
  result.encode_seconds = fastest(repeats, [&] { encode(); });
  result.decode_seconds = fastest(repeats, [&] {
    draco::DecoderBuffer in;
    in.Init(buffer.data(), buffer.size());
    draco::Decoder decoder;
    PAC_ASSERT(decoder.DecodeMeshFromBuffer(&in).ok());
  });
  return result;
}

Measured measure_meshoptimizer_zstd(const QuantizedMesh& mesh, const Attributes& attributes) {
  std::vector<uint32_t> indices = triangles_of(mesh);
  const size_t stride =
      8 + (attributes.colors ? 4u : 0u) + (attributes.normals ? 4u : 0u) + (attributes.texcoords ? 4u : 0u);
  std::vector<uint8_t> vertices(mesh.vertices.size() * stride);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    uint8_t* out = &vertices[v * stride];
    const auto put = [&](const auto& values) {
      const auto* from = reinterpret_cast<const uint8_t*>(values);
      out = std::copy(from, from + sizeof values, out);
    };
    put(mesh.vertices[v].position);
    out += 2;
    if (attributes.colors) put(mesh.vertices[v].color);
    if (attributes.normals) put(mesh.vertices[v].normal);
    if (attributes.texcoords) put(mesh.vertices[v].texcoord);
  }
  meshopt_optimizeVertexCacheStrip(indices.data(), indices.data(), indices.size(), mesh.vertices.size());
  const size_t n = meshopt_optimizeVertexFetch(vertices.data(), indices.data(), indices.size(), vertices.data(),
                                               mesh.vertices.size(), stride);
  std::vector<uint8_t> bytes(meshopt_encodeVertexBufferBound(n, stride) +
                             meshopt_encodeIndexBufferBound(indices.size(), n));
  size_t size = meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), vertices.data(), n, stride);
  size += meshopt_encodeIndexBuffer(bytes.data() + size, bytes.size() - size, indices.data(), indices.size());
  std::vector<uint8_t> packed(ZSTD_compressBound(size));
  Measured result;
  result.bytes = ZSTD_compress(packed.data(), packed.size(), bytes.data(), size, 19);
  return result;
}

}  // namespace pac::peers
