#include "compiler/diagnostics/pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace tectum {
namespace {

struct NumberedPage {
  Severity severity;
  std::uint16_t number;
  DiagnosticPage page;
};

constexpr std::array kPages = {
#define PAGE(severity, number, meaning, failing, mended) \
  NumberedPage{Severity::severity, number, {meaning, failing, mended}},
#include "compiler/diagnostics/pages.def"
#undef PAGE
};

constexpr std::string_view kExampleCircuit = R"({
  "tectum": 1, "name": "example", "tick": "0.1 ms",
  "axes": { "horizontal": ["left", "right"] },
  "parameters": { "g": "1 nA" },
  "neurons": { "burst": { "model": "lif_exp", "I_bias": "2 nA" } },
  "populations": {
    "SC": { "input": "left_eye", "rate": "100 Hz" },
    "EBN": { "neuron": "burst", "size": 10, "axis": "horizontal" },
    "IFN": { "neuron": "burst", "size": 10, "axis": "horizontal" },
    "OPN": { "neuron": "burst", "size": 10 }
  },
  "projections": {
    "ebn_ifn": { "from": "EBN", "to": "IFN", "rule": "one_to_one", "weight": "2 nA", "delay": "1 ms" }
  },
  "inputs": {
    "left_eye": { "retina": {
      "eye": "left", "frame": [64, 64], "field_of_view": "60 deg", "lit": { "channel": "luma", "above": 128 },
      "rings": [{ "outer": 32, "fields_per_side": 4 }, { "outer": 16, "block": [4, 4] }]
    } }
  }
}
)";

constexpr std::size_t kTextWidth = 96;

/// Words at blanks, lines of at most kTextWidth.
std::string wrapped(std::string_view text) {
  std::string result;
  std::size_t column = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (column > 0 && column + 1 + end > kTextWidth) {
      result += '\n';
      column = 0;
    }
    result += column > 0 ? " " : "";
    result += text.substr(0, end);
    column += (column > 0 ? 1 : 0) + end;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result + '\n';
}

std::string shown_example(std::string_view example) {
  const bool is_file = example.substr(0, 1) == "=";
  return fmt::format("    {}\n", is_file ? example.substr(2) : example);
}

}  // namespace

const DiagnosticPage& page_of(Code code) {
  static constexpr DiagnosticPage kNoPage{};
  for (const NumberedPage& page : kPages) {
    if (page.severity == code_info(code).severity && page.number == code_info(code).number) {
      return page.page;
    }
  }
  return kNoPage;
}

std::string_view example_circuit() { return kExampleCircuit; }

std::string example_file(std::string_view example) {
  if (example.substr(0, 1) == "=") {
    return std::string(example.substr(1));
  }
  return fmt::format("{{ \"extends\": \"base.json\",\n{}\n}}\n", example);
}

std::string page_text(Code code) {
  const DiagnosticPage& page = page_of(code);
  std::string text = fmt::format("{}[{}] {}\n\n{}", code_info(code).severity == Severity::Error ? "error" : "warning",
                                 code_label(code), code_info(code).name, wrapped(page.meaning));
  if (page.failing.empty()) {
    return text;
  }
  text += "\nThis fails:\n" + shown_example(page.failing) + "\nThis does not:\n" + shown_example(page.mended);
  return text + "\nThe rest of the circuit in these examples: `tectum explain example`\n";
}

}  // namespace tectum
