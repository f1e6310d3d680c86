// A table in a text file, read row by row: commas, semicolons or tabs, one header line or none.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tectum {

/// Streams numbers out of chosen columns; holds one chunk of the file at a time.
class CsvReader {
 public:
  /// Opens the file and reads its first line. On failure `error()` says why and next() gives nothing.
  explicit CsvReader(const std::string& path);

  /// "path: reason" or "path:line: reason"; empty while all is well.
  [[nodiscard]] const std::string& error() const { return error_; }
  /// The fields of the first line, without quotes.
  [[nodiscard]] const std::vector<std::string>& header() const { return header_; }

  /// Which columns to read, by position. Without a header the first line is a row.
  void select(std::vector<std::size_t> columns, bool has_header);
  /// The next row's selected fields as numbers. False at the end, or when error() says why not. Skips empty lines.
  [[nodiscard]] bool next(std::span<double> values);
  /// Counted from 1, of the row that next() gave last.
  [[nodiscard]] std::uint64_t line() const { return line_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::optional<std::string_view> next_line();
  bool refill();
  bool read_field(std::string_view text, std::size_t column, double& value);

  std::string path_;
  std::string error_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::string buffer_;
  std::size_t at_ = 0;
  bool is_at_end_ = false;
  char separator_ = ',';
  std::vector<std::string> header_;
  std::vector<std::size_t> columns_;
  std::vector<std::size_t> value_of_column_;  // where each column of the file goes, npos when nowhere
  std::uint64_t line_ = 0;
};

}  // namespace tectum
