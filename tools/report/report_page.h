// One self-contained HTML page: no network, no external file, readable without its script.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tectum {

struct ReportCard {
  std::string value;
  std::string label;
};

struct ReportTable {
  std::vector<std::string> header;  // first column: row names
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> notes;  // one a row, under its name; may be empty
  bool holds_text = false;         // cells are sentences: left-aligned, and broken into lines
};

/// Text arguments are plain and escaped here; `svg` and `html` arguments are written as they are.
class ReportPage {
 public:
  void heading(std::string_view title);
  void paragraph(std::string_view text);
  void cards(const std::vector<ReportCard>&);
  void table(const ReportTable&);
  void figure(std::string_view title, std::string_view caption, std::string_view svg);
  /// Small pictures side by side where there is room.
  void begin_grid();
  void end_grid();
  /// Everything until end_details() is folded away under a summary line.
  void begin_details(std::string_view summary);
  void end_details();
  void html(std::string_view elements) { body_ += elements; }

  [[nodiscard]] std::string finish(std::string_view title, std::string_view subtitle) const;

 private:
  std::string body_;
};

}  // namespace tectum
