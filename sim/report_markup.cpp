#include "sim/report_markup.h"

#include <algorithm>
#include <charconv>

namespace pac::sim {

std::string html_escaped(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string html_tag(const char* name, const std::string& attributes, const std::string& content) {
  std::string html = std::string("<") + name;
  if (!attributes.empty()) html += " " + attributes;
  return html + ">" + content + "</" + name + ">";
}

std::string html_attribute(const char* name, std::string_view value) {
  return std::string(name) + "=\"" + html_escaped(value) + "\" ";
}

std::string decimal_text(double number, int digits) {
  char buffer[352];  // the longest double is 309 digits before the point
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::fixed, digits).ptr;
  std::string text(buffer, end);
  const size_t point = std::min(text.find('.'), text.size());
  const size_t first = text[0] == '-' ? 1 : 0;
  for (size_t i = point; i > first + 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

}  // namespace pac::sim
