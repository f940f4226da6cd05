#include "raster/load_obj_file.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>

#include "raster/load_text.h"

namespace pac::raster {
namespace {

// What the loader skips, told once a kind with how often it was met.
class Skipped {
 public:
  void add(const char* text, std::string_view statement, uint64_t byte_offset) {
    for (Entry& entry : entries_) {
      if (entry.text != text || entry.statement != statement) continue;
      ++entry.count;
      return;
    }
    constexpr size_t kMaxKinds = 64;  // bounds the search in files of nonsense
    if (entries_.size() < kMaxKinds) entries_.push_back({text, std::string(statement), byte_offset, 1});
  }
  void report(std::vector<Warning>& warnings) const {
    for (const Entry& entry : entries_)
      warnings.push_back({entry.text, entry.statement + " (" + std::to_string(entry.count) + "x)", entry.byte_offset});
  }

 private:
  struct Entry {
    const char* text;
    std::string statement;
    uint64_t byte_offset;
    uint64_t count;
  };
  std::vector<Entry> entries_;
};

class Parser {
 public:
  Parser(std::span<const uint8_t> bytes, const Limits& limits)
      : lines_(bytes, byte_order_mark_size(bytes), true), limits_(limits) {}
  Result<ObjFile> run(std::vector<Warning>& warnings);

 private:
  Failure failure(const char* text, Error error = Error::corrupt) const { return {error, lines_.offset(), text}; }
  Result<void> statement(std::string_view line);
  Result<void> vertex(std::string_view text);
  Result<void> face(std::string_view text);
  Result<ObjCorner> corner(std::string_view word) const;
  // Reads up to `most` numbers to the end of the text; their count. not_finite_ok: they become 0 with a warning.
  Result<int> numbers(std::string_view text, int least, int most, bool not_finite_ok, float* values,
                      const char* too_few);
  Result<uint32_t> index(std::string_view word, size_t count) const;
  void use_material(std::string_view name);
  void smoothing(std::string_view text);
  Result<void> check_indices() const;

