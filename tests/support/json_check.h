// A strict reader of JSON texts [RFC 8259] that keeps the leaves.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace pac::test {

// "a.b[2].c" -> the leaf's text: strings unescaped, numbers and words as written. Empty where `text` is not exactly one
// JSON value (white space around it is fine).
std::optional<std::map<std::string, std::string>> json_leaves(const std::string& text);

}  // namespace pac::test
