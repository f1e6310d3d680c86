// The reference manual, checked: its generated tables are those of the code and its example compiles; and
// every circuit that is shipped is formatted. UPDATE_GOLDEN=1 rewrites the tables.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "compiler/compile.h"
#include "compiler/diagnostics/pages.h"
#include "compiler/diagnostics/render.h"
#include "compiler/expression/functions.h"
#include "compiler/format/format_circuit.h"
#include "compiler/optimise/optimise.h"
#include "compiler/validate/plasticity_keys.h"
#include "compiler/validate/rules.h"
#include "runtime/image/models.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = TECTUM_SOURCE_DIR;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string units() {
  std::map<std::string, std::string> by_dimension;
  for (const auto& [name, dimension] : expression_units()) {
    std::string& list = by_dimension[dimension];
    list += fmt::format("{}`{}`", list.empty() ? "" : " ", name);
  }
  std::string text = "| measures | units |\n| --- | --- |\n";
  for (const auto& [dimension, list] : by_dimension) {
    text += fmt::format("| {} | {} |\n", dimension, list);
  }
  return text;
}

std::string functions() {
  std::string text = "| function | arguments | what it is |\n| --- | --- | --- |\n";
  for (const FunctionInfo& f : expression_functions()) {
    const std::string count = f.least_arguments == f.most_arguments ? fmt::format("{}", f.least_arguments)
                                                                    : fmt::format("{} or more", f.least_arguments);
    text += fmt::format("| `{}` | {} | {} |\n", f.name, count, f.about);
  }
  return text;
}

std::string range(const ParameterInfo& info) {
  if (!std::isfinite(info.minimum) && !std::isfinite(info.maximum)) {
    return "any";
  }
  if (std::isfinite(info.maximum)) {
    return fmt::format("{:g} to {:g}", info.minimum, info.maximum);
  }
  return fmt::format("{} {:g}", info.minimum_is_allowed ? "at least" : "above", info.minimum);
}

std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) {
    result += c == '|' ? "\\|" : c == '\n' ? "<br>" : std::string(1, c);
  }
  return result;
}

std::string models() {
  std::string text;
  for (const ModelInfo& model : all_models()) {
    text += fmt::format("### `{}`: {}\n", model.name, model.title);
    text += fmt::format("{}  \nspikes when {}; then {}.  \nSource: {}.", cell(model.equation),
                        cell(model.spike_condition), cell(model.reset), cell(model.source));
    text += model.weight_unit.empty() ? " Takes no synapses.\n" : fmt::format(" Weights in {}.\n", model.weight_unit);
    text += model.limits.empty() ? "" : fmt::format("Limits: {}.\n", cell(model.limits));
    if (model.parameters.empty()) {
      text += "\n";
      continue;
    }
    text += "\n| parameter | default | range | per neuron | meaning |\n| --- | --- | --- | --- | --- |\n";
    for (const ParameterInfo& info : model.parameters) {
      const std::string value = info.is_required            ? "required"
                                : info.default_text.empty() ? fmt::format("{:g} {}", info.default_value, info.unit)
                                                            : fmt::format("`{}`", info.default_text);
      text += fmt::format("| `{}` | {} | {} | {} | {} |\n", info.name, value, range(info), info.may_vary ? "yes" : "no",
                          cell(info.meaning));
    }
    text += "\n";
  }
  return text;
}

std::string rules() {
  std::string text = "| rule | keys | what it joins |\n| --- | --- | --- |\n";
  for (const RuleSpelling& rule : kRules) {
    std::string keys;
    for (const char* key : rule.arguments) {
      keys += key == nullptr ? "" : fmt::format("{}`{}`", keys.empty() ? "" : ", ", key);
    }
    text += fmt::format("| `{}` | {} | {} |\n", rule.text, keys, rule.about);
  }
  return text;
}

std::string plasticity() {
  std::string text = "| key | default | meaning |\n| --- | --- | --- |\n";
  for (const PlasticityNumber& number : kPlasticityNumbers) {
    text += fmt::format("| `{}` | {} | {} |\n", number.key,
                        number.default_text == nullptr ? "required" : number.default_text, cell(number.about));
  }
  return text;
}

