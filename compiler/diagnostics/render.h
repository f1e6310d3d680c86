// Diagnostics as text for people and as JSON for tools.
#pragma once

#include <string>
#include <string_view>

#include "compiler/diagnostics/diagnostic.h"

namespace tectum {

/// file:line:col: error[E0204]: message, the line with carets, other places, help lines.
[[nodiscard]] std::string render_text(const Diagnostics& diagnostics, const Sources& sources);

/// One JSON object: {"diagnostics": [{code, name, severity, message, file, line, column, end_line, end_column,
/// begin, end, labels, help}], "errors": n, "warnings": n}. Lines and columns count from 1, offsets are bytes.
/// `members`, unless empty, are further members of the object, already JSON.
[[nodiscard]] std::string render_json(const Diagnostics& diagnostics, const Sources& sources,
                                      std::string_view members = {});

/// `text` as a JSON string, with its quotes.
[[nodiscard]] std::string json_quoted(std::string_view text);

}  // namespace tectum
