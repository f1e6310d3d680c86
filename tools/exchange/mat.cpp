// MATLAB level 5: a header of 128 bytes, then data elements: tag (type, bytes) and data, padded to 8 bytes.
#include <cstring>

#include "tools/exchange/array.h"

namespace tectum {
namespace {

constexpr std::size_t kHeaderBytes = 128;
constexpr std::size_t kMaxValues = std::size_t{1} << 32U;
constexpr std::size_t kMaxElementBytes = std::size_t{1} << 35U;

enum MatType : std::uint32_t {
  kInt8 = 1,
  kUint8 = 2,
  kInt16 = 3,
  kUint16 = 4,
  kInt32 = 5,
  kUint32 = 6,
  kSingle = 7,
  kDouble = 9,
  kInt64 = 12,
  kUint64 = 13,
  kMatrix = 14,
  kCompressed = 15,
};
enum MatClass : std::uint32_t { kCharClass = 4, kSparseClass = 5, kFirstNumeric = 6, kLastNumeric = 15 };

struct Element {
  std::uint32_t type = 0;
  std::string_view data;
};

std::uint32_t load32(const char* at) {
  std::uint32_t value = 0;
  std::memcpy(&value, at, sizeof value);
  return value;
}

/// The next element of `bytes`, which is shortened by it. Data of up to 4 bytes stand in the tag itself.
std::optional<Element> take_element(std::string_view& bytes) {
  constexpr std::size_t kTagBytes = 8;
  if (bytes.size() < kTagBytes) {
    return std::nullopt;
  }
  const std::uint32_t first = load32(bytes.data());
  const std::uint32_t small_bytes = first >> 16U;
  Element element;
  if (small_bytes != 0) {
    element.type = first & 0xFFFFU;
    if (small_bytes > 4) {
      return std::nullopt;
    }
    element.data = bytes.substr(4, small_bytes);
    bytes.remove_prefix(kTagBytes);
    return element;
  }
  element.type = first;
  const std::size_t size = load32(bytes.data() + 4);
  bytes.remove_prefix(kTagBytes);
  if (size > bytes.size()) {
    return std::nullopt;
  }
  element.data = bytes.substr(0, size);
  // Compressed elements are not padded.
  const std::size_t padded = element.type == kCompressed ? size : (size + 7) / 8 * 8;
  bytes.remove_prefix(std::min(padded, bytes.size()));
  return element;
}

template <typename Number>
std::vector<double> converted(std::string_view data) {
  std::vector<double> values(data.size() / sizeof(Number));
  for (std::size_t i = 0; i < values.size(); ++i) {
    Number value;
    std::memcpy(&value, data.data() + i * sizeof(Number), sizeof(Number));
    values[i] = static_cast<double>(value);
  }
  return values;
}

std::optional<std::vector<double>> numbers_of(const Element& element) {
  switch (element.type) {
    case kInt8:
      return converted<std::int8_t>(element.data);
    case kUint8:
      return converted<std::uint8_t>(element.data);
    case kInt16:
      return converted<std::int16_t>(element.data);
    case kUint16:
      return converted<std::uint16_t>(element.data);
    case kInt32:
      return converted<std::int32_t>(element.data);
    case kUint32:
      return converted<std::uint32_t>(element.data);
    case kSingle:
      return converted<float>(element.data);
    case kDouble:
      return converted<double>(element.data);
    case kInt64:
      return converted<std::int64_t>(element.data);
    case kUint64:
      return converted<std::uint64_t>(element.data);
    default:
      return std::nullopt;
  }
}

/// Compressed sparse columns: ir are the rows, jc where each column begins.
bool read_sparse(std::string_view& bytes, std::size_t rows, std::size_t columns, SparseMatrix& matrix) {
  const auto ir = take_element(bytes);
  const auto jc = take_element(bytes);
  const auto pr = take_element(bytes);
  const auto row = ir ? numbers_of(*ir) : std::nullopt;
  const auto begin = jc ? numbers_of(*jc) : std::nullopt;
  const auto value = pr ? numbers_of(*pr) : std::nullopt;
  if (!row || !begin || !value || begin->size() != columns + 1) {
    return false;
  }
  matrix.rows = static_cast<std::uint32_t>(rows);
  matrix.columns = static_cast<std::uint32_t>(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const auto end = static_cast<std::size_t>((*begin)[c + 1]);
    if (end > row->size() || end > value->size()) {
      return false;
    }
    for (auto k = static_cast<std::size_t>((*begin)[c]); k < end; ++k) {
      if ((*row)[k] < 0 || (*row)[k] >= static_cast<double>(rows)) {
        return false;
      }
      matrix.row.push_back(static_cast<std::uint32_t>((*row)[k]));
      matrix.column.push_back(static_cast<std::uint32_t>(c));
      matrix.value.push_back((*value)[k]);
    }
  }
  return true;
}

/// Columns into rows.
NamedArray row_major(std::size_t rows, std::size_t columns, const std::vector<double>& numbers) {
  NamedArray array;
  array.shape = {rows, columns};
  array.numbers.resize(rows * columns);
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      array.numbers[r * columns + c] = numbers[c * rows + r];
    }
  }
  return array;
}

