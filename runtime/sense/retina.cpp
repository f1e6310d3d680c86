#include "runtime/sense/retina.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "runtime/sense/lit_pixels.h"

namespace tectum {
namespace {

constexpr int kMinFrameSidePx = 8;
constexpr int kMaxFrameSidePx = 8192;
// A boundary that misses a camera pixel's edge or centre by less than this lies on it: the reference frame is scaled
// by ratios that binary fractions do not hold exactly.
constexpr double kBoundaryTolerancePx = 1e-6;

/// Half-open interval of camera pixels, relative to the crop.
struct PixelSpan {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// Rows or columns of the crop, cut at every field boundary. Strip s covers pixels [edges[s], edges[s + 1]).
struct Strips {
  std::vector<std::uint32_t> edges;

  explicit Strips(const std::vector<PixelSpan>& spans, std::uint32_t size_px) {
    edges = {0, size_px};
    for (const PixelSpan& span : spans) {
      edges.push_back(span.begin);
      edges.push_back(span.end);
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  }
  [[nodiscard]] std::uint32_t index_of(std::uint32_t edge_px) const {
    return static_cast<std::uint32_t>(std::lower_bound(edges.begin(), edges.end(), edge_px) - edges.begin());
  }
  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(edges.size()) - 1; }
};

/// The camera pixels of a field along one axis; `scale` is camera pixels per reference pixel.
PixelSpan pixels_of(double begin_ref, double end_ref, double scale, std::uint32_t size_px) {
  const double begin = begin_ref * scale;
  const double end = end_ref * scale;
  const bool is_narrower_than_a_pixel = end - begin < 1.0 - kBoundaryTolerancePx;
  const double first = is_narrower_than_a_pixel ? std::floor(begin + kBoundaryTolerancePx)
                                                : std::ceil(begin - 0.5 - kBoundaryTolerancePx);
  const double last =
      is_narrower_than_a_pixel ? std::ceil(end - kBoundaryTolerancePx) : std::ceil(end - 0.5 - kBoundaryTolerancePx);
  const auto clip = [size_px](double v) { return static_cast<std::uint32_t>(std::clamp<double>(v, 0.0, size_px)); };
  if (!(last > first)) {
    return {};
  }
  return {clip(first), clip(last)};
}

/// Four corners of the count table, and the count that makes the field active.
struct FieldCells {
  std::uint32_t top_left = 0, top_right = 0, bottom_left = 0, bottom_right = 0;
  std::uint32_t needed_px = 0;
};

}  // namespace

struct Retina::Impl {
  RetinaRecord record{};
  std::vector<FieldRecord> fields;

  int width_px = 0, height_px = 0;
  std::size_t crop_x_px = 0, crop_y_px = 0;
  std::size_t crop_width_px = 0, crop_height_px = 0;
  std::vector<std::uint32_t> column_edges, row_edges;
  std::vector<FieldCells> cells;

  std::vector<std::uint8_t> first_of_pixel;  // 1 0 0 1 0 0 ...
  std::vector<std::uint8_t> lit;             // one row
  // lit_before[r * stride + c] = lit pixels in strips of rows [0, r) and of columns [0, c).
  std::vector<std::uint32_t> lit_before;
  std::vector<std::uint32_t> active;
  RetinaCounters counters;

