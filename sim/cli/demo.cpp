// `pac demo`: the paper's experiments, as two pages, pictures, streams, and Table I.
#include <cstdio>

#include "sim/cli/animate_files.h"
#include "sim/cli/command.h"
#include "sim/cli/report_files.h"
#include "sim/paper_figures.h"
#include "sim/report_animations.h"
#include "sim/report_demo.h"
#include "sim/report_markup.h"

namespace pac::cli {
namespace {

std::string cell(const sim::Table1Row& row, double value) {
  return sim::decimal_text(value, row.decimals) + (std::string(row.unit) == ":1" ? ":1" : "");
}

void print_claims(const sim::Table1& table) {
  for (const sim::Table1Column& column : table.columns)
    for (const sim::Table1Claim& claim : column.claims)
      if (claim.paper_holds != claim.ours_holds)
        std::printf("against the paper: %s: %s (%s in the paper, %s here)\n", column.scene.c_str(), claim.text,
                    claim.paper_holds ? "holds" : "does not hold", claim.ours_holds ? "holds" : "does not hold");
}

void print_table(const sim::Table1& table) {
  std::printf("Table I%54s", "");
  for (const sim::Table1Column& column : table.columns) std::printf("%12s %12s", column.scene.c_str(), "");
  std::printf("\n%61s", "");
  for (size_t i = 0; i < table.columns.size(); ++i) std::printf("%12s %12s", "paper", "ours");
  std::printf("\n");
  for (size_t i = 0; i < table.columns[0].rows.size(); ++i) {
    const sim::Table1Row& row = table.columns[0].rows[i];
    const std::string unit = std::string(row.unit) == ":1" || *row.unit == 0 ? "" : std::string(", ") + row.unit;
    std::printf("%c  %-58.58s", row.section, (row.label + unit).c_str());
    for (const sim::Table1Column& column : table.columns) {
      const sim::Table1Row& entry = column.rows[i];
      std::printf("%12s %12s", entry.paper ? cell(entry, *entry.paper).c_str() : "-", cell(entry, entry.ours).c_str());
    }
    std::printf("\n");
  }
}

using AnimationSets = std::vector<sim::AnimationSet>;

int write_animations(const std::string& folder, const AnimationSets& sets, const Options& options) {
  for (const sim::AnimationSet& set : sets)
    for (const sim::AnimationStreams& streams : set.streams) {
      const std::string path = folder + "/" + sim::streams_folder(set, streams);
      if (const int code = make_folder(path); code != kDone) return code;
      const int code = write_streams(path, streams.codec, set.frames_per_second, streams.image, streams.difference);
      if (code != kDone) return code;
      if (const int last = write_output(path + "/session.pacs", streams.session); last != kDone) return last;
    }
  return write_report(folder, sim::animations_report(sets), options, "animations.html");
}

int write_everything(const std::string& folder, const sim::PaperResults& results, const AnimationSets& animations,
                     const Options& options) {
  if (const int code = write_animations(folder, animations, options); code != kDone) return code;
  if (const int code = write_report(folder, sim::demo_report(results), options); code != kDone) return code;
  if (const int code = write_output(folder + "/table1.csv", sim::table1_csv(results.table1)); code != kDone)
    return code;
  return write_output(folder + "/table1.json", sim::table1_json(results.table1));
}

}  // namespace

int run_demo(Args args) {
  Options options("demo", "runs the paper's experiments on the built-in scenes and writes a page about them",
                  "pac demo -o out");
  std::string folder = "out";
  options.text("-o|--output", "DIR", folder,
               "index.html, animations.html, pictures, streams, table1.csv, table1.json (out)");
  if (const auto code = options.parse(args)) return *code;
  if (const int code = make_folder(folder); code != kDone) return code;
  const Stopwatch clock;
  sim::PaperOptions paper;
  paper.threads = options.threads;
  paper.isa = options.isa;
  {
    Progress progress(options.quiet);
    paper.progress = [&](const char* step, int done, int total) {
      progress.show(static_cast<double>(done) / total, step);
    };
    auto results = sim::run_paper(paper);
    if (!results.ok()) return data_error("demo", results.failure());
    const auto animations = sim::run_paper_animations(paper);
    if (!animations.ok()) return data_error("demo", animations.failure());
    progress.show(1, "writing");
    if (const int code = write_everything(folder, *results, *animations, options); code != kDone) return code;
    if (options.json) return write_output("-", sim::table1_json(results->table1));
    print_table(results->table1);
    print_claims(results->table1);
  }
  if (!options.quiet)
    std::printf(
        "\n%.0f s. Look at %s/index.html and %s/animations.html; the table is also in %s/table1.csv and "
        "%s/table1.json\n",
        clock.ms() / 1000, folder.c_str(), folder.c_str(), folder.c_str(), folder.c_str());
  return kDone;
}

}  // namespace pac::cli
