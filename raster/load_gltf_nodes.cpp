// Node hierarchy [glTF 2.0 s.3.5], animations [s.3.11], cameras [s.3.10] and KHR_lights_punctual.
#include <algorithm>
#include <cmath>

#include "base/exact_math.h"
#include "raster/load_gltf_scene.h"

namespace pac::raster {
namespace {

// The numbers in an array of whole numbers below `count`.
Result<std::vector<uint32_t>> get_indices(const GltfFile& file, const Json& array, size_t count) {
  std::vector<uint32_t> out;
  for (const Json& element : array.elements()) {
    const double number = element.number(-1);
    if (!(number >= 0 && number < static_cast<double>(count)) || number != std::floor(number))
      return file.failure(Error::corrupt, element, "names something that the file does not have");
    out.push_back(static_cast<uint32_t>(number));
  }
  return out;
}

Result<AnimatedNode> load_node(const GltfFile& file, const Json& json) {
  AnimatedNode node;
  node.has_matrix = json["matrix"].exists();
  double matrix[16] = {};
  PAC_CHECK(get_numbers(file, json, "matrix", matrix, 16));
  for (int column = 0; column < 4 && node.has_matrix; ++column)
    for (int row = 0; row < 3; ++row) node.matrix.m[column][row] = matrix[4 * column + row];
  PAC_CHECK(get_numbers(file, json, "translation", node.translation.data(), 3));
  PAC_CHECK(get_numbers(file, json, "rotation", node.rotation.data(), 4));
  PAC_CHECK(get_numbers(file, json, "scale", node.scale.data(), 3));
  return node;
}

class Hierarchy {
 public:
  explicit Hierarchy(const GltfFile& file) : file_(file), parent_(file.nodes.size(), -1) {}

  Result<GltfNodes> run() {
    const size_t n = file_.nodes.size();
    std::vector<std::vector<uint32_t>> children(n);
    for (uint32_t i = 0; i < n; ++i) {
      PAC_TRY(children[i], get_indices(file_, file_.nodes[i]["children"], n));
      for (const uint32_t child : children[i]) {
        if (parent_[child] >= 0) return file_.failure(Error::corrupt, file_.nodes[child], "node has two parents");
        parent_[child] = static_cast<int32_t>(i);
      }
    }
    GltfNodes out;
    for (uint32_t i = 0; i < n; ++i)
      if (parent_[i] < 0) out.order.push_back(i);
    for (size_t i = 0; i < out.order.size(); ++i)  // every node has one parent, so that each comes by once
      for (const uint32_t child : children[out.order[i]]) out.order.push_back(child);
    if (out.order.size() < n) return file_.failure(Error::corrupt, cyclic_node(out.order), "nodes form a cycle");
    PAC_CHECK(place(out));
    PAC_CHECK(mark_drawn(out));
    return out;
  }

 private:
  Json cyclic_node(const std::vector<uint32_t>& order) const {
    std::vector<uint8_t> reached(file_.nodes.size());
    for (const uint32_t node : order) reached[node] = 1;
    return file_.nodes[static_cast<size_t>(std::find(reached.begin(), reached.end(), 0) - reached.begin())];
  }
  Result<void> place(GltfNodes& out) {
    place_.resize(out.order.size());
    for (uint32_t i = 0; i < out.order.size(); ++i) place_[out.order[i]] = i;
    for (const uint32_t number : out.order) {
      PAC_TRY(AnimatedNode node, load_node(file_, file_.nodes[number]));
      const int32_t parent = parent_[number];
      node.parent = parent < 0 ? -1 : static_cast<int32_t>(place_[static_cast<size_t>(parent)]);
      out.animation.nodes.push_back(node);
    }
    return {};
  }
  Result<void> mark_drawn(GltfNodes& out) {
    const std::vector<Json> scenes = file_.root()["scenes"].elements();
    PAC_TRY(const uint32_t given, get_index(file_, file_.root(), "scene", scenes.size()));
    out.drawn.assign(out.order.size(), scenes.empty() ? 1 : 0);
    if (scenes.empty()) return {};
    PAC_TRY(const auto roots, get_indices(file_, scenes[given == kNoIndex ? 0 : given]["nodes"], out.order.size()));
    for (const uint32_t root : roots) out.drawn[place_[root]] = 1;
    for (size_t i = 0; i < out.order.size(); ++i)
      if (const int32_t parent = out.animation.nodes[i].parent; parent >= 0)
        out.drawn[i] = out.drawn[i] | out.drawn[static_cast<size_t>(parent)];
    return {};
  }

