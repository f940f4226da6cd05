#include "jpeg/band_decoder.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>

#include "jpeg/bands.h"
#include "jpeg/markers.h"

namespace pac::jpeg {
namespace {

int64_t n_intervals(const Scan& scan) {
  const int64_t n_mcus = int64_t{scan.mcus_per_row} * scan.mcu_rows;
  return (n_mcus + scan.restart_interval - 1) / scan.restart_interval;
}

// Rows from one row that begins with a restart interval to the next such row.
int period_rows(const Scan& scan) {
  return scan.restart_interval / std::gcd(scan.restart_interval, scan.mcus_per_row);
}

int mcu_height(const BandedScan& job) {
  return job.scan->n_components > 1 ? 8 * job.frame->v_max : 8;
}

// Blocks from one MCU row to the next.
int rows_of_blocks(const BandedScan& job, int c) {
  return job.scan->n_components > 1 ? job.frame->components[c].v : 1;
}

}  // namespace

// True if exactly the markers that are due stand in the data, in order.
bool BandDecoder::find_all_restarts(const BandedScan& job) {
  const auto n_due = static_cast<uint64_t>(n_intervals(*job.scan) - 1);
  if (!find_restarts(job.bytes, job.data_offset, n_due, restarts_)) return false;
  data_end_ = find_marker(job.bytes, restarts_.empty() ? job.data_offset : restarts_.back() + 2);
  return data_end_ == job.bytes.size() || !is_restart(job.bytes[data_end_ + 1]);
}

void BandDecoder::split(const BandedScan& job, int n_threads, const Kernels& kernels) {
  const Scan& scan = *job.scan;
  const int period = period_rows(scan), n_periods = ceil_div(scan.mcu_rows, period);
  size_t n_bands = 0;
  for (int done = 0; done < n_periods; ++n_bands) {
    if (n_bands == bands_.size()) bands_.emplace_back(kernels);
    Band& band = bands_[n_bands];
    band.first_row = done * period;
    band.first_interval = int64_t{band.first_row} * scan.mcus_per_row / scan.restart_interval;
    done += next_band(n_periods - done, n_periods, n_threads);
    band.end_row = std::min(done * period, scan.mcu_rows);
    band.sound = false;
    band.n_sides_done = 0;
  }
  bands_.erase(bands_.begin() + static_cast<ptrdiff_t>(n_bands), bands_.end());
  // Costliest first: the last thread to finish then has little left to do. Bytes tell most of what a band takes.
  order_.resize(bands_.size());
  std::iota(order_.begin(), order_.end(), size_t{0});
  const auto end_of = [&](size_t i) { return i + 1 < bands_.size() ? offset_of(job, bands_[i + 1]) : data_end_; };
  std::stable_sort(order_.begin(), order_.end(), [&](size_t a, size_t b) {
    return end_of(a) - offset_of(job, bands_[a]) > end_of(b) - offset_of(job, bands_[b]);
  });
}

// Where the data of its first interval begin.
uint64_t BandDecoder::offset_of(const BandedScan& job, const Band& band) const {
  return band.first_row == 0 ? job.data_offset : restarts_[static_cast<size_t>(band.first_interval - 1)] + 2;
}

// The first pixel row of a band and the last one lean on samples of two bands: write_seam() makes them.
bool BandDecoder::decode_rows(const BandedScan& job, Band& band, Damage& damage, RgbView out) const {
  const int height = mcu_height(job), n_rows = job.scan->mcu_rows;
  for (int row = band.first_row; row < band.end_row; ++row) {
    if (!band.mcus.decode_row(row, band.planes).ok() || damage.warnings > 0) return false;
    const bool is_top = row == band.first_row;
    for (int c = 0; is_top && c < job.frame->n_components; ++c) {
      const uint8_t* first = band.planes.block_row(c, row * rows_of_blocks(job, c));
      band.top[c].assign(first, first + band.planes.stride(c));
    }
    const int begin = row == 0 ? 0 : row * height + (is_top ? 1 : -1);
    const int end = row + 1 == n_rows ? out.height : (row + 1) * height - 1;
    band.planes.write_rgb(begin, end, out);
  }
  return true;
}

// Whether the data end where the next band's marker stands, with nothing between.
bool BandDecoder::ends_well(const BandedScan& job, const Band& band) const {
  if (band.end_row == job.scan->mcu_rows) return true;
  const int64_t next = int64_t{band.end_row} * job.scan->mcus_per_row / job.scan->restart_interval;
  const uint64_t end = band.mcus.byte_offset(), marker = restarts_[static_cast<size_t>(next - 1)];
  return end <= marker && job.bytes[end] == 0xFF && find_marker(job.bytes, end) == marker;
}

// Of two neighbors the one that is done last makes their seam.
void BandDecoder::decode_band(const BandedScan& job, size_t i, const Kernels& kernels, RgbView out) {
  Band& band = bands_[i];
  Damage damage;
  band.planes.reset_ring(*job.frame, job.color, kernels);
  band.mcus.start(job.bytes, *job.scan, offset_of(job, band), damage, band.first_interval);
  band.sound = decode_rows(job, band, damage, out) && ends_well(job, band);
  if (!band.sound) return;
  for (size_t below = std::max<size_t>(i, 1); below <= std::min(i + 1, bands_.size() - 1); ++below)
    if (std::atomic_ref(bands_[below].n_sides_done).fetch_add(1) == 1)
      write_seam(job, bands_[below - 1], bands_[below], kernels, out);
}

void BandDecoder::write_seam(const BandedScan& job, Band& above, Band& below, const Kernels& kernels,
                             RgbView out) const {
  ComponentPlanes& seam = below.seam;
  seam.reset_ring(*job.frame, job.color, kernels);
  for (int c = 0; c < job.frame->n_components; ++c) {
    const int first = below.first_row * rows_of_blocks(job, c);
    const ptrdiff_t stride = seam.stride(c), last = 7 * stride;
    std::memcpy(seam.block_row(c, first - 1) + last, above.planes.block_row(c, first - 1) + last,
                static_cast<size_t>(stride));
    std::memcpy(seam.block_row(c, first), below.top[c].data(), static_cast<size_t>(stride));
  }
  const int y = below.first_row * mcu_height(job);
  seam.write_rgb(y - 1, y + 1, out);
}

std::optional<uint64_t> BandDecoder::decode(const BandedScan& job, ThreadPool& pool, const Kernels& kernels,
                                            RgbView out) {
  const Scan& scan = *job.scan;
  if (scan.restart_interval == 0 || period_rows(scan) >= scan.mcu_rows || !find_all_restarts(job)) return {};
  split(job, pool.thread_count(), kernels);
  pool.for_each(static_cast<int64_t>(bands_.size()),
                [&](int64_t i) { decode_band(job, order_[static_cast<size_t>(i)], kernels, out); });
  for (const Band& band : bands_)
    if (!band.sound) return {};
  return bands_.back().mcus.byte_offset();
}

}  // namespace pac::jpeg
