// Colours and type of every picture and page.
//
// The hues are Okabe & Ito's (2008), which people with any common form of colour blindness tell apart, darkened for
// white paper and lightened for a dark page until each has a contrast of at least 3 : 1 with its background
// (WCAG 2.1, 1.4.11).
#pragma once

#include <string>
#include <string_view>

namespace tectum {

/// Roles that a mark can take. `c0`..`c7` are for categories, such as nuclei.
struct Ink {
  std::string_view name;
  std::string_view light;
  std::string_view dark;
};

inline constexpr int kCategoryInks = 8;
[[nodiscard]] std::string category_ink(std::size_t index);

/// `:root { --left: ... }` with a dark variant by prefers-color-scheme.
[[nodiscard]] std::string theme_variables_css();

/// Rules for the classes that charts use, with var(--ink) colours: for pages.
[[nodiscard]] std::string chart_css();

/// The same rules with the light colours written out: for SVG files, whose renderers may not know variables.
[[nodiscard]] std::string standalone_chart_css();

}  // namespace tectum
