// Runs a fuzz target on damaged copies of the files in a folder: every strict prefix of each, then random corruptions,
// COUNT in all: bytes changed, removed, doubled, swapped with other places, tails of other files. The same ones for the
// same seed everywhere. Usage: corrupt_NAME FOLDER COUNT [SEED]
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/generators.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size);

namespace {

using File = std::vector<uint8_t>;

std::vector<File> read_folder(const char* folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  std::vector<File> files;
  for (const std::string& path : paths) {
    std::ifstream in(path, std::ios::binary);
    files.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  }
  return files;
}

size_t below(pac::test::Random& random, size_t n) {
  return n == 0 ? 0 : static_cast<size_t>(random.next() % n);
}

void damage(File& file, const File& other, pac::test::Random& random) {
  const size_t at = below(random, file.size()), n = below(random, std::min<size_t>(16, file.size() - at)) + 1;
  const auto begin = file.begin() + static_cast<ptrdiff_t>(at);
  const auto end = begin + static_cast<ptrdiff_t>(std::min(n, file.size() - at));
  switch (random.next() % 6) {
    case 0:
      *begin = static_cast<uint8_t>(*begin ^ (1u << (random.next() & 7)));
      break;
    case 1:
      *begin = static_cast<uint8_t>(random.next());
      break;
    case 2:
      *begin = random.next() % 2 == 0 ? uint8_t{0xFF} : uint8_t{0};
      break;
    case 3:
      file.erase(begin, end);
      break;
    case 4: {
      const File part(begin, end);
      file.insert(begin, part.begin(), part.end());
      break;
    }
    default: {
      const auto from = other.begin() + static_cast<ptrdiff_t>(below(random, other.size()));
      file.erase(begin, file.end());
      file.insert(file.end(), from, other.end());
    }
  }
}

// Exactly sized, so that AddressSanitizer sees a read beyond it.
void try_file(const File& file) {
  const File exact(file.begin(), file.end());
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: corrupt_NAME FOLDER COUNT [SEED]\n");
    return 2;
  }
  const std::vector<File> files = read_folder(argv[1]);
  const long count = std::atol(argv[2]);
  pac::test::Random random(argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1);
  long tried = 0;
  // Of few corruptions some prefixes, of many all.
  size_t total = 0;
  for (const File& file : files) total += file.size();
  const size_t step = total / (static_cast<size_t>(count) / 4 + 1) + 1;
  for (const File& file : files)
    for (size_t n = 0; n < file.size(); n += step, ++tried)
      try_file({file.begin(), file.begin() + static_cast<ptrdiff_t>(n)});
  for (; tried < count; ++tried) {
    File file = files[below(random, files.size())];
    const File& other = files[below(random, files.size())];
    for (uint64_t i = random.next() % 4 + 1; i > 0 && !file.empty(); --i) damage(file, other, random);
    try_file(file);
  }
  std::printf("%ld damaged files of %zu, every %zu-th prefix among them\n", tried, files.size(), step);
  return files.empty() ? 1 : 0;
}
