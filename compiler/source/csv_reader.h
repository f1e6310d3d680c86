// A table in a text file, read row by row: any separator, one header line or none, fields in double quotes or bare.
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

/// One row: there, at fault (row_error() says how; the next call goes on behind it), or none left (or error()).
enum class CsvRow { Read, Bad, End };

/// Streams chosen columns; holds one chunk of the file at a time.
class CsvReader {
 public:
  /// Opens the file and reads its first line. On failure `error()` says why and next() gives nothing.
  /// Separator 0: comma, semicolon, tab or bar, whichever the first line uses most.
  explicit CsvReader(const std::string& path, char separator = '\0');

  /// "path: reason" or "path:line: reason"; empty while all is well.
  [[nodiscard]] const std::string& error() const { return error_; }
  /// The fields of the first line, without quotes.
  [[nodiscard]] const std::vector<std::string>& header() const { return header_; }

  /// Which columns to read, by position. Without a header the first line is a row.
  void select(std::vector<std::size_t> columns, bool has_header);
  /// The next row's selected fields as numbers. False at the end, or when error() says why not. Skips empty lines.
  [[nodiscard]] bool next(std::span<double> values);
  /// The next row's selected fields as they stand, without quotes and surrounding blanks. They hold until the next
  /// call.
  [[nodiscard]] CsvRow next_fields(std::span<std::string_view> fields);
  /// "path:line: reason" of the last Bad row.
  [[nodiscard]] const std::string& row_error() const { return row_error_; }
  /// Reads a whole field as a number. Otherwise row_error() says which field of the last row is none.
  [[nodiscard]] bool read_number(std::string_view field, std::size_t selected, double& value);
  /// Bytes read so far, and of the whole file; for progress.
  [[nodiscard]] std::uint64_t bytes_read() const { return bytes_read_; }
  [[nodiscard]] std::uint64_t bytes_total() const { return bytes_total_; }
  /// 0 to 1: how much of the file has been read.
  [[nodiscard]] double share_read() const {
    return bytes_total_ == 0 ? 1 : static_cast<double>(bytes_read_) / static_cast<double>(bytes_total_);
  }

  /// Counted from 1, of the row that next() gave last.
  [[nodiscard]] std::uint64_t line() const { return line_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::optional<std::string_view> next_line();
  bool refill();

  std::string path_;
  std::string error_;
  std::unique_ptr<std::FILE, CloseFile> file_;
  std::string buffer_;
  std::size_t at_ = 0;
  bool is_at_end_ = false;
  char separator_;
  std::string row_error_;
  std::vector<std::string_view> fields_;  // of next()
  std::uint64_t bytes_read_ = 0;
  std::uint64_t bytes_total_ = 0;
  std::vector<std::string> header_;
  std::vector<std::size_t> columns_;
  std::vector<std::size_t> value_of_column_;  // where each column of the file goes, npos when nowhere
  std::uint64_t line_ = 0;
};

}  // namespace tectum
