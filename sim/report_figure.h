// From experiments to figures: captions, enlargements, file names. Shared by the demo's page and compare's.
#pragma once

#include <string>
#include <vector>

#include "sim/experiment.h"
#include "sim/report_demo.h"

namespace pac::sim {

// Builds one ReportFigure and the list of its image files.
class FigureBuilder {
 public:
  // key: prefix of ids and files, [a-z0-9-]; images: where the files are listed.
  FigureBuilder(std::string key, std::string number, std::string title, std::vector<ReportImage>& images);

  // The row H, L, D; labels: the paper's letters, or "".
  void add_renderings(const Renderings& renderings, const std::string& high_label, const std::string& low_label,
                      const std::string& difference_label);

  // A row of one picture an arm, each coded from `renderings`.
  void begin_row(const std::string& label);
  void add_arm(const Renderings& renderings, const Arm& arm, ArmKind kind, const std::string& label,
               const std::string& name);

  // Enlarges the place where `kind` fails most, 128 pixels wide, from H and both arms. The figure's pictures "h",
  // "image" and "polygon" are those of this pair.
  void add_enlargement(const Renderings& renderings, const Arm& image_based, const Arm& polygon_assisted, ArmKind kind);

  void set_wipe(const std::string& left, const std::string& right);
  ReportFigure& figure() { return figure_; }
  std::string id_of(const std::string& name) const { return key_ + "-" + name; }

 private:
  ReportPicture& add_picture(const std::string& name, ConstRgbView image);
  std::string key_;
  ReportFigure figure_;
  std::vector<ReportImage>& images_;
};

// "q 36.2 (18.1 with the division by two undone)", or "q 15".
std::string quality_text(const Arm& arm, ArmKind kind);
// "9,836 bytes, 80:1".
std::string size_text(const Arm& arm);
// "rms 6.1, PSNR 32.4 dB, SSIM 0.912".
std::string scores_text(const Scores& scores);

// "15", "36.2": at most one digit after the point.
std::string short_quality(double quality);

// Upper left corner of the size x size window with the largest sum of squared differences: where `test` is worst.
struct Place {
  int x = 0, y = 0;
};
Place worst_place(ConstRgbView reference, ConstRgbView test, int size);

}  // namespace pac::sim
