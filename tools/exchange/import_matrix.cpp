#include "tools/exchange/import_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

// With lif_exp's defaults one spike of 30 nA lifts the membrane by 23 mV, above the threshold 20 mV away.
constexpr double kDriveWeightNa = 30;

void divide_by_input(SparseMatrix& matrix) {
  std::vector<double> input(matrix.columns, 0);
  for (std::size_t k = 0; k < matrix.value.size(); ++k) {
    input[matrix.column[k]] += std::abs(matrix.value[k]);
  }
  for (std::size_t k = 0; k < matrix.value.size(); ++k) {
    matrix.value[k] /= input[matrix.column[k]];
  }
}

ForeignPopulation cells(const std::string& name, std::uint32_t size, const char* model) {
  ForeignPopulation population;
  population.name = name;
  population.model = model;
  population.size = size;
  population.sides.emplace_back();
  return population;
}

/// The entries of one sign.
ForeignProjection entries(const SparseMatrix& matrix, const MatrixImport& options, bool is_inhibitory) {
  ForeignProjection projection;
  projection.name = is_inhibitory ? "inhibition" : "excitation";
  projection.is_inhibitory = is_inhibitory;
  projection.weight_unit = "nA";
  for (std::size_t k = 0; k < matrix.value.size(); ++k) {
    if ((matrix.value[k] < 0) == is_inhibitory) {
      projection.pre.push_back(matrix.row[k]);
      projection.post.push_back(matrix.column[k]);
      projection.weight.push_back(std::abs(matrix.value[k]) * options.weight_na);
      projection.delay_ms.push_back(options.delay_ms);
    }
  }
  return projection;
}

void add_drive(const ForeignPopulation& target, double rate_hz, ForeignCircuit& circuit) {
  ForeignPopulation drive = cells("drive", target.size, "poisson");
  drive.sides.front().parameters["rate"] = {{rate_hz}, "Hz"};
  ForeignProjection projection;
  projection.name = "drive_" + target.name;
  projection.from = drive.name;
  projection.to = target.name;
  projection.weight_unit = "nA";
  for (std::uint32_t i = 0; i < target.size; ++i) {
    projection.pre.push_back(i);
    projection.post.push_back(i);
    projection.weight.push_back(kDriveWeightNa);
    projection.delay_ms.push_back(1);
  }
  circuit.populations.push_back(std::move(drive));
  circuit.projections.push_back(std::move(projection));
}

}  // namespace

double leading_eigenvalue(const SparseMatrix& matrix) {
  constexpr int kSettling = 100;
  constexpr int kCounted = 200;
  std::vector<double> vector(matrix.rows);
  for (std::size_t i = 0; i < vector.size(); ++i) {
    vector[i] = 1 + 0.1 * static_cast<double>(i % 7);  // not orthogonal to anything in particular
  }
  double growth = 0;
  for (int step = 0; step < kSettling + kCounted; ++step) {
    std::vector<double> next(matrix.columns, 0);
    for (std::size_t k = 0; k < matrix.value.size(); ++k) {
      next[matrix.column[k]] += matrix.value[k] * vector[matrix.row[k]];
    }
    double square = 0;
    for (const double x : next) {
      square += x * x;
    }
    const double norm = std::sqrt(square);
    if (!(norm > 0)) {
      return 0;
    }
    for (double& x : next) {
      x /= norm;
    }
    growth += step >= kSettling ? std::log(norm) : 0;
    vector = std::move(next);
  }
  return std::exp(growth / kCounted);
}

std::optional<ForeignCircuit> import_matrix(const MatrixImport& options, std::string& error) {
  auto matrix = read_matrix(options.path, options.variable, error);
  if (!matrix) {
    return std::nullopt;
  }
  if (matrix->value.empty()) {
    error =
        fmt::format("{}: the {} x {} matrix has no entry that is not 0", options.path, matrix->rows, matrix->columns);
    return std::nullopt;
  }
  if (options.rows_are_targets) {
    std::swap(matrix->rows, matrix->columns);
    std::swap(matrix->row, matrix->column);
  }
  if (options.divides_by_input) {
    divide_by_input(*matrix);
  }
  const bool is_square = matrix->rows == matrix->columns;
  if (options.leading_eigenvalue) {
    const double found = is_square ? leading_eigenvalue(*matrix) : 0;
    if (found == 0) {
      error = fmt::format("{}: the matrix has no eigenvalue to scale: it {}", options.path,
                          is_square ? "has no cycles" : "is not square");
      return std::nullopt;
    }
    for (double& value : matrix->value) {
      value *= *options.leading_eigenvalue / found;
    }
  }
  ForeignCircuit circuit;
  if (!is_square) {
    circuit.populations.push_back(cells("sources", matrix->rows, "lif_exp"));
  }
  circuit.populations.push_back(cells(is_square ? "cells" : "targets", matrix->columns, "lif_exp"));
  for (const bool is_inhibitory : {false, true}) {
    ForeignProjection projection = entries(*matrix, options, is_inhibitory);
    projection.from = circuit.populations.front().name;
    projection.to = circuit.populations.back().name;
    if (!projection.pre.empty()) {
      circuit.projections.push_back(std::move(projection));
    }
  }
  const bool mixes = circuit.projections.size() > 1;
  if (mixes) {
    circuit.populations.front().more["mixed_signs"] = "the matrix has entries of both signs";
  }
  if (options.drive_hz) {
    const ForeignPopulation driven = circuit.populations.front();
    add_drive(driven, *options.drive_hz, circuit);
  }
  return circuit;
}

}  // namespace tectum
