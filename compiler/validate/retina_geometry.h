// Squares around the optical axis: from rings to receptive fields, and from pixels to angles.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/image/spike_image.h"

namespace tectum {

/// A square annulus of half-width outer_px with inner_px cut out, tiled by squares of 2 outer_px / fields_per_side.
/// Appends its fields row by row from the top left, in a frame centred at (centre_x, centre_y) px.
void tile_ring(double centre_x, double centre_y, double outer_px, double inner_px, std::uint32_t fields_per_side,
               std::vector<FieldRecord>& fields);

/// One cell thick, between the squares of half-widths outer_px and inner_px: a square in each corner and
/// fields_per_side - 2 rectangles along each side. Meets any inner square, so a geometric series has no gaps.
void tile_strip(double centre_x, double centre_y, double outer_px, double inner_px, std::uint32_t fields_per_side,
                std::vector<FieldRecord>& fields);

/// The innermost square as columns x rows fields.
void tile_block(double centre_x, double centre_y, double outer_px, std::uint32_t columns, std::uint32_t rows,
                std::vector<FieldRecord>& fields);

/// Angles of a point of a pinhole camera's frame from the optical axis.
struct FieldAngles {
  double x_deg;    // right positive
  double y_deg;    // up positive
  double ecc_deg;  // between the point's ray and the axis
};
[[nodiscard]] FieldAngles field_angles(const FieldRecord& field, double frame_width_px, double frame_height_px,
                                       double field_of_view_deg);

}  // namespace tectum
