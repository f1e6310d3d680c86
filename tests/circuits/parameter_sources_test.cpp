// No number without an origin: what the shipped circuits' parameters say about where their values come from.
#include <doctest/doctest.h>

#include <filesystem>

#include "compiler/compile.h"
#include "compiler/diagnostics/render.h"

using namespace tectum;
namespace fs = std::filesystem;

namespace {

const fs::path kCircuits = fs::path(TECTUM_SOURCE_DIR) / "circuits";

bool is_circuit(const fs::path& path) {
  return path.extension() == ".json" && !path.filename().string().ends_with(".test.json");
}

void check_parameters(const std::string& owner, const std::vector<ParameterDecl>& parameters) {
  for (const ParameterDecl& parameter : parameters) {
    const std::string name = owner + parameter.name.text;
    CHECK_MESSAGE((parameter.basis || !parameter.provenance.cites.empty()), name,
                  " says neither `cite` nor `basis`: published, \"fitted\", \"derived\" or \"chosen\"?");
    const bool says_fitted_in_prose = parameter.provenance.about.starts_with("fitted");
    CHECK_MESSAGE(!says_fitted_in_prose, name, ": fitted is said by `basis`");
  }
}

/// The number of parameters that were looked at.
std::size_t check_circuit(const fs::path& path) {
  ReadSource source = read_source(path.string());
  REQUIRE_MESSAGE(source.ok, source.error);
  CompileOptions options;
  options.last_stage = Stage::Validate;
  Diagnostics diagnostics;
  const CompileResult result = compile_circuit(std::move(source.file), options, diagnostics);
  REQUIRE_MESSAGE(result.circuit.has_value(), render_text(diagnostics, result.sources));
  const std::string file = path.filename().string() + ": ";
  check_parameters(file, result.decl->parameters);
  for (const ModuleDecl& module : result.decl->modules) {
    check_parameters(file + module.name.text + ".", module.parameters);
  }
  return result.decl->parameters.size();
}

}  // namespace

TEST_CASE("every parameter of a shipped circuit cites a source or says on what basis it has its value") {
  std::size_t parameters = 0;
  for (const char* folder : {"", "experiments", "bench"}) {
    for (const fs::directory_entry& entry : fs::directory_iterator(kCircuits / folder)) {
      if (is_circuit(entry.path())) {
        parameters += check_circuit(entry.path());
      }
    }
  }
  CHECK(parameters > 100);
}
