// What `tectum check` says of a circuit without a mistake.
#pragma once

#include <string>

#include "compiler/compile.h"

namespace tectum {

/// Sizes, worst case and mirrors, a line each. Needs: a result with its network.
[[nodiscard]] std::string check_text(const std::string& path, const CompileResult& result);

/// The same as members of a JSON object, without its braces; with the provenance where it is asked for.
[[nodiscard]] std::string check_json(const CompileResult& result, bool shows_provenance);

}  // namespace tectum
