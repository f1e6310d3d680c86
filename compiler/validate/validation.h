// The state that the parts of validate() share. Included by validate*.cpp alone.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/validate/cell_tables.h"
#include "compiler/validate/circuit.h"
#include "compiler/validate/scope.h"
#include "compiler/validate/validate.h"
#include "runtime/image/models.h"

namespace tectum {

/// A neuron type with everything it inherits.
struct ResolvedNeuron {
  NameDecl name;
  const ModelInfo* model = nullptr;  // null when it could not be found; that has been reported
  NameDecl model_name;
  std::vector<KeyedValue> parameters;  // nearest declaration of each key
  std::vector<ReceptorDecl> receptors;
  bool has_poisoned_receptors = false;
  std::shared_ptr<const UserModel> user_model;  // when the circuit declares the model
};

struct Validation {
  const CircuitDecl& decl;
  const Overrides& overrides;
  Scope scope;
  Circuit circuit;

  std::map<std::string, std::uint32_t, std::less<>> axis_of;
  std::map<std::string, std::uint32_t, std::less<>> population_of;  // declared, right or wrong
  std::vector<bool> is_sound;     // population by population: model, size, sides and places are known
  std::vector<bool> knows_sides;  // population by population
  std::vector<bool> is_sound_axis;
  std::map<std::string, std::shared_ptr<const UserModel>, std::less<>> user_models;  // null: wrong
  std::map<std::string, std::uint32_t, std::less<>> retina_of;
  std::vector<bool> is_sound_retina;
  std::map<std::string, std::uint32_t, std::less<>> table_of;
  std::vector<TableContents> tables;

  [[nodiscard]] Diagnostics& diagnostics() { return scope.diagnostics(); }
  /// Can a name that is not found in this section be called unknown? No when the section could not be read.
  [[nodiscard]] bool knows_all(std::string_view section) const;
  /// The same of one name: not when it is poisoned itself. Notes the silence that follows.
  [[nodiscard]] bool can_report(const NameDecl& name, std::string_view section);
  void check_cites(const ProvenanceDecl& provenance);
  /// "EBN" or "EBN.left". Reports what it does not find.
  std::optional<Endpoint> endpoint(const NameDecl& name);
};

void validate_parameters(Validation& v);
void validate_axes(Validation& v);
void validate_models(Validation& v);
/// Compiles the equations with the population's own parameters, so that lowering cannot fail.
void check_user_model(Validation& v, const Population& population, const NameDecl& owner);
void validate_retinas(Validation& v);
void validate_populations(Validation& v);
void validate_projections(Validation& v);
/// `known_sides` are those of the projection's ends. Nothing when it has a mistake, which is reported.
[[nodiscard]] std::optional<Plasticity> validate_plasticity(Validation& v, const PlasticityDecl& decl,
                                                            const std::string& target,
                                                            const std::vector<std::string>& known_sides);
void validate_outputs(Validation& v);
void validate_lesions(Validation& v);
void validate_scalings(Validation& v);
void validate_stimuli(Validation& v);

/// The names of a list of declarations, for suggestions.
template <typename Decl>
[[nodiscard]] std::vector<std::string> names_of(const std::vector<Decl>& decls) {
  std::vector<std::string> names;
  for (const Decl& decl : decls) {
    names.push_back(decl.name.text);
  }
  return names;
}

}  // namespace tectum
