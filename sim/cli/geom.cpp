// `pac geom encode | decode | info`: polygon meshes to the geometry codec's streams and back.
#include <cstdio>

#include "geomcodec/geomcodec.h"
#include "raster/load_ply.h"
#include "sim/cli/command.h"
#include "sim/cli/scene_source.h"

namespace pac::cli {
namespace {

using geomcodec::EncodedSize;

double per(uint64_t bytes, uint64_t count) {
  return count > 0 ? static_cast<double>(bytes) / static_cast<double>(count) : 0;
}

uint64_t triangles_of(uint64_t n_faces, uint64_t n_corners) {
  return n_corners - 2 * n_faces;  // a polygon with n corners is n - 2 triangles
}

struct Counts {
  uint64_t vertices = 0, faces = 0, corners = 0;
};

void json_sizes(sim::JsonWriter& json, const EncodedSize& size, const Counts& counts) {
  const uint64_t total = size.total_bytes();
  json.field("bytes", total);
  json.field("vertices", counts.vertices);
  json.field("polygons", counts.faces);
  json.field("triangles", triangles_of(counts.faces, counts.corners));
  json.field("bytes_per_polygon", per(total, counts.faces));
  json.field("bytes_per_vertex", per(total, counts.vertices));
  json.field("bits_per_triangle", 8 * per(total, triangles_of(counts.faces, counts.corners)));
  json.field("estimated_bytes", geomcodec::levoy95_estimated_bytes(counts.faces));
  json.begin_object("parts");
  json.field("header", size.header_bytes);
  json.field("connectivity", size.connectivity_bytes);
  json.field("seams", size.seam_bytes);
  json.field("positions", size.position_bytes);
  json.field("colors", size.color_bytes);
  json.field("normals", size.normal_bytes);
  json.field("texcoords", size.texcoord_bytes);
  json.field("materials", size.material_bytes);
  json.field("face_values", size.face_value_bytes);
  json.field("order", size.order_bytes);
  json.end_object();
}

void print_sizes(std::FILE* out, const EncodedSize& size, const Counts& counts) {
  const uint64_t total = size.total_bytes(), triangles = triangles_of(counts.faces, counts.corners);
  std::fprintf(out, "%s bytes for %s vertices, %s polygons, %s triangles\n", grouped(total).c_str(),
               grouped(counts.vertices).c_str(), grouped(counts.faces).c_str(), grouped(triangles).c_str());
  std::fprintf(out, "%.2f bytes a polygon (the paper estimates 3.33), %.2f bytes a vertex, %.2f bits a triangle\n",
               per(total, counts.faces), per(total, counts.vertices), 8 * per(total, triangles));
  const struct {
    const char* name;
    uint64_t bytes;
  } parts[] = {{"header", size.header_bytes},
               {"connectivity", size.connectivity_bytes},
               {"seams", size.seam_bytes},
               {"positions", size.position_bytes},
               {"colors", size.color_bytes},
               {"normals", size.normal_bytes},
               {"texture", size.texcoord_bytes},
               {"materials", size.material_bytes},
               {"face values", size.face_value_bytes},
               {"order", size.order_bytes}};
  for (const auto& part : parts)
    if (part.bytes > 0) std::fprintf(out, "  %-13s %12s\n", part.name, grouped(part.bytes).c_str());
}

}  // namespace

int run_geom_encode(Args args) {
  Options options("geom encode", "codes a polygon mesh: positions quantized, then without loss",
                  "pac geom encode model.obj --position-bits 14 --effort best -o model.pgc");
  std::string in, out;
  geomcodec::AttributeBits bits;
  geomcodec::EncodeOptions encode;
  options.positional("IN", in, "OBJ, PLY or glTF, or the name of a built-in scene");
  options.text("-o|--output", "OUT.pgc", out, "the stream; - is stdout", true);
  options.integer("--position-bits", "N", bits.position, 1, 16, "of the grid along the longest side (16)");
  options.integer("--normal-bits", "N", bits.normal, 0, 16,
                  "2..16 a component of octahedral normals; 0 drops them (0)");
  options.integer("--texcoord-bits", "N", bits.texcoord, 0, 16, "of texture coordinates; 0 drops them (0)");
  options.flag("--keep-order", encode.keep_order,
               "vertices and polygons come back in the order given; else equal vertices become one");
  using geomcodec::Effort;
  options.choice<Effort>("--effort", encode.effort,
                         {{"fast", Effort::fast}, {"default", Effort::balanced}, {"best", Effort::best}},
                         "fast: symbols by tables; default: the same from 16,384 vertices on; best: adaptive models, "
                         "the fewest bytes");
  if (const auto code = options.parse(args)) return *code;
  if (options.json && out == "-") return options.usage_error("--json and -o - both want stdout");
  auto scene = load_scene(in, options);
  if (!scene) return kBadData;
  if (bits.normal == 1) return options.usage_error("--normal-bits is 0 or 2..16");
  auto quantized = geomcodec::quantize(scene->set.fine.mesh, bits);
  if (!quantized.ok()) return data_error(in, quantized.failure());
  if (!encode.keep_order) quantized = geomcodec::merge_equal_vertices(*quantized);
  EncodedSize size;
  const auto bytes = geomcodec::encode(*quantized, encode, &size);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  if (const int code = write_output(out, *bytes); code != kDone) return code;
  const Counts counts{quantized->vertices.size(), quantized->faces.size(), quantized->indices.size()};
  if (options.json) {
    sim::JsonWriter json;
    json.begin_object();
    json_sizes(json, size, counts);
    json.field("position_bits", bits.position);
    json.end_object();
    return print_json(json);
  }
  if (!options.quiet) print_sizes(stderr, size, counts);
  return kDone;
}

int run_geom_decode(Args args) {
  Options options("geom decode", "writes a coded mesh as PLY", "pac geom decode model.pgc -o model.ply");
  std::string in, out;
  options.positional("IN.pgc", in, "- is stdin");
  options.text("-o|--output", "OUT.ply", out, "binary little-endian PLY; - is stdout", true);
  if (const auto code = options.parse(args)) return *code;
  if (options.json && out == "-") return options.usage_error("--json and -o - both want stdout");
  const auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  const auto mesh = geomcodec::decode(*bytes);
  if (!mesh.ok()) return data_error(in, mesh.failure());
  if (const int code = write_output(out, raster::write_ply(geomcodec::dequantize(*mesh))); code != kDone) return code;
  if (!options.json) return kDone;
  sim::JsonWriter json;
  json.begin_object();
  json.field("vertices", uint64_t{mesh->vertices.size()});
  json.field("polygons", uint64_t{mesh->faces.size()});
  json.field("position_bits", mesh->position_bits);
  json.end_object();
  return print_json(json);
}

int run_geom_info(Args args) {
  Options options("geom info", "what a coded mesh's header says", "pac geom info model.pgc");
  std::string in;
  options.positional("IN.pgc", in, "- is stdin");
  if (const auto code = options.parse(args)) return *code;
  const auto bytes = read_file(in);
  if (!bytes.ok()) return data_error(in, bytes.failure());
  const auto info = geomcodec::read_info(*bytes);
  if (!info.ok()) return data_error(in, info.failure());
  const Counts counts{info->n_vertices, info->n_faces, info->n_corners};
  if (!options.json) {
    print_sizes(stdout, info->size, counts);
    std::printf("version %d, %d position bits, step %g, %u materials%s%s\n", info->version, info->position_bits,
                static_cast<double>(info->step[0]), info->n_materials, info->constant_color ? ", one color" : "",
                info->keeps_order ? ", order kept" : "");
    return kDone;
  }
  sim::JsonWriter json;
  json.begin_object();
  json_sizes(json, info->size, counts);
  json.field("version", info->version);
  json.field("position_bits", info->position_bits);
  json.field("materials", info->n_materials);
  json.field("normal_bits", info->normal_bits);
  json.field("texcoord_bits", info->texcoord_bits);
  json.field("distinct_positions", info->n_points);
  json.field("constant_color", info->constant_color);
  json.field("keeps_order", info->keeps_order);
  json.end_object();
  return print_json(json);
}

}  // namespace pac::cli
