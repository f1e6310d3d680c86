// Arrays as they come out of NumPy and MATLAB files, before anybody knows which of them make up a matrix.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/exchange/matrix_file.h"

namespace tectum {

/// Numbers in row-major order, or a text.
struct NamedArray {
  std::vector<std::size_t> shape;
  std::vector<double> numbers;
  std::string text;  // of the type of text
  bool is_text = false;
};

/// What a file holds: arrays, and matrices that are sparse already.
struct ArrayFile {
  std::map<std::string, NamedArray> arrays;
  std::map<std::string, SparseMatrix> sparse;
};

/// An .npy file's bytes.
[[nodiscard]] std::optional<NamedArray> parse_npy(std::string_view bytes, std::string& error);
/// An .npz file's bytes: a ZIP archive of .npy members.
[[nodiscard]] std::optional<ArrayFile> parse_npz(std::string_view bytes, std::string& error);
/// A level 5 .mat file's bytes.
[[nodiscard]] std::optional<ArrayFile> parse_mat(std::string_view bytes, std::string& error);

/// zlib (`is_raw` false) or bare deflate data; at most `limit` bytes. Nothing when it is damaged.
[[nodiscard]] std::optional<std::string> inflate(std::string_view compressed, std::size_t limit, bool is_raw);

}  // namespace tectum
