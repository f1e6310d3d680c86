// Exact integration of a linear system over one step.
#pragma once

#include <cstddef>
#include <vector>

namespace tectum {

/// A square matrix, row by row.
struct SquareMatrix {
  explicit SquareMatrix(std::size_t n) : size(n), values(n * n) {}
  double& at(std::size_t row, std::size_t column) { return values[row * size + column]; }
  [[nodiscard]] double at(std::size_t row, std::size_t column) const { return values[row * size + column]; }
  std::size_t size;
  std::vector<double> values;
};

/// e^A by scaling and squaring of the Taylor series. Not finite when A or the result is not.
SquareMatrix matrix_exponential(const SquareMatrix& a);

/// dx/dt = A x + b, b constant over the step h:   x(t + h) = P x(t) + R b.
struct Propagators {
  SquareMatrix state;  // P = e^(A h)
  SquareMatrix input;  // R = integral of e^(A s) over s in [0, h)
};
Propagators propagators(const SquareMatrix& a, double h);

}  // namespace tectum
