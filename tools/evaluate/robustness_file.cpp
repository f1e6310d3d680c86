// The robustness protocol's part of a protocol file.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/diagnostics/render.h"
#include "compiler/parse/object_reader.h"
#include "compiler/parse/parse_json.h"
#include "compiler/validate/scope.h"
#include "tools/evaluate/robustness.h"

namespace tectum {
namespace {

constexpr std::array<DisturbanceFacts, kDisturbances> kFacts = {{
    {"sensor_noise", "Noise of the sensor", "grey levels", 1, 0, 255, false},
    {"dropped_frames", "Dropped frames", "%", 100, 0, 0.99, false},
    {"dot_brightness", "Brightness of the dot", "grey levels", 1, 0, 1000, false},
    {"room_brightness", "Brightness of the room", "grey levels", 1, 0, 255, false},
    {"dead_fields", "Dead receptive fields", "%", 100, 0, 1, true},
    {"lost_neurons", "Lost neurons", "%", 100, 0, 1, true},
    {"weight_noise", "Each synapse off by at most", "%", 100, 0, 0.9, true},
    {"pathway_noise", "Each pathway off by at most", "%", 100, 0, 0.9, true},
}};

RobustnessPlan read_plan(const JsonTree& tree, Diagnostics& diagnostics) {
  RobustnessPlan plan;
  ObjectReader protocol(tree, tree.root(), "the protocol", diagnostics);
  const JsonId id = protocol.child("robustness");
  if (id == JsonId::None) {
    return plan;  // read_protocol_text() reports it
  }
  Scope scope(diagnostics);
  ObjectReader in(tree, id, "`robustness`", diagnostics);
  for (std::size_t d = 0; d < kDisturbances; ++d) {
    const DisturbanceFacts& facts = kFacts[d];
    if (in.child(facts.key) == JsonId::None) {
      continue;
    }
    for (const ValueDecl& value : in.values(facts.key, 0)) {
      const std::optional<double> level = scope.constant(value, facts.key, kNumber);
      if (level && (*level < facts.lowest || *level > facts.highest)) {
        diagnostics.add(Code::OutOfRange, value.span,
                        {facts.key, shown(*level, kNumber), fmt::format("{} to {}", facts.lowest, facts.highest)});
      } else if (level) {
        plan.levels[d].push_back(*level);
      }
    }
  }
  in.finish();
  return plan;
}

}  // namespace

const DisturbanceFacts& facts_of(Disturbance disturbance) { return kFacts[static_cast<std::size_t>(disturbance)]; }

ReadRobustness read_robustness_text(const std::string& name, const std::string& bytes) {
  ReadRobustness read;
  Sources sources;
  Diagnostics diagnostics;
  const FileId file = sources.add({name, bytes});
  if (const std::optional<JsonTree> tree = parse_json(sources, file, diagnostics)) {
    read.plan = read_plan(*tree, diagnostics);
  }
  if (!diagnostics.all().empty()) {
    diagnostics.sort();
    read.problems = render_text(diagnostics, sources);
  }
  if (diagnostics.has_errors()) {
    read.plan.reset();
  }
  return read;
}

}  // namespace tectum
