#include "sim/report.h"

#include <algorithm>
#include <charconv>

#include "sim/report_diagram.h"
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

std::string decimal_text(double number, int digits) {
  char buffer[352];  // the longest double is 309 digits before the point
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, number, std::chars_format::fixed, digits).ptr;
  std::string text(buffer, end);
  const size_t point = std::min(text.find('.'), text.size());
  const size_t first = text[0] == '-' ? 1 : 0;
  for (size_t i = point; i > first + 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

namespace {

using Text = std::string;

Text tag(const char* name, const Text& attributes, const Text& content) {
  return Text("<") + name + (attributes.empty() ? "" : " " + attributes) + ">" + content + "</" + name + ">";
}

Text attribute(const char* name, std::string_view value) {
  return Text(name) + "=\"" + html_escaped(value) + "\" ";
}

Text paragraphs(const std::vector<Text>& texts, const char* style = "") {
  Text html;
  for (const Text& text : texts) html += tag("p", style, html_escaped(text)) + "\n";
  return html;
}

Text section(const Text& id, const Text& number, const Text& title, const Text& content) {
  const Text label = number.empty() ? "" : tag("span", "class=\"number\"", html_escaped(number));
  return "<section id=\"" + id + "\"><div class=\"wrap\">\n" + tag("h2", "", label + html_escaped(title)) + "\n" +
         content + "</div></section>\n";
}

const char* verdict_class(Verdict verdict) {
  constexpr const char* kClasses[] = {"none", "agrees", "differs", "against"};
  return kClasses[static_cast<size_t>(verdict)];
}

const char* verdict_text(Verdict verdict) {
  constexpr const char* kTexts[] = {"noted", "as in the paper", "differs", "against the paper"};
  return kTexts[static_cast<size_t>(verdict)];
}

Text findings_list(const std::vector<ReportFinding>& findings) {
  if (findings.empty()) return "";
  Text items;
  for (const ReportFinding& finding : findings) {
    const Text chip = tag("span", "class=\"chip\"", verdict_text(finding.verdict));
    const Text claim = tag("p", "class=\"claim\"", html_escaped(finding.claim));
    const Text ours = tag("p", "class=\"ours\"", html_escaped(finding.ours));
    items +=
        tag("li", Text("class=\"") + verdict_class(finding.verdict) + "\"", chip + tag("div", "", claim + ours)) + "\n";
  }
  return tag("ul", "class=\"findings\"", "\n" + items) + "\n";
}

// ---- head

Text masthead(const Report& report) {
  Text html = tag("p", "class=\"kicker\"", html_escaped(report.subtitle)) + tag("h1", "", html_escaped(report.title));
  html += paragraphs(report.abstract, "class=\"lede\"");
  Text numbers;
  for (const ReportHighlight& one : report.highlights)
    numbers += tag("div", "", tag("dt", "", html_escaped(one.value)) + tag("dd", "", html_escaped(one.text)));
  if (!numbers.empty()) html += tag("dl", "class=\"highlights\"", numbers);
  return "<header class=\"masthead\"><div class=\"wrap\">\n" + html + "</div></header>\n";
}

Text contents(const Report& report) {
  Text links;
  const auto link = [&](const Text& id, const Text& text) {
    links += tag("a", "href=\"#" + id + "\"", html_escaped(text)) + "\n";
  };
  if (!report.table.columns.empty()) {
    link("idea", "The idea");
    link("table-1", "Table I");
  }
  for (const ReportFigure& figure : report.figures) link(figure.id, figure.number);
  if (!report.plots.empty()) link("plots", "Rate and distortion");
  if (!report.findings.empty()) link("claims", "Claims");
  if (!report.methods.empty()) link("methods", "Methods");
  return "<nav class=\"contents\" aria-label=\"Contents\"><div class=\"wrap\">\n" + links + "</div></nav>\n";
}

// ---- Table I

constexpr const char* kPartTitles[] = {"High-quality rendering",
                                       "Low-quality rendering",
                                       "Difference image",
                                       "Image-based compression",
                                       "Polygon-assisted compression (resident model)",
                                       "Polygon-assisted compression (transmitted model)"};

Text part_title(char part) {
  const Text letter(1, part);
  return part >= 'A' && part <= 'F' ? letter + ". " + kPartTitles[part - 'A'] : letter;
}

Text table_value(const Table1Row& row, double value) {
  return decimal_text(value, row.decimals) + (Text(row.unit) == ":1" ? ":1" : "");
}

// The notes of a row, scene by scene, once where they are equal.
Text row_notes(const Table1& table, size_t row_index) {
  Text notes;
  for (const Table1Column& column : table.columns) {
    const Text note = column.rows[row_index].note;
    if (note.empty() || notes.find(note) != Text::npos) continue;
    notes += (notes.empty() ? "" : " ") + note;
  }
  return notes;
}

Text table_head(const Table1& table) {
  Text scenes = "<td></td>", sources = "<th scope=\"col\"></th>";
  for (const Table1Column& column : table.columns) {
    scenes += tag("th", "colspan=\"2\" scope=\"colgroup\"", html_escaped(column.scene));
    sources += "<th scope=\"col\">paper</th><th scope=\"col\">ours</th>";
  }
  scenes += "<td></td>";
  sources += "<th scope=\"col\" class=\"letter\">what differs, and why</th>";
  return tag("thead", "", tag("tr", "", scenes) + tag("tr", "", sources));
}

Text table_row(const Table1& table, size_t index) {
  const Table1Row& first = table.columns[0].rows[index];
  const Text unit = first.unit;
  Text cells = html_escaped(first.label);
  if (!unit.empty() && unit != ":1") cells += " " + tag("span", "class=\"unit\"", html_escaped(unit));
  cells = tag("th", "scope=\"row\"", cells);
  for (const Table1Column& column : table.columns) {
    const Table1Row& row = column.rows[index];
    cells += tag("td", "class=\"paper\"", row.paper ? table_value(row, *row.paper) : "–");
    cells += tag("td", "class=\"ours\"", table_value(row, row.ours));
  }
  return tag("tr", "", cells + tag("td", "class=\"note\"", html_escaped(row_notes(table, index)))) + "\n";
}

Text table_section(const Report& report) {
  const Table1& table = report.table;
  Text body;
  const size_t n_columns = 2 + 2 * table.columns.size();
  for (size_t i = 0; i < table.columns[0].rows.size(); ++i) {
    const char part = table.columns[0].rows[i].section;
    if (i == 0 || part != table.columns[0].rows[i - 1].section) {
      if (i > 0) body += "</tbody>";
      const Text span = "colspan=\"" + std::to_string(n_columns) + "\" scope=\"rowgroup\"";
      body += "<tbody>" + tag("tr", "class=\"part\"", tag("th", span, html_escaped(part_title(part)))) + "\n";
    }
    body += table_row(table, i);
  }
  body += "</tbody>";
  const Text grid = tag("table", "class=\"table-one\"", "\n" + table_head(table) + body);
  const Text region = "class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Table I\"";
  std::vector<ReportFinding> claims;
  for (const Table1Column& column : table.columns)
    for (const Table1Claim& claim : column.claims) {
      const bool same = claim.paper_holds == claim.ours_holds;
      const Text paper = claim.paper_holds ? "It holds in the paper’s table" : "It does not hold in the paper’s table";
      const Text ours = claim.ours_holds ? "holds in ours" : "does not hold in ours";
      claims.push_back({same ? Verdict::agrees : Verdict::against, Text(claim.text) + " (" + column.scene + ")",
                        paper + (same ? ", and " : ", but ") + ours + "."});
    }
  const Text files =
      "<p>The same rows for machines: <a href=\"table1.csv\">table1.csv</a>, <a "
      "href=\"table1.json\">table1.json</a>.</p>";
  return section("table-1", "Table I", "Image-based against polygon-assisted compression",
                 tag("div", region, grid) + paragraphs(report.table_notes) + files +
                     tag("h3", "", "What the table says, checked") + findings_list(claims));
}

// ---- pictures

const char* arm_class(const ReportPicture& picture) {
  constexpr const char* kClasses[] = {"", "arm-image", "arm-polygon"};
  return kClasses[static_cast<size_t>(picture.arm)];
}

Text caption(const Text& label, const Text& title, const Text& numbers) {
  Text html = label.empty() ? "" : tag("span", "class=\"letter-tag\"", html_escaped(label));
  html += tag("b", "", html_escaped(title));
  if (!numbers.empty()) html += " " + tag("span", "class=\"numbers\"", html_escaped(numbers));
  return html;
}

Text wipe_button(const ReportFigure& figure, const ReportPicture& picture, const char* side) {
  return tag("button",
             "type=\"button\" " + attribute("data-wipe", figure.id + "-wipe") + attribute("data-side", side) +
                 attribute("data-id", picture.id) +
                 attribute("aria-label", "Show " + picture.title + " on the " + side + " of the wipe"),
             Text(side));
}

Text picture_html(const ReportFigure& figure, const ReportPicture& picture) {
  const Text size = "width=\"" + std::to_string(picture.width) + "\" height=\"" + std::to_string(picture.height) + "\"";
  const Text image = "<img " + attribute("src", picture.file) + attribute("alt", picture.alt) + size + ">";
  Text content = tag("a", attribute("href", picture.file), image) +
                 tag("figcaption", "", caption(picture.label, picture.title, picture.caption));
  if (!figure.wipe_left.empty())
    content +=
        tag("div", "class=\"to-wipe\"", wipe_button(figure, picture, "left") + wipe_button(figure, picture, "right"));
  return tag("figure", "class=\"picture " + Text(arm_class(picture)) + "\"", content) + "\n";
}

Text row_html(const ReportFigure& figure, const ReportRow& row) {
  Text pictures;
  int widest = 0;
  for (const ReportPicture& picture : row.pictures) {
    pictures += picture_html(figure, picture);
    widest = std::max(widest, picture.width);
  }
  const Text style = "class=\"grid\" style=\"--columns:" + std::to_string(row.pictures.size()) +
                     ";--widest:" + std::to_string(widest) + "px\"";
  const Text label = row.label.empty() ? "" : tag("p", "class=\"label\"", html_escaped(row.label));
  return tag("div", "class=\"row\"", label + tag("div", style, "\n" + pictures)) + "\n";
}

Text picture_name(const ReportPicture& picture) {
  return (picture.label.empty() ? "" : picture.label + " · ") + picture.title;
}

std::vector<const ReportPicture*> pictures_of(const ReportFigure& figure) {
  std::vector<const ReportPicture*> pictures;
  for (const ReportRow& row : figure.rows)
    for (const ReportPicture& picture : row.pictures) pictures.push_back(&picture);
  return pictures;
}

const ReportPicture* find_picture(const ReportFigure& figure, const Text& id) {
  for (const ReportPicture* picture : pictures_of(figure))
    if (picture->id == id) return picture;
  return nullptr;
}

Text wipe_select(const ReportFigure& figure, const char* side, const Text& selected) {
  Text options;
  for (const ReportPicture* picture : pictures_of(figure))
    options += tag("option",
                   attribute("value", picture->id) + attribute("data-file", picture->file) +
                       attribute("data-alt", picture->alt) +
                       attribute("data-details", picture->caption + "\n" + picture->details) +
                       (picture->id == selected ? "selected" : ""),
                   html_escaped(picture_name(*picture))) +
               "\n";
  const Text id = figure.id + "-" + side;
  return tag("label", attribute("for", id), side[0] == 'l' ? "On the left" : "On the right") +
         tag("select", attribute("id", id) + attribute("class", side), "\n" + options);
}

Text wipe_side(const ReportFigure& figure, const char* side, const ReportPicture& picture) {
  return tag(
      "div", "class=\"side\"",
      wipe_select(figure, side, picture.id) + tag("p", Text("class=\"numbers ") + side + "\" aria-live=\"polite\"",
                                                  html_escaped(picture.caption + "\n" + picture.details)));
}

Text wipe_layer(const char* side, const ReportPicture& picture) {
  return tag("div", Text("class=\"layer ") + side + "\"",
             "<img " + attribute("src", picture.file) + attribute("alt", picture.alt) + "draggable=\"false\">");
}

Text wipe_tools() {
  Text html = tag("span", "", "Enlarge");
  for (const int zoom : {1, 2, 4, 8})
    html += tag("button", "type=\"button\" data-zoom=\"" + std::to_string(zoom) + "\"", std::to_string(zoom) + "×");
  html += tag("button", "type=\"button\" class=\"blink\" aria-pressed=\"false\"", "Blink");
  return tag("div", "class=\"tools\"", html);
}

Text wipe_html(const ReportFigure& figure) {
  const ReportPicture* left = find_picture(figure, figure.wipe_left);
  const ReportPicture* right = find_picture(figure, figure.wipe_right);
  if (left == nullptr || right == nullptr) return "";
  const Text handle = tag("div",
                          "class=\"handle\" role=\"slider\" tabindex=\"0\" aria-label=\"Wipe between two pictures of " +
                              figure.number + "\" aria-valuemin=\"0\" aria-valuemax=\"100\" aria-valuenow=\"50\"",
                          "");
  const Text stage = wipe_layer("right", *right) + wipe_layer("left", *left) +
                     tag("span", "class=\"tag left\" aria-hidden=\"true\"", html_escaped(picture_name(*left))) +
                     tag("span", "class=\"tag right\" aria-hidden=\"true\"", html_escaped(picture_name(*right))) +
                     handle;
  constexpr const char* kHint =
      "Drag the handle, or focus it and use the arrow keys (<kbd>Shift</kbd> for larger steps), <kbd>+</kbd> and "
      "<kbd>−</kbd> to enlarge. Enlarged, drag the picture itself, or hold <kbd>Alt</kbd> with the arrow keys.";
  const Text panel = wipe_side(figure, "left", *left) + wipe_side(figure, "right", *right) + wipe_tools() +
                     tag("p", "class=\"hint\"", kHint);
  const Text width = std::to_string(left->width), height = std::to_string(left->height);
  return tag("div",
             "class=\"wipe\" id=\"" + figure.id + "-wipe\" data-width=\"" + width + "\" style=\"--w:" + width +
                 ";--h:" + height + "\"",
             "\n" + tag("div", "class=\"stage\"", stage) + "\n" + tag("div", "class=\"panel\"", panel)) +
         "\n";
}

Text percent(double part, double whole) {
  return decimal_text(100 * part / whole, 4) + "%";
}

Text crop_html(const ReportFigure& figure, const ReportCrop& crop) {
  const ReportPicture* picture = find_picture(figure, crop.picture_id);
  if (picture == nullptr || crop.width <= 0 || crop.height <= 0) return "";
  const Text place = "width:" + percent(picture->width, crop.width) + ";left:" + percent(-crop.x, crop.width) +
                     ";top:" + percent(-crop.y, crop.height);
  const Text image = "<img " + attribute("src", picture->file) + attribute("alt", "Enlarged part of: " + picture->alt) +
                     "style=\"" + place + "\">";
  const Text frame = tag(
      "div",
      "class=\"crop\" style=\"aspect-ratio:" + std::to_string(crop.width) + "/" + std::to_string(crop.height) + "\"",
      image);
  return tag("figure", "class=\"" + Text(arm_class(*picture)) + "\"",
             frame + tag("figcaption", "", caption(crop.label, crop.title, crop.caption))) +
         "\n";
}

Text figure_section(const ReportFigure& figure) {
  Text html = paragraphs(figure.paragraphs) + findings_list(figure.findings);
  for (size_t i = 0; i < figure.rows.size(); ++i) {
    html += row_html(figure, figure.rows[i]);
    if (i == 0) html += wipe_html(figure);
  }
  if (!figure.crops.empty()) {
    Text crops;
    for (const ReportCrop& crop : figure.crops) crops += crop_html(figure, crop);
    const size_t columns = std::min<size_t>(figure.crops.size(), 3);
    html +=
        tag("h3", "", "Enlarged") +
        tag("div", "class=\"grid\" style=\"--columns:" + std::to_string(columns) + ";--widest:576px\"", "\n" + crops);
  }
  return section(figure.id, figure.number, figure.title, html);
}

Text plots_section(const Report& report) {
  Text plots;
  for (const Plot& plot : report.plots)
    plots += tag("figure", "", tag("p", "", html_escaped(plot.title)) + plot_svg(plot)) + "\n";
  return section("plots", "", "Rate and distortion",
                 paragraphs(report.plot_paragraphs) + tag("div", "class=\"plots\"", "\n" + plots));
}

Text methods_section(const Report& report) {
  Text items;
  for (const Text& method : report.methods) items += tag("li", "", html_escaped(method)) + "\n";
  Text commands;
  for (const Text& line : report.command_lines) commands += line + "\n";
  return section("methods", "", "Methods",
                 tag("ul", "class=\"plain\"", "\n" + items) +
                     (commands.empty() ? "" : tag("h3", "", "To reproduce") + tag("pre", "", html_escaped(commands))));
}

Text idea_section() {
  return section(
      "idea", "Figure 1", "Polygons for edges and shading, JPEG for the rest",
      "<div class=\"diagram scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Figure 1\">" + Text(kFlowDiagram) +
          "</div>\n" +
          paragraphs({"The server renders each frame twice, subtracts the low-quality rendering L from the "
                      "high-quality rendering H, and sends the difference image D = 127 + (H − L)/2 as a JPEG "
                      "file. The client renders the same L and adds: L + 2 (D − 127). Edges and smooth shading, "
                      "which JPEG codes worst, never pass through the codec."}));
}

}  // namespace

std::string report_html(const Report& report) {
  Text html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n";
  html += tag("title", "", html_escaped(report.title)) + "\n" + tag("style", "", kReportStyle) + "\n</head>\n<body>\n";
  html += "<a class=\"skip\" href=\"#main\">To the content</a>\n" + masthead(report) + contents(report);
  html += "<main id=\"main\">\n";
  if (!report.table.columns.empty()) html += idea_section() + table_section(report);
  for (const ReportFigure& figure : report.figures) html += figure_section(figure);
  if (!report.plots.empty()) html += plots_section(report);
  if (!report.findings.empty())
    html += section("claims", "", "The paper’s claims, one by one", findings_list(report.findings));
  if (!report.methods.empty()) html += methods_section(report);
  html += "</main>\n<footer><div class=\"wrap\">" + html_escaped(report.footer) + "</div></footer>\n";
  html += tag("script", "", kReportScript) + "\n</body>\n</html>\n";
  return html;
}

}  // namespace pac::sim
