#include "compiler/expression/matrix_exponential.h"

#include <algorithm>
#include <cmath>

namespace tectum {
namespace {

SquareMatrix product(const SquareMatrix& a, const SquareMatrix& b) {
  SquareMatrix result(a.size);
  for (std::size_t i = 0; i < a.size; ++i) {
    for (std::size_t k = 0; k < a.size; ++k) {
      const double factor = a.at(i, k);
      if (factor == 0) {
        continue;
      }
      for (std::size_t j = 0; j < a.size; ++j) {
        result.at(i, j) += factor * b.at(k, j);
      }
    }
  }
  return result;
}

// Largest sum of sizes in a row.
double row_norm(const SquareMatrix& a) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size; ++i) {
    double sum = 0;
    for (std::size_t j = 0; j < a.size; ++j) {
      sum += std::abs(a.at(i, j));
    }
    if (!(sum <= largest)) {
      largest = sum;
    }  // takes NaN
  }
  return largest;
}

}  // namespace

// Moler & Van Loan 2003, doi:10.1137/S00361445024180, method 3. With the norm at most 1/4 the first
// omitted term, 1/4^15 / 15!, is below 2^-70; e^A - 1 is squared rather than e^A, by
// (1 + X)^2 - 1 = X (2 + X), so that small steps lose no digits.
SquareMatrix matrix_exponential(const SquareMatrix& a) {
  constexpr int kTerms = 14;
  constexpr double kLargestNorm = 0.25;
  const double norm = row_norm(a);
  SquareMatrix result(a.size);
  if (!std::isfinite(norm)) {
    std::fill(result.values.begin(), result.values.end(), norm - norm);  // NaN
    return result;
  }
  int halvings = 0;
  for (double scaled = norm; scaled > kLargestNorm; scaled /= 2) {
    ++halvings;
  }
  SquareMatrix small = a;
  for (double& value : small.values) {
    value = std::ldexp(value, -halvings);
  }

  // X = A (1 + A/2 (1 + A/3 (...))), innermost first.
  SquareMatrix sum(a.size);
  for (int k = kTerms; k >= 1; --k) {
    SquareMatrix inner = sum;
    for (std::size_t i = 0; i < a.size; ++i) {
      inner.at(i, i) += 1;
    }
    sum = product(small, inner);
    for (double& value : sum.values) {
      value /= k;
    }
  }
  for (int s = 0; s < halvings; ++s) {
    SquareMatrix two_more = sum;
    for (std::size_t i = 0; i < a.size; ++i) {
      two_more.at(i, i) += 2;
    }
    sum = product(sum, two_more);
  }
  for (std::size_t i = 0; i < a.size; ++i) {
    sum.at(i, i) += 1;
  }
  return sum;
}

// exp of [[A, 1], [0, 0]] h is [[P, R], [0, 1]]. Van Loan 1978, doi:10.1109/TAC.1978.1101743.
Propagators propagators(const SquareMatrix& a, double h) {
  const std::size_t n = a.size;
  SquareMatrix block(2 * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      block.at(i, j) = a.at(i, j) * h;
    }
    block.at(i, n + i) = h;
  }
  const SquareMatrix exponential = matrix_exponential(block);
  Propagators result{SquareMatrix(n), SquareMatrix(n)};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      result.state.at(i, j) = exponential.at(i, j);
      result.input.at(i, j) = exponential.at(i, n + j);
    }
  }
  return result;
}

}  // namespace tectum
