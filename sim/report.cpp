#include "sim/report.h"

#include "sim/report_diagram.h"
#include "sim/report_markup.h"
#include "sim/report_pictures.h"

namespace pac::sim {

namespace {

using Text = std::string;

Text paragraphs(const std::vector<Text>& texts, const char* style = "") {
  Text html;
  for (const Text& text : texts) html += html_tag("p", style, html_escaped(text)) + "\n";
  return html;
}

const char* verdict_class(Verdict verdict) {
  constexpr const char* kClasses[] = {"none", "agrees", "differs", "against"};
  return kClasses[static_cast<size_t>(verdict)];
}

const char* verdict_text(Verdict verdict) {
  constexpr const char* kTexts[] = {"beyond the paper", "as in the paper", "differs", "against the paper"};
  return kTexts[static_cast<size_t>(verdict)];
}

Text findings_list(const std::vector<ReportFinding>& findings) {
  if (findings.empty()) return "";
  Text items;
  for (const ReportFinding& finding : findings) {
    const Text chip = html_tag("span", "class=\"chip\"", verdict_text(finding.verdict));
    const Text claim = html_tag("p", "class=\"claim\"", html_escaped(finding.claim));
    const Text ours = finding.ours.empty() ? "" : html_tag("p", "class=\"ours\"", html_escaped(finding.ours));
    items += html_tag("li", Text("class=\"") + verdict_class(finding.verdict) + "\"",
                      chip + html_tag("div", "", claim + ours)) +
             "\n";
  }
  return html_tag("ul", "class=\"findings\"", "\n" + items) + "\n";
}

// ---- head

Text masthead(const Report& report) {
  Text html =
      html_tag("p", "class=\"kicker\"", html_escaped(report.subtitle)) + html_tag("h1", "", html_escaped(report.title));
  html += paragraphs(report.abstract, "class=\"lede\"");
  Text numbers;
  for (const ReportHighlight& one : report.highlights)
    numbers +=
        html_tag("div", "", html_tag("dt", "", html_escaped(one.value)) + html_tag("dd", "", html_escaped(one.text)));
  html = html_tag("div", "class=\"words\"", "\n" + html);
  for (const ReportFigure& figure : report.figures)
    if (figure.id == report.head_figure) html += std::string("\n") + head_wipe(figure);
  if (!numbers.empty()) html += html_tag("dl", "class=\"highlights\"", numbers);
  return "<header class=\"masthead\"><div class=\"wrap\">\n" + html + "</div></header>\n";
}

Text contents(const Report& report) {
  Text links;
  const auto link = [&](const Text& id, const Text& text) {
    links += html_tag("a", "href=\"#" + id + "\"", html_escaped(text)) + "\n";
  };
  if (!report.table.columns.empty()) {
    link("idea", "The idea");
    link("table-1", "Table I");
  }
  for (const ReportFigure& figure : report.figures) link(figure.id, figure.number);
  if (!report.plots.empty()) link("plots", "Rate and distortion");
  if (!report.findings.empty()) link("claims", "Claims");
  if (!report.methods.empty()) link("methods", "Methods");
  for (const ReportLink& page : report.pages)
    links += html_tag("a", html_attribute("href", page.file), html_escaped(page.text)) + "\n";
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
    scenes += html_tag("th", "colspan=\"2\" scope=\"colgroup\"", html_escaped(column.scene));
    sources += "<th scope=\"col\">paper</th><th scope=\"col\">ours</th>";
  }
  scenes += "<td></td>";
  sources += "<th scope=\"col\" class=\"letter\">what differs, and why</th>";
  return html_tag("thead", "", html_tag("tr", "", scenes) + html_tag("tr", "", sources));
}

Text table_row(const Table1& table, size_t index) {
  const Table1Row& first = table.columns[0].rows[index];
  const Text unit = first.unit;
  Text cells = html_escaped(first.label);
  const bool says_unit = Text(first.label).find(unit) != Text::npos;
  if (unit != ":1" && !says_unit) cells += std::string(" ") + html_tag("span", "class=\"unit\"", html_escaped(unit));
  cells = html_tag("th", "scope=\"row\"", cells);
  for (const Table1Column& column : table.columns) {
    const Table1Row& row = column.rows[index];
    cells += html_tag("td", "class=\"paper\"", row.paper ? table_value(row, *row.paper) : "–");
    cells += html_tag("td", "class=\"ours\"", table_value(row, row.ours));
  }
  return html_tag("tr", "", cells + html_tag("td", "class=\"note\"", html_escaped(row_notes(table, index)))) + "\n";
}

Text table_section(const Report& report) {
  const Table1& table = report.table;
  Text body;
  const size_t n_columns = 2 + 2 * table.columns.size();
  for (size_t i = 0; i < table.columns[0].rows.size(); ++i) {
    const char part = table.columns[0].rows[i].section;
    if (i == 0 || part != table.columns[0].rows[i - 1].section) {
      if (i > 0) body += "</tbody>";
      const Text span = std::string("colspan=\"") + std::to_string(n_columns) + "\" scope=\"rowgroup\"";
      body += std::string("<tbody>") +
              html_tag("tr", "class=\"part\"", html_tag("th", span, html_escaped(part_title(part)))) + "\n";
    }
    body += table_row(table, i);
  }
  body += "</tbody>";
  const Text grid = html_tag("table", "class=\"table-one\"", std::string("\n") + table_head(table) + body);
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
  return html_section("table-1", "Table I", "Image-based against polygon-assisted compression",
                      html_tag("div", region, grid) + paragraphs(report.table_notes) + files +
                          html_tag("h3", "", "What the table says, checked") + findings_list(claims));
}

Text files_list(const std::vector<ReportLink>& files) {
  if (files.empty()) return "";
  Text items;
  for (const ReportLink& file : files)
    items += html_tag("li", "",
                      html_tag("a", html_attribute("href", file.file), html_escaped(file.file)) + ": " +
                          html_escaped(file.text)) +
             "\n";
  return html_tag("h3", "", "Files") + html_tag("ul", "class=\"plain\"", "\n" + items) + "\n";
}

Text figure_section(const ReportFigure& figure) {
  return html_section(figure.id, figure.number, figure.title,
                      paragraphs(figure.paragraphs) + findings_list(figure.findings) + figure_pictures(figure) +
                          files_list(figure.files));
}

Text plots_section(const Report& report) {
  Text plots;
  for (const Plot& plot : report.plots)
    plots += html_tag("figure", "", html_tag("p", "", html_escaped(plot.title)) + plot_svg(plot)) + "\n";
  return html_section("plots", "", "Rate and distortion",
                      paragraphs(report.plot_paragraphs) + html_tag("div", "class=\"plots\"", "\n" + plots));
}

Text methods_section(const Report& report) {
  Text items;
  for (const Text& method : report.methods) items += html_tag("li", "", html_escaped(method)) + "\n";
  Text commands;
  for (const Text& line : report.command_lines) commands += line + "\n";
  return html_section(
      "methods", "", "Methods",
      html_tag("ul", "class=\"plain\"", "\n" + items) +
          (commands.empty() ? "" : html_tag("h3", "", "To reproduce") + html_tag("pre", "", html_escaped(commands))));
}

Text idea_section() {
  return html_section(
      "idea", "Figure 1", "Polygons for edges and shading, JPEG for the rest",
      std::string("<div class=\"diagram scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Figure 1\">") +
          Text(kFlowDiagram) + "</div>\n" +
          paragraphs({"The server renders each frame twice, subtracts the low-quality rendering L from the "
                      "high-quality rendering H, and sends the difference image D = 127 + (H − L)/2 as a JPEG "
                      "file. The client renders the same L and adds: L + 2 (D − 127). Edges and smooth shading, "
                      "which JPEG codes worst, never pass through the codec."}));
}

}  // namespace

std::string report_html(const Report& report) {
  Text main;
  if (!report.table.columns.empty()) main += idea_section() + table_section(report);
  for (const ReportFigure& figure : report.figures) main += figure_section(figure);
  if (!report.plots.empty()) main += plots_section(report);
  if (!report.findings.empty())
    main += html_section("claims", "", "The paper’s claims, one by one", findings_list(report.findings));
  if (!report.methods.empty()) main += methods_section(report);
  return html_page(report.title, masthead(report) + contents(report), main, html_escaped(report.footer));
}

}  // namespace pac::sim
