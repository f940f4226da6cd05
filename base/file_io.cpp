#include "base/file_io.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

namespace pac {
namespace {

Result<Bytes> read_stream(std::FILE* stream, const Limits& limits) {
  Bytes bytes;
  size_t size = 0;
  while (true) {
    if (size == bytes.size()) bytes.resize(bytes.empty() ? size_t{1} << 16 : 2 * bytes.size());
    const size_t n = std::fread(bytes.data() + size, 1, bytes.size() - size, stream);
    if (n == 0) break;
    size += n;
    if (size > limits.max_bytes) return Failure{Error::limit_exceeded, size, "file is longer than the limit"};
  }
  if (std::ferror(stream) != 0) return Failure{Error::io, size, "cannot read"};
  bytes.resize(size);
  return bytes;
}

bool write_stream(std::FILE* stream, std::span<const uint8_t> bytes) {
  // An empty span may hold a null pointer, which fwrite must not be given.
  const bool written = bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size();
  return written && std::fflush(stream) == 0;
}

// A device or pipe such as /dev/null is written to: a rename would put a file in its place.
bool is_special_file(const std::string& path) {
  struct stat info;
  return stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

bool write_in_place(const std::string& path, std::span<const uint8_t> bytes) {
  std::FILE* stream = std::fopen(path.c_str(), "wb");
  if (stream == nullptr) return false;
  const bool written = write_stream(stream, bytes);
  return std::fclose(stream) == 0 && written;
}

}  // namespace

Result<Bytes> read_file(const std::string& path, const Limits& limits) {
  if (path == "-") return read_stream(stdin, limits);
  struct stat info;
  if (stat(path.c_str(), &info) != 0) return Failure{Error::io, 0, errno == ENOENT ? "no such file" : "cannot open"};
  if (S_ISDIR(info.st_mode)) return Failure{Error::io, 0, "is a directory"};
  std::FILE* stream = std::fopen(path.c_str(), "rb");
  if (stream == nullptr) return Failure{Error::io, 0, "cannot open"};
  auto bytes = read_stream(stream, limits);
  std::fclose(stream);
  return bytes;
}

Result<void> write_file(const std::string& path, std::span<const uint8_t> bytes) {
  const Failure failure{Error::io, 0, "cannot write"};
  if (path == "-") return write_stream(stdout, bytes) ? Result<void>{} : Result<void>{failure};
  if (is_special_file(path)) return write_in_place(path, bytes) ? Result<void>{} : Result<void>{failure};
  const std::string temporary = path + ".tmp" + std::to_string(static_cast<long>(getpid()));
  std::FILE* stream = std::fopen(temporary.c_str(), "wb");
  if (stream == nullptr) return failure;
  const bool written = write_stream(stream, bytes);
  if (std::fclose(stream) != 0 || !written || std::rename(temporary.c_str(), path.c_str()) != 0) {
    std::remove(temporary.c_str());
    return failure;
  }
  return {};
}

}  // namespace pac
