#include "sim/report_markup.h"

#include <algorithm>
#include <charconv>

#include "sim/report_script.h"
#include "sim/report_style.h"

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

std::string html_section(const std::string& id, const std::string& number, const std::string& title,
                         const std::string& content) {
  const std::string label = number.empty() ? "" : html_tag("span", "class=\"number\"", html_escaped(number));
  return "<section id=\"" + id + "\"><div class=\"wrap\">\n" + html_tag("h2", "", label + html_escaped(title)) + "\n" +
         content + "</div></section>\n";
}

std::string html_page(const std::string& title, const std::string& head, const std::string& main,
                      const std::string& footer) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n";
  html +=
      html_tag("title", "", html_escaped(title)) + "\n" + html_tag("style", "", kReportStyle) + "\n</head>\n<body>\n";
  html += "<a class=\"skip\" href=\"#main\">To the content</a>\n" + head + "<main id=\"main\">\n" + main +
          "</main>\n<footer><div class=\"wrap\">" + footer + "</div></footer>\n";
  return html + html_tag("script", "", kReportScript) + "\n</body>\n</html>\n";
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
