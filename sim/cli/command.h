// What the subcommands share: exit codes, messages, output, progress. One file per subcommand; main.cpp lists them.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "base/file_io.h"
#include "base/result.h"
#include "sim/cli/options.h"
#include "sim/json.h"

namespace pac::cli {

constexpr int kDone = 0;
constexpr int kBadData = 1;
constexpr int kBadUsage = 2;

// Each parses its arguments (those after the command's name), works, and returns the exit code.
int run_demo(Args args);
int run_render(Args args);
int run_compare(Args args);
int run_jpeg_encode(Args args);
int run_jpeg_decode(Args args);
int run_jpeg_transcode(Args args);
int run_jpeg_info(Args args);
int run_mpeg1_encode(Args args);
int run_mpeg1_decode(Args args);
int run_mpeg1_info(Args args);
int run_geom_encode(Args args);
int run_geom_decode(Args args);
int run_geom_info(Args args);
int run_animate(Args args);
int run_sweep(Args args);
int run_metrics(Args args);
int run_scenes(Args args);
int run_isa(Args args);

// Prints "pac: FILE: what is wrong (at byte N)"; returns kBadData. The offset is left out where it has no meaning.
int data_error(const std::string& file, const Failure& failure);
int data_error(const std::string& file, const std::string& problem);

// Prints "pac: FILE: warning: TEXT" on stderr.
void warn(const std::string& file, const std::string& text);

// write_file with the message; kDone or kBadData.
int write_output(const std::string& path, std::span<const uint8_t> bytes);
int write_output(const std::string& path, const std::string& text);

// The object and a newline on stdout.
int print_json(const sim::JsonWriter& json);

// ".png" of "out/a.PNG": lower case, empty where the last component has none.
std::string extension(const std::string& path);

// "12,345": thousands apart.
std::string grouped(uint64_t number);

// Wall clock since construction.
class Stopwatch {
 public:
  double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// A bar with an ETA on stderr where that is a terminal, nothing otherwise. The destructor wipes it.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // done: part of the work, 0..1; what: a few words.
  void show(double done, const char* what);

 private:
  Stopwatch clock_;
  bool active_;
  bool drawn_ = false;
};

}  // namespace pac::cli
