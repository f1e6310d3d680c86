// A page for each diagnostic: what it means, a failing example and the mended one.
#pragma once

#include <string>
#include <string_view>

#include "compiler/diagnostics/diagnostic.h"

namespace tectum {

struct DiagnosticPage {
  std::string_view meaning;
  std::string_view failing;  // empty where no small file can fail in this way
  std::string_view mended;
};

[[nodiscard]] const DiagnosticPage& page_of(Code code);

/// What the examples are written over.
[[nodiscard]] std::string_view example_circuit();
/// The example as a whole file: one that begins with = is a file already, any other extends "base.json", which is the
/// example circuit.
[[nodiscard]] std::string example_file(std::string_view example);

/// For `tectum explain E0204`.
[[nodiscard]] std::string page_text(Code code);

}  // namespace tectum