/// A variable; one of a class that is no matrix of numbers is passed over.
bool read_matrix_element(std::string_view bytes, ArrayFile& file) {
  const auto flags = take_element(bytes);
  const auto dimensions = take_element(bytes);
  const auto name = take_element(bytes);
  if (!flags || flags->data.size() < 4 || !dimensions || !name) {
    return false;
  }
  const std::uint32_t matrix_class = load32(flags->data.data()) & 0xFFU;
  const auto extents = numbers_of(*dimensions);
  const bool is_numeric = matrix_class >= kFirstNumeric && matrix_class <= kLastNumeric;
  if (!extents || extents->size() != 2 || !(is_numeric || matrix_class == kSparseClass)) {
    return true;
  }
  const double most = static_cast<double>(kMaxValues);
  if ((*extents)[0] < 0 || (*extents)[1] < 0 || (*extents)[0] >= most || (*extents)[1] >= most) {
    return false;
  }
  const auto rows = static_cast<std::size_t>((*extents)[0]);
  const auto columns = static_cast<std::size_t>((*extents)[1]);
  if (matrix_class == kSparseClass) {
    return read_sparse(bytes, rows, columns, file.sparse[std::string(name->data)]);
  }
  const auto element = take_element(bytes);
  const auto numbers = element ? numbers_of(*element) : std::nullopt;
  if (!numbers || rows * columns != numbers->size()) {
    return false;
  }
  file.arrays[std::string(name->data)] = row_major(rows, columns, *numbers);
  return true;
}

}  // namespace

std::optional<ArrayFile> parse_mat(std::string_view bytes, std::string& error) {
  if (bytes.substr(0, 8) == "\x89HDF\r\n\x1a\n" || bytes.substr(0, 10) == "MATLAB 7.3") {
    error = "is a MATLAB 7.3 file; save it with save(..., '-v7')";
    return std::nullopt;
  }
  if (bytes.size() < kHeaderBytes || bytes.substr(0, 10) != "MATLAB 5.0" || bytes.substr(126, 2) != "IM") {
    error = "is no MATLAB level 5 file of a little-endian machine";
    return std::nullopt;
  }
  ArrayFile file;
  std::string_view rest = bytes.substr(kHeaderBytes);
  while (!rest.empty()) {
    auto element = take_element(rest);
    std::optional<std::string> unpacked;
    if (element && element->type == kCompressed) {
      unpacked = inflate(element->data, kMaxElementBytes, false);
      std::string_view inner = unpacked ? std::string_view(*unpacked) : std::string_view();
      element = take_element(inner);
    }
    if (!element || (element->type == kMatrix && !read_matrix_element(element->data, file))) {
      error = "the MATLAB file is damaged";
      return std::nullopt;
    }
  }
  return file;
}

}  // namespace tectum
