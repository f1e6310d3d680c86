// What a circuit file says, as written: every name with its place and unresolved, every value still text.
// Shape is settled (known keys, right JSON types); meaning is not. What had no right shape has been reported and is
// poisoned: it stays in its place, so that the rest can be checked, and nothing is said of what follows from it.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "compiler/source/source_file.h"

namespace tectum {

struct NameDecl {
  std::string text;
  Span span;  // without the quotes
  bool is_poisoned = false;
};

/// A number, or a string that holds an expression.
struct ValueDecl {
  bool is_number = false;
  double number = 0;
  std::string text;                // as written, also of a number
  Span span;                       // without the quotes
  bool has_exact_offsets = false;  // byte i of `text` is byte span.begin + i of the file
  std::uint32_t scope = 0;         // index into CircuitDecl::scopes: whose parameters the expression sees
  bool is_poisoned = false;
};

/// A key whose meaning depends on the model or the rule: "tau_m": "20 ms", "times": ["1 ms", "2 ms"].
struct KeyedValue {
  NameDecl key;
  std::vector<ValueDecl> values;
  bool is_list = false;
  Span span;  // of the value or the list
};

struct ProvenanceDecl {
  std::vector<NameDecl> cites;
  std::string about;
};

struct ReferenceDecl {
  NameDecl name;
  std::string doi;
  std::string title;
};

struct ParameterDecl {
  NameDecl name;
  ValueDecl value;
  std::vector<ValueDecl> range;   // none, or lowest and highest
  std::optional<NameDecl> basis;  // where the value comes from, when no source gives it
  ProvenanceDecl provenance;
};

struct AxisDecl {
  NameDecl name;
  std::vector<NameDecl> sides;
};

struct ReceptorDecl {
  NameDecl name;
  std::optional<NameDecl> kind;
  std::optional<ValueDecl> tau;
  std::optional<ValueDecl> window;
};

struct NamedValueDecl {
  NameDecl name;
  ValueDecl value;
};

/// A neuron model by its equations.
struct ModelDecl {
  NameDecl name;
  std::vector<NamedValueDecl> parameters;
  std::vector<NamedValueDecl> inputs;  // receptor: unit
  std::vector<NamedValueDecl> states;  // with initial values
  std::vector<NamedValueDecl> equations;
  ValueDecl threshold;
  std::vector<NamedValueDecl> reset;
  std::optional<ValueDecl> refractory;
  std::optional<std::vector<NameDecl>> hold;
  std::optional<NameDecl> method;
  ProvenanceDecl provenance;
};

struct NeuronDecl {
  NameDecl name;
  std::optional<NameDecl> extends;
  std::optional<NameDecl> model;
  std::vector<KeyedValue> parameters;
  std::vector<ReceptorDecl> receptors;
  bool has_poisoned_receptors = false;  // not all of them could be read
  ProvenanceDecl provenance;
};

/// What differs on one side of an axis.
struct ExceptionDecl {
  NameDecl side;
  std::vector<KeyedValue> values;
};

/// The input behind a population; `side` is empty when one input serves it whole.
struct InputUseDecl {
  NameDecl side;
  NameDecl input;
};

/// A table of cells in a file: one row a cell, or a list of which each row names some.
struct TableDecl {
  NameDecl name;
  NameDecl file;     // as written
  std::string path;  // the same, as seen from here
  std::vector<NameDecl> ids;
  std::optional<NameDecl> separator;
};

/// The rows of a table that are a population's neurons.
struct CellsDecl {
  NameDecl table;
  std::vector<KeyedValue> where;  // column: what stands in it
  Span span;
};

struct PopulationDecl {
  NameDecl name;
  std::optional<NameDecl> neuron;
  std::vector<InputUseDecl> inputs;
  std::optional<ValueDecl> size;
  std::optional<CellsDecl> cells;  // instead of a size
  std::vector<NameDecl> axes;
  std::optional<NameDecl> nucleus;
  std::string mixed_signs;            // why it both excites and inhibits; empty when it is not meant to
  std::vector<KeyedValue> position;   // x and y
  std::vector<KeyedValue> overrides;  // parameters of the neuron type, for this population
  std::vector<ExceptionDecl> exceptions;
  ProvenanceDecl provenance;
};

struct RuleDecl {
  NameDecl kind;
  std::vector<KeyedValue> arguments;
  std::optional<NameDecl> file;  // of an edge list, as written
  std::string path;              // the same, as seen from here
  std::vector<KeyedValue> columns;
  std::optional<NameDecl> separator;
  std::vector<KeyedValue> rows;  // column: what stands in it; other rows are left out
};

/// One relation for every shared axis (axis empty), or one for a named axis.
struct SideDecl {
  NameDecl axis;
  NameDecl relation;
};

/// Which reward a target side learns by; `side` is empty when one serves them all.
struct RewardUseDecl {
  NameDecl side;
  NameDecl channel;
};

/// How a projection's weights change while it runs.
struct PlasticityDecl {
  Span span;
  bool is_poisoned = false;  // is no object
  std::optional<NameDecl> form;
  std::vector<RewardUseDecl> rewards;
  std::vector<KeyedValue> numbers;  // of kPlasticityNumbers
  std::vector<ValueDecl> bounds;    // none, or lowest and highest
  Span bounds_span;
  std::vector<KeyedValue> learned;  // "A.left->B.left": factors, one a synapse
  ProvenanceDecl provenance;
};

struct ProjectionDecl {
  NameDecl name;
  std::vector<NameDecl> from;
  std::vector<NameDecl> to;
  RuleDecl rule;
  std::vector<SideDecl> side;
  std::vector<NameDecl> only_sides;
  std::optional<NameDecl> sign;
  std::optional<NameDecl> receptor;
  std::optional<ValueDecl> weight;
  std::optional<ValueDecl> delay;
  std::optional<ValueDecl> where;
  std::vector<ExceptionDecl> exceptions;
  std::optional<PlasticityDecl> plasticity;
  ProvenanceDecl provenance;
};

struct RingDecl {
  Span span;
  ValueDecl outer;
  std::optional<ValueDecl> fields_per_side;  // of a ring
  std::vector<ValueDecl> block;              // of the innermost square: columns, rows
};

/// The shorthand that generates the rings.
struct FoveatedDecl {
  Span span;
  ValueDecl outer;
  ValueDecl inner;
  ValueDecl fields_per_side;
  ValueDecl fovea_px;
};

struct RetinaDecl {
  NameDecl name;
  Span span;
  bool is_poisoned = false;  // without its parts
  NameDecl eye;
  std::vector<ValueDecl> frame;
  Span frame_span;
  ValueDecl field_of_view;
  std::vector<RingDecl> rings;
  std::optional<FoveatedDecl> foveated;
  std::optional<NameDecl> lit_channel;
  std::optional<ValueDecl> lit_above;
  std::optional<NameDecl> fires_when;
};

struct OutputTermDecl {
  NameDecl population;
  ValueDecl gain;
};

struct OutputDecl {
  NameDecl name;
  std::vector<NameDecl> rate_difference;  // none, or two
  std::optional<ValueDecl> gain;
  std::vector<OutputTermDecl> terms;
  ValueDecl window;
  std::optional<ValueDecl> offset;
  std::vector<NameDecl> joints;
  std::vector<ValueDecl> limits;
  ProvenanceDecl provenance;
};

struct JointDecl {
  NameDecl name;
  std::vector<ValueDecl> limits;
  Span limits_span;
  std::optional<ValueDecl> max_speed;
};

struct LesionDecl {
  NameDecl name;  // empty for one from the command line
  std::vector<NameDecl> targets;
  std::optional<ValueDecl> fraction;
  std::optional<ValueDecl> weaken_to;  // of the weights; else the targets are removed
};

/// A current from outside the circuit.
struct StimulusDecl {
  NameDecl name;
  std::vector<NameDecl> into;
  std::optional<NameDecl> receptor;
  ValueDecl amplitude;
  ValueDecl at;
  ValueDecl duration;
  std::optional<ValueDecl> pulses;
  std::optional<ValueDecl> every;
};

/// Weights of these projections are multiplied by one factor, so that their matrix has this leading eigenvalue.
struct ScalingDecl {
  NameDecl name;
  std::vector<NameDecl> projections;
  ValueDecl leading_eigenvalue;
};

/// A circuit inside the circuit, to be made several times.
struct ModuleDecl {
  NameDecl name;
  std::vector<NameDecl> ports;  // names that its projections use and that each instance binds
  std::vector<ParameterDecl> parameters;
  std::vector<NeuronDecl> neurons;
  std::vector<PopulationDecl> populations;
  std::vector<ProjectionDecl> projections;
  bool is_poisoned = false;  // may hold more than could be read
};

struct PortBinding {
  NameDecl port;
  std::vector<NameDecl> populations;
};

struct InstanceDecl {
  NameDecl name;
  NameDecl module;
  std::vector<KeyedValue> parameters;
  std::vector<PortBinding> ports;
  bool has_poisoned_ports = false;
};

/// The parameters that one instance of a module sees. Scope 0 is the circuit itself and has none of its own.
struct ScopeDecl {
  std::string prefix;
  std::vector<ParameterDecl> parameters;
};

struct CircuitDecl {
  Span span;
  NameDecl name;
  std::optional<ValueDecl> tick;
  std::optional<ValueDecl> seed;
  std::vector<ReferenceDecl> references;
  std::vector<ParameterDecl> parameters;
  std::vector<AxisDecl> axes;
  std::vector<ModelDecl> models;
  std::vector<NeuronDecl> neurons;
  std::vector<PopulationDecl> populations;
  std::vector<ProjectionDecl> projections;
  std::vector<RetinaDecl> retinas;
  std::vector<OutputDecl> outputs;
  std::vector<JointDecl> joints;
  std::vector<LesionDecl> lesions;
  std::vector<TableDecl> tables;
  std::vector<ScalingDecl> scalings;
  std::vector<StimulusDecl> stimuli;
  std::vector<ModuleDecl> modules;
  std::vector<InstanceDecl> instances;
  std::vector<ScopeDecl> scopes;             // filled by expand_modules
  std::set<std::string> poisoned_sections;   // "populations", ...: may hold names that could not be read
  std::set<std::string> poisoned_instances;  // the same of a module's instance
};

/// One line a declaration, for `dump`.
[[nodiscard]] std::string dump_circuit_decl(const CircuitDecl& decl);

}  // namespace tectum
