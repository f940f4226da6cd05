#include "tests/support/peer.h"

#include <doctest/doctest.h>
#include <stdlib.h>
#include <sys/wait.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "base/file_io.h"

namespace pac::test {

bool have_peer(const char* program) {
  if (run("command -v " + std::string(program) + " >/dev/null") == 0) return true;
  const char* ci = std::getenv("CI");
  if (ci != nullptr && std::string_view(ci) == "true") {
    FAIL_CHECK("the peer program is missing: ", program);
  } else {
    MESSAGE("skipped: the peer program is not installed: ", program);
  }
  return false;
}

int run(const std::string& command) {
  const int status = std::system(("( " + command + " ) 2>/dev/null").c_str());
  return status != -1 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string output_of(const std::string& command) {
  std::FILE* pipe = popen(("( " + command + " ) 2>&1").c_str(), "r");
  if (pipe == nullptr) return {};
  std::string output;
  char buffer[4096];
  for (size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) output.append(buffer, n);
  pclose(pipe);
  return output;
}

TempDir::TempDir() {
  std::string pattern = (std::filesystem::temp_directory_path() / "pac-test-XXXXXX").string();
  REQUIRE(mkdtemp(pattern.data()) != nullptr);
  path_ = pattern;
}

TempDir::~TempDir() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<uint8_t> read_bytes(const std::string& path) {
  auto bytes = read_file(path);
  CAPTURE(path);
  REQUIRE(bytes.ok());
  return std::move(*bytes);
}

void write_bytes(const std::string& path, std::span<const uint8_t> bytes) {
  CAPTURE(path);
  REQUIRE(write_file(path, bytes).ok());
}

}  // namespace pac::test
