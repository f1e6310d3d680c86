#include "tools/sweep/row_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

namespace tectum {
namespace {

namespace fs = std::filesystem;

std::string header_line() {
  std::string line;
  for (const SweepMeasure& measure : kSweepMeasures) {
    line += (line.empty() ? "" : ",") + std::string(measure.name);
  }
  return line + "\n";
}

}  // namespace

std::string cell_text(const std::optional<double>& value) { return value ? fmt::format("{:.9g}", *value) : ""; }

std::string row_path(const std::string& folder, const std::string& digest) {
  return (fs::path(folder) / "rows" / (digest + ".csv")).string();
}

std::string make_row_folder(const std::string& folder) {
  std::error_code error;
  const fs::path rows = fs::path(folder) / "rows";
  fs::create_directories(rows, error);
  return error ? fmt::format("{}: cannot be made: {}", rows.string(), error.message()) : "";
}

std::string write_row(const std::string& folder, const std::string& digest, const SweepRow& row) {
  const std::string path = row_path(folder, digest);
  // Two processes may run the same point: each writes a file of its own and the last one is kept.
  const std::string beside = fmt::format("{}.{}", path, getpid());
  std::string line;
  for (std::size_t k = 0; k < row.size(); ++k) {
    line += (k > 0 ? "," : "") + cell_text(row[k]);
  }
  std::ofstream file(beside, std::ios::binary);
  file << header_line() << line << "\n" << std::flush;
  file.close();
  std::error_code error;
  if (file) {
    fs::rename(beside, path, error);
  }
  return !file || error ? fmt::format("{}: cannot be written", path) : "";
}

std::optional<SweepRow> read_row(const std::string& folder, const std::string& digest) {
  std::ifstream file(row_path(folder, digest), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string header = header_line();
  if (!text.starts_with(header) || text.size() == header.size() || text.back() != '\n') {
    return std::nullopt;
  }
  std::string_view rest = std::string_view(text).substr(header.size());
  rest.remove_suffix(1);
  SweepRow row;
  for (std::size_t k = 0; k < row.size(); ++k) {
    const std::size_t comma = rest.find(',');
    if ((comma == std::string_view::npos) != (k + 1 == row.size())) {
      return std::nullopt;
    }
    const std::string_view cell = rest.substr(0, comma);
    if (!cell.empty()) {
      double value = 0;
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
      if (error != std::errc{} || end != cell.data() + cell.size()) {
        return std::nullopt;
      }
      row[k] = value;
    }
    rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
  }
  return row;
}

}  // namespace tectum
