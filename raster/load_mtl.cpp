#include "raster/load_mtl.h"

#include <algorithm>
#include <string_view>

#include "raster/load_text.h"

namespace pac::raster {
namespace {

class MtlParser {
 public:
  MtlParser(std::span<const uint8_t> bytes, const std::string& name, std::vector<Warning>& warnings)
      : lines_(bytes, byte_order_mark_size(bytes), true), name_(name), warnings_(warnings) {}
  std::vector<MtlMaterial> run();

 private:
  void statement(std::string_view keyword, std::string_view rest);
  void finish();
  void color(std::string_view text, glm::vec3& value);
  float number(std::string_view text, float unchanged);
  void map(std::string_view text, MtlMap& out);
  void side_map(std::string_view text, MtlMap& out);
  void opacity(float value);
  bool option(std::string_view word, std::string_view& text);
  void pair_of_numbers(std::string_view& text, float values[2]);
  void warn(const char* text) { warnings_.push_back({text, name_, lines_.offset()}); }

  LineReader lines_;
  const std::string& name_;
  std::vector<Warning>& warnings_;
  std::vector<MtlMaterial> materials_;
  // Of the material at hand.
  bool has_ambient_ = false, has_diffuse_ = false, has_specular_ = false, has_emission_ = false;
  int illumination_model_ = 2;
};

std::vector<MtlMaterial> MtlParser::run() {
  constexpr size_t kMaxWarnings = 1000;
  while (lines_.next() && warnings_.size() < kMaxWarnings) {
    std::string_view rest = lines_.line();
    const std::string_view keyword = take_word(rest);
    if (keyword.empty() || keyword[0] == '#') continue;
    if (keyword == "newmtl") {
      finish();
      materials_.emplace_back();
      materials_.back().material.name = std::string(trimmed(rest));
      has_ambient_ = has_diffuse_ = has_specular_ = has_emission_ = false;
      illumination_model_ = 2;
    } else if (!materials_.empty()) {
      statement(keyword, rest);
    } else {
      warn("statement before the first newmtl");
    }
  }
  finish();
  return std::move(materials_);
}

void MtlParser::statement(std::string_view keyword, std::string_view rest) {
  MtlMaterial& entry = materials_.back();
  Material& material = entry.material;
  if (keyword == "Ka") {
    color(rest, material.ambient);
    has_ambient_ = true;
  } else if (keyword == "Kd") {
    color(rest, material.diffuse);
    has_diffuse_ = true;
  } else if (keyword == "Ks") {
    color(rest, material.specular);
    has_specular_ = true;
  } else if (keyword == "Ke") {
    color(rest, material.emission);
    has_emission_ = true;
  } else if (keyword == "Ns") {
    material.shininess = static_cast<int>(std::clamp(number(rest, 1.0f), 1.0f, 1000.0f) + 0.5f);
  } else if (keyword == "illum") {
    illumination_model_ = static_cast<int>(std::clamp(number(rest, 2.0f), 0.0f, 10.0f));
  } else if (keyword == "map_Kd") {
    map(rest, entry.base);
  } else if (keyword == "map_Ks") {
    side_map(rest, entry.specular);
  } else if (keyword == "map_Ke") {
    side_map(rest, entry.emission);
  } else if (keyword == "map_d") {
    side_map(rest, entry.opacity);
  } else if (keyword == "map_Bump" || keyword == "map_bump" || keyword == "bump" || keyword == "norm") {
    side_map(rest, entry.bump);
  } else if (keyword == "d") {
    opacity(number(rest, 1.0f));
  } else if (keyword == "Tr") {
    opacity(1.0f - number(rest, 0.0f));
  }
}

// The last of several statements counts.
void MtlParser::opacity(float value) {
  Material& material = materials_.back().material;
  material.opacity = std::clamp(value, 0.0f, 1.0f);
  material.alpha = material.opacity < 1.0f ? AlphaMode::blend : AlphaMode::opaque;
}

// What depends on several statements of one material.
void MtlParser::finish() {
  if (materials_.empty()) return;
  MtlMaterial& entry = materials_.back();
  Material& material = entry.material;
  if (!entry.base.name.empty() && (!has_diffuse_ || material.diffuse == glm::vec3(0.0f))) {
    if (has_diffuse_) warn("black material with a texture: drawn white");
    material.diffuse = glm::vec3(1.0f);
    has_ambient_ = false;
  }
  if (!has_ambient_) material.ambient = material.diffuse;
  if (!entry.specular.name.empty() && !has_specular_) material.specular = glm::vec3(1.0f);
  if (!entry.emission.name.empty() && (!has_emission_ || material.emission == glm::vec3(0.0f)))
    material.emission = glm::vec3(1.0f);
  if (illumination_model_ == 0) material.lit = false;
  if (illumination_model_ <= 1) material.specular = glm::vec3(0.0f);
}

// Three numbers, or one for all three.
void MtlParser::color(std::string_view text, glm::vec3& value) {
  text = without_comment(text);
  float rgb[3] = {0, 0, 0};
  int count = 0;
  for (std::string_view word = take_word(text); !word.empty() && count < 3; word = take_word(text))
    if (parse_float(word, rgb[count++]) != NumberKind::finite) return warn("malformed color: keeps its default");
  if (count == 1) rgb[1] = rgb[2] = rgb[0];
  if (count == 0 || count == 2) return warn("malformed color: keeps its default");
  for (int c = 0; c < 3; ++c) value[c] = std::clamp(rgb[c], 0.0f, 1.0f);
}

float MtlParser::number(std::string_view text, float unchanged) {
  float value = 0;
  if (parse_float(take_word(text), value) == NumberKind::finite) return value;
  warn("malformed number: keeps its default");
  return unchanged;
}

// [options] file; the file's name may hold blanks.
void MtlParser::map(std::string_view text, MtlMap& out) {
  std::string_view rest = trimmed(text);
  for (;;) {
    std::string_view after = rest;
    const std::string_view word = take_word(after);
    if (word.size() < 2 || word[0] != '-' || trimmed(after).empty()) break;
    rest = after;
    if (!option(word, rest)) {
      rest = trimmed(text);  // no option after all: a name that starts with '-'
      break;
    }
    rest = trimmed(rest);
  }
  out.name = std::string(rest);
  std::replace(out.name.begin(), out.name.end(), '\\', '/');
  while (out.name.starts_with("./")) out.name.erase(0, 2);
  out.offset = lines_.offset();
  if (out.name.empty()) warn("texture without a name");
}

// The vertices have one set of texture coordinates: map_Kd's.
void MtlParser::side_map(std::string_view text, MtlMap& out) {
  MtlMaterial& entry = materials_.back();
  const Wrap wrap = entry.material.wrap;
  float scale[2], offset[2];
  std::copy_n(entry.texcoord_scale, 2, scale);
  std::copy_n(entry.texcoord_offset, 2, offset);
  map(text, out);
  entry.material.wrap = wrap;
  std::copy_n(scale, 2, entry.texcoord_scale);
  std::copy_n(offset, 2, entry.texcoord_offset);
}

// Up to three numbers, of which two matter.
void MtlParser::pair_of_numbers(std::string_view& text, float values[2]) {
  for (int i = 0; i < 3; ++i) {
    std::string_view after = text;
    float value = 0;
    if (parse_float(take_word(after), value) != NumberKind::finite) return;
    if (i < 2) values[i] = value;
    text = after;
  }
}

// Takes an option's arguments off `text`; false if there is no such option.
bool MtlParser::option(std::string_view word, std::string_view& text) {
  MtlMaterial& entry = materials_.back();
  float unused[2];
  if (word == "-s") {
    pair_of_numbers(text, entry.texcoord_scale);
  } else if (word == "-o") {
    pair_of_numbers(text, entry.texcoord_offset);
  } else if (word == "-t") {
    pair_of_numbers(text, unused);
  } else if (word == "-clamp") {
    entry.material.wrap = take_word(text) == "on" ? Wrap::clamp : Wrap::repeat;
  } else if (word == "-mm") {
    take_word(text);
    take_word(text);
  } else if (word == "-bm") {
    float value = 1;
    if (parse_float(take_word(text), value) == NumberKind::finite) entry.bump_scale = value;
  } else if (word == "-blendu" || word == "-blendv" || word == "-cc" || word == "-texres" || word == "-boost" ||
             word == "-imfchan" || word == "-type") {
    take_word(text);
  } else {
    return false;
  }
  return true;
}

}  // namespace

std::vector<MtlMaterial> parse_mtl(std::span<const uint8_t> bytes, const std::string& name,
                                   std::vector<Warning>& warnings) {
  if (is_wide_text(bytes)) {
    warnings.push_back({"UTF-16 text: save the library as UTF-8", name, 0});
    return {};
  }
  return MtlParser(bytes, name, warnings).run();
}

}  // namespace pac::raster
