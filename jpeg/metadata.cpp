#include "jpeg/metadata.h"

#include <algorithm>
#include <cstring>

#include "jpeg/jpeg.h"
#include "jpeg/marker_writer.h"
#include "jpeg/markers.h"
#include "jpeg/metadata_writer.h"

namespace pac::jpeg {
namespace {

// Segments know themselves by these first bytes, zeros included.
constexpr uint8_t kExifName[] = {'E', 'x', 'i', 'f', 0, 0};
constexpr uint8_t kIccName[] = {'I', 'C', 'C', '_', 'P', 'R', 'O', 'F', 'I', 'L', 'E', 0};
constexpr char kXmpName[] = "http://ns.adobe.com/xap/1.0/";  // with its zero
constexpr size_t kJfifBytes = 18;
constexpr size_t kMaxSegment = 65533;  // without the length field
constexpr size_t kMaxExif = kMaxSegment - sizeof kExifName, kMaxXmp = kMaxSegment - sizeof kXmpName;
constexpr size_t kMaxIccPart = kMaxSegment - sizeof kIccName - 2;  // number and count of the part

template <class Name>
std::span<const uint8_t> name_bytes(const Name& name) {
  return {reinterpret_cast<const uint8_t*>(name), sizeof name};
}

bool starts_with(std::span<const uint8_t> data, std::span<const uint8_t> name) {
  return data.size() >= name.size() && std::memcmp(data.data(), name.data(), name.size()) == 0;
}

std::vector<uint8_t> behind(std::span<const uint8_t> data, size_t n) {
  return {data.begin() + static_cast<ptrdiff_t>(n), data.end()};
}

// The parameters of a listed segment: behind its marker, fill bytes and length.
std::span<const uint8_t> parameters(std::span<const uint8_t> file, const MarkerInfo& marker) {
  uint64_t at = marker.offset;
  while (file[at] == 0xFF) ++at;
  return file.subspan(at + 3, marker.size_bytes);
}

bool has_parameters(uint8_t code) {
  return code != kSoi && code != kTem && !is_restart(code);
}

// Parts of an ICC profile by their number; each says how many there are.
class IccParts {
 public:
  // False: the part contradicts those before it.
  bool add(std::span<const uint8_t> data) {
    if (data.size() < sizeof kIccName + 2) return false;
    const size_t number = data[sizeof kIccName], count = data[sizeof kIccName + 1];
    if (number < 1 || number > count || (!parts_.empty() && parts_.size() != count)) return false;
    parts_.resize(count);
    std::vector<uint8_t>& part = parts_[number - 1];
    if (!part.empty()) return false;
    part = behind(data, sizeof kIccName + 2);
    return true;
  }
  // Empty where a part is missing.
  std::vector<uint8_t> joined() const {
    std::vector<uint8_t> all;
    for (const std::vector<uint8_t>& part : parts_) {
      if (part.empty()) return {};
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  }
  bool empty() const { return parts_.empty(); }

 private:
  std::vector<std::vector<uint8_t>> parts_;
};

// Whether with_metadata() replaces the segment.
bool is_metadata(uint8_t code, std::span<const uint8_t> data) {
  switch (code) {
    case kCom:
      return true;
    case kApp0:
      return data.size() >= 5 && std::memcmp(data.data(), "JFIF", 5) == 0;
    case kApp1:
      return starts_with(data, name_bytes(kExifName)) || starts_with(data, name_bytes(kXmpName));
    case kApp2:
      return starts_with(data, name_bytes(kIccName));
    default:
      return false;
  }
}

void take_app1(std::span<const uint8_t> data, MetadataFound& found) {
  Metadata& m = found.metadata;
  const bool is_exif = starts_with(data, name_bytes(kExifName)), is_xmp = starts_with(data, name_bytes(kXmpName));
  if (!is_exif && !is_xmp) return;
  std::vector<uint8_t>& target = is_exif ? m.exif : m.xmp;
  if (target.empty())
    target = behind(data, is_exif ? sizeof kExifName : sizeof kXmpName);
  else
    found.warnings += 1;
}

void write_segment(int code, std::span<const uint8_t> name, std::span<const uint8_t> data, ByteSink& sink) {
  sink.put16(0xFF00 | code);
  sink.put16(static_cast<int>(2 + name.size() + data.size()));
  sink.append(name);
  sink.append(data);
}

void write_icc_profile(std::span<const uint8_t> profile, ByteSink& sink) {
  const size_t count = (profile.size() + kMaxIccPart - 1) / kMaxIccPart;
  for (size_t i = 0; i < count; ++i) {
    const auto part = profile.subspan(i * kMaxIccPart, std::min(kMaxIccPart, profile.size() - i * kMaxIccPart));
    uint8_t name[sizeof kIccName + 2];
    std::memcpy(name, kIccName, sizeof kIccName);
    name[sizeof kIccName] = static_cast<uint8_t>(i + 1);
    name[sizeof kIccName + 1] = static_cast<uint8_t>(count);
    write_segment(kApp2, name, part, sink);
  }
}

}  // namespace

bool Metadata::operator==(const Metadata& other) const {
  return density.unit == other.density.unit && density.x == other.density.x && density.y == other.density.y &&
         exif == other.exif && xmp == other.xmp && icc_profile == other.icc_profile && comments == other.comments;
}

Result<void> check_metadata(const Metadata& m) {
  const auto bad = [](const char* text) { return Failure{Error::bad_argument, 0, text}; };
  if (m.density.x < 1 || m.density.x > 65535 || m.density.y < 1 || m.density.y > 65535)
    return bad("density is not within 1..65535");
  if (m.exif.size() > kMaxExif) return bad("Exif data have more than 65527 bytes");
  if (m.xmp.size() > kMaxXmp) return bad("the XMP packet has more than 65504 bytes");
  if (m.icc_profile.size() > 255 * kMaxIccPart) return bad("the ICC profile has more than 255 * 65519 bytes");
  for (const std::string& comment : m.comments)
    if (comment.size() > kMaxSegment) return bad("a comment has more than 65533 bytes");
  return {};
}

void write_jfif(const Density& density, ByteSink& sink) {
  constexpr uint8_t kStart[] = {'J', 'F', 'I', 'F', 0, 1, 1};  // 1.01
  sink.put16(0xFF00 | kApp0);
  sink.put16(16);
  sink.append(kStart);
  sink.put(static_cast<int>(density.unit));
  sink.put16(density.x);
  sink.put16(density.y);
  sink.put16(0);  // no thumbnail
}

void write_metadata(const Metadata& m, ByteSink& sink) {
  if (!m.exif.empty()) write_segment(kApp1, name_bytes(kExifName), m.exif, sink);
  if (!m.xmp.empty()) write_segment(kApp1, name_bytes(kXmpName), m.xmp, sink);
  write_icc_profile(m.icc_profile, sink);
  for (const std::string& comment : m.comments)
    write_segment(kCom, {}, {reinterpret_cast<const uint8_t*>(comment.data()), comment.size()}, sink);
}

uint64_t metadata_bytes(const Metadata& metadata) {
  ByteSink counter;
  write_metadata(metadata, counter);
  return counter.size();
}

Result<MetadataFound> read_metadata(std::span<const uint8_t> file, const Limits& limits) {
  PAC_TRY(const Info info, read_info(file, limits));
  MetadataFound found;
  Metadata& m = found.metadata;
  IccParts icc;
  bool whole_profile = true;
  for (const MarkerInfo& marker : info.markers) {
    if (!has_parameters(marker.code)) continue;
    const auto data = parameters(file, marker);
    if (marker.code == kCom) m.comments.emplace_back(data.begin(), data.end());
    if (marker.code == kApp1) take_app1(data, found);
    if (marker.code == kApp2 && starts_with(data, name_bytes(kIccName))) whole_profile = icc.add(data) && whole_profile;
  }
  if (whole_profile) m.icc_profile = icc.joined();
  if (m.icc_profile.empty() && (!icc.empty() || !whole_profile)) found.warnings += 1;
  const bool known_unit = info.density_units >= 0 && info.density_units <= 2;
  if (info.jfif && known_unit && info.density_x > 0 && info.density_y > 0)
    m.density = {static_cast<Density::Unit>(info.density_units), info.density_x, info.density_y};
  else if (info.jfif)
    found.warnings += 1;
  return found;
}

Result<std::vector<uint8_t>> with_metadata(std::span<const uint8_t> file, const Metadata& metadata,
                                           const Limits& limits) {
  PAC_CHECK(check_metadata(metadata));
  PAC_TRY(const Info info, read_info(file, limits));
  std::vector<uint8_t> out;
  out.reserve(file.size() + metadata_bytes(metadata) + kJfifBytes);
  ByteSink sink(out);
  write_start_of_image(sink);
  // JFIF claims gray or YCbCr: a file that is neither does not get the segment.
  if (info.color == ColorModel::gray || info.color == ColorModel::ycc) write_jfif(metadata.density, sink);
  write_metadata(metadata, sink);
  for (const MarkerInfo& marker : info.markers) {
    if (!has_parameters(marker.code)) continue;
    const auto data = parameters(file, marker);
    if (is_metadata(marker.code, data)) continue;
    sink.put16(0xFF00 | marker.code);
    sink.put16(static_cast<int>(data.size()) + 2);
    sink.append(data);
  }
  sink.append(file.subspan(info.header_bytes));
  return out;
}

}  // namespace pac::jpeg
