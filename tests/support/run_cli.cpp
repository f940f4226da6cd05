#include "tests/support/run_cli.h"

#include <dirent.h>
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace pac::test {
namespace {

constexpr const char* kOut = ".stdout";
constexpr const char* kErr = ".stderr";

std::vector<std::string> entries(const std::string& folder) {
  std::vector<std::string> names;
  DIR* stream = opendir(folder.c_str());
  REQUIRE(stream != nullptr);
  while (const dirent* entry = readdir(stream)) names.emplace_back(entry->d_name);
  closedir(stream);
  std::sort(names.begin(), names.end());
  return names;
}

void remove_tree(const std::string& folder) {
  for (const std::string& name : entries(folder)) {
    if (name == "." || name == "..") continue;
    const std::string path = folder + "/" + name;
    struct stat info;
    if (lstat(path.c_str(), &info) == 0 && S_ISDIR(info.st_mode))
      remove_tree(path);
    else
      unlink(path.c_str());
  }
  rmdir(folder.c_str());
}

}  // namespace

CliFolder::CliFolder() {
  const char* base = std::getenv("TMPDIR");
  std::string name = std::string(base != nullptr ? base : "/tmp") + "/pac_cli_XXXXXX";
  REQUIRE(mkdtemp(name.data()) != nullptr);
  folder_ = name;
}

CliFolder::~CliFolder() {
  remove_tree(folder_);
}

CliRun CliFolder::shell(const std::string& command) const {
  const char* binary = std::getenv("PAC_CLI");
  REQUIRE_MESSAGE(binary != nullptr, "PAC_CLI names the pac binary; CTest sets it");
  // $PAC stays unquoted in commands: under qemu-user it is an emulator and a path.
  const std::string line =
      std::string("cd '") + folder_ + "' && PAC='" + binary + "' && { " + command + "; } >" + kOut + " 2>" + kErr;
  CliRun run;
  const int status = std::system(line.c_str());
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  run.out = read(kOut);
  run.err = read(kErr);
  return run;
}

CliRun CliFolder::pac(const std::string& arguments, const std::string& before) const {
  return shell(before + "$PAC " + arguments);
}

bool CliFolder::exists(const std::string& name) const {
  return access(path(name).c_str(), F_OK) == 0;
}

std::vector<std::string> CliFolder::files() const {
  std::vector<std::string> names;
  for (const std::string& name : entries(folder_))
    if (name != "." && name != ".." && name != kOut && name != kErr) names.push_back(name);
  return names;
}

void CliFolder::write(const std::string& name, const std::string& content) const {
  REQUIRE(write_file(path(name), {reinterpret_cast<const uint8_t*>(content.data()), content.size()}).ok());
}

std::string CliFolder::read(const std::string& name) const {
  const auto bytes = read_file(path(name));
  return bytes.ok() ? std::string(bytes->begin(), bytes->end()) : "";
}

}  // namespace pac::test
