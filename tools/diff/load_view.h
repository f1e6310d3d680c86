#pragma once

#include <string>

#include "tools/diff/circuit_view.h"

namespace tectum {

struct LoadedView {
  CircuitView view;
  std::string error;              // as printed; empty when there is a view
  bool is_wrong_circuit = false;  // the file was read; the circuit in it has errors
};

/// A circuit file or a compiled image.
[[nodiscard]] LoadedView load_view(const std::string& path);
/// The text of a circuit file that `name` stands for.
[[nodiscard]] LoadedView compile_view(SourceFile file);

}  // namespace tectum
