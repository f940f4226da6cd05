// One scene's pictures through every arm of the experiment.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/peers/experiment_table.h"
#include "bench/peers/peer_codecs.h"
#include "bench/peers/scene_shots.h"

namespace pac::bench {

// Pictures drawn once, and what peers need of them written once. Keeps the reference: `sequence` outlives it.
class ExperimentCodecs {
 public:
  explicit ExperimentCodecs(Sequence& sequence) : sequence_(sequence) {}

  // Stills: the first picture. Empty where a peer's program is not there or fails.
  std::optional<PeerCode> code(const ExperimentArm& arm, double setting);

 private:
  PeerRunner& runner(std::unique_ptr<PeerRunner>& runner, RgbImage sim::FrameImages::*member) const;
  PeerRunner& pictures() { return runner(pictures_, &sim::FrameImages::high); }
  PeerRunner& differences() { return runner(differences_, &sim::FrameImages::difference); }

  std::optional<PeerCode> composite(std::optional<PeerCode> code) const;
  PeerCode code_jpeg(bool is_video, bool is_difference, double setting) const;
  PeerCode code_mpeg1(const ExperimentArm& arm, double setting);
  PeerCode code_plain_mpeg1(const std::vector<sim::Shot>& shots, double setting) const;
  PeerCode code_assisted(const std::string& key, const std::vector<sim::Shot>& shots, double setting) const;

  Sequence& sequence_;
  std::unique_ptr<PeerRunner> pictures_, differences_;
};

}  // namespace pac::bench
