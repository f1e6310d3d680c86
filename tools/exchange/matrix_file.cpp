#include "tools/exchange/matrix_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tools/exchange/array.h"

namespace tectum {
namespace {

constexpr double kMaxExtent = 1U << 28U;

std::optional<SparseMatrix> dense_matrix(const NamedArray& array) {
  SparseMatrix matrix;
  matrix.rows = static_cast<std::uint32_t>(array.shape[0]);
  matrix.columns = static_cast<std::uint32_t>(array.shape[1]);
  for (std::size_t r = 0; r < array.shape[0]; ++r) {
    for (std::size_t c = 0; c < array.shape[1]; ++c) {
      const double value = array.numbers[r * array.shape[1] + c];
      if (value != 0) {
        matrix.row.push_back(static_cast<std::uint32_t>(r));
        matrix.column.push_back(static_cast<std::uint32_t>(c));
        matrix.value.push_back(value);
      }
    }
  }
  return matrix;
}

const NamedArray* find_array(const ArrayFile& file, const std::string& name) {
  const auto found = file.arrays.find(name);
  return found == file.arrays.end() ? nullptr : &found->second;
}

/// What scipy.sparse.save_npz wrote.
std::optional<SparseMatrix> scipy_matrix(const ArrayFile& file, std::string& error) {
  const std::string format = find_array(file, "format")->text;
  const NamedArray* shape = find_array(file, "shape");
  const NamedArray* data = find_array(file, "data");
  const bool is_coo = format == "coo";
  const NamedArray* major = find_array(file, is_coo ? "row" : "indptr");
  const NamedArray* minor = find_array(file, is_coo ? "col" : "indices");
  error = "the sparse matrix of format `" + format + "` is incomplete or of a kind that is not read (csr, csc, coo)";
  if ((!is_coo && format != "csr" && format != "csc") || shape == nullptr || shape->numbers.size() != 2 ||
      data == nullptr || major == nullptr || minor == nullptr || minor->numbers.size() != data->numbers.size() ||
      (is_coo && major->numbers.size() != data->numbers.size()) || shape->numbers[0] > kMaxExtent ||
      shape->numbers[1] > kMaxExtent) {
    return std::nullopt;
  }
  SparseMatrix matrix;
  matrix.rows = static_cast<std::uint32_t>(shape->numbers[0]);
  matrix.columns = static_cast<std::uint32_t>(shape->numbers[1]);
  const bool is_csc = format == "csc";
  const auto add = [&](double first, double second, double value) {
    const double r = is_csc ? second : first;
    const double c = is_csc ? first : second;
    if (!(r >= 0 && r < matrix.rows && c >= 0 && c < matrix.columns)) {
      return false;
    }
    matrix.row.push_back(static_cast<std::uint32_t>(r));
    matrix.column.push_back(static_cast<std::uint32_t>(c));
    matrix.value.push_back(value);
    return true;
  };
  bool is_sound = true;
  if (is_coo) {
    for (std::size_t k = 0; k < data->numbers.size() && is_sound; ++k) {
      is_sound = add(major->numbers[k], minor->numbers[k], data->numbers[k]);
    }
  } else {
    is_sound = major->numbers.size() == std::size_t{is_csc ? matrix.columns : matrix.rows} + 1;
    for (std::size_t m = 0; is_sound && m + 1 < major->numbers.size(); ++m) {
      const double begin = major->numbers[m];
      const double end = major->numbers[m + 1];
      is_sound = begin >= 0 && begin <= end && end <= static_cast<double>(data->numbers.size());
      for (auto k = static_cast<std::size_t>(begin); is_sound && k < static_cast<std::size_t>(end); ++k) {
        is_sound = add(static_cast<double>(m), minor->numbers[k], data->numbers[k]);
      }
    }
  }
  if (!is_sound) {
    error = "the sparse matrix has an entry outside its shape";
    return std::nullopt;
  }
  error.clear();
  return matrix;
}

/// Entries row by row; those that a file gives several times are added, as SciPy does, and zeros left out.
void put_in_order(SparseMatrix& matrix) {
  std::vector<std::size_t> order(matrix.row.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    order[k] = k;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(matrix.row[a], matrix.column[a]) < std::pair(matrix.row[b], matrix.column[b]);
  });
  SparseMatrix sorted;
  sorted.rows = matrix.rows;
  sorted.columns = matrix.columns;
  for (const std::size_t k : order) {
    const bool is_again =
        !sorted.row.empty() && sorted.row.back() == matrix.row[k] && sorted.column.back() == matrix.column[k];
    if (is_again) {
      sorted.value.back() += matrix.value[k];
    } else if (matrix.value[k] != 0) {
      sorted.row.push_back(matrix.row[k]);
      sorted.column.push_back(matrix.column[k]);
      sorted.value.push_back(matrix.value[k]);
    }
  }
  matrix = std::move(sorted);
}

std::optional<SparseMatrix> choose(const ArrayFile& file, const std::string& variable, std::string& error) {
  if (variable.empty() && file.arrays.count("format") != 0 && file.arrays.count("shape") != 0) {
    return scipy_matrix(file, error);
  }
  std::vector<std::string> names;
  for (const auto& [name, matrix] : file.sparse) {
    names.push_back(name);
  }
  for (const auto& [name, array] : file.arrays) {
    if (array.shape.size() == 2 && !array.is_text) {
      names.push_back(name);
    }
  }
  std::string wanted = variable;
  if (wanted.empty() && names.size() == 1) {
    wanted = names.front();
  }
  if (std::find(names.begin(), names.end(), wanted) == names.end()) {
    error = names.empty() ? "holds no matrix"
            : wanted.empty()
                ? fmt::format("holds several matrices; name one with --variable: {}", fmt::join(names, ", "))
                : fmt::format("has no matrix `{}`; it has {}", wanted, fmt::join(names, ", "));
    return std::nullopt;
  }
  const auto sparse = file.sparse.find(wanted);
  return sparse != file.sparse.end() ? sparse->second : dense_matrix(*find_array(file, wanted));
}

}  // namespace

std::optional<SparseMatrix> read_matrix(const std::string& path, const std::string& variable, std::string& error) {
  std::error_code ignored;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path, ignored)) {
    error = path + ": cannot be read";
    return std::nullopt;
  }
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  const std::string extension = std::filesystem::path(path).extension().string();
  std::optional<ArrayFile> file;
  if (extension == ".mat") {
    file = parse_mat(bytes, error);
  } else if (extension == ".npy") {
    if (auto array = parse_npy(bytes, error)) {
      file.emplace().arrays.emplace("array", std::move(*array));
    }
  } else {
    file = parse_npz(bytes, error);
  }
  auto matrix = file ? choose(*file, variable, error) : std::nullopt;
  if (!matrix) {
    error = path + ": " + error;
    return std::nullopt;
  }
  const bool is_finite =
      std::all_of(matrix->value.begin(), matrix->value.end(), [](double value) { return std::isfinite(value); });
  if (!is_finite) {
    error = path + ": the matrix has entries that are not finite";
    return std::nullopt;
  }
  put_in_order(*matrix);
  return matrix;
}

}  // namespace tectum
