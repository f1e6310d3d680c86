#include "compiler/validate/retina_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tectum {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

}  // namespace

void tile_ring(double centre_x, double centre_y, double outer_px, double inner_px, std::uint32_t fields_per_side,
               std::vector<FieldRecord>& fields) {
  // Edges by multiplication, so that neighbours share them to the last bit.
  const auto edge = [&](double centre, std::uint32_t i) {
    return static_cast<float>(centre + outer_px * (2.0 * i / fields_per_side - 1.0));
  };
  for (std::uint32_t row = 0; row < fields_per_side; ++row) {
    for (std::uint32_t column = 0; column < fields_per_side; ++column) {
      const double x_mid = outer_px * ((2.0 * column + 1.0) / fields_per_side - 1.0);
      const double y_mid = outer_px * ((2.0 * row + 1.0) / fields_per_side - 1.0);
      if (std::max(std::abs(x_mid), std::abs(y_mid)) < inner_px) {
        continue;
      }
      fields.push_back(
          {edge(centre_x, column), edge(centre_y, row), edge(centre_x, column + 1), edge(centre_y, row + 1)});
    }
  }
}

void tile_strip(double centre_x, double centre_y, double outer_px, double inner_px, std::uint32_t fields_per_side,
                std::vector<FieldRecord>& fields) {
  std::vector<double> edges = {-outer_px};
  for (std::uint32_t i = 0; i <= fields_per_side - 2; ++i) {
    edges.push_back(inner_px * (2.0 * i / (fields_per_side - 2) - 1.0));
  }
  edges.push_back(outer_px);
  for (std::uint32_t row = 0; row < fields_per_side; ++row) {
    for (std::uint32_t column = 0; column < fields_per_side; ++column) {
      const bool is_border = row == 0 || column == 0 || row + 1 == fields_per_side || column + 1 == fields_per_side;
      if (is_border) {
        fields.push_back({static_cast<float>(centre_x + edges[column]), static_cast<float>(centre_y + edges[row]),
                          static_cast<float>(centre_x + edges[column + 1]),
                          static_cast<float>(centre_y + edges[row + 1])});
      }
    }
  }
}

void tile_block(double centre_x, double centre_y, double outer_px, std::uint32_t columns, std::uint32_t rows,
                std::vector<FieldRecord>& fields) {
  const auto edge = [&](double centre, std::uint32_t i, std::uint32_t count) {
    return static_cast<float>(centre + outer_px * (2.0 * i / count - 1.0));
  };
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t column = 0; column < columns; ++column) {
      fields.push_back({edge(centre_x, column, columns), edge(centre_y, row, rows), edge(centre_x, column + 1, columns),
                        edge(centre_y, row + 1, rows)});
    }
  }
}

FieldAngles field_angles(const FieldRecord& field, double frame_width_px, double frame_height_px,
                         double field_of_view_deg) {
  const double focal_px = frame_width_px / 2 / std::tan(field_of_view_deg / 2 / kDegPerRad);
  const double right_px = (static_cast<double>(field.x0) + static_cast<double>(field.x1)) / 2 - frame_width_px / 2;
  const double up_px = frame_height_px / 2 - (static_cast<double>(field.y0) + static_cast<double>(field.y1)) / 2;
  return {std::atan2(right_px, focal_px) * kDegPerRad, std::atan2(up_px, focal_px) * kDegPerRad,
          std::atan2(std::hypot(right_px, up_px), focal_px) * kDegPerRad};
}

}  // namespace tectum