std::string rewards() {
  std::string text =
      "| reward | R = 1 - \\|x\\|, x from 0 in the middle of the retina to 1 at its edge |\n| --- | --- |\n";
  for (std::size_t channel = 0; channel < kRewardChannelCount; ++channel) {
    text += fmt::format("| `{}` | {} |\n", kRewardChannelNames[channel], kRewardChannelMeanings[channel]);
  }
  return text;
}

std::string codes() {
  std::string text = "| code | says | means |\n| --- | --- | --- |\n";
  for (std::size_t i = 0; i < code_count(); ++i) {
    const auto code = static_cast<Code>(i);
    const std::string_view meaning = page_of(code).meaning;
    text += fmt::format("| {} | {} | {} |\n", code_label(code), code_info(code).name,
                        cell(meaning.substr(0, meaning.find(". "))));
  }
  return text;
}

std::string passes() {
  std::string text = "| pass | from | what it does |\n| --- | --- | --- |\n";
  for (const PassInfo& pass : all_passes()) {
    text += fmt::format("| `{}` | -O{} | {} |\n", pass.name, static_cast<int>(pass.from), pass.what);
  }
  return text;
}

/// `text` with what stands between the markers of `name` replaced.
std::string with_table(std::string text, const std::string& name, const std::string& table) {
  const std::string begin = "<!-- generated: " + name + " -->\n";
  const std::size_t at = text.find(begin);
  REQUIRE_MESSAGE(at != std::string::npos, name);
  const std::size_t end = text.find("<!-- end -->", at);
  return text.replace(at + begin.size(), end - at - begin.size(), table);
}

}  // namespace

TEST_CASE("the manual's tables are those of the code") {
  const fs::path path = kRoot / "compiler" / "README.md";
  const std::string before = read_text(path);
  std::string text = before;
  text = with_table(text, "units", units());
  text = with_table(text, "functions", functions());
  text = with_table(text, "models", models());
  text = with_table(text, "rules", rules());
  text = with_table(text, "plasticity", plasticity());
  text = with_table(text, "rewards", rewards());
  text = with_table(text, "codes", codes());
  text = with_table(text, "passes", passes());
  const char* update = getenv("UPDATE_GOLDEN");
  if (update != nullptr && std::string(update) == "1") {
    std::ofstream(path, std::ios::binary) << text;
  } else {
    CHECK_MESSAGE(text == before, "UPDATE_GOLDEN=1 brings compiler/README.md up to date");
  }
}

TEST_CASE("the manual's example compiles without a word") {
  const std::string manual = read_text(kRoot / "compiler" / "README.md");
  const std::string begin = "<!-- example -->\n```jsonc\n";
  const std::size_t at = manual.find(begin) + begin.size();
  Diagnostics diagnostics;
  const CompileResult result =
      compile_circuit({"example.json", manual.substr(at, manual.find("```", at) - at)}, {}, diagnostics);
  CHECK(render_text(diagnostics, result.sources) == "");
  CHECK(result.image.has_value());
}

TEST_CASE("every circuit that is shipped is formatted") {
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "circuits")) {
    // Heads, protocols and tests of circuits are JSON too, and no circuits.
    const std::string folder = entry.path().parent_path().filename().string();
    if (entry.path().extension() != ".json" || folder == "schema" || folder == "heads" || folder == "protocols" ||
        entry.path().stem().extension() == ".test") {
      continue;
    }
    CAPTURE(entry.path().filename().string());
    const std::string text = read_text(entry.path());
    const FormattedCircuit once = format_circuit(text);
    REQUIRE_MESSAGE(once.text.has_value(), once.error);
    CHECK_MESSAGE(*once.text == text, "tectum fmt brings it into form");
    CHECK(format_circuit(*once.text).text == once.text);
    ++count;
  }
  CHECK(count > 0);
}

}  // namespace tectum
