// A legal circuit: names are ids, quantities are numbers in fixed units, every reference leads somewhere.
// Only validate() makes one; later stages check nothing again except resource limits.
// Fixed units: mV, ms, nA, MOhm, Hz, deg, px; a weight is in its target model's weight unit.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/expression/expression.h"
#include "compiler/source/cell_numbers.h"
#include "compiler/source/source_file.h"
#include "compiler/validate/user_model.h"
#include "runtime/image/plasticity.h"
#include "runtime/image/spike_image.h"

namespace tectum {

enum class AxisId : std::uint32_t {};
enum class PopulationId : std::uint32_t {};
/// One side of a population: "EBN.left". A population without an axis has one.
enum class InstanceId : std::uint32_t {};
enum class ProjectionId : std::uint32_t {};
enum class RetinaId : std::uint32_t {};

template <typename Id>
[[nodiscard]] constexpr std::size_t index_of(Id id) {
  return static_cast<std::size_t>(id);
}

/// Which neuron a cell of a table is.
struct CellPlace {
  static constexpr std::uint32_t kNowhere = 0xFFFFFFFFU;
  std::uint32_t instance = kNowhere;  // of no population
  std::uint32_t index = 0;
};

/// Cells that a file lists.
struct CellTable {
  std::string name;
  CellNumbers numbers;
  std::vector<CellPlace> places;  // by number
};

struct Axis {
  std::string name;
  std::vector<std::string> sides;
};

struct Receptor {
  std::string name;
  ReceptorKind kind = ReceptorKind::Exponential;
  double tau_ms = 0;               // Exponential
  std::uint32_t window_ticks = 0;  // Boxcar
};

struct Population {
  std::string name;
  Span name_span;
  std::string nucleus;  // empty when none is given
  ModelKind model = ModelKind::LifExp;
  std::shared_ptr<const UserModel> user_model;  // of ModelKind::Program
  bool may_sleep = false;
  bool may_mix_signs = false;               // the circuit says why it both excites and inhibits
  std::uint32_t size = 0;                   // of each side
  std::optional<std::uint32_t> cell_table;  // its neurons are cells of this table
  std::vector<AxisId> axes;
  std::vector<Receptor> receptors;
  std::optional<Dimension> position_dimension;  // of its neurons' x and y, where they have a place
  InstanceId first_instance{};
  std::uint32_t instance_count = 1;
};

struct Instance {
  std::string name;  // "EBN.left"
  PopulationId population{};
  std::vector<std::uint32_t> sides;  // one an axis of the population
  /// By language name; one value for all neurons, or one a neuron.
  std::map<std::string, std::vector<double>> parameters;
  std::vector<std::uint32_t> spike_ticks;  // spike_list: ascending
  /// Where the neurons lie, coherent units; for a retina deg from the optical axis, right and up positive.
  std::vector<double> x, y;
  std::vector<double> ecc;  // retina: deg between the field's ray and the axis
  std::optional<RetinaId> retina;
};

/// The population's model, built in or declared by the circuit.
[[nodiscard]] const ModelInfo& model_of(const Population& population);

enum class RuleKind : std::uint8_t { OneToOne, AllToAll, FixedProbability, FixedInDegree, FixedOutDegree, EdgeList };
enum class Relation : std::uint8_t { Ipsi, Contra, Both };

/// A population, or one side of it; fixed_sides has one entry an axis of the population.
struct Endpoint {
  PopulationId population{};
  std::vector<std::optional<std::uint32_t>> fixed_sides;
  std::uint32_t receptor = 0;  // of a target
};

struct AxisRelation {
  AxisId axis{};
  Relation relation = Relation::Ipsi;
};

/// Rows of an edge list that are meant: those with one of these texts in the column.
struct RowFilter {
  std::size_t column = 0;  // of the file
  std::vector<std::string> texts;
};

/// Wiring in a file: one row a synapse.
struct EdgeTable {
  std::string path;
  Span span;
  bool has_header = true;
  std::vector<std::size_t> columns;  // of the file: pre, post, then those that expressions read
  std::uint64_t first_index = 0;     // what the file calls the first neuron
  char separator = '\0';             // 0: whichever the first line uses most
  bool names_cells = false;          // pre and post are names in these tables
  std::uint32_t pre_table = 0;
  std::uint32_t post_table = 0;
  std::vector<RowFilter> rows;
};

/// What differs where the target (or, where it has no side, the source) is on this side.
struct SideException {
  std::string side;
  std::optional<TypedExpression> weight;
  std::optional<TypedExpression> delay;
};

/// Which reward the target sides of this name learn by; empty means all.
struct RewardUse {
  std::string side;
  RewardChannel channel = RewardChannel::Pan;
};

/// Factors on the declared weights of a pathway "A.left->B.left", in the order in which its synapses are made.
struct LearnedFactors {
  std::string pathway;
  Span span;
  std::vector<double> factors;
};

/// How a projection learns; the rule is in runtime/image/plasticity.h.
struct Plasticity {
  PlasticityForm form = PlasticityForm::ThreeFactor;
  std::vector<RewardUse> rewards;  // a side that none of them means does not learn
  double learning_rate = 0;        // 1/ms
  double tau_eligibility_ms = 0;
  double tau_rate_ms = 0;
  double tau_mean_ms = 0;
  double tau_reward_ms = 0;
  double reference_rate = 0;  // 1/ms
  double lowest = 0;          // of a weight, as a share of the declared one
  double highest = 2;
  std::vector<LearnedFactors> learned;
};

struct Projection {
  std::string name;
  Span name_span;
  std::vector<Endpoint> from;
  std::vector<Endpoint> to;
  RuleKind rule = RuleKind::AllToAll;
  bool allows_autapses = false;
  std::uint32_t degree = 0;                    // FixedInDegree, FixedOutDegree
  std::optional<TypedExpression> probability;  // FixedProbability
  std::vector<AxisRelation> relations;         // of axes where it is not ipsi
  std::vector<std::string> only_sides;         // of the target, else of the source; empty = all
  bool is_inhibitory = false;
  TypedExpression weight;
  TypedExpression delay;  // ms
  std::optional<TypedExpression> where;
  std::optional<EdgeTable> edges;
  std::vector<SideException> exceptions;
  std::optional<Plasticity> plasticity;
  Span weight_span;
  Span delay_span;
  std::string cite;  // reference keys, comma separated
};

/// Variables of projection expressions, as evaluator slots. Three more follow for each axis a:
/// kFirstAxisVariable + 3 a + {0: side of pre, 1: side of post, 2: hemifield of pre}, and then the columns of an edge
/// list. Places are in the coherent units of the populations' positions.
enum PairVariable : std::uint32_t {
  kPreIndex,
  kPostIndex,
  kPreSize,
  kPostSize,
  kPrePosition,  // (index + 1/2) / size
  kPostPosition,
  kPreX,
  kPreY,
  kPreEccentricity,
  kPostX,
  kPostY,
  kPostEccentricity,
  kDistance,    // between (pre.x, pre.y) and (post.x, post.y)
  kPairRandom,  // in [0, 1): a number of its own for each pair, another one for each expression of a projection
  kFirstAxisVariable
};

/// Field centres as angles from the optical axis, for retina populations.
struct RetinaSheet {
  std::string name;
  Eye eye = Eye::Left;
  std::uint32_t frame_width = 0;
  std::uint32_t frame_height = 0;
  double field_of_view_deg = 0;
  LitChannel lit_channel = LitChannel::Luma;
  std::uint32_t lit_above = 0;
  double lit_share = 0;
  std::vector<FieldRecord> fields;
};

struct OutputTerm {
  InstanceId instance{};
  double gain = 0;  // deg/Hz or deg/s/Hz
};

struct Output {
  std::string name;
  OutputKind kind = OutputKind::Position;
  std::vector<OutputTerm> terms;
  std::uint32_t joint_mask = 0;
  std::uint32_t window_ticks = 0;
  double offset_deg = 0;
};

struct JointSetting {
  Joint joint = Joint::LeftEyePan;
  double min_deg = 0;
  double max_deg = 0;
  double max_speed_deg_s = 0;  // 0 = none
};

/// One factor for all weights of some projections.
struct Scaling {
  std::string name;
  Span span;
  std::vector<ProjectionId> projections;
  double leading_eigenvalue = 0;  // in the weights' unit
};

/// Removes all, or a random fraction, of what it names.
struct Lesion {
  std::string key;  // of the random draws
  double fraction = 1;
  std::optional<double> weaken_to;    // instead of removing: what is left of the weights
  std::vector<InstanceId> instances;  // their neurons fall silent
  std::vector<ProjectionId> projections;
  std::vector<std::pair<InstanceId, InstanceId>> pathways;
};

struct Circuit {
  std::string name;
  std::uint64_t tick_ns = 0;
  std::uint64_t seed = 0;
  bool has_references = false;  // the file keeps track of its sources
  std::vector<Axis> axes;
  std::vector<Population> populations;
  std::vector<Instance> instances;
  std::vector<Projection> projections;
  std::vector<RetinaSheet> retinas;
  std::vector<Output> outputs;
  std::vector<JointSetting> joints;
  std::vector<Lesion> lesions;
  std::vector<Scaling> scalings;
  std::vector<std::shared_ptr<CellTable>> cell_tables;
  /// Number of each side's word in expressions; 0 is the hemifield of a cell on the midline.
  std::map<std::string, int> words;

  [[nodiscard]] double tick_ms() const { return static_cast<double>(tick_ns) / 1e6; }
  [[nodiscard]] const Population& population_of(InstanceId id) const {
    return populations[index_of(instances[index_of(id)].population)];
  }
};

/// The populations, projections and parameters as validate understood them, for `dump`.
[[nodiscard]] std::string dump_circuit(const Circuit& circuit);

}  // namespace tectum
