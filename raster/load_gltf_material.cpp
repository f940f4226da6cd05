// Metallic-roughness materials [glTF 2.0 s.3.9] as the shading model's, and their textures.
#include <algorithm>
#include <cmath>
#include <map>

#include "base/exact_math.h"
#include "raster/load_gltf_scene.h"

namespace pac::raster {
namespace {

constexpr uint64_t kMostTexcoordSets = 1000;
constexpr uint64_t kNearest = 9728, kClamp = 33071, kMirror = 33648, kRepeat = 10497;

float encoded(double linear) {
  return static_cast<float>(srgb_from_linear(std::clamp(linear, 0.0, 1.0)));
}

// The image with a mirrored copy beside or below it: repeated, it is what mirrored repetition asks for.
RgbaImage mirrored(const RgbaImage& image, bool x_axis, bool y_axis) {
  RgbaImage out(image.width() * (x_axis ? 2 : 1), image.height() * (y_axis ? 2 : 1));
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) {
      const int from_x = x < image.width() ? x : out.width() - 1 - x;
      const int from_y = y < image.height() ? y : out.height() - 1 - y;
      std::copy_n(image.pixel(from_x, from_y), 4, out.pixel(x, y));
    }
  return out;
}

class Materials {
 public:
  Materials(const GltfFile& file, const AssetSource& assets, LoadedScene& loaded)
      : file_(file), assets_(assets), loaded_(loaded), checker_(assets, loaded.scene, loaded.warnings) {}

  Result<std::vector<GltfMaterial>> run() {
    std::vector<GltfMaterial> out;
    for (const Json& json : file_.materials) {
      PAC_TRY(GltfMaterial material, load(json));
      out.push_back(std::move(material));
    }
    PAC_TRY(GltfMaterial otherwise, load(Json()));
    out.push_back(std::move(otherwise));
    return out;
  }

 private:
  struct Wraps {
    uint64_t s = kRepeat, t = kRepeat, magnify = 0;
  };
  Result<GltfMaterial> load(const Json& json);
  Result<void> load_texture(const Json& info, GltfMaterial& out);
  Result<int32_t> load_map(const Json& info, bool& has_coordinates, GltfMaterial& out);
  int32_t gloss_texture(int32_t metal_map, const double factors[2], const GltfMaterial& out);
  Result<void> load_transform(const Json& transform, GltfMaterial& out);
  Result<int32_t> image_texture(uint32_t image, bool mirror_s, bool mirror_t);
  Result<Bytes> image_bytes(uint32_t image, const char*& fault);
  void warn(const char* text, const Json& where, std::string_view name = {}) {
    loaded_.warnings.push_back({text, std::string(name), file_.json_offset + where.offset()});
  }

