// Pieces of HTML.
#pragma once

#include <string>
#include <string_view>

namespace pac::sim {

// & < > " as entities: safe in text and in quoted attributes.
std::string html_escaped(std::string_view text);

// <name attributes>content</name>; content is markup already.
std::string html_tag(const char* name, const std::string& attributes, const std::string& content);

// name="value" and a space, the value escaped.
std::string html_attribute(const char* name, std::string_view value);

// "1,234.5": `digits` after the point, thousands apart.
std::string decimal_text(double number, int digits);

}  // namespace pac::sim
