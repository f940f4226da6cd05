#include "jpeg/component_planes.h"

#include <algorithm>
#include <bit>

namespace pac::jpeg {
namespace {

struct Rows {
  const uint8_t* of[kMaxComponents];
};

void rgb_from_gray_row(const uint8_t* gray, int n, uint8_t* rgb) {
  for (int x = 0; x < n; ++x)
    for (int i = 0; i < 3; ++i) rgb[3 * x + i] = gray[x];
}

void interleave_row(const Rows& rows, int n, uint8_t* rgb) {
  for (int x = 0; x < n; ++x)
    for (int i = 0; i < 3; ++i) rgb[3 * x + i] = rows.of[i][x];
}

// Inks as Adobe stores them, inverted: 255 is no ink. round(ink * k / 255).
uint8_t with_black(int inverted_ink, int inverted_black) {
  return static_cast<uint8_t>((2 * inverted_ink * inverted_black + 255) / 510);
}

void rgb_from_cmyk_row(const Rows& rows, int n, uint8_t* rgb) {
  for (int x = 0; x < n; ++x)
    for (int i = 0; i < 3; ++i) rgb[3 * x + i] = with_black(rows.of[i][x], rows.of[3][x]);
}

// YCCK: the YCbCr conversion gives the complement of the stored inks. In place.
void apply_ycck_black(const uint8_t* black, int n, uint8_t* rgb) {
  for (int x = 0; x < n; ++x)
    for (int i = 0; i < 3; ++i) rgb[3 * x + i] = with_black(255 - rgb[3 * x + i], black[x]);
}

int plane_rows(const ScaledFrame& scaled, int c, bool whole_image) {
  // A factor after scaling counts units of 8 / scale samples, as that of the file counts blocks.
  const Frame& frame = scaled.frame;
  return 8 / scaled.scale * frame.components[c].v * (whole_image ? frame.mcu_rows : std::min(2, frame.mcu_rows));
}

ptrdiff_t plane_stride(const ScaledFrame& scaled, int c) {
  return ptrdiff_t{scaled.block_size[c]} * scaled.frame.components[c].padded_width_blocks;
}

}  // namespace

uint64_t ComponentPlanes::size_bytes(const ScaledFrame& scaled, bool whole_image) {
  uint64_t sum = 0;
  for (int c = 0; c < scaled.frame.n_components; ++c)
    sum += static_cast<uint64_t>(plane_stride(scaled, c)) * static_cast<uint64_t>(plane_rows(scaled, c, whole_image));
  return sum;
}

uint64_t ComponentPlanes::size_bytes(const Frame& frame, bool whole_image) {
  return size_bytes(scaled_frame(frame, 1), whole_image);
}

// As the IJG software chooses: the triangle filter for factors of two where rows are wide enough, else repetition.
ComponentPlanes::Upsampling ComponentPlanes::choose(const Component& c) const {
  const int h = frame_.h_max, v = frame_.v_max;
  if (c.h == h && c.v == v) return Upsampling::none;
  if (!fancy_) return Upsampling::nearest;
  if (c.h * 2 == h && c.v == v && c.width > 2) return Upsampling::h2v1;
  if (c.h == h && c.v * 2 == v) return Upsampling::h1v2;
  if (c.h * 2 == h && c.v * 2 == v && c.width > 2) return Upsampling::h2v2;
  return Upsampling::nearest;
}

void ComponentPlanes::reset_ring(const Frame& frame, ColorModel color, const Kernels& kernels) {
  set_up(scaled_frame(frame, 1), false, color, kernels);
  for (int i = 0; i < frame.n_components; ++i) planes_[i].samples.resize(planes_[i].size());
}

void ComponentPlanes::reset(const ScaledFrame& scaled, bool whole_image, ColorModel color, const Kernels& kernels) {
  set_up(scaled, whole_image, color, kernels);
  // 128 is what a block of zero coefficients decodes to.
  for (int i = 0; i < scaled.frame.n_components; ++i) planes_[i].samples.assign(planes_[i].size(), 128);
}

// All but the samples.
void ComponentPlanes::set_up(const ScaledFrame& scaled, bool whole_image, ColorModel color, const Kernels& kernels) {
  const Frame& frame = scaled.frame;
  frame_ = frame;
  mcu_width_ = scaled.mcu_width();
  fancy_ = scaled.scale < 8;  // as the IJG software: an eighth is a thumbnail
  color_ = color;
  kernels_ = &kernels;
  for (int i = 0; i < frame.n_components; ++i) {
    const Component& c = frame.components[i];
    Plane& plane = planes_[i];
    plane.block_size = scaled.block_size[i];
    plane.first = 0;
    plane.stride = plane_stride(scaled, i);
    plane.n_rows = plane_rows(scaled, i, whole_image);
    // Divisions, five a row, would be a tenth of what a small picture takes.
    plane.row_mask = whole_image ? -1 : std::has_single_bit(static_cast<uint32_t>(plane.n_rows)) ? plane.n_rows - 1 : 0;
    plane.upsampling = choose(c);
    upsampled_[i].resize(static_cast<size_t>(frame.mcus_per_row) * 8 * static_cast<size_t>(frame.h_max) + 2);
  }
}

void ComponentPlanes::narrow(int first, int end) {
  const auto cut = [&](int width, int mcu_width) { return std::min(width, end * mcu_width) - first * mcu_width; };
  for (int i = 0; i < frame_.n_components; ++i) {
    Component& c = frame_.components[i];
    const int samples = mcu_width_ / frame_.h_max * c.h;  // of an MCU in a row
    planes_[i].first = ptrdiff_t{first} * samples;
    c.width = cut(c.width, samples);
  }
  frame_.width = cut(frame_.width, mcu_width_);
}

// Row y of the image at full width, from component c.
const uint8_t* ComponentPlanes::full_row(int c, int y) {
  const Component& component = frame_.components[c];
  const Plane& plane = planes_[c];
  const auto n = static_cast<size_t>(component.width);
  uint8_t* out = upsampled_[c].data();
  const int near = y * component.v / frame_.v_max;
  // For vertical factor 2: even output rows lean on the row above, odd ones on the row below; both stop at the edges.
  const int far = std::clamp(near + ((y & 1) != 0 ? 1 : -1), 0, component.height - 1);
  switch (plane.upsampling) {
    case Upsampling::none:
      return row(c, y);
    case Upsampling::h2v1:
      kernels_->pixel.upsample_h2v1_row(row(c, near), n, out);
      return out;
    case Upsampling::h2v2:
      kernels_->pixel.upsample_h2v2_row(row(c, near), row(c, far), n, out);
      return out;
    case Upsampling::h1v2:
      kernels_->pixel.upsample_h1v2_row(row(c, near), row(c, far), (y & 1) != 0 ? 2 : 1, n, out);
      return out;
    case Upsampling::nearest:
      break;
  }
  const uint8_t* in = row(c, near);
  for (int x = 0; x < frame_.width; ++x) out[x] = in[x * component.h / frame_.h_max];
  return out;
}

bool ComponentPlanes::is_plain_420() const {
  return color_ == ColorModel::ycc && planes_[0].upsampling == Upsampling::none &&
         planes_[1].upsampling == Upsampling::h2v2 && planes_[2].upsampling == Upsampling::h2v2;
}

// Most files: upsampling and color in one kernel.
void ComponentPlanes::write_420_row(int y, uint8_t* rgb) {
  const int near = y / 2, far = std::clamp(near + ((y & 1) != 0 ? 1 : -1), 0, frame_.components[1].height - 1);
  kernels_->pixel.rgb_from_ycc420_row(row(0, y), row(1, near), row(1, far), row(2, near), row(2, far),
                                      static_cast<size_t>(frame_.width), rgb);
}

void ComponentPlanes::write_rgb(int y_begin, int y_end, RgbView out) {
  const int n = frame_.width;
  const auto size = static_cast<size_t>(n);
  const bool is_420 = is_plain_420();
  for (int y = y_begin; y < y_end; ++y) {
    if (is_420) {
      write_420_row(y, out.row(y));
      continue;
    }
    Rows rows{};
    for (int c = 0; c < frame_.n_components; ++c) rows.of[c] = full_row(c, y);
    uint8_t* rgb = out.row(y);
    switch (color_) {
      case ColorModel::gray:
        rgb_from_gray_row(rows.of[0], n, rgb);
        break;
      case ColorModel::rgb:
        interleave_row(rows, n, rgb);
        break;
      case ColorModel::cmyk:
        rgb_from_cmyk_row(rows, n, rgb);
        break;
      case ColorModel::ycc:
        kernels_->pixel.rgb_from_ycc_row(rows.of[0], rows.of[1], rows.of[2], size, rgb);
        break;
      case ColorModel::ycck:
        kernels_->pixel.rgb_from_ycc_row(rows.of[0], rows.of[1], rows.of[2], size, rgb);
        apply_ycck_black(rows.of[3], n, rgb);
        break;
      case ColorModel::unknown:
        PAC_ASSERT(false);  // refused before
    }
  }
}

}  // namespace pac::jpeg