  const GltfFile& file_;
  const AssetSource& assets_;
  LoadedScene& loaded_;
  TextureLoader checker_;
  std::map<uint32_t, int32_t> loaded_images_;  // image * 4 + mirrored axes -> texture
};

Result<GltfMaterial> Materials::load(const Json& json) {
  const Json pbr = json["pbrMetallicRoughness"];
  double base[4] = {1, 1, 1, 1}, metallic[1] = {1}, roughness[1] = {1}, emissive[3] = {0, 0, 0};
  PAC_CHECK(get_numbers(file_, pbr, "baseColorFactor", base, 4));
  PAC_CHECK(get_numbers(file_, json, "emissiveFactor", emissive, 3));
  metallic[0] = std::clamp(pbr["metallicFactor"].number(json.exists() ? 1 : 0), 0.0, 1.0);
  roughness[0] = std::clamp(pbr["roughnessFactor"].number(1), 0.0, 1.0);
  GltfMaterial out;
  Material& look = out.material;
  look.name = std::string(json["name"].text());
  PAC_CHECK(load_texture(pbr["baseColorTexture"], out));
  bool has_coordinates = look.texture >= 0;
  PAC_TRY(const int32_t metal_map, load_map(pbr["metallicRoughnessTexture"], has_coordinates, out));
  const double factors[2] = {metallic[0], roughness[0]};
  if (metal_map >= 0) {  // one exponent and one diffuse color a material: by the means
    const auto mean = loaded_.scene.textures[static_cast<size_t>(metal_map)].mean_color();
    metallic[0] *= mean[2] / 255.0;
    roughness[0] *= mean[1] / 255.0;
  }
  look.lit = !json["extensions"]["KHR_materials_unlit"].exists();
  look.two_sided = json["doubleSided"].boolean(false);
  // Lobe: Phong's exponent of a Beckmann-like roughness alpha = roughness^2, 2 / alpha^2 - 2.
  const double alpha = std::max(roughness[0] * roughness[0], 0.04);
  look.shininess = static_cast<int>(std::clamp(2 / (alpha * alpha) - 2, 1.0, 1000.0));
  for (int c = 0; c < 3; ++c) {
    const float color = encoded(base[c]);
    const float metal = static_cast<float>(metallic[0]), gloss = static_cast<float>(1 - roughness[0]);
    out.base_color[c] = color;
    look.diffuse[c] = color * (1 - 0.5f * metal);  // nothing is mirrored here: black metal would show nothing
    look.ambient[c] = color;
    look.specular[c] = gloss * (0.25f * (1 - metal) + color * metal);
    look.emission[c] = encoded(emissive[c]);
  }
  if (metal_map >= 0) {
    look.specular_texture = gloss_texture(metal_map, factors, out);
    look.specular = glm::vec3(1.0f);
  }
  PAC_TRY(look.emission_texture, load_map(json["emissiveTexture"], has_coordinates, out));
  PAC_TRY(look.normal_texture, load_map(json["normalTexture"], has_coordinates, out));
  look.normal_scale = static_cast<float>(std::clamp(json["normalTexture"]["scale"].number(1), -1000.0, 1000.0));
  const std::string_view mode = json["alphaMode"].text();
  look.alpha = mode == "BLEND" ? AlphaMode::blend : mode == "MASK" ? AlphaMode::mask : AlphaMode::opaque;
  look.alpha_cutoff = static_cast<float>(std::clamp(json["alphaCutoff"].number(0.5), 0.0, 2.0));
  look.opacity = static_cast<float>(std::clamp(base[3], 0.0, 1.0));
  return out;
}

// A texture besides the base color's, or -1: there is none, it cannot be read, or it wants texture coordinates of its
// own, of which a vertex has none.
Result<int32_t> Materials::load_map(const Json& info, bool& has_coordinates, GltfMaterial& out) {
  if (!info.exists()) return -1;
  GltfMaterial other;
  PAC_CHECK(load_texture(info, other));
  const int32_t number = other.material.texture;
  if (number < 0 || number == checker_.known_missing()) return -1;
  if (!has_coordinates) {
    has_coordinates = true;
    out.texcoord_set = other.texcoord_set;
    for (int row = 0; row < 2; ++row) std::copy_n(other.texcoord_map[row], 3, out.texcoord_map[row]);
    out.material.filter = other.material.filter;
    out.material.wrap = other.material.wrap;
    return number;
  }
  bool same = out.texcoord_set == other.texcoord_set;
  for (int row = 0; row < 2; ++row)
    same = same && std::equal(out.texcoord_map[row], out.texcoord_map[row] + 3, other.texcoord_map[row]);
  if (same) return number;
  warn("texture with texture coordinates of its own is not drawn", info, out.material.name);
  return -1;
}

// Specular colors from metalness (blue) and roughness (green): gloss times the base color of metal, a quarter of white
// of other surfaces.
int32_t Materials::gloss_texture(int32_t metal_map, const double factors[2], const GltfMaterial& out) {
  const std::vector<Texture>& textures = loaded_.scene.textures;
  const ConstRgbaView metal = textures[static_cast<size_t>(metal_map)].level(0);
  const int32_t base = out.material.texture;
  const ConstRgbaView colors = base >= 0 ? textures[static_cast<size_t>(base)].level(0) : metal;
  RgbaImage image(metal.width, metal.height);
  for (int y = 0; y < metal.height; ++y)
    for (int x = 0; x < metal.width; ++x) {
      const uint8_t* p = metal.pixel(x, y);
      const uint8_t* color = colors.pixel(static_cast<int>(int64_t{x} * colors.width / metal.width),
                                          static_cast<int>(int64_t{y} * colors.height / metal.height));
      const double m = factors[0] * p[2] / 255.0, gloss = 1 - factors[1] * p[1] / 255.0;
      for (int c = 0; c < 3; ++c) {
        const double own = static_cast<double>(out.base_color[c]) * (base >= 0 ? color[c] / 255.0 : 1.0);
        image.pixel(x, y)[c] =
            static_cast<uint8_t>(std::clamp(gloss * (0.25 * (1 - m) + own * m), 0.0, 1.0) * 255 + 0.5);
      }
      image.pixel(x, y)[3] = 255;
    }
  const auto number = static_cast<int32_t>(textures.size());
  loaded_.scene.textures.push_back(make_texture("gloss of " + out.material.name, image));
  return number;
}

Result<void> Materials::load_texture(const Json& info, GltfMaterial& out) {
  if (!info.exists()) return {};
  PAC_TRY(const uint32_t number, get_index(file_, info, "index", file_.textures.size()));
  if (number == kNoIndex) return file_.failure(Error::corrupt, info, "texture without an index");
  PAC_TRY(const uint64_t set, get_integer(file_, info, "texCoord", 0));
  out.texcoord_set = static_cast<uint32_t>(std::min<uint64_t>(set, kMostTexcoordSets));
  PAC_CHECK(load_transform(info["extensions"]["KHR_texture_transform"], out));
  const Json texture = file_.textures[number];
  PAC_TRY(const uint32_t sampler, get_index(file_, texture, "sampler", file_.samplers.size()));
  Wraps wraps;
  if (sampler != kNoIndex) {
    const Json json = file_.samplers[sampler];
    PAC_TRY(wraps.s, get_integer(file_, json, "wrapS", kRepeat));
    PAC_TRY(wraps.t, get_integer(file_, json, "wrapT", kRepeat));
    PAC_TRY(wraps.magnify, get_integer(file_, json, "magFilter", 0));
  }
  const bool mirror_s = wraps.s == kMirror, mirror_t = wraps.t == kMirror;
  out.material.filter = wraps.magnify == kNearest ? Filter::nearest : Filter::trilinear;
  out.material.wrap = wraps.s == kClamp && wraps.t == kClamp ? Wrap::clamp : Wrap::repeat;
  if ((wraps.s == kClamp) != (wraps.t == kClamp)) warn("texture is clamped along one side only: repeated", texture);
  PAC_TRY(const uint32_t image, get_index(file_, texture, "source", file_.images.size()));
  if (image == kNoIndex) {
    warn("texture has no PNG or JPEG image: checker instead", texture);
    out.material.texture = checker_.missing();
    return {};
  }
  PAC_TRY(out.material.texture, image_texture(image, mirror_s, mirror_t));
  for (double& value : out.texcoord_map[0]) value *= mirror_s ? 0.5 : 1;
  for (double& value : out.texcoord_map[1]) value *= mirror_t ? 0.5 : 1;
  return {};
}

// Offset * rotation * scale; the rotation is counter-clockwise where v points down [KHR_texture_transform].
Result<void> Materials::load_transform(const Json& transform, GltfMaterial& out) {
  if (!transform.exists()) return {};
  double offset[2] = {0, 0}, scale[2] = {1, 1};
  PAC_CHECK(get_numbers(file_, transform, "offset", offset, 2));
  PAC_CHECK(get_numbers(file_, transform, "scale", scale, 2));
  const double turn = std::fmod(transform["rotation"].number(0), 2 * kPi);
  const double angle = std::isfinite(turn) ? turn : 0;
  const double cosine = exact_cos(angle), sine = exact_sin(angle);
  const double map[2][3] = {{cosine * scale[0], sine * scale[1], offset[0]},
                            {-sine * scale[0], cosine * scale[1], offset[1]}};
  for (int row = 0; row < 2; ++row) std::copy_n(map[row], 3, out.texcoord_map[row]);
  PAC_TRY(const uint64_t set, get_integer(file_, transform, "texCoord", out.texcoord_set));
  out.texcoord_set = static_cast<uint32_t>(std::min<uint64_t>(set, kMostTexcoordSets));
  return {};
}

// Empty with `fault` set where the image is missing; a Failure where the file is wrong about it.
Result<Bytes> Materials::image_bytes(uint32_t image, const char*& fault) {
  const Json json = file_.images[image];
  PAC_TRY(const uint32_t view_number, get_index(file_, json, "bufferView", file_.views.size()));
  if (view_number != kNoIndex) {
    PAC_TRY(const GltfView view, get_view(file_, view_number));
    return Bytes(view.bytes.begin(), view.bytes.end());
  }
  const std::string_view uri = json["uri"].text();
  if (uri.starts_with("data:")) {
    Bytes bytes = decode_data_uri(uri);
    if (bytes.empty()) fault = "data URI is not base64: checker instead";
    return bytes;
  }
  if (uri.empty() || !assets_.read) {
    fault = "texture cannot be read here: checker instead";
    return Bytes{};
  }
  auto read = assets_.read(decode_uri(uri));
  if (read.ok()) return std::move(*read);
  fault = "texture is missing: checker instead";
  return Bytes{};
}

Result<int32_t> Materials::image_texture(uint32_t image, bool mirror_s, bool mirror_t) {
  const uint32_t key = image * 4 + (mirror_s ? 1 : 0) + (mirror_t ? 2 : 0);
  if (const auto known = loaded_images_.find(key); known != loaded_images_.end()) return known->second;
  const char* fault = nullptr;
  PAC_TRY(const Bytes bytes, image_bytes(image, fault));
  const Json json = file_.images[image];
  const std::string_view uri = json["uri"].text().starts_with("data:") ? "" : json["uri"].text();
  const std::string name(json["name"].text().empty() ? uri : json["name"].text());
  int32_t number = -1;
  if (fault == nullptr && !assets_.decode_image) fault = "textures cannot be decoded here: checker instead";
  if (fault == nullptr) {
    auto decoded = assets_.decode_image(bytes);
    if (!decoded.ok()) {
      fault = decoded.failure().text;
    } else if (decoded->empty()) {
      fault = "texture has no pixels: checker instead";
    } else if ((mirror_s || mirror_t) && std::max(decoded->width(), decoded->height()) > 16384) {
      fault = "mirrored texture is too large: checker instead";
    } else {
      number = static_cast<int32_t>(loaded_.scene.textures.size());
      loaded_.scene.textures.push_back(
          make_texture(name, mirror_s || mirror_t ? mirrored(*decoded, mirror_s, mirror_t) : std::move(*decoded)));
    }
  }
  if (fault != nullptr) {
    warn(fault, json, name);
    number = checker_.missing();
  }
  loaded_images_.emplace(key, number);
  return number;
}

}  // namespace

Result<std::vector<GltfMaterial>> load_gltf_materials(const GltfFile& file, const AssetSource& assets,
                                                      LoadedScene& loaded) {
  return Materials(file, assets, loaded).run();
}

}  // namespace pac::raster
