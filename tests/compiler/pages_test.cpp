// The page of each diagnostic, taken at its word: its failing example fails with that code alone, the mended one does
// not.
#include "compiler/diagnostics/pages.h"

#include <doctest/doctest.h>

#include <set>
#include <string>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"

namespace tectum {
namespace {

struct Checked {
  std::set<std::string> errors;
  std::set<std::string> all;
  std::string text;
};

Checked check(const std::string& bytes) {
  CompileOptions options;
  options.read = [&](const std::string& path) {
    if (path == "base.json") {
      return ReadSource{true, {path, std::string(example_circuit())}, {}};
    }
    return path == "example.json" ? ReadSource{true, {path, bytes}, {}}
                                  : ReadSource{false, {}, path + ": No such file or directory"};
  };
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit({"example.json", bytes}, options, diagnostics);
  Checked checked;
  for (const Diagnostic& d : diagnostics.all()) {
    checked.all.insert(code_label(d.code));
    if (code_info(d.code).severity == Severity::Error) {
      checked.errors.insert(code_label(d.code));
    }
  }
  checked.text = render_text(diagnostics, result.sources);
  return checked;
}

}  // namespace

TEST_CASE("the circuit behind the examples has nothing to report") {
  CHECK(check(std::string(example_circuit())).text.empty());
}

TEST_CASE("every diagnostic has a page whose failing example gives its code alone and whose mended one does not") {
  // Not text, not UTF-8, 65 brackets, the command line, and sizes beyond memory: no example that could be read.
  const std::set<std::string> without_example = {"E0102", "E0103", "E0114", "E0221", "E0501", "E0502"};
  for (std::size_t i = 0; i < code_count(); ++i) {
    const auto code = static_cast<Code>(i);
    const std::string label = code_label(code);
    CAPTURE(label);
    const DiagnosticPage& page = page_of(code);
    CHECK(page.meaning.size() > 20);
    CHECK(page.failing.empty() == (without_example.count(label) != 0));
    if (page.failing.empty()) {
      continue;
    }
    const Checked failing = check(example_file(page.failing));
    CAPTURE(failing.text);
    CHECK(failing.all.count(label) == 1);
    CHECK(failing.errors.size() == (code_info(code).severity == Severity::Error ? 1U : 0U));
    const Checked mended = check(example_file(page.mended));
    CAPTURE(mended.text);
    CHECK(mended.all.count(label) == 0);
    CHECK(mended.errors.empty());
  }
}

}  // namespace tectum
