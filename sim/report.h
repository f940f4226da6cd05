// The web page of a run: a document model, and the one HTML file that shows it. The page needs no network and no
// server: styles, script and plots are inside, pictures are files beside it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/report_plot.h"
#include "sim/table1.h"

namespace pac::sim {

enum class PictureArm : uint8_t { none, image_based, polygon_assisted };

// A picture file that the page shows. Texts are plain, without markup.
struct ReportPicture {
  std::string id;       // unique in the page, [a-z0-9-]
  std::string file;     // relative to the page
  std::string label;    // "2d": the paper's letter where it has one
  std::string title;    // "Image-based, q 15"
  std::string caption;  // "9,836 B, 80:1"
  std::string details;  // more figures of merit, shown beside the wipe
  std::string alt;
  int width = 0, height = 0;  // pixels
  PictureArm arm = PictureArm::none;
  int frames = 1;              // more: the file holds them one below the other, the page plays them over and over
  int frames_per_second = 20;  // of these
};

// A file beside the page, or another page.
struct ReportLink {
  std::string text, file;
};

// Pictures side by side.
struct ReportRow {
  std::string label;
  std::vector<ReportPicture> pictures;
};

// A part of a picture of the same figure, enlarged with sharp pixels as in figures 2l and 2m.
struct ReportCrop {
  std::string picture_id;                   // its label and title stand below
  std::string caption;                      // which part, in words
  int x = 0, y = 0, width = 0, height = 0;  // pixels of the picture
};

// How a finding relates to the paper's.
enum class Verdict : uint8_t { none, agrees, differs, against };

struct ReportFinding {
  Verdict verdict = Verdict::none;
  std::string claim;  // the paper's, with its section
  std::string ours;   // what this run measured
};

struct ReportFigure {
  std::string id;      // anchor
  std::string number;  // "Figure 2"
  std::string title;
  std::vector<std::string> paragraphs;
  std::vector<ReportRow> rows;
  std::string wipe_left, wipe_right;  // ids that the wipe starts with; empty = no wipe
  std::vector<ReportCrop> crops;      // in rows of three
  std::vector<ReportFinding> findings;
  std::vector<ReportLink> files;  // to be played or read elsewhere
};

// One number of the page's head.
struct ReportHighlight {
  std::string value, text;
};

struct Report {
  std::string title, subtitle;
  std::vector<std::string> abstract;
  std::vector<ReportHighlight> highlights;
  std::string head_figure;               // id of the figure whose wipe also stands in the page's head, or empty
  Table1 table;                          // shown where it has columns
  std::vector<std::string> table_notes;  // what differs and why, for all rows
  std::vector<ReportFigure> figures;
  std::vector<std::string> plot_paragraphs;
  std::vector<Plot> plots;
  std::vector<ReportFinding> findings;     // the paper's claims, one by one
  std::vector<std::string> methods;        // how each figure of merit is defined
  std::vector<std::string> command_lines;  // what reproduces the page
  std::string footer;
  std::vector<ReportLink> pages;  // at the end of the contents
};

// The whole file, UTF-8.
std::string report_html(const Report& report);

}  // namespace pac::sim
