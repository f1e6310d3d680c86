#include <array>

#include "compiler/compile.h"
#include "compiler/parse/json_tree.h"

namespace tectum {
namespace {

constexpr std::array<std::string_view, 6> kStageNames = {"json", "decl", "circuit", "network", "optimise", "image"};

}  // namespace

std::string_view stage_name(Stage stage) { return kStageNames[static_cast<std::size_t>(stage)]; }

std::optional<Stage> find_stage(std::string_view name) {
  for (std::size_t i = 0; i < kStageNames.size(); ++i) {
    if (kStageNames[i] == name) {
      return static_cast<Stage>(i);
    }
  }
  return std::nullopt;
}

std::string dump_stage(const CompileResult& result, Stage stage, std::size_t max_synapses) {
  switch (stage) {
    case Stage::ParseJson:
      return result.tree ? dump_json_tree(*result.tree) : "";
    case Stage::ParseCircuit:
      return result.decl ? dump_circuit_decl(*result.decl) : "";
    case Stage::Validate:
      return result.circuit ? dump_circuit(*result.circuit) : "";
    case Stage::Elaborate:
    case Stage::Optimise:
      return result.network ? dump_network(*result.network, max_synapses) : "";
    case Stage::Lower:
      break;  // the image has its own dump: runtime/image/describe_image.h
  }
  return "";
}

}  // namespace tectum
