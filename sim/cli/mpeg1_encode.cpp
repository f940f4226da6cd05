// `pac mpeg1 encode`.
#include <algorithm>
#include <cstdio>
#include <deque>
#include <optional>
#include <vector>

#include "base/y4m.h"
#include "mpeg1/mpeg1.h"
#include "mpeg1/repeats.h"
#include "mpeg1/system.h"
#include "sim/cli/command.h"

namespace pac::cli {
namespace {

struct EncodeSettings {
  std::string in, out;
  mpeg1::SequenceOptions sequence;
  int bit_rate_bps = 0;
  int look_ahead = -1;  // frames; -1: the group, but not where encoding is to be fast
};

int look_ahead_frames(const EncodeSettings& settings, int rate) {
  if (settings.look_ahead >= 0) return settings.look_ahead;
  if (settings.sequence.effort == mpeg1::Effort::fast) return 0;
  const int legal_rate = mpeg1::kPictureRatesMilli[settings.sequence.picture_rate_code];
  return (settings.sequence.gop_length - 1) * std::min(rate, legal_rate) / legal_rate;  // others are repeated pictures
}

// Frames of a clip, and those that come after the one in work.
class FrameWindow {
 public:
  FrameWindow(Y4mReader& reader, int look_ahead) : reader_(reader), look_ahead_(static_cast<size_t>(look_ahead)) {}

  // The next frame; null where the clip ends. It stays until the next call.
  Result<const Frame420*> next() {
    if (!frames_.empty()) frames_.pop_front();
    while (!is_over_ && frames_.size() <= look_ahead_) {
      Frame420 frame;
      PAC_TRY(const bool more, reader_.next(frame));
      is_over_ = !more;
      if (more) frames_.push_back(std::move(frame));
    }
    following_.clear();
    for (size_t i = 1; i < frames_.size(); ++i) following_.push_back(&frames_[i]);
    return frames_.empty() ? nullptr : &frames_[0];
  }
  const std::vector<const Frame420*>& following() const { return following_; }

