#include "geomcodec/table_choice.h"

#include <algorithm>
#include <utility>

namespace pac::geomcodec {
namespace {

// Tables may make a stream grow by this part of it, faces and positions by the second one where plain coding takes far
// more.
constexpr int64_t kGrowth = 24, kMostGrowth = 4;
// So few bytes in all sections that may be either are left as they are.
constexpr int64_t kFewBytes = 1024;

struct Candidate {
  Section section;
  bool of_geometry;
  int64_t growth;      // bytes
  int64_t saved_time;  // about so many ns
};

std::vector<Candidate> candidates_of(const Header& header, const Sections& sections, const Sections& by_tables) {
  std::vector<Candidate> candidates;
  const int64_t n_vertices = header.n_vertices(), n_points = header.n_points(), n_faces = header.n_faces;
  for (const auto& [section, saved_time] :
       {std::pair{kConnectivity, 20 * n_faces}, std::pair{kPositions, 90 * n_points},
        std::pair{kColors, 40 * n_vertices}, std::pair{kNormals, 25 * n_vertices},
        std::pair{kTexcoords, 35 * n_vertices}}) {
    const size_t bytes = sections[section].size();
    if (by_tables[section].empty() || header.by_tables(section)) continue;
    candidates.push_back({section, section == kConnectivity || section == kPositions,
                          static_cast<int64_t>(by_tables[section].size()) - static_cast<int64_t>(bytes), saved_time});
  }
  return candidates;
}

// So many are a little below what plain coding takes: no growth leads beyond.
int64_t below(int64_t plain_bytes) {
  return plain_bytes * 983 / 1000;
}

// By how many bytes faces and positions together may grow: by a part of them as long as they stay a little below what
// a coder without contexts takes, by more where they are far below it.
int64_t room_for_geometry(int64_t bytes, int64_t plain_bytes) {
  const int64_t little = std::min(bytes / kGrowth, below(plain_bytes) - bytes);
  return std::max(little, std::min(bytes / kMostGrowth, plain_bytes * 95 / 100 - bytes));
}

}  // namespace

bool PlainBytes::are_raw(const Header& header) const {
  return 8 * positions >= int64_t{3} * header.position_bits * header.n_points();
}

bool PlainBytes::is_tight(size_t position_bytes) const {
  return all > 0 && 100 * (static_cast<int64_t>(position_bytes) + connectivity) > 96 * all;
}

bool PlainBytes::tables_may_suffice(size_t bytes_by_tables) const {
  return static_cast<int64_t>(bytes_by_tables) + connectivity <= below(all);
}

bool PlainBytes::tables_suffice(size_t bytes_by_tables, size_t adaptive_bytes) const {
  const auto bytes = static_cast<int64_t>(adaptive_bytes);
  return static_cast<int64_t>(bytes_by_tables) - bytes <= room_for_geometry(bytes + connectivity, all);
}

void keep_fastest(Header& header, const PlainBytes& plain, int64_t grown, Sections& sections, Sections& by_tables) {
  int64_t bytes = 0;
  for (const Section section : {kConnectivity, kPositions, kColors, kNormals, kTexcoords})
    bytes += static_cast<int64_t>(sections[section].size());
  if (bytes < kFewBytes) return;
  const std::vector<Candidate> candidates = candidates_of(header, sections, by_tables);
  const auto geometry_bytes = static_cast<int64_t>(sections[kConnectivity].size() + sections[kPositions].size());
  // Normals and texture take about what other coders' do: they may not spend what faces and positions leave little of.
  const bool is_tight =
      (header.normal_bits != 0 || header.texcoord_bits != 0) && plain.is_tight(sections[kPositions].size());
  const int64_t room = is_tight ? 0 : bytes / kGrowth;
  const int64_t geometry_room =
      std::min(room_for_geometry(geometry_bytes - grown, plain.all),
               header.chooses && !header.by_tables(kPositions) ? geometry_bytes / kGrowthBesideChoosing : INT64_MAX);
  const uint8_t settled = header.tables;
  int64_t most_saved = 0;
  for (uint32_t subset = 1; subset < 1u << candidates.size(); ++subset) {
    int64_t growth = 0, growth_of_geometry = grown, saved_time = 0;
    uint8_t tables = settled;
    for (size_t i = 0; i < candidates.size(); ++i) {
      if ((subset >> i & 1) == 0) continue;
      (candidates[i].of_geometry ? growth_of_geometry : growth) += candidates[i].growth;
      saved_time += candidates[i].saved_time;
      tables = static_cast<uint8_t>(tables | 1u << candidates[i].section);
    }
    const bool fits = growth <= room && (growth_of_geometry == grown || growth_of_geometry <= geometry_room);
    if (!fits || saved_time <= most_saved) continue;
    most_saved = saved_time;
    header.tables = tables;
  }
  for (const Candidate& candidate : candidates)
    if (header.by_tables(candidate.section)) sections[candidate.section] = std::move(by_tables[candidate.section]);
  if (header.by_tables(kPositions)) header.chooses = header.ranked = header.parts_repeat_by_size = false;
}

}  // namespace pac::geomcodec
