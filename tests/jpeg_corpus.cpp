// Other people's files: PAC_JPEG_CORPUS names a folder of them (tests/fetch_jpeg_corpus.sh fills one).
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "base/image_io.h"
#include "jpeg/jpeg.h"
#include "tests/support/jpeg_file.h"
#include "tests/support/peer.h"

namespace pac::test {
namespace {

std::vector<std::string> files_under(const char* folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path().string());
  std::sort(files.begin(), files.end());
  return files;
}

std::string quoted(const std::string& path) {
  std::string out = "'";
  for (const char c : path) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

struct Counts {
  int equal = 0, within_one = 0, refused = 0, unsupported = 0, lenient = 0;
};

void check_file(const std::string& path, const TempDir& dir, Counts& counts) {
  CAPTURE(path);
  const auto bytes = read_bytes(path);
  const auto info = jpeg::read_info(bytes);
  const auto ours = jpeg::decode(bytes);
  const auto lenient = jpeg::decode_lenient(bytes);
  if (!ours.ok()) {
    CHECK(std::strlen(ours.failure().text) > 0);
    CHECK(ours.failure().byte_offset <= bytes.size());
  }
  if (info.ok() && info->unsupported != nullptr) {
    CHECK(ours.failure().error == Error::unsupported);
    counts.unsupported += 1;
    return;
  }
  // djpeg's exit codes: 0 sound, 1 refused, 2 decoded with warnings.
  const int code = run("djpeg -pnm -maxmemory 1000000 -outfile " + dir.file("d.pnm") + " " + quoted(path));
  if (code == 0) {
    CHECK(ours.ok());
  } else if (!ours.ok()) {
    counts.refused += 1;
  }
  if (!ours.ok() && (code == 1 || !lenient.ok())) return;
  const auto theirs = decode_rgb(read_bytes(dir.file("d.pnm")));
  REQUIRE(theirs.ok());
  const int difference = max_difference(ours.ok() ? ours->view() : lenient->image.view(), theirs->view());
  // Of a progressive file without its last scans djpeg guesses some coefficients ("block smoothing"); we do not.
  const bool lacks_scans = path.find("progressive.truncated") != std::string::npos;
  if (ours.ok()) CHECK(difference <= (lacks_scans ? 8 : 1));
  (!ours.ok() ? counts.lenient : difference == 0 ? counts.equal : counts.within_one) += 1;
}

TEST_CASE("we see in other people's files what djpeg sees, and refuse by name what we cannot read") {
  const char* folder = std::getenv("PAC_JPEG_CORPUS");
  if (folder == nullptr) {
    MESSAGE("skipped: PAC_JPEG_CORPUS names no folder of JPEG files");
    return;
  }
  if (!have_peer("djpeg")) return;
  TempDir dir;
  Counts counts;
  const auto files = files_under(folder);
  REQUIRE_FALSE(files.empty());
  for (const auto& path : files) check_file(path, dir, counts);
  MESSAGE(files.size(), " files: ", counts.equal, " decoded equal to djpeg, ", counts.within_one, " within 1 level, ",
          counts.unsupported, " unsupported, ", counts.refused, " damaged (", counts.lenient,
          " of them decoded leniently)");
  CHECK(counts.equal + counts.within_one > 0);
}

}  // namespace
}  // namespace pac::test
