// From a circuit file to the contents of its spike image, in one call.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/elaborate/elaborate.h"
#include "compiler/elaborate/network.h"
#include "compiler/optimise/optimise.h"
#include "compiler/parse/circuit_decl.h"
#include "compiler/parse/compose.h"
#include "compiler/parse/json_tree.h"
#include "compiler/validate/circuit.h"
#include "runtime/image/image_contents.h"

namespace tectum {

/// The stages, in order. A compilation can stop after any of them.
enum class Stage { ParseJson, ParseCircuit, Validate, Elaborate, Optimise, Lower };
/// "json", "decl", "circuit", "network", "optimise", "image".
[[nodiscard]] std::string_view stage_name(Stage stage);
[[nodiscard]] std::optional<Stage> find_stage(std::string_view name);

struct CompileOptions {
  OptimisationLevel level = OptimisationLevel::O2;
  Stage last_stage = Stage::Lower;
  std::string last_pass;                // with Stage::Optimise: stop after this pass; empty = all
  std::optional<std::uint64_t> seed;    // instead of the file's
  std::vector<std::string> lesions;     // "OPN", "EBN.left", "sc_llbn", "SC*->LLBN", "OPN:0.5"
  std::vector<std::string> parameters;  // "g_sc=0.5 nA"
  SourceReader read = read_source;      // of included and extended files
  ElaborateProgress progress;           // of the longest stage, the wiring
  bool measures_memory = false;         // peak memory of each stage
};

struct StageTime {
  std::string name;
  double seconds = 0;
  std::uint64_t peak_bytes = 0;  // of the whole process while the stage ran; 0: not measured
};

/// Every stage's product, as far as the compilation came.
struct CompileResult {
  Sources sources;  // what diagnostics point into
  std::optional<JsonTree> tree;
  std::optional<CircuitDecl> decl;
  std::optional<Circuit> circuit;
  std::optional<Network> network;  // optimised when that stage ran
  std::optional<ImageContents> image;
  std::vector<PassStats> passes;
  std::vector<StageTime> times;
};

/// Compiles `file`. The image is there if and only if there were no errors (and no earlier last_stage);
/// `diagnostics` holds errors and warnings in source order.
[[nodiscard]] CompileResult compile_circuit(SourceFile file, const CompileOptions& options, Diagnostics& diagnostics);

/// Text of what the last stage made, for `dump`; of a network, at most `max_synapses` synapses.
[[nodiscard]] std::string dump_stage(const CompileResult& result, Stage stage, std::size_t max_synapses);

}  // namespace tectum
