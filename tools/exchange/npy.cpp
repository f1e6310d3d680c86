// NumPy's .npy: "\x93NUMPY", version, header length, a Python dictionary as text, the numbers. .npz: a ZIP of them.
#include <bit>
#include <cstring>
#include <limits>

#include "tools/exchange/array.h"

namespace tectum {
namespace {

constexpr std::size_t kMaxValues = std::size_t{1} << 32U;
constexpr std::size_t kMaxMemberBytes = std::size_t{1} << 35U;

template <typename Number>
Number load(const char* at) {
  Number value;
  std::memcpy(&value, at, sizeof(Number));
  return value;
}

template <typename Number>
void convert(std::string_view bytes, std::vector<double>& out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<double>(load<Number>(bytes.data() + i * sizeof(Number)));
  }
}

/// What stands after `'key':` in the header's dictionary, up to the next comma outside brackets.
std::string_view dictionary_value(std::string_view header, std::string_view key) {
  std::size_t at = header.find(std::string("'") + std::string(key) + "'");
  at = at == std::string_view::npos ? at : header.find(':', at);
  if (at == std::string_view::npos) {
    return {};
  }
  const std::size_t begin = header.find_first_not_of(' ', at + 1);
  if (begin == std::string_view::npos) {
    return {};
  }
  const std::size_t end = header[begin] == '(' ? header.find(')', begin) : header.find_first_of(",}", begin);
  return header.substr(begin, end == std::string_view::npos ? end : end - begin);
}

std::optional<std::vector<std::size_t>> parse_shape(std::string_view text) {
  std::vector<std::size_t> shape;
  std::size_t count = 1;
  for (std::size_t at = text.find_first_of("0123456789"); at < text.size(); at = text.find_first_of("0123456789", at)) {
    std::size_t extent = 0;
    while (at < text.size() && text[at] >= '0' && text[at] <= '9') {
      extent = extent * 10 + static_cast<std::size_t>(text[at++] - '0');
      if (extent > kMaxValues) {
        return std::nullopt;
      }
    }
    shape.push_back(extent);
    count = extent == 0 ? 0 : count > kMaxValues / extent ? kMaxValues + 1 : count * extent;
    if (count > kMaxValues) {
      return std::nullopt;
    }
  }
  return shape;
}

/// Column after column, as Fortran and MATLAB keep matrices, into row after row.
void to_row_major(NamedArray& array) {
  if (array.shape.size() != 2) {
    return;
  }
  std::vector<double> rows(array.numbers.size());
  for (std::size_t r = 0; r < array.shape[0]; ++r) {
    for (std::size_t c = 0; c < array.shape[1]; ++c) {
      rows[r * array.shape[1] + c] = array.numbers[c * array.shape[0] + r];
    }
  }
  array.numbers = std::move(rows);
}

bool read_numbers(std::string_view type, std::string_view bytes, NamedArray& array, std::string& error) {
  std::size_t count = 1;
  for (const std::size_t extent : array.shape) {
    count *= extent;
  }
  // "<f8": byte order, kind, bytes an item.
  const char kind = type[1];
  const std::size_t item = static_cast<std::size_t>(std::strtoul(std::string(type.substr(2)).c_str(), nullptr, 10));
  const std::size_t item_bytes = kind == 'U' ? 4 * item : item;
  if (item_bytes == 0 || bytes.size() / item_bytes < count) {
    error = "an array is cut short";
    return false;
  }
  if (kind == 'S' || kind == 'U') {
    array.is_text = true;
    for (std::size_t i = 0; i < item; ++i) {
      const char c = bytes[i * (kind == 'U' ? 4 : 1)];
      array.text += c == '\0' ? "" : std::string(1, c);
    }
    return true;
  }
  if (type[0] == '>' && item > 1) {
    error = "big-endian arrays are not read; save them with astype('<f8')";
    return false;
  }
  array.numbers.resize(count);
  const std::string name = std::string(1, kind) + std::to_string(item);
  if (name == "f8") {
    convert<double>(bytes, array.numbers);
  } else if (name == "f4") {
    convert<float>(bytes, array.numbers);
  } else if (name == "i8") {
    convert<std::int64_t>(bytes, array.numbers);
  } else if (name == "i4") {
    convert<std::int32_t>(bytes, array.numbers);
  } else if (name == "i2") {
    convert<std::int16_t>(bytes, array.numbers);
  } else if (name == "i1") {
    convert<std::int8_t>(bytes, array.numbers);
  } else if (name == "u8") {
    convert<std::uint64_t>(bytes, array.numbers);
  } else if (name == "u4") {
    convert<std::uint32_t>(bytes, array.numbers);
  } else if (name == "u2") {
    convert<std::uint16_t>(bytes, array.numbers);
  } else if (name == "u1" || name == "b1") {
    convert<std::uint8_t>(bytes, array.numbers);
  } else {
    error = "arrays of type " + std::string(type) + " are not read";
    return false;
  }
  return true;
}

/// The end-of-directory record, from the back: a comment may follow it.
std::optional<std::size_t> find_directory_end(std::string_view bytes) {
  constexpr std::size_t kRecordBytes = 22;
  for (std::size_t at = bytes.size() < kRecordBytes ? 0 : bytes.size() - kRecordBytes + 1; at-- > 0;) {
    if (load<std::uint32_t>(bytes.data() + at) == 0x06054b50U) {
      return at;
    }
  }
  return std::nullopt;
}

struct ZipEntry {
  std::string name;
  std::uint16_t method = 0;
  std::uint64_t packed_bytes = 0, bytes = 0, header_at = 0;
};

/// Sizes beyond 32 bits stand in the extra field 0x0001, in this order, where the plain ones are all ones.
void take_zip64(std::string_view extra, ZipEntry& entry) {
  constexpr std::uint64_t kElsewhere = 0xFFFFFFFFU;
  for (std::size_t at = 0; at + 4 <= extra.size();) {
    const std::size_t size = load<std::uint16_t>(extra.data() + at + 2);
    if (load<std::uint16_t>(extra.data() + at) == 1) {
      std::size_t value_at = at + 4;
      for (std::uint64_t* value : {&entry.bytes, &entry.packed_bytes, &entry.header_at}) {
        if (*value == kElsewhere && value_at + 8 <= std::min(extra.size(), at + 4 + size)) {
          *value = load<std::uint64_t>(extra.data() + value_at);
          value_at += 8;
        }
      }
    }
    at += 4 + size;
  }
}

std::optional<ZipEntry> read_entry(std::string_view bytes, std::size_t& at) {
  constexpr std::size_t kEntryBytes = 46;
  if (at > bytes.size() || bytes.size() - at < kEntryBytes || load<std::uint32_t>(bytes.data() + at) != 0x02014b50U) {
    return std::nullopt;
  }
  const char* const p = bytes.data() + at;
  ZipEntry entry;
  entry.method = load<std::uint16_t>(p + 10);
  entry.packed_bytes = load<std::uint32_t>(p + 20);
  entry.bytes = load<std::uint32_t>(p + 24);
  const std::size_t name_bytes = load<std::uint16_t>(p + 28);
  const std::size_t extra_bytes = load<std::uint16_t>(p + 30);
  const std::size_t comment_bytes = load<std::uint16_t>(p + 32);
  entry.header_at = load<std::uint32_t>(p + 42);
  if (bytes.size() - at - kEntryBytes < name_bytes + extra_bytes) {
    return std::nullopt;
  }
  entry.name = std::string(bytes.substr(at + kEntryBytes, name_bytes));
  take_zip64(bytes.substr(at + kEntryBytes + name_bytes, extra_bytes), entry);
  at += kEntryBytes + name_bytes + extra_bytes + comment_bytes;
  return entry;
}

std::optional<std::string> member_of(std::string_view bytes, const ZipEntry& entry) {
  constexpr std::size_t kHeaderBytes = 30;
  if (entry.header_at > bytes.size() || bytes.size() - entry.header_at < kHeaderBytes) {
    return std::nullopt;
  }
  const char* const p = bytes.data() + entry.header_at;
  const std::size_t data_at =
      entry.header_at + kHeaderBytes + load<std::uint16_t>(p + 26) + load<std::uint16_t>(p + 28);
  if (data_at > bytes.size() || bytes.size() - data_at < entry.packed_bytes || entry.bytes > kMaxMemberBytes) {
    return std::nullopt;
  }
  const std::string_view packed = bytes.substr(data_at, entry.packed_bytes);
  if (entry.method == 0) {
    return std::string(packed);
  }
  constexpr std::uint16_t kDeflated = 8;
  return entry.method == kDeflated ? inflate(packed, entry.bytes, true) : std::nullopt;
}

}  // namespace

