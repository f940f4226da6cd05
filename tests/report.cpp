// The demo's page: well-formed, complete, self-contained.
#include "sim/report.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "sim/report_claims.h"
#include "sim/report_demo.h"
#include "sim/report_figure.h"
#include "sim/report_markup.h"
#include "tests/support/mock_results.h"

using namespace pac;
using namespace pac::sim;

namespace {

// The values of every attribute `name` in the page.
std::vector<std::string> attributes(const std::string& html, const std::string& name) {
  std::vector<std::string> values;
  const std::string start = " " + name + "=\"";
  for (size_t at = html.find(start); at != std::string::npos; at = html.find(start, at + 1)) {
    const size_t from = at + start.size();
    values.push_back(html.substr(from, html.find('"', from) - from));
  }
  return values;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// The first tag that closes what is not open, or is never closed; empty where all is well.
std::string unbalanced_tag(const std::string& html) {
  const std::set<std::string> kVoid = {"meta", "link", "img", "br", "!doctype"};
  std::vector<std::string> open;
  for (size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const size_t end = html.find('>', at);
    if (end == std::string::npos) return html.substr(at);
    std::string tag = html.substr(at + 1, end - at - 1);
    if (tag.ends_with('/')) continue;
    tag = tag.substr(0, tag.find_first_of(" \n"));
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return tag;
      open.pop_back();
    } else if (!kVoid.contains(tag)) {
      open.push_back(tag);
      if (tag == "style" || tag == "script") at = html.find("</" + tag, at) - 1;
    }
  }
  return open.empty() ? "" : open.back();
}

struct Page {
  PaperResults results = test::mock_results(64);
  IllustratedReport made = demo_report(results);
  std::string html = report_html(made.report);
};

const Page& page() {
  static const Page made;
  return made;
}

}  // namespace

TEST_CASE("every tag of the page is closed in order") {
  CHECK(unbalanced_tag(page().html) == "");
}

TEST_CASE("the page needs no network: every picture it names is written beside it, nothing else is loaded") {
  std::set<std::string> files;
  for (const ReportImage& image : page().made.images) {
    CHECK(files.insert(image.file).second);
    CHECK(image.image.width == 64);
  }
  for (const std::string& source : attributes(page().html, "src")) CHECK(files.contains(source));
  for (const std::string& source : attributes(page().html, "data-file")) CHECK(files.contains(source));
  for (const std::string& target : attributes(page().html, "href"))
    CHECK((files.contains(target) || target.starts_with("#") || target.starts_with("table1.") || target == "data:," ||
           target == "animations.html"));
  CHECK(!contains(page().html, "http"));
  CHECK(!contains(page().html, "@import"));
  for (size_t at = page().html.find("url("); at != std::string::npos; at = page().html.find("url(", at + 1))
    CHECK(page().html[at + 4] == '#');
}

TEST_CASE("ids are unique and every link inside the page has its target") {
  const auto ids = attributes(page().html, "id");
  const std::set<std::string> known(ids.begin(), ids.end());
  CHECK(known.size() == ids.size());
  for (const std::string& target : attributes(page().html, "href"))
    if (target.starts_with("#")) CHECK(known.contains(target.substr(1)));
  for (const std::string& target : attributes(page().html, "data-wipe")) CHECK(known.contains(target));
}

TEST_CASE("every picture has a text for those who cannot see it") {
  const auto sources = attributes(page().html, "src"), texts = attributes(page().html, "alt");
  CHECK(sources.size() == texts.size());
  CHECK(std::none_of(texts.begin(), texts.end(), [](const std::string& text) { return text.empty(); }));
}

TEST_CASE("Table I shows every row for both scenes and says where one has no counterpart in the paper") {
  for (const Table1Column& column : page().results.table1.columns)
    for (const Table1Row& row : column.rows) {
      CHECK(contains(page().html, html_escaped(row.label)));
      CHECK(contains(page().html, html_escaped(row.note)));
    }
  CHECK(contains(page().html, ">1,131</td>"));
  CHECK(contains(page().html, ">80:1</td>"));
  CHECK(contains(page().html, ">–</td>"));
}

TEST_CASE("a finding that contradicts the paper is marked so in words") {
  CHECK(contains(page().html, "against the paper"));
  CHECK(contains(page().html, "It does not hold in the paper’s table, but holds in ours."));
}

