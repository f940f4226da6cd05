// A page and its pictures as files in a folder.
#pragma once

#include <string>

#include "sim/cli/command.h"
#include "sim/report_demo.h"

namespace pac::cli {

// Makes the folder (and those above it) where it is missing, writes the pictures as PNG on all threads, the page itself
// last, so that it never names a picture that is not there. kDone, or kBadData after the message.
int write_report(const std::string& folder, const sim::IllustratedReport& page, const Options& options,
                 const char* name = "index.html");

// mkdir -p. kDone, or kBadData after the message.
int make_folder(const std::string& folder);

}  // namespace pac::cli
