// Table I of [Levoy95], row by row: the paper's figures beside ours.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "sim/experiment.h"

namespace pac::sim {

// One line of the table.
struct Table1Row {
  char section = 'A';      // A..F
  const char* key = "";    // stable name for machines: "high_entropy_bits_per_pixel"
  const char* label = "";  // the paper's words
  const char* unit = "";
  int decimals = 0;             // digits to print
  std::optional<double> paper;  // absent where the row is ours alone
  double ours = 0;
  const char* note = "";  // what differs and why, where it does
};

// A comparison that the paper's text claims of its own table, checked on ours.
struct Table1Claim {
  const char* key = "";
  const char* text = "";
  bool paper_holds = true;  // in the paper's own numbers
  bool ours_holds = false;
};

struct Table1Column {
  std::string scene;  // "room" or "pin"
  int width = 0, height = 0;
  std::vector<Table1Row> rows;  // the same keys in the same order for every scene
  std::vector<Table1Claim> claims;
};

struct Table1 {
  std::vector<Table1Column> columns;
};

// The column of one scene. `still`: run_still's matched pair with the model resident (rows A-E); `transmitted`:
// run_transmitted's at row E's quality (row F). The paper's figures go in where scene is "room" or "pin".
Table1Column make_table1_column(const std::string& scene, const Still& still, const Still& transmitted);

// {"columns": [{"scene", "width", "height", "rows": [{"section", "key", "label", "unit", "paper"|null, "ours",
// "note"}], "claims": [...]}]} and section,label,unit,room paper,room ours,... with one line a row.
std::string table1_json(const Table1& table);
std::string table1_csv(const Table1& table);

}  // namespace pac::sim