  LineReader lines_;
  const Limits& limits_;
  ObjFile file_;
  Skipped skipped_;
  std::unordered_map<std::string, uint32_t> material_number_{{"", 0}};
  uint32_t material_ = 0, smoothing_group_ = 0;
  uint64_t n_triangles_ = 0;
};

Result<ObjFile> Parser::run(std::vector<Warning>& warnings) {
  while (lines_.next()) PAC_CHECK(statement(lines_.line()));
  PAC_CHECK(check_indices());
  skipped_.report(warnings);
  if (file_.faces.empty()) return Failure{Error::unsupported, 0, "no faces: points and lines alone are not drawn"};
  return std::move(file_);
}

Result<void> Parser::statement(std::string_view line) {
  std::string_view rest = line;
  const std::string_view keyword = take_word(rest);
  if (keyword.empty() || keyword[0] == '#') return {};
  float values[3];
  if (keyword == "v") return vertex(rest);
  if (keyword == "vt") {
    PAC_CHECK(numbers(rest, 1, 3, true, values, "texture coordinate without a number"));
    file_.texcoords.insert(file_.texcoords.end(), values, values + 2);
  } else if (keyword == "vn") {
    PAC_CHECK(numbers(rest, 3, 3, true, values, "normal with fewer than three numbers"));
    file_.normals.insert(file_.normals.end(), values, values + 3);
  } else if (keyword == "f" || keyword == "fo") {
    return face(rest);
  } else if (keyword == "usemtl") {
    use_material(trimmed(rest));
  } else if (keyword == "mtllib") {
    if (trimmed(rest).empty())
      skipped_.add("statement without a name", keyword, lines_.offset());
    else
      file_.libraries.emplace_back(trimmed(rest));
  } else if (keyword == "s") {
    smoothing(trimmed(without_comment(rest)));
  } else if (keyword == "l" || keyword == "p") {
    skipped_.add("lines and points are not drawn", keyword, lines_.offset());
  } else if (keyword != "g" && keyword != "o" && keyword != "mg") {
    skipped_.add("statement is unknown", keyword.substr(0, 32), lines_.offset());
  }
  return {};
}

Result<int> Parser::numbers(std::string_view text, int least, int most, bool not_finite_ok, float* values,
                            const char* too_few) {
  text = without_comment(text);
  int count = 0;
  std::fill(values, values + most, 0.0f);
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    if (count == most) break;  // more than the statement needs: files have them, nobody reads them
    switch (parse_float(word, values[count++])) {
      case NumberKind::finite:
        break;
      case NumberKind::not_finite:
        if (!not_finite_ok) return failure("number is not finite");
        skipped_.add("number that is not finite becomes 0", "vt or vn", lines_.offset());
        break;
      case NumberKind::malformed:
        return failure("malformed number");
    }
  }
  if (count < least) return failure(too_few);
  return count;
}

uint8_t color_from(float value) {
  return static_cast<uint8_t>(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
}

// v x y z [w], or with a color: v x y z r g b [a]. The weight w matters to curves only.
Result<void> Parser::vertex(std::string_view text) {
  float values[7];
  PAC_TRY(const int count, numbers(text, 3, 7, false, values, "vertex with fewer than three coordinates"));
  file_.positions.insert(file_.positions.end(), values, values + 3);
  const size_t n_vertices = file_.positions.size() / 3;
  if (count >= 6) file_.colors.resize(4 * n_vertices, 255);
  if (file_.colors.empty()) return {};
  file_.colors.resize(4 * n_vertices, 255);
  for (size_t c = 0; count >= 6 && c < 3; ++c) file_.colors[4 * (n_vertices - 1) + c] = color_from(values[3 + c]);
  if (count >= 7) file_.colors[4 * (n_vertices - 1) + 3] = color_from(values[6]);
  return {};
}

// One-based, or negative: counted back from the last one so far. Forward references are checked at the end of the file.
Result<uint32_t> Parser::index(std::string_view word, size_t count) const {
  int64_t number = 0;
  if (!parse_integer(word, number)) return failure("malformed index");
  if (number == 0) return failure("index 0: indices start at 1");
  if (number < 0 && static_cast<uint64_t>(-number) > count) return failure("index out of range");
  const int64_t zero_based = number > 0 ? number - 1 : static_cast<int64_t>(count) + number;
  if (zero_based >= int64_t{ObjCorner::kAbsent}) return failure("index out of range");
  return static_cast<uint32_t>(zero_based);
}

// v, v/vt, v//vn, v/vt/vn.
Result<ObjCorner> Parser::corner(std::string_view word) const {
  ObjCorner result;
  std::string_view part[3];
  size_t n_parts = 0;
  for (size_t begin = 0; n_parts < 3;) {
    const size_t slash = word.find('/', begin);
    part[n_parts++] = word.substr(begin, slash == std::string_view::npos ? slash : slash - begin);
    if (slash == std::string_view::npos) break;
    if (n_parts == 3) return failure("malformed index");
    begin = slash + 1;
  }
  PAC_TRY(result.position, index(part[0], file_.positions.size() / 3));
  if (!part[1].empty()) {
    PAC_TRY(result.texcoord, index(part[1], file_.texcoords.size() / 2));
  }
  if (!part[2].empty()) {
    PAC_TRY(result.normal, index(part[2], file_.normals.size() / 3));
  }
  return result;
}

Result<void> Parser::face(std::string_view text) {
  text = without_comment(text);
  const size_t first = file_.corners.size();
  for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
    PAC_TRY(const ObjCorner next, corner(word));
    file_.corners.push_back(next);
  }
  const size_t count = file_.corners.size() - first;
  if (count < 3) {
    skipped_.add("face with fewer than three corners", "f", lines_.offset());
    file_.corners.resize(first);
    return {};
  }
  n_triangles_ += count - 2;
  if (n_triangles_ > limits_.max_triangles || file_.corners.size() >= ObjCorner::kAbsent)
    return failure("model has more triangles than the limit", Error::limit_exceeded);
  file_.faces.push_back(
      {static_cast<uint32_t>(first), static_cast<uint32_t>(count), material_, smoothing_group_, lines_.offset()});
  return {};
}

void Parser::use_material(std::string_view name) {
  const auto [entry, is_new] =
      material_number_.try_emplace(std::string(name), static_cast<uint32_t>(file_.materials.size()));
  if (is_new) file_.materials.emplace_back(name);
  material_ = entry->second;
}

void Parser::smoothing(std::string_view text) {
  file_.has_smoothing = true;
  int64_t group = 0;
  if (text == "on")
    group = 1;
  else if (text != "off" && text != "null" && (!parse_integer(text, group) || group < 0 || group > 0xFFFFFFFF))
    skipped_.add("malformed smoothing group", "s", lines_.offset());
  smoothing_group_ = static_cast<uint32_t>(std::clamp<int64_t>(group, 0, 0xFFFFFFFF));
}

Result<void> Parser::check_indices() const {
  const size_t n_positions = file_.positions.size() / 3, n_texcoords = file_.texcoords.size() / 2,
               n_normals = file_.normals.size() / 3;
  for (const ObjFace& face : file_.faces) {
    for (uint32_t k = face.first; k < face.first + face.count; ++k) {
      const ObjCorner& corner = file_.corners[k];
      if (corner.position >= n_positions || (corner.texcoord != ObjCorner::kAbsent && corner.texcoord >= n_texcoords) ||
          (corner.normal != ObjCorner::kAbsent && corner.normal >= n_normals))
        return Failure{Error::corrupt, face.byte_offset, "index out of range"};
    }
  }
  return {};
}

}  // namespace

Result<ObjFile> parse_obj(std::span<const uint8_t> bytes, const Limits& limits, std::vector<Warning>& warnings) {
  if (bytes.size() > limits.max_bytes) return Failure{Error::limit_exceeded, 0, "file is larger than the limit"};
  if (is_wide_text(bytes)) return Failure{Error::unsupported, 0, "UTF-16 text: save the model as UTF-8"};
  return Parser(bytes, limits).run(warnings);
}

}  // namespace pac::raster