  bool prepare(int new_width_px, int new_height_px);
  void place_crop();
  void place_fields();
  [[nodiscard]] bool count_lit(const Frame& frame) noexcept;
  void add_row(std::uint32_t* strip_counts) const noexcept;
  void collect_active() noexcept;
};

bool Retina::Impl::prepare(int new_width_px, int new_height_px) {
  width_px = 0;
  height_px = 0;
  active.clear();
  if (std::min(new_width_px, new_height_px) < kMinFrameSidePx ||
      std::max(new_width_px, new_height_px) > kMaxFrameSidePx) {
    return false;
  }
  width_px = new_width_px;
  height_px = new_height_px;
  place_crop();
  place_fields();
  first_of_pixel.assign(3 * crop_width_px, 0);
  for (std::size_t i = 0; i < crop_width_px; ++i) {
    first_of_pixel[3 * i] = 1;
  }
  lit.assign(3 * crop_width_px, 0);
  lit_before.assign(column_edges.size() * row_edges.size(), 0);
  return true;
}

void Retina::Impl::place_crop() {
  const auto width = static_cast<std::uint64_t>(width_px);
  const auto height = static_cast<std::uint64_t>(height_px);
  const std::uint64_t reference_width = std::max(record.frame_width, 1U);
  const std::uint64_t reference_height = std::max(record.frame_height, 1U);
  const std::uint64_t crop_width = std::clamp<std::uint64_t>(height * reference_width / reference_height, 1, width);
  const std::uint64_t crop_height = std::clamp<std::uint64_t>(width * reference_height / reference_width, 1, height);
  crop_width_px = crop_width;
  crop_height_px = crop_height;
  crop_x_px = (width - crop_width) / 2;
  crop_y_px = (height - crop_height) / 2;
}

void Retina::Impl::place_fields() {
  const auto crop_width = static_cast<std::uint32_t>(crop_width_px);
  const auto crop_height = static_cast<std::uint32_t>(crop_height_px);
  const double x_scale = static_cast<double>(crop_width) / std::max(record.frame_width, 1U);
  const double y_scale = static_cast<double>(crop_height) / std::max(record.frame_height, 1U);
  std::vector<PixelSpan> columns, rows;
  for (const FieldRecord& field : fields) {
    columns.push_back(pixels_of(field.x0, field.x1, x_scale, crop_width));
    rows.push_back(pixels_of(field.y0, field.y1, y_scale, crop_height));
  }
  const Strips column_strips(columns, crop_width);
  const Strips row_strips(rows, crop_height);
  const std::uint32_t stride = column_strips.count() + 1;

  cells.clear();
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const std::uint32_t left = column_strips.index_of(columns[k].begin), right = column_strips.index_of(columns[k].end);
    const std::uint32_t top = row_strips.index_of(rows[k].begin), bottom = row_strips.index_of(rows[k].end);
    const double pixels = static_cast<double>(columns[k].end - columns[k].begin) * (rows[k].end - rows[k].begin);
    // The tolerance keeps a share such as 0.1 of 30 pixels at 3.
    const double needed = std::max(1.0, std::ceil(record.lit_share * pixels - 1e-9));
    cells.push_back({.top_left = top * stride + left,
                     .top_right = top * stride + right,
                     .bottom_left = bottom * stride + left,
                     .bottom_right = bottom * stride + right,
                     .needed_px = static_cast<std::uint32_t>(std::min(needed, 4e9))});
  }
  column_edges = column_strips.edges;
  row_edges = row_strips.edges;
}

/// Fills lit_before. False when no pixel is lit.
bool Retina::Impl::count_lit(const Frame& frame) noexcept {
  const std::size_t stride = column_edges.size();
  bool any = false;
  for (std::size_t strip = 0; strip + 1 < row_edges.size(); ++strip) {
    std::uint32_t* above = lit_before.data() + strip * stride;
    std::uint32_t* below = above + stride;
    std::fill(below, below + stride, 0U);
    bool is_strip_lit = false;
    for (std::size_t y = row_edges[strip]; y < row_edges[strip + 1]; ++y) {
      const std::uint8_t* row = frame.bgr + (crop_y_px + y) * frame.stride_bytes + 3 * crop_x_px;
      if (mark_lit_pixels(record.lit_channel, record.lit_above, row, crop_width_px, first_of_pixel.data(),
                          lit.data())) {
        add_row(below + 1);
        is_strip_lit = true;
      }
    }
    any = any || is_strip_lit;
    std::uint32_t in_strip = 0;
    for (std::size_t c = 1; c < stride; ++c) {
      in_strip += below[c];
      below[c] = above[c] + in_strip;
    }
  }
  return any;
}

void Retina::Impl::add_row(std::uint32_t* strip_counts) const noexcept {
  for (std::size_t s = 0; s + 1 < column_edges.size(); ++s) {
    std::uint32_t count = 0;
    for (std::size_t x = column_edges[s]; x < column_edges[s + 1]; ++x) {
      count += lit[3 * x];
    }
    strip_counts[s] += count;
  }
}

void Retina::Impl::collect_active() noexcept {
  const std::uint32_t* table = lit_before.data();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const FieldCells& cell = cells[k];
    const std::uint32_t lit_px =
        table[cell.bottom_right] - table[cell.bottom_left] - table[cell.top_right] + table[cell.top_left];
    if (lit_px >= cell.needed_px) {
      active.push_back(static_cast<std::uint32_t>(k));  // within the capacity reserved in the constructor
    }
  }
}

Retina::Retina(const SpikeImage& image, std::uint32_t retina_index) : impl_(std::make_unique<Impl>()) {
  assert(retina_index < image.retinas.size());
  impl_->record = image.retinas[retina_index];
  const auto fields = image.fields.subspan(impl_->record.first_field, impl_->record.field_count);
  impl_->fields.assign(fields.begin(), fields.end());
  impl_->active.reserve(fields.size());
}

Retina::~Retina() = default;
Retina::Retina(Retina&&) noexcept = default;
Retina& Retina::operator=(Retina&&) noexcept = default;

bool Retina::prepare(int width_px, int height_px) { return impl_->prepare(width_px, height_px); }

bool Retina::encode(const Frame& frame) noexcept {
  impl_->active.clear();
  const bool is_prepared_size = impl_->width_px > 0 && frame.width_px == impl_->width_px &&
                                frame.height_px == impl_->height_px && frame.bgr != nullptr &&
                                frame.stride_bytes >= 3 * static_cast<std::size_t>(frame.width_px);
  if (!is_prepared_size) {
    return false;
  }
  ++impl_->counters.frames;
  impl_->counters.lit_pixels_last_frame = 0;
  if (impl_->count_lit(frame)) {
    impl_->counters.lit_pixels_last_frame = impl_->lit_before.back();
    impl_->collect_active();
  }
  return true;
}

std::span<const std::uint32_t> Retina::active() const noexcept { return impl_->active; }
const RetinaCounters& Retina::counters() const noexcept { return impl_->counters; }

}  // namespace tectum
