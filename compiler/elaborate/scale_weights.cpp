#include "compiler/elaborate/scale_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace tectum {
namespace {

constexpr int kMostSteps = 3000;
constexpr double kTolerance = 1e-9;  // of the eigenvalue, from step to step
constexpr int kSteadySteps = 5;

/// The synapses of some projections as a matrix: from presynaptic to postsynaptic neuron.
struct Matrix {
  const Network& network;
  const std::vector<double>& weights;
  std::vector<std::size_t> synapses;

  void multiply(const std::vector<double>& x, std::vector<double>& y) const {
    std::fill(y.begin(), y.end(), 0.0);
    for (const std::size_t s : synapses) {
      y[network.synapses.post[s]] += weights[s] * x[network.synapses.pre[s]];
    }
  }
};

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    sum += a[i] * b[i];
  }
  return sum;
}

/// Size of the leading eigenvalue if span{x, Ax} is nearly its space. With A A x = a A x + b x in the sense of least
/// squares, the eigenvalues there solve l^2 = a l + b: a real one, or a pair of complex or of opposite ones.
std::optional<double> leading_in(const std::vector<double>& x, const std::vector<double>& ax,
                                 const std::vector<double>& aax) {
  const double xx = dot(x, x), xy = dot(x, ax), yy = dot(ax, ax);
  const double determinant = xx * yy - xy * xy;
  constexpr double kParallel = 1e-14;
  if (determinant <= kParallel * xx * yy) {
    return std::abs(xy / xx);
  }
  const double xz = dot(x, aax), yz = dot(ax, aax);
  const double a = (yz * xx - xz * xy) / determinant;
  const double b = (xz * yy - yz * xy) / determinant;
  const double under_root = a * a / 4 + b;
  return under_root < 0 ? std::sqrt(-b) : std::abs(a) / 2 + std::sqrt(under_root);
}

/// By powers of the matrix, from a vector that no symmetry of a circuit makes orthogonal to the leading space.
/// Nothing when it does not settle; 0 when no loop is in the matrix.
std::optional<double> leading_eigenvalue(const Matrix& matrix) {
  const std::size_t size = matrix.network.neuron_count();
  std::vector<double> x(size), ax(size), aax(size);
  constexpr double kGoldenRatio = 0.6180339887498949;
  for (std::size_t i = 0; i < size; ++i) {
    const double turn = kGoldenRatio * static_cast<double>(i + 1);
    x[i] = 1 + (turn - std::floor(turn));
  }
  double last = 0;
  int steady = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    matrix.multiply(x, ax);
    matrix.multiply(ax, aax);
    const double length = std::sqrt(dot(aax, aax));
    if (length == 0) {
      return 0.0;
    }
    const auto now = leading_in(x, ax, aax);
    steady = now && std::abs(*now - last) <= kTolerance * *now ? steady + 1 : 0;
    last = now.value_or(0);
    if (steady >= kSteadySteps) {
      return last;
    }
    for (std::size_t i = 0; i < size; ++i) {
      x[i] = aax[i] / length;
    }
  }
  return std::nullopt;
}

void scale(const Scaling& scaling, const Circuit& circuit, const Network& network, std::vector<double>& weights,
           Diagnostics& diagnostics) {
  Matrix matrix{network, weights, {}};
  std::vector<bool> is_meant(circuit.projections.size(), false);
  for (const ProjectionId id : scaling.projections) {
    is_meant[index_of(id)] = true;
  }
  for (std::size_t s = 0; s < weights.size(); ++s) {
    if (is_meant[index_of(network.pathways[network.synapses.pathway[s]].projection)]) {
      matrix.synapses.push_back(s);
    }
  }
  const auto eigenvalue = leading_eigenvalue(matrix);
  if (!eigenvalue || *eigenvalue == 0) {
    diagnostics
        .add(Code::CannotScale, scaling.span,
             {eigenvalue
                  ? fmt::format("the projections of `{}` close no loop: their leading eigenvalue is 0", scaling.name)
                  : fmt::format("the leading eigenvalue of `{}` does not settle", scaling.name)})
        .help(eigenvalue ? "scale by a number in `weight` instead"
                         : "two eigenvalues of nearly the same size lead it: scale by a number in `weight` instead");
    return;
  }
  const double factor = scaling.leading_eigenvalue / *eigenvalue;
  for (const std::size_t s : matrix.synapses) {
    weights[s] *= factor;
  }
}

}  // namespace

void scale_weights(const Circuit& circuit, const Network& network, std::vector<double>& weights,
                   Diagnostics& diagnostics) {
  for (const Scaling& scaling : circuit.scalings) {
    scale(scaling, circuit, network, weights, diagnostics);
  }
}

}  // namespace tectum