std::optional<NamedArray> parse_npy(std::string_view bytes, std::string& error) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::size_t kBeforeLength = 8;
  if (bytes.substr(0, 6) != "\x93NUMPY" || bytes.size() < kBeforeLength + 4) {
    error = "is no NumPy array";
    return std::nullopt;
  }
  const bool is_first_version = bytes[6] == 1;
  const std::size_t header_bytes = is_first_version ? load<std::uint16_t>(bytes.data() + kBeforeLength)
                                                    : load<std::uint32_t>(bytes.data() + kBeforeLength);
  const std::size_t header_at = kBeforeLength + (is_first_version ? 2 : 4);
  if (bytes.size() - header_at < header_bytes) {
    error = "an array's header is cut short";
    return std::nullopt;
  }
  const std::string_view header = bytes.substr(header_at, header_bytes);
  std::string_view type = dictionary_value(header, "descr");
  const auto shape = parse_shape(dictionary_value(header, "shape"));
  if (type.size() < 5 || type.front() != '\'' || !shape) {
    error = type.substr(0, 1) == "[" ? "arrays of records are not read" : "an array's header makes no sense";
    return std::nullopt;
  }
  type = type.substr(1, type.size() - 2);
  if (type.substr(0, 2) == "|O") {
    error = "an array holds Python objects; save numbers (and sparse matrices with scipy.sparse.save_npz)";
    return std::nullopt;
  }
  NamedArray array;
  array.shape = *shape;
  if (!read_numbers(type, bytes.substr(header_at + header_bytes), array, error)) {
    return std::nullopt;
  }
  if (dictionary_value(header, "fortran_order") == "True" && !array.is_text) {
    to_row_major(array);
  }
  return array;
}

std::optional<ArrayFile> parse_npz(std::string_view bytes, std::string& error) {
  const auto end = find_directory_end(bytes);
  if (!end) {
    error = "is no .npz file, or one that is cut short";
    return std::nullopt;
  }
  std::size_t at = load<std::uint32_t>(bytes.data() + *end + 16);
  const std::size_t count = load<std::uint16_t>(bytes.data() + *end + 10);
  ArrayFile file;
  for (std::size_t e = 0; e < count; ++e) {
    const auto entry = read_entry(bytes, at);
    const auto member = entry ? member_of(bytes, *entry) : std::nullopt;
    if (!member) {
      error = "the .npz file is damaged" + (entry ? ": member " + entry->name : "");
      return std::nullopt;
    }
    std::string name = entry->name;
    if (name.size() > 4 && name.substr(name.size() - 4) == ".npy") {
      name.resize(name.size() - 4);
      auto array = parse_npy(*member, error);
      if (!array) {
        error = "member " + name + ": " + error;
        return std::nullopt;
      }
      file.arrays.emplace(std::move(name), std::move(*array));
    }
  }
  return file;
}

}  // namespace tectum
