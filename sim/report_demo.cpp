#include "sim/report_demo.h"

#include <string_view>

#include "sim/report_claims.h"
#include "sim/report_curves.h"
#include "sim/report_figure.h"

namespace pac::sim {
namespace {

// What the page says about a figure before any number.
struct FigureText {
  std::string_view key;
  const char* number;
  const char* title;
  const char* paragraph;
  const char* labels[3];  // of H, L, D in the paper
};

constexpr FigureText kFigureTexts[] = {
    {"figure2",
     "Figure 2",
     "A room: the server adds textures",
     "A radiosity solution gives every vertex a fixed color; both sides draw it antialiased with Gouraud-interpolated "
     "colors, and only the server draws textures. The upper pictures of a pair code H itself; the lower ones code D at "
     "the "
     "quality that makes the file equally long.",
     {"2a", "2b", "2c"}},
    {"figure3",
     "Figure 3",
     "A bowling pin: the server tessellates finely",
     "A bicubic patch mesh is diced twice, as REYES does, and the expensive shading is computed at the vertices of "
     "each. "
     "The client draws few large polygons, the server many small ones; D carries the detail between the coarse "
     "vertices.",
     {"3a", "3b", "3c"}},
    {"figure4",
     "Figure 4",
     "An extruded letter: the partition that does not work well",
     "H is textured, Phong-shaded and antialiased; L is Gouraud-shaded with jagged edges. Subtracting a jagged edge "
     "from a "
     "smooth one leaves an edge in D, and JPEG spends its bits there.",
     {"4f", "4g", "4h"}},
    {"figure5",
     "Figure 5",
     "The same letter, only texture left out",
     "Both sides antialias and interpolate alike, so D holds texture and nothing else.",
     {"5", "", ""}},
    {"antialiasing",
     "No antialiasing",
     "Jagged on both sides, on purpose",
     "The paper’s alternative for clients that cannot antialias: leave it out on the server as well. Edges have "
     "jaggies, but "
     "JPEG does not smear them.",
     {"", "", ""}},
    {"lighting",
     "Lighting",
     "Beyond the paper: the client draws textures, the server sends light",
     "Turned around: the client keeps model and textures and lights them locally, the server sends what the radiosity "
     "solution adds. That difference is smooth, which is what JPEG codes best.",
     {"", "", ""}},
    {"cubes",
     "Cubes",
     "Rotating textured cubes",
     "The scene of the paper’s web page: H has texture, antialiasing and smooth shading, L no texture.",
     {"", "", ""}},
};

const FigureText* find_text(const std::string& key) {
  for (const FigureText& text : kFigureTexts)
    if (text.key == key) return &text;
  return nullptr;
}

void add_pair_arm(FigureBuilder& builder, const FigureSet& set, size_t i, ArmKind kind, const std::string& name) {
  const MatchedPair& pair = set.pairs[i];
  const bool image = kind == ArmKind::image_based;
  builder.add_arm(set.renderings, image ? pair.image_based : pair.polygon_assisted, kind,
                  image ? pair.image_label : pair.assisted_label, name);
}

// The last pair is the one that is enlarged; those before it form two rows. A single pair stands beside H, L and D.
void add_pairs(FigureBuilder& builder, const FigureSet& set) {
  const size_t last = set.pairs.size() - 1;
  if (last > 0) {
    builder.begin_row("Image-based: JPEG of H");
    for (size_t i = 0; i < last; ++i)
      add_pair_arm(builder, set, i, ArmKind::image_based, std::string("image") + std::to_string(i + 1));
    builder.begin_row("Polygon-assisted: L plus JPEG of D, in the bytes of the picture above");
    for (size_t i = 0; i < last; ++i)
      add_pair_arm(builder, set, i, ArmKind::polygon_assisted, std::string("polygon") + std::to_string(i + 1));
    builder.begin_row("The pair of Table I");
  }
  add_pair_arm(builder, set, last, ArmKind::image_based, "image");
  add_pair_arm(builder, set, last, ArmKind::polygon_assisted, "polygon");
  const MatchedPair& pair = set.pairs[last];
  const bool in_table = set.key == "figure2" || set.key == "figure3";
  if (in_table) builder.add_enlargement(set.renderings, pair.image_based, pair.polygon_assisted, ArmKind::image_based);
  builder.add_enlargement(set.renderings, pair.image_based, pair.polygon_assisted, ArmKind::polygon_assisted);
  builder.set_wipe("image", "polygon");
}

void add_figure(const FigureSet& set, IllustratedReport& page) {
  const FigureText* known = find_text(set.key);
  const FigureText text =
      known != nullptr ? *known : FigureText{set.key, set.key.c_str(), set.title.c_str(), "", {"", "", ""}};
  FigureBuilder builder(set.key, text.number, text.title, page.images);
  if (*text.paragraph != 0) builder.figure().paragraphs.emplace_back(text.paragraph);
  builder.add_renderings(set.renderings, text.labels[0], text.labels[1], text.labels[2]);
  if (!set.pairs.empty()) add_pairs(builder, set);
  builder.figure().findings.push_back(figure_finding(set));
  page.report.figures.push_back(std::move(builder.figure()));
}

std::vector<std::string> method_texts() {
  return {
      "Compression ratio: width × height × 3 bytes over the bytes of the file, headers included; in row F the model "
      "counts "
      "as well.",
      "Matched bytes: the quality of the polygon-assisted arm is searched, byte-exactly, for the file size nearest to "
      "the "
      "image-based one. Both arms use the same chroma subsampling (4:2:0, which the paper calls 4:1:1), the same "
      "Huffman "
      "tables (the standard ones for Table I and the figures, as in the IJG software of 1992; optimal ones for the "
      "plots) "
      "and quantization tables of one family.",
      "Quality: the IJG scale, real-valued. D = 127 + (H − L)/2 halves every feature, so tables half as coarse treat "
      "features of D as the unhalved ones would be: quality 15 for H corresponds to 30 for D. The paper states D’s "
      "quality "
      "without undoing that; we give both.",
      "rms and PSNR: over all samples of R, G and B against H, in code values of 0 to 255. SSIM: of luma, against H.",
      "Entropy: first order. The paper does not define its own; we give the mean over R, G and B, that of luma, and "
      "the "
      "joint entropy of whole pixels.",
      "2 Mb/s at 20 frames a second leaves 12,500 bytes a frame.",
      "Model bytes: polygons clipped to the view, 16 bits a coordinate and 8 a color channel, coded without loss "
      "together "
      "with their connectivity. The client draws the decoded model, and so does the server: both pictures are equal, "
      "bit "
      "for bit.",
      "Our scenes follow the paper’s descriptions, but are not its models, which are lost. Compare directions and "
      "ratios, "
      "not digits.",
  };
}

}  // namespace

IllustratedReport demo_report(const PaperResults& results) {
  IllustratedReport page;
  Report& report = page.report;
  report.title = "Polygon-assisted JPEG compression of synthetic images";
  report.subtitle = "Marc Levoy’s experiments of 1995, run again";
  report.abstract = {
      "A rendering server could send each frame as a JPEG file. Levoy proposed to let the client draw what JPEG codes "
      "worst, "
      "edges and smooth shading, and to send only the difference. This page repeats his experiments with a rasterizer, "
      "a JPEG "
      "codec and a geometry codec written for the purpose, and says where the results differ from his."};
  report.highlights = demo_highlights(results);
  report.head_figure = "figure2";
  report.table = results.table1;
  report.table_notes = {
      "In D, quality 15 as in the paper. In E, the quality whose file is nearest to D’s in size, the model resident on "
      "both "
      "machines. In F, the same JPEG file plus the model, compressed without loss; the paper estimates those bytes, we "
      "count "
      "them."};
  for (const FigureSet& set : results.figures) add_figure(set, page);
  report.plots = demo_plots(results);
  report.plot_paragraphs = {
      "Every point is a JPEG file; both arms use optimal Huffman codes here. Lines at 25:1, above which the paper "
      "expects its "
      "method to pay, and at 12,500 bytes, a frame’s share of 2 Mb/s at 20 frames a second.",
      "SSIM jumps where a coarse DC step turns a black background into one that is nearly black: an error of one or "
      "two levels "
      "that nobody sees, but that SSIM counts in full over a large flat area. PSNR beside it does not jump."};
  report.findings = paper_claims(results);
  report.methods = method_texts();
  report.command_lines = {"pac demo -o out", "pac compare room -o room", "pac compare pin --quality 15 --json"};
  report.pages = {{"Animations", "animations.html"}};
  report.footer =
      "After M. Levoy, Polygon-Assisted JPEG and MPEG Compression of Synthetic Images, Proc. SIGGRAPH 95. This page "
      "needs no "
      "network; its pictures are the PNG files beside it.";
  return page;
}

IllustratedReport compare_report(const std::string& title, const Still& still, const std::string& command_line) {
  IllustratedReport page;
  Report& report = page.report;
  report.title = title;
  report.subtitle = "Image-based against polygon-assisted JPEG, split: " + still.renderings.split.name;
  FigureBuilder builder("still", "One still", "Both arms at matched bytes", page.images);
  builder.add_renderings(still.renderings, "", "", "");
  builder.add_arm(still.renderings, still.image_based, ArmKind::image_based, "", "image");
  builder.add_arm(still.renderings, still.polygon_assisted, ArmKind::polygon_assisted, "", "polygon");
  for (const ArmKind kind : {ArmKind::image_based, ArmKind::polygon_assisted})
    builder.add_enlargement(still.renderings, still.image_based, still.polygon_assisted, kind);
  builder.set_wipe("image", "polygon");
  report.highlights = still_highlights(still);
  report.figures.push_back(std::move(builder.figure()));
  report.command_lines = {command_line};
  report.methods = method_texts();
  return page;
}

}  // namespace pac::sim
