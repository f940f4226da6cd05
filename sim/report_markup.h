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

// A section of the page with its heading; content is markup, the other texts are plain. number: above the title, or "".
std::string html_section(const std::string& id, const std::string& number, const std::string& title,
                         const std::string& content);

// A whole file, UTF-8, with style sheet and script inside. head: what stands above <main>; main and footer: markup.
std::string html_page(const std::string& title, const std::string& head, const std::string& main,
                      const std::string& footer);

// "1,234.5": `digits` after the point, thousands apart.
std::string decimal_text(double number, int digits);

}  // namespace pac::sim
