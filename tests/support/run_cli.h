// Runs the `pac` binary that the environment variable PAC_CLI names, in a folder of its own.
#pragma once

#include <string>
#include <vector>

#include "base/file_io.h"

namespace pac::test {

struct CliRun {
  int code = -1;
  std::string out, err;
};

// A fresh folder for files; removed with everything in it at the end.
class CliFolder {
 public:
  CliFolder();
  ~CliFolder();
  CliFolder(const CliFolder&) = delete;
  CliFolder& operator=(const CliFolder&) = delete;

  // "pac ARGUMENTS" through the shell, inside the folder. `before` may set variables or feed a pipe: "PAC_ISA=x ".
  CliRun pac(const std::string& arguments, const std::string& before = "") const;
  // A whole shell command line in which $PAC is the binary.
  CliRun shell(const std::string& command) const;

  std::string path(const std::string& name) const { return folder_ + "/" + name; }
  bool exists(const std::string& name) const;
  std::vector<std::string> files() const;  // names, sorted, without those of the harness
  void write(const std::string& name, const std::string& content) const;
  std::string read(const std::string& name) const;  // empty where there is no such file

 private:
  std::string folder_;
};

}  // namespace pac::test
