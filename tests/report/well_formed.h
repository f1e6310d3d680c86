// Is a page or picture well-formed? Enough of XML to notice an unclosed tag, a stray bracket or a raw ampersand.
#pragma once

#include <string>
#include <string_view>

namespace tectum {

/// Empty if every tag is closed in order, every attribute quoted and every & an entity; else what is wrong and where.
[[nodiscard]] std::string first_markup_error(std::string_view text);

}  // namespace tectum
