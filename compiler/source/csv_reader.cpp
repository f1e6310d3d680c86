#include "compiler/source/csv_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <utility>

namespace tectum {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20U;
constexpr std::size_t kMaxLineBytes = std::size_t{1} << 20U;
constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);

bool is_blank(char letter) { return letter == ' ' || letter == '\t' || letter == '\r'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && is_blank(text.back())) {
    text.remove_suffix(1);
  }
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return text;
}

/// Where the field that begins at `at` ends: at a separator that stands in no quotes, or with the line.
std::size_t field_end(std::string_view line, std::size_t at, char separator) {
  std::size_t begin = at;
  while (begin < line.size() && line[begin] == ' ' && separator != ' ') {
    ++begin;
  }
  if (begin < line.size() && line[begin] == '"') {
    const std::size_t closing = line.find('"', begin + 1);
    at = closing == std::string_view::npos ? at : closing + 1;
  }
  return std::min(line.find(separator, at), line.size());
}

/// The separator that the first line uses most.
char guess_separator(std::string_view line) {
  char best = ',';
  for (const char candidate : {';', '\t', '|'}) {
    if (std::count(line.begin(), line.end(), candidate) > std::count(line.begin(), line.end(), best)) {
      best = candidate;
    }
  }
  return best;
}

}  // namespace

CsvReader::CsvReader(const std::string& path, char separator) : path_(path), separator_(separator) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    error_ = path + ": is a directory, not a table";
    return;
  }
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_) {
    error_ = path + ": " + std::strerror(errno);
    return;
  }
  bytes_total_ = std::filesystem::file_size(path, ignored);
  if (ignored) {
    bytes_total_ = 0;
  }
  const auto first = next_line();
  if (!first) {
    error_ = error_.empty() ? path + ": is empty" : error_;
    return;
  }
  std::string_view line = *first;
  if (line.substr(0, 3) == "\xEF\xBB\xBF") {
    line.remove_prefix(3);
  }
  separator_ = separator_ == '\0' ? guess_separator(line) : separator_;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = field_end(line, at, separator_);
    header_.emplace_back(trimmed(line.substr(at, end - at)));
    at = end + 1;
  }
}

void CsvReader::select(std::vector<std::size_t> columns, bool has_header) {
  columns_ = std::move(columns);
  value_of_column_.assign(header_.size(), kNowhere);
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    value_of_column_[columns_[i]] = i;
  }
  if (!has_header) {
    at_ = 0;  // the first line lies at the buffer's start: nothing has been read since
    line_ = 0;
  }
}

bool CsvReader::refill() {
  buffer_.erase(0, at_);
  at_ = 0;
  const std::size_t old_size = buffer_.size();
  buffer_.resize(old_size + kChunkBytes);
  const std::size_t got = std::fread(buffer_.data() + old_size, 1, kChunkBytes, file_.get());
  buffer_.resize(old_size + got);
  bytes_read_ += got;
  is_at_end_ = got < kChunkBytes;
  return got > 0;
}

std::optional<std::string_view> CsvReader::next_line() {
  while (true) {
    const void* const found =
        at_ < buffer_.size() ? std::memchr(buffer_.data() + at_, '\n', buffer_.size() - at_) : nullptr;
    if (found != nullptr) {
      const auto end = static_cast<std::size_t>(static_cast<const char*>(found) - buffer_.data());
      const std::string_view line = std::string_view(buffer_).substr(at_, end - at_);
      at_ = end + 1;
      ++line_;
      return line;
    }
    if (buffer_.size() - at_ > kMaxLineBytes) {
      error_ = fmt::format("{}:{}: a line is longer than 1 MiB; this is no table", path_, line_ + 1);
      return std::nullopt;
    }
    if (!is_at_end_ && refill()) {
      continue;
    }
    if (at_ >= buffer_.size()) {
      return std::nullopt;
    }
    const std::string_view line = std::string_view(buffer_).substr(at_);
    at_ = buffer_.size();
    ++line_;
    return line;
  }
}

bool CsvReader::read_number(std::string_view field, std::size_t selected, double& value) {
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (status != std::errc{} || end != field.data() + field.size()) {
    row_error_ = fmt::format("{}:{}: `{}` in column `{}` is no number", path_, line_, field.substr(0, 40),
                             header_[columns_[selected]]);
    return false;
  }
  return true;
}

CsvRow CsvReader::next_fields(std::span<std::string_view> fields) {
  while (error_.empty()) {
    const auto line = next_line();
    if (!line) {
      return CsvRow::End;
    }
    if (trimmed(*line).empty()) {
      continue;
    }
    std::size_t column = 0;
    std::size_t found = 0;
    for (std::size_t at = 0; at <= line->size() && column < value_of_column_.size(); ++column) {
      const std::size_t end = field_end(*line, at, separator_);
      const std::size_t target = value_of_column_[column];
      if (target != kNowhere) {
        fields[target] = trimmed(line->substr(at, end - at));
        ++found;
      }
      at = end + 1;
    }
    if (found < columns_.size()) {
      row_error_ =
          fmt::format("{}:{}: the row has {} columns, the first line has {}", path_, line_, column, header_.size());
      return CsvRow::Bad;
    }
    return CsvRow::Read;
  }
  return CsvRow::End;
}

bool CsvReader::next(std::span<double> values) {
  fields_.resize(columns_.size());
  const CsvRow row = next_fields(fields_);
  bool is_sound = row == CsvRow::Read;
  for (std::size_t i = 0; i < fields_.size() && is_sound; ++i) {
    is_sound = read_number(fields_[i], i, values[i]);
  }
  if (row != CsvRow::End && !is_sound) {
    error_ = row_error_;
  }
  return is_sound;
}

}  // namespace tectum
