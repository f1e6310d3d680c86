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

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) {
    text.remove_prefix(1);
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) {
    text.remove_suffix(1);
  }
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') {
    text = text.substr(1, text.size() - 2);
  }
  return text;
}

/// The separator that the first line uses most.
char guess_separator(std::string_view line) {
  char best = ',';
  for (const char candidate : {';', '\t'}) {
    if (std::count(line.begin(), line.end(), candidate) > std::count(line.begin(), line.end(), best)) {
      best = candidate;
    }
  }
  return best;
}

}  // namespace

CsvReader::CsvReader(const std::string& path) : path_(path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    error_ = path + ": is a directory, not an edge list";
    return;
  }
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_) {
    error_ = path + ": " + std::strerror(errno);
    return;
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
  separator_ = guess_separator(line);
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find(separator_, at), line.size());
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
      error_ = fmt::format("{}:{}: a line is longer than 1 MiB; this is no edge list", path_, line_ + 1);
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

bool CsvReader::read_field(std::string_view text, std::size_t column, double& value) {
  const std::string_view field = trimmed(text);
  const auto [end, status] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (status != std::errc{} || end != field.data() + field.size()) {
    error_ = fmt::format("{}:{}: `{}` in column `{}` is no number", path_, line_, field.substr(0, 40), header_[column]);
    return false;
  }
  return true;
}

bool CsvReader::next(std::span<double> values) {
  while (error_.empty()) {
    const auto line = next_line();
    if (!line) {
      return false;
    }
    if (trimmed(*line).empty()) {
      continue;
    }
    std::size_t column = 0;
    std::size_t found = 0;
    for (std::size_t at = 0; at <= line->size() && column < value_of_column_.size(); ++column) {
      const std::size_t end = std::min(line->find(separator_, at), line->size());
      const std::size_t target = value_of_column_[column];
      if (target != kNowhere) {
        if (!read_field(line->substr(at, end - at), column, values[target])) {
          return false;
        }
        ++found;
      }
      at = end + 1;
    }
    if (found < columns_.size()) {
      error_ =
          fmt::format("{}:{}: the row has {} columns, the first line has {}", path_, line_, column, header_.size());
      return false;
    }
    return true;
  }
  return false;
}

}  // namespace tectum