 private:
  Y4mReader& reader_;
  size_t look_ahead_;
  bool is_over_ = false;
  std::deque<Frame420> frames_;
  std::vector<const Frame420*> following_;
};

// Frames in 1000 seconds, at least one; those of NTSC where the header tells none.
int rate_milli(const Y4mHeader& header) {
  if (header.rate_numerator == 0 || header.rate_denominator == 0) return 29970;
  const int64_t milli = (int64_t{header.rate_numerator} * 1000 + header.rate_denominator / 2) / header.rate_denominator;
  return static_cast<int>(std::clamp<int64_t>(milli, 1, 60000));
}

int print_summary(const Options& options, const EncodeSettings& settings, uint64_t frames, uint64_t repeated,
                  uint64_t bytes) {
  if (!options.json) return kDone;
  sim::JsonWriter json;
  json.begin_object();
  json.field("width", settings.sequence.width);
  json.field("height", settings.sequence.height);
  json.field("frames", frames);
  json.field("repeated_pictures", repeated);
  json.field("bytes", bytes);
  json.end_object();
  return print_json(json);
}

int encode(const Options& options, EncodeSettings settings) {
  const auto bytes = read_file(settings.in);
  if (!bytes.ok()) return data_error(settings.in, bytes.failure());
  auto reader = Y4mReader::open(*bytes);
  if (!reader.ok()) return data_error(settings.in, reader.failure());
  settings.sequence.width = reader->header().width;
  settings.sequence.height = reader->header().height;
  const int rate = rate_milli(reader->header());
  settings.sequence.picture_rate_code = mpeg1::picture_rate_code(rate);
  settings.sequence.bit_rate_bps = settings.bit_rate_bps;
  settings.sequence.threads = options.threads;
  auto encoder = mpeg1::Encoder::create(settings.sequence, options.isa);
  if (!encoder.ok()) return data_error(settings.in, encoder.failure());
  std::vector<uint8_t> out;
  uint64_t frames = 0, repeated = 0;
  Progress progress(options.quiet || options.json);
  FrameWindow window(*reader, look_ahead_frames(settings, rate));
  for (;;) {
    const auto frame = window.next();
    if (!frame.ok()) return data_error(settings.in, frame.failure());
    if (*frame == nullptr) break;
    mpeg1::PictureOptions picture;
    picture.following = window.following();
    const auto report = encoder->add(**frame, out, picture);
    if (!report.ok()) return data_error(settings.in, report.failure());
    ++frames;
    // So that a clip slower than any legal picture_rate keeps its duration.
    for (; mpeg1::is_repeat_due(frames + repeated, frames, static_cast<uint64_t>(rate),
                                settings.sequence.picture_rate_code);
         ++repeated)
      if (const auto again = encoder->repeat(out); !again.ok()) return data_error(settings.in, again.failure());
    const double bytes_a_frame = static_cast<double>(settings.sequence.width) * settings.sequence.height * 1.5;
    progress.show(std::min(1.0, static_cast<double>(frames) * bytes_a_frame / static_cast<double>(bytes->size())),
                  "encoding");
  }
  if (frames == 0) return data_error(settings.in, "no frame to encode");
  encoder->finish(out);
  if (extension(settings.out) == ".mpg" || extension(settings.out) == ".mpeg") {
    auto system = mpeg1::multiplex(out);
    if (!system.ok()) return data_error(settings.in, system.failure());
    out = std::move(*system);
  }
  if (const int code = write_output(settings.out, out); code != kDone) return code;
  return print_summary(options, settings, frames, repeated, out.size());
}

}  // namespace

int run_mpeg1_encode(Args args) {
  Options options("mpeg1 encode", "codes a Y4M clip as MPEG-1 video",
                  "pac mpeg1 encode clip.y4m -o clip.m1v --quantizer-scale 4");
  EncodeSettings settings;
  options.positional("IN.y4m", settings.in, "8-bit 4:2:0; - is stdin");
  options.text("-o|--output", "OUT", settings.out, ".m1v, or .mpg for a system stream; - is stdout", true);
  options.real("--quantizer-scale", "Q", settings.sequence.quantizer_scale, mpeg1::kLeastQuantizerScale, 31,
               "fixed quantizer, also between integers; below 1 by finer matrices (default 4)");
  options.integer("--bit-rate", "BPS", settings.bit_rate_bps, 400, 100000000, "constant bit rate instead");
  options.integer("--gop", "N", settings.sequence.gop_length, 1, 132, "an I picture every N pictures (default 15)");
  options.integer("--slice-rows", "N", settings.sequence.slice_rows, 0, 175,
                  "macroblock rows a slice, 0: one slice a picture (default 0)");
  options.flag("--scene-cuts", settings.sequence.scene_cuts, "I pictures where the scene changes");
  options.flag("--adapt-matrices", settings.sequence.adapt_matrices,
               "later groups with matrices that suit the pictures before (not with --effort fast)");
  options.choice<mpeg1::Effort>(
      "--effort", settings.sequence.effort,
      {{"fast", mpeg1::Effort::fast}, {"default", mpeg1::Effort::normal}, {"best", mpeg1::Effort::best}},
      "how hard to search (default: default)");
  options.integer("--look-ahead", "N", settings.look_ahead, 0, 131,
                  "frames to look at after each I picture, so that more bits go to what they go on showing "
                  "(default: the group; 0 with --effort fast)");
  if (const auto code = options.parse(args)) return *code;
  if (options.json && settings.out == "-") return options.usage_error("--json and -o - both want stdout");
  if (options.given("--bit-rate") && options.given("--quantizer-scale"))
    return options.usage_error("--bit-rate and --quantizer-scale exclude each other");
  return encode(options, settings);
}

}  // namespace pac::cli
