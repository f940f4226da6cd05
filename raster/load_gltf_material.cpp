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
  // The texture of metalness and roughness is not sampled; where there is one, factors of 1 say nothing.
  if (pbr["metallicRoughnessTexture"].exists()) {
    metallic[0] *= 0.5;
    roughness[0] *= 0.7;
    warn("metallic-roughness texture is not sampled", json, json["name"].text());
  }
  GltfMaterial out;
  Material& look = out.material;
  look.name = std::string(json["name"].text());
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
  if (json["emissiveTexture"].exists() && look.emission != glm::vec3(0)) {
    look.emission = glm::vec3(0);
    warn("emissive texture is not drawn", json, look.name);
  }
  if (const std::string_view mode = json["alphaMode"].text(); mode == "BLEND" || mode == "MASK")
    warn("drawn opaque", json, look.name);
  PAC_CHECK(load_texture(pbr["baseColorTexture"], out));
  return out;
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
