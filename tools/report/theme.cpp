#include "tools/report/theme.h"

#include <fmt/format.h>

#include <array>
#include <functional>

namespace tectum {
namespace {

constexpr std::array<Ink, 18> kInks = {{
    {"bg", "#ffffff", "#14171a"},
    {"panel", "#f5f6f7", "#1d2125"},
    {"fg", "#1b1f23", "#e8eaed"},
    {"muted", "#5c6670", "#9aa5b0"},
    {"grid", "#dfe3e7", "#30363c"},
    {"target", "#8a929a", "#b9c1c9"},
    {"left", "#0072b2", "#56b4e9"},
    {"right", "#d55e00", "#ff8f4d"},
    {"neck", "#00815e", "#2fcf9f"},
    {"goal", "#8a929a", "#b9c1c9"},
    {"c0", "#0072b2", "#56b4e9"},
    {"c1", "#d55e00", "#ff8f4d"},
    {"c2", "#00815e", "#2fcf9f"},
    {"c3", "#a8447f", "#e79ac6"},
    {"c4", "#8a6d00", "#f0c849"},
    {"c5", "#2f83b5", "#9ad1f5"},
    {"c6", "#6a4fb3", "#b9a5f2"},
    {"c7", "#5c6670", "#a9b4be"},
}};

std::string colour_rules(const std::function<std::string(const Ink&)>& colour) {
  std::string css;
  for (const Ink& ink : kInks) {
    css += fmt::format(".s-{0}{{stroke:{1}}}.f-{0}{{fill:{1}}}\n", ink.name, colour(ink));
  }
  return css;
}

constexpr std::string_view kShapeRules =
    "text{font-family:system-ui,-apple-system,'Segoe UI','DejaVu Sans',Roboto,sans-serif;font-size:12px}\n"
    ".b{font-weight:600}.small{font-size:10.5px}.big{font-size:18px}\n"
    ".ln{fill:none;stroke-linejoin:round;stroke-linecap:round}\n"
    ".hair{stroke-width:1;shape-rendering:crispEdges}\n"
    ".dash{stroke-dasharray:5 4}\n"
    ".end{text-anchor:end}.mid{text-anchor:middle}\n";

}  // namespace

std::string category_ink(std::size_t index) { return fmt::format("c{}", index % kCategoryInks); }

std::string theme_variables_css() {
  std::string light;
  std::string dark;
  for (const Ink& ink : kInks) {
    light += fmt::format("--{}:{};", ink.name, ink.light);
    dark += fmt::format("--{}:{};", ink.name, ink.dark);
  }
  return fmt::format(":root{{color-scheme:light dark;{}}}\n@media (prefers-color-scheme:dark){{:root{{{}}}}}\n", light,
                     dark);
}

std::string chart_css() {
  return fmt::format("{}{}", kShapeRules,
                     colour_rules([](const Ink& ink) { return fmt::format("var(--{})", ink.name); }));
}

std::string standalone_chart_css() {
  return fmt::format("{}{}", kShapeRules, colour_rules([](const Ink& ink) { return std::string(ink.light); }));
}

}  // namespace tectum
