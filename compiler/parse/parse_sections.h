// The sections of a circuit file, one function a kind of declaration. Called by parse_circuit alone.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "compiler/diagnostics/diagnostic.h"
#include "compiler/parse/circuit_decl.h"
#include "compiler/parse/json_tree.h"

namespace tectum {

/// Where a section's parser stands.
struct SectionContext {
  const JsonTree& tree;
  const Sources& sources;
  Diagnostics& diagnostics;
};

/// A member of a section: its name with its place, and its value's node.
struct Member {
  NameDecl name;
  JsonId id;
};

class ObjectReader;

/// "exceptions": { "left": { "weight": "2 nA" } } of a population or a projection.
std::vector<ExceptionDecl> parse_exceptions(const SectionContext& context, ObjectReader& owner);

/// "plasticity" of a projection.
PlasticityDecl parse_plasticity(const SectionContext& context, JsonId id, const std::string& owner);

/// "`size`".
[[nodiscard]] std::string quoted_key(std::string_view key);
/// "population `EBN`".
[[nodiscard]] std::string described(std::string_view kind, const NameDecl& name);

ReferenceDecl parse_reference(const SectionContext& context, const Member& member);
ParameterDecl parse_parameter(const SectionContext& context, const Member& member);
AxisDecl parse_axis(const SectionContext& context, const Member& member);
ModelDecl parse_model(const SectionContext& context, const Member& member);
NeuronDecl parse_neuron(const SectionContext& context, const Member& member);
PopulationDecl parse_population(const SectionContext& context, const Member& member);
ProjectionDecl parse_projection(const SectionContext& context, const Member& member);
RetinaDecl parse_input(const SectionContext& context, const Member& member);
OutputDecl parse_output(const SectionContext& context, const Member& member);
JointDecl parse_joint(const SectionContext& context, const Member& member);
ModuleDecl parse_module(const SectionContext& context, const Member& member);
InstanceDecl parse_instance(const SectionContext& context, const Member& member);
LesionDecl parse_lesion(const SectionContext& context, const Member& member);
TableDecl parse_table(const SectionContext& context, const Member& member);
ScalingDecl parse_scaling(const SectionContext& context, const Member& member);
/// "cells" of a population.
CellsDecl parse_cells(const SectionContext& context, JsonId id);
/// An object of column: what stands in it, or a list of such.
std::vector<KeyedValue> parse_row_filter(const SectionContext& context, ObjectReader& owner, std::string_view key);
StimulusDecl parse_stimulus(const SectionContext& context, const Member& member);

}  // namespace tectum