TEST_CASE("texts from outside cannot break the page") {
  CHECK(contains(page().html, "&lt;every&gt;"));
  CHECK(html_escaped("a<b>&\"c\"") == "a&lt;b&gt;&amp;&quot;c&quot;");
  Report report;
  report.title = "</title><script>alert(1)</script>";
  CHECK(!contains(report_html(report), "<script>alert"));
}

TEST_CASE("each figure has H, L, D, both arms at matched bytes and a wipe between any two of its pictures") {
  for (const ReportFigure& figure : page().made.report.figures) {
    CAPTURE(figure.id);
    size_t pictures = 0, image_based = 0, polygon_assisted = 0;
    for (const ReportRow& row : figure.rows)
      for (const ReportPicture& picture : row.pictures) {
        ++pictures;
        image_based += picture.arm == PictureArm::image_based ? 1u : 0u;
        polygon_assisted += picture.arm == PictureArm::polygon_assisted ? 1u : 0u;
      }
    CHECK(figure.rows[0].pictures.size() >= 3);
    CHECK(image_based >= 1);
    CHECK(image_based == polygon_assisted);
    const size_t start = page().html.find("id=\"" + figure.id + "-left\"");
    REQUIRE(start != std::string::npos);
    const std::string select = page().html.substr(start, page().html.find("</select>", start) - start);
    CHECK(attributes(select, "data-file").size() == pictures);
  }
}

TEST_CASE("plots stay inside their frame, leave out numbers that are none, and name axes and units") {
  Plot plot;
  plot.id = "plot-a";
  plot.y_label = "PSNR (dB)";
  plot.top_per_x = 8 / 4096.0;
  plot.series.resize(2);
  plot.series[0] = {"a", "image", {{100, 20, "q 5"}, {1000, 30, "q < 50"}}};
  plot.series[1] = {"b", "polygon", {{0, 1, {}}, {500, std::numeric_limits<double>::quiet_NaN(), {}}, {2000, 35, {}}}};
  plot.marks = {{491, "25:1"}, {1e9, "outside"}};
  const std::string svg = plot_svg(plot);
  CHECK(unbalanced_tag(svg) == "");
  CHECK(!contains(svg, "nan"));
  CHECK(!contains(svg, "inf"));
  CHECK(!contains(svg, "outside"));
  CHECK(contains(svg, "q &lt; 50"));
  for (const char* text : {"PSNR (dB)", "bytes", "bits per pixel", "25:1"}) CHECK(contains(svg, text));
  for (const char* name : {"x1", "x2", "cx"})
    for (const std::string& value : attributes(svg, name)) {
      const double x = std::stod(value);
      CHECK((x >= 0 && x <= 520));
    }
  CHECK(!contains(plot_svg(Plot{}), "nan"));
}

TEST_CASE("enlargements show the place where a picture is worst") {
  RgbImage reference(64, 40), test(64, 40);
  test.pixel(50, 30)[1] = 200;
  const Place place = worst_place(reference.view(), test.view(), 16);
  CHECK((place.x <= 50 && place.x + 16 > 50));
  CHECK((place.y <= 30 && place.y + 16 > 30));
  const Place small = worst_place(reference.view(), test.view(), 128);
  CHECK((small.x == 0 && small.y == 0));
}

TEST_CASE("numbers are printed with thousands apart and digits as asked") {
  CHECK(decimal_text(1234567, 0) == "1,234,567");
  CHECK(decimal_text(-1234.56, 1) == "-1,234.6");
  CHECK(decimal_text(999, 2) == "999.00");
  CHECK(short_quality(15) == "15");
  CHECK(short_quality(36.24) == "36.2");
}

TEST_CASE("a claim turns against the paper when the numbers do") {
  PaperResults results = test::mock_results(32);
  const auto verdict_of = [&](const char* part) {
    for (const ReportFinding& finding : paper_claims(results))
      if (contains(finding.claim, part)) return finding.verdict;
    return Verdict::none;
  };
  CHECK(verdict_of("entropy") == Verdict::agrees);
  CHECK(verdict_of("quality factor") == Verdict::agrees);
  results.figures[1].renderings.difference_entropy.mean_rgb = 9;
  results.pin.polygon_assisted.coded.equivalent_quality = 14;
  for (FigureSet& set : results.figures)
    for (MatchedPair& pair : set.pairs) pair.polygon_assisted.scores.ssim = 0.1;
  CHECK(verdict_of("entropy") == Verdict::against);
  CHECK(verdict_of("quality factor") == Verdict::against);
  CHECK(verdict_of("In every case") == Verdict::against);
}
