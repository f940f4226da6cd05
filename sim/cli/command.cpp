#include "sim/cli/command.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace pac::cli {

int data_error(const std::string& file, const std::string& problem) {
  std::fprintf(stderr, "pac: %s: %s\n", file.c_str(), problem.c_str());
  return kBadData;
}

int data_error(const std::string& file, const Failure& failure) {
  std::string problem = failure.text;
  const bool has_place = failure.error == Error::truncated || failure.error == Error::corrupt ||
                         failure.error == Error::unsupported || failure.error == Error::limit_exceeded;
  if (has_place) problem += std::string(" (at byte ") + std::to_string(failure.byte_offset) + ")";
  return data_error(file == "-" ? "standard input" : file, problem);
}

void warn(const std::string& file, const std::string& text) {
  std::fprintf(stderr, "pac: %s: warning: %s\n", file.c_str(), text.c_str());
}

int write_output(const std::string& path, std::span<const uint8_t> bytes) {
  const auto written = write_file(path, bytes);
  return written.ok() ? kDone : data_error(path == "-" ? "standard output" : path, written.failure());
}

int write_output(const std::string& path, const std::string& text) {
  return write_output(path, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

int print_json(const sim::JsonWriter& json) {
  return write_output("-", json.text() + "\n");
}

std::string extension(const std::string& path) {
  const size_t slash = path.rfind('/');
  const size_t dot = path.rfind('.');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return "";
  std::string lower = path.substr(dot);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

std::string grouped(uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

Progress::Progress(bool quiet) : active_(!quiet && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (drawn_) std::fprintf(stderr, "\r%79s\r", "");
}

void Progress::show(double done, const char* what) {
  if (!active_) return;
  constexpr int kCells = 28;
  done = std::clamp(done, 0.0, 1.0);
  std::string bar(static_cast<size_t>(done * kCells), '#');
  bar.resize(kCells, '.');
  char eta[32] = "";
  if (done > 0.02) std::snprintf(eta, sizeof eta, "%.0f s left", clock_.ms() / 1000 * (1 - done) / done);
  std::fprintf(stderr, "\r[%s] %3.0f %% %-11s %-24.24s", bar.c_str(), 100 * done, eta, what);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace pac::cli