  const GltfFile& file_;
  std::vector<int32_t> parent_;
  std::vector<uint32_t> place_;  // in GltfNodes::order, by the file's number
};

Result<void> check_keys(const GltfFile& file, const Json& where, const Channel& channel) {
  const bool spline = channel.interpolation == Interpolation::cubic_spline;
  const size_t n = channel.times_s.size();
  if (n == 0) return file.failure(Error::corrupt, where, "animation without key frames");
  for (size_t i = 1; i < n; ++i)
    if (!(channel.times_s[i] > channel.times_s[i - 1]))
      return file.failure(Error::corrupt, where, "times of key frames do not increase");
  if (channel.values.size() != n * channel.width() * (spline ? 3 : 1))
    return file.failure(Error::corrupt, where, "animation has another number of values than of times");
  return {};
}

// One channel [s.3.11]; channels of other properties are left out.
Result<bool> load_channel(const GltfFile& file, const Json& json, const std::vector<Json>& samplers,
                          const std::vector<uint32_t>& place, const Limits& limits, Channel& out) {
  const Json target = json["target"];
  PAC_TRY(const uint32_t node, get_index(file, target, "node", place.size()));
  const std::string_view path = target["path"].text();
  if (node == kNoIndex || (path != "translation" && path != "rotation" && path != "scale")) return false;
  out.node = place[node];
  out.path = path == "translation" ? ChannelPath::translation
             : path == "rotation"  ? ChannelPath::rotation
                                   : ChannelPath::scale;
  PAC_TRY(const uint32_t number, get_index(file, json, "sampler", samplers.size()));
  if (number == kNoIndex) return file.failure(Error::corrupt, json, "animation channel without a sampler");
  const Json sampler = samplers[number];
  const std::string_view kind = sampler["interpolation"].text();
  out.interpolation = kind == "STEP"          ? Interpolation::step
                      : kind == "CUBICSPLINE" ? Interpolation::cubic_spline
                                              : Interpolation::linear;
  PAC_TRY(const uint32_t input, get_index(file, sampler, "input", file.accessors.size()));
  PAC_TRY(const uint32_t output, get_index(file, sampler, "output", file.accessors.size()));
  if (input == kNoIndex || output == kNoIndex)
    return file.failure(Error::corrupt, sampler, "animation sampler without input or output");
  PAC_TRY(GltfFloats times, read_floats(file, input, 1, 1, limits));
  PAC_TRY(GltfFloats values, read_floats(file, output, out.width(), out.width(), limits));
  out.times_s = std::move(times.values);
  out.values = std::move(values.values);
  PAC_CHECK(check_keys(file, sampler, out));
  return true;
}

Result<void> load_animation(const GltfFile& file, const Limits& limits, GltfNodes& nodes, LoadedScene& loaded) {
  nodes.animated.assign(nodes.order.size(), 0);
  const std::vector<Json> animations = file.root()["animations"].elements();
  if (animations.empty()) return {};
  if (animations.size() > 1)
    loaded.warnings.push_back({"only the first animation is played", "", file.json_offset + animations[1].offset()});
  std::vector<uint32_t> place(nodes.order.size());
  for (uint32_t i = 0; i < place.size(); ++i) place[nodes.order[i]] = i;
  const std::vector<Json> samplers = animations[0]["samplers"].elements();
  uint64_t n_values = 0;
  for (const Json& json : animations[0]["channels"].elements()) {
    Channel channel;
    PAC_TRY(const bool used, load_channel(file, json, samplers, place, limits, channel));
    if (!used) {
      loaded.warnings.push_back({"animation of this property is not played", std::string(json["target"]["path"].text()),
                                 file.json_offset + json.offset()});
      continue;
    }
    n_values += channel.times_s.size() + channel.values.size();
    if (n_values > limits.max_bytes / sizeof(float))  // channels may share one sampler
      return file.failure(Error::limit_exceeded, json, "animation is larger than the limit");
    nodes.animation.nodes[channel.node].has_matrix = false;  // [s.3.5.2] forbids a matrix there
    nodes.animated[channel.node] = 1;
    nodes.animation.duration_s = std::max<double>(nodes.animation.duration_s, channel.times_s.back());
    nodes.animation.channels.push_back(std::move(channel));
  }
  for (size_t i = 0; i < nodes.order.size(); ++i)
    if (const int32_t parent = nodes.animation.nodes[i].parent; parent >= 0)
      nodes.animated[i] = nodes.animated[i] | nodes.animated[static_cast<size_t>(parent)];
  return {};
}

glm::vec3 column_of(const Affine& a, int column) {
  glm::vec3 out;
  for (int row = 0; row < 3; ++row) out[row] = static_cast<float>(a.m[column][row]);
  return out;
}

void add_camera(const Json& json, const Affine& world, LoadedScene& loaded) {
  const Json perspective = json["perspective"];
  const double fov = perspective["yfov"].number(0), near_plane = perspective["znear"].number(0);
  if (!(fov > 0 && fov < 3.1) || !(near_plane > 0 && near_plane < 1e9)) return;  // orthographic, or no camera
  LoadedCamera camera;
  camera.eye = column_of(world, 3);
  camera.target = camera.eye - column_of(world, 2);
  camera.up = column_of(world, 1);
  camera.fov_y_rad = static_cast<float>(fov);
  camera.near_plane = static_cast<float>(near_plane);
  const double far_plane = perspective["zfar"].number(1e4 * near_plane);
  camera.far_plane = static_cast<float>(far_plane > near_plane && far_plane < 1e12 ? far_plane : 1e4 * near_plane);
  loaded.cameras.push_back(camera);
}

Result<void> add_light(const GltfFile& file, const Json& json, const Affine& world, LoadedScene& loaded) {
  Light light;
  const std::string_view type = json["type"].text();
  light.kind = type == "point" ? Light::Kind::point : type == "spot" ? Light::Kind::spot : Light::Kind::directional;
  double color[3] = {1, 1, 1};
  PAC_CHECK(get_numbers(file, json, "color", color, 3));
  const double intensity = std::clamp(json["intensity"].number(1), 0.0, 1e12);
  for (int c = 0; c < 3; ++c) light.color[c] = static_cast<float>(std::clamp(color[c], 0.0, 1.0) * intensity);
  light.position = column_of(world, 3);
  light.direction = -column_of(world, 2);
  if (light.kind == Light::Kind::spot) {
    const double inner = json["spot"]["innerConeAngle"].number(0),
                 outer = json["spot"]["outerConeAngle"].number(0.7854);
    light.cone_inner = static_cast<float>(exact_cos(std::clamp(inner, 0.0, kPi / 2)));
    light.cone_outer =
        std::min(static_cast<float>(exact_cos(std::clamp(outer, 0.0, kPi / 2))), light.cone_inner - 1e-4f);
  }
  loaded.scene.lights.push_back(light);
  return {};
}

// Candela and lux have no display: the brightest light becomes 1, the others keep their ratio to it.
void scale_lights(Scene& scene) {
  float brightest = 0;
  for (const Light& light : scene.lights)
    brightest = std::max({brightest, light.color.x, light.color.y, light.color.z});
  for (Light& light : scene.lights) light.color = brightest > 0 ? light.color / brightest : glm::vec3(0);
}

}  // namespace

Result<GltfNodes> load_gltf_nodes(const GltfFile& file, const Limits& limits, LoadedScene& loaded) {
  PAC_TRY(GltfNodes nodes, Hierarchy(file).run());
  PAC_CHECK(load_animation(file, limits, nodes, loaded));
  return nodes;
}

Result<void> load_gltf_lights(const GltfFile& file, const GltfNodes& nodes, const std::vector<Affine>& world,
                              LoadedScene& loaded) {
  constexpr size_t kMostLights = 16;  // of a scene
  const std::vector<Json> lights = file.root()["extensions"]["KHR_lights_punctual"]["lights"].elements();
  std::vector<Light> standing;
  standing.swap(loaded.scene.lights);
  for (size_t i = 0; i < nodes.order.size(); ++i) {
    if (nodes.drawn[i] == 0) continue;
    const Json node = file.nodes[nodes.order[i]];
    PAC_TRY(const uint32_t camera, get_index(file, node, "camera", file.cameras.size()));
    if (camera != kNoIndex) add_camera(file.cameras[camera], world[i], loaded);
    const Json punctual = node["extensions"]["KHR_lights_punctual"];
    PAC_TRY(const uint32_t light, get_index(file, punctual, "light", lights.size()));
    if (light != kNoIndex && loaded.scene.lights.size() < kMostLights)
      PAC_CHECK(add_light(file, lights[light], world[i], loaded));
  }
  scale_lights(loaded.scene);
  if (loaded.scene.lights.empty()) loaded.scene.lights = std::move(standing);
  return {};
}

}  // namespace pac::raster
