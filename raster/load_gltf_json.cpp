// The one file that includes RapidJSON (header-only), and only where the build found it: PAC_HAVE_RAPIDJSON. Its
// iterative parser has no recursion that a file could deepen; this file's handler bounds what it may collect.
#include "raster/load_gltf_json.h"

#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#if defined(PAC_HAVE_RAPIDJSON) && PAC_HAVE_RAPIDJSON
#include <rapidjson/error/error.h>
#include <rapidjson/reader.h>
#endif

namespace pac::raster {

Json Json::operator[](std::string_view key) const {
  if (!is_object()) return {};
  for (Json member = first(); member.exists(); member = member.next())
    if (member.key() == key) return member;
  return {};
}

std::vector<Json> Json::elements() const {
  std::vector<Json> all;
  if (!is_array()) return all;
  for (Json element = first(); element.exists(); element = element.next()) all.push_back(element);
  return all;
}

#if defined(PAC_HAVE_RAPIDJSON) && PAC_HAVE_RAPIDJSON

namespace {

constexpr size_t kMaxNodes = size_t{1} << 24, kMaxDepth = 64;

// What RapidJSON reads from: the bytes, then zeros without end.
class ByteStream {
 public:
  using Ch = char;
  explicit ByteStream(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  Ch Peek() const { return at_ < bytes_.size() ? static_cast<char>(bytes_[at_]) : '\0'; }
  Ch Take() { return at_ < bytes_.size() ? static_cast<char>(bytes_[at_++]) : '\0'; }
  size_t Tell() const { return at_; }
  // Of streams that are written to, which this one never is.
  Ch* PutBegin() { return nullptr; }
  void Put(Ch) {}
  size_t PutEnd(Ch*) { return 0; }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

// Of a number outside double's range: whether it is too small, which its exponent says.
bool is_tiny(const char* text, size_t length) {
  for (size_t i = 0; i + 1 < length; ++i)
    if ((text[i] == 'e' || text[i] == 'E') && text[i + 1] == '-') return true;
  return false;
}

// Grows the tree as values come by; false stops the parser.
class TreeBuilder {
 public:
  explicit TreeBuilder(const ByteStream& stream) : stream_(stream) { tree_.strings.emplace_back(); }

  bool Null() { return add(JsonNode::Kind::null, 0); }
  bool Bool(bool value) { return add(JsonNode::Kind::boolean, value ? 1 : 0); }
  // Of numbers that RapidJSON reads itself, which it is told not to.
  bool Int(int) { return false; }
  bool Uint(unsigned) { return false; }
  bool Int64(int64_t) { return false; }
  bool Uint64(uint64_t) { return false; }
  bool Double(double) { return false; }
  // JSON's numbers are among those that from_chars reads. Beyond double's range: infinity or 0, as rounding gives.
  bool RawNumber(const char* text, rapidjson::SizeType length, bool) {
    double value = 0;
    const auto read = std::from_chars(text, text + length, value);
    if (read.ec == std::errc::result_out_of_range) value = is_tiny(text, length) ? 0.0 : HUGE_VAL;
    return add(JsonNode::Kind::number, value);
  }
  bool String(const char* text, rapidjson::SizeType length, bool) {
    if (!add(JsonNode::Kind::string, 0)) return false;
    tree_.nodes.back().text = static_cast<uint32_t>(tree_.strings.size());
    tree_.strings.emplace_back(text, length);
    return true;
  }
  bool Key(const char* text, rapidjson::SizeType length, bool) {
    if (tree_.strings.size() > 2 * kMaxNodes) return false;
    key_ = static_cast<uint32_t>(tree_.strings.size());
    tree_.strings.emplace_back(text, length);
    return true;
  }
  bool StartObject() { return open(JsonNode::Kind::object); }
  bool StartArray() { return open(JsonNode::Kind::array); }
  bool EndObject(rapidjson::SizeType) { return close(); }
  bool EndArray(rapidjson::SizeType) { return close(); }

  JsonTree take() { return std::move(tree_); }

 private:
  bool add(JsonNode::Kind kind, double number) {
    if (tree_.nodes.size() >= kMaxNodes) return false;
    const uint32_t self = static_cast<uint32_t>(tree_.nodes.size());
    JsonNode node;
    node.kind = kind;
    node.number = number;
    node.offset = stream_.Tell();
    node.key = key_;
    key_ = 0;
    tree_.nodes.push_back(node);
    if (open_.empty()) return true;
    JsonNode& parent = tree_.nodes[open_.back()];
    if (parent.last_child == 0)
      parent.first_child = self;
    else
      tree_.nodes[parent.last_child].next = self;
    parent.last_child = self;
    return true;
  }
  bool open(JsonNode::Kind kind) {
    if (open_.size() >= kMaxDepth || !add(kind, 0)) return false;
    open_.push_back(static_cast<uint32_t>(tree_.nodes.size() - 1));
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const ByteStream& stream_;
  JsonTree tree_;
  std::vector<uint32_t> open_;
  uint32_t key_ = 0;
};

}  // namespace

bool has_json_parser() {
  return true;
}

Result<JsonTree> parse_json(std::span<const uint8_t> text) {
  const size_t mark = text.size() >= 3 && text[0] == 0xEF && text[1] == 0xBB && text[2] == 0xBF ? 3 : 0;
  ByteStream stream(text.subspan(mark));
  TreeBuilder builder(stream);
  rapidjson::Reader reader;
  // Numbers come as text: RapidJSON 1.1's own reading of them shifts zero by the count of its leading zeros.
  constexpr unsigned kFlags =
      rapidjson::kParseIterativeFlag | rapidjson::kParseNumbersAsStringsFlag | rapidjson::kParseValidateEncodingFlag;
  const rapidjson::ParseResult result = reader.Parse<kFlags>(stream, builder);
  if (result.IsError()) {
    const uint64_t at = result.Offset() + mark;
    if (result.Code() == rapidjson::kParseErrorTermination)
      return Failure{Error::limit_exceeded, at, "JSON nests too deep or has too many values"};
    return Failure{Error::corrupt, at < text.size() ? at : text.size(), "malformed JSON"};
  }
  JsonTree tree = builder.take();
  for (JsonNode& node : tree.nodes) node.offset += mark;
  return tree;
}

#else

bool has_json_parser() {
  return false;
}

Result<JsonTree> parse_json(std::span<const uint8_t>) {
  return Failure{Error::unsupported, 0, "built without glTF (Debian: rapidjson-dev)"};
}

#endif

}  // namespace pac::raster
