// A clip from a Y4M file.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/file_io.h"
#include "base/y4m.h"

namespace pac::bench {

using Clip = std::vector<Frame420>;

// The frames that can be read: none where the file is missing or is no Y4M file.
inline Clip read_clip(const std::string& path) {
  Clip clip;
  const auto bytes = read_file(path);
  if (!bytes.ok()) return clip;
  auto reader = Y4mReader::open(*bytes);
  if (!reader.ok()) return clip;
  for (Frame420 frame;; frame = Frame420()) {
    const auto more = reader->next(frame);
    if (!more.ok() || !*more) return clip;
    clip.push_back(std::move(frame));
  }
}

}  // namespace pac::bench
