// The files of `pac sweep`: tables, plots and page in a folder; the parts of a sweep from folders.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/sweep.h"
#include "sim/sweep_gain.h"

namespace pac::cli {

// "sweep.csv", or "sweep-2-of-8.csv": shards may share a folder.
std::string sweep_file(const char* stem, const sim::SweepShard& shard);

// sweep.csv, gains.csv, a .svg a plot, index.html last. The folder is there. kDone, or kBadData after the message.
int write_sweep(const std::string& folder, const sim::SweepTable& table, const sim::SweepGains& gains);

// A whole sweep, and the lines of its files of times.
struct SweepParts {
  sim::SweepTable table;
  std::string times_csv;
};

// Every sweep-I-of-N.csv of the folders, or where a folder has none, its sweep.csv, joined; times where they are there.
// Empty after a message: a file that is no part of this sweep, a job that is missing or there twice.
std::optional<SweepParts> read_sweeps(const std::vector<std::string>& folders);

}  // namespace pac::cli
