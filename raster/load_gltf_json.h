// JSON [RFC 8259] as a tree that keeps where each value stood in the file, so that errors can say so.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace pac::raster {

struct JsonNode {
  enum class Kind : uint8_t { null, boolean, number, string, array, object } kind = Kind::null;
  double number = 0;                                   // boolean: 0 or 1
  uint32_t text = 0;                                   // string: into JsonTree::strings
  uint32_t key = 0;                                    // of a member: into JsonTree::strings
  uint32_t first_child = 0, last_child = 0, next = 0;  // into JsonTree::nodes; 0 = none (the root is nobody's child)
  uint64_t offset = 0;  // byte in the text: behind the first character of an array or object, else behind the value
};

struct JsonTree {
  std::vector<JsonNode> nodes;  // nodes[0] is the root
  std::vector<std::string> strings;
};

// A value of a tree, or nothing: what is asked of nothing is nothing again, so that a chain of look-ups needs one test.
// Valid as long as the tree lives unchanged.
class Json {
 public:
  Json() = default;
  Json(const JsonTree& tree, uint32_t node) : tree_(&tree), node_(node) {}

  bool exists() const { return tree_ != nullptr; }
  bool is_array() const { return is(JsonNode::Kind::array); }
  bool is_object() const { return is(JsonNode::Kind::object); }
  bool is_string() const { return is(JsonNode::Kind::string); }
  bool is_number() const { return is(JsonNode::Kind::number); }
  uint64_t offset() const { return exists() ? node().offset : 0; }
  // A member (the first of that name), or nothing; linear in the number of members.
  Json operator[](std::string_view key) const;
  Json first() const { return child(exists() ? node().first_child : 0); }
  Json next() const { return child(exists() ? node().next : 0); }
  // All elements of an array; empty for everything else.
  std::vector<Json> elements() const;
  std::string_view key() const { return exists() ? std::string_view(tree_->strings[node().key]) : ""; }
  std::string_view text() const { return is_string() ? std::string_view(tree_->strings[node().text]) : ""; }
  double number(double otherwise) const { return is_number() ? node().number : otherwise; }
  bool boolean(bool otherwise) const { return is(JsonNode::Kind::boolean) ? node().number != 0 : otherwise; }

 private:
  const JsonNode& node() const { return tree_->nodes[node_]; }
  bool is(JsonNode::Kind kind) const { return exists() && node().kind == kind; }
  Json child(uint32_t number) const { return number == 0 ? Json() : Json(*tree_, number); }

  const JsonTree* tree_ = nullptr;
  uint32_t node_ = 0;
};

// Whether this build has a JSON parser; without, parse_json() refuses everything.
bool has_json_parser();

// Fails with corrupt ("malformed JSON", byte_offset where), limit_exceeded (more than 2^24 values, nested deeper than
// 64) or unsupported (no parser in this build).
Result<JsonTree> parse_json(std::span<const uint8_t> text);

}  // namespace pac::raster
