// Other programs as judges: whether one is installed, running it, files for it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pac::test {

// True if `program` is on the PATH. Where it is missing: a failure in CI (environment CI=true), else a message that the
// test is skipped.
bool have_peer(const char* program);

// Runs a shell command; its exit code, or -1. Standard error is dropped.
int run(const std::string& command);

// The command's standard output and error together; empty if it could not run.
std::string output_of(const std::string& command);

// A folder that is removed with its files at the end.
class TempDir {
 public:
  TempDir();
  ~TempDir();
  TempDir(const TempDir&) = delete;
  TempDir& operator=(const TempDir&) = delete;
  std::string file(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// Whole files; a failure of the running test where that is impossible.
std::vector<uint8_t> read_bytes(const std::string& path);
void write_bytes(const std::string& path, std::span<const uint8_t> bytes);

}  // namespace pac::test
