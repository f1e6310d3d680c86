#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/validate/validation.h"

namespace tectum {

/// Opens an edge list far enough to find its columns; the rows come later.
class EdgeTableReader {
 public:
  EdgeTableReader(Validation& v, const RuleDecl& rule) : v_(v), rule_(rule) {}

  /// Reports and returns nothing when the file cannot be read or lacks a column.
  std::optional<EdgeTable> read();
  /// Columns beside pre and post, in the order of EdgeTable::columns: what expressions call `edge.NAME`.
  [[nodiscard]] const std::vector<std::string>& variables() const { return variables_; }

 private:
  std::optional<std::size_t> find_column(const std::string& name, Span span, const std::vector<std::string>& header);

  Validation& v_;
  const RuleDecl& rule_;
  std::vector<std::string> variables_;
};

}  // namespace tectum
