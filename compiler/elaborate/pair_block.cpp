#include "compiler/elaborate/pair_block.h"

#include <algorithm>

#include "compiler/validate/retina_geometry.h"
#include "compiler/validate/slot_use.h"

namespace tectum {
namespace {

// A field whose centre is closer to the midline than this belongs to neither hemifield.
constexpr double kMidlineDeg = 1e-9;

std::vector<double> indices(std::uint32_t size) {
  std::vector<double> values(size);
  for (std::uint32_t i = 0; i < size; ++i) {
    values[i] = i;
  }
  return values;
}

std::vector<double> positions(std::uint32_t size) {
  std::vector<double> values(size);
  for (std::uint32_t i = 0; i < size; ++i) {
    values[i] = (i + 0.5) / size;
  }
  return values;
}

double side_word(const Circuit& circuit, const Instance& instance, AxisId axis) {
  const Population& population = circuit.populations[index_of(instance.population)];
  for (std::size_t a = 0; a < population.axes.size(); ++a) {
    if (population.axes[a] == axis) {
      return circuit.words.at(circuit.axes[index_of(axis)].sides[instance.sides[a]]);
    }
  }
  return 0;
}

}  // namespace

PairVariables::PairVariables(const Circuit& circuit, const Instance& pre, const Instance& post) {
  columns_.resize(kFirstAxisVariable + 3 * circuit.axes.size());
  gathered_.resize(columns_.size());
  const std::uint32_t pre_size = circuit.populations[index_of(pre.population)].size;
  const std::uint32_t post_size = circuit.populations[index_of(post.population)].size;
  columns_[kPreIndex] = {indices(pre_size), true};
  columns_[kPostIndex] = {indices(post_size), false};
  columns_[kPreSize] = {{static_cast<double>(pre_size)}, true};
  columns_[kPostSize] = {{static_cast<double>(post_size)}, false};
  columns_[kPrePosition] = {positions(pre_size), true};
  columns_[kPostPosition] = {positions(post_size), false};
  add_geometry(circuit, pre, true);
  add_geometry(circuit, post, false);
  add_sides(circuit, pre, post);
}

void PairVariables::add_geometry(const Circuit& circuit, const Instance& instance, bool is_pre) {
  if (!instance.retina) {
    return;
  }
  const RetinaSheet& retina = circuit.retinas[index_of(*instance.retina)];
  const std::uint32_t first = is_pre ? kPreX : kPostX;
  for (std::uint32_t k = 0; k < 3; ++k) {
    columns_[first + k].is_pre = is_pre;
  }
  for (const FieldRecord& field : retina.fields) {
    const FieldAngles angles = field_angles(field, retina.frame_width, retina.frame_height, retina.field_of_view_deg);
    columns_[first].values.push_back(angles.x_deg);
    columns_[first + 1].values.push_back(angles.y_deg);
    columns_[first + 2].values.push_back(angles.ecc_deg);
  }
}

void PairVariables::add_sides(const Circuit& circuit, const Instance& pre, const Instance& post) {
  for (std::uint32_t a = 0; a < circuit.axes.size(); ++a) {
    const std::uint32_t slot = kFirstAxisVariable + 3 * a;
    const std::vector<std::string>& sides = circuit.axes[a].sides;
    columns_[slot] = {{side_word(circuit, pre, static_cast<AxisId>(a))}, true};
    columns_[slot + 1] = {{side_word(circuit, post, static_cast<AxisId>(a))}, false};
    if (!pre.retina) {
      continue;
    }
    const bool is_vertical = std::find(sides.begin(), sides.end(), "up") != sides.end() ||
                             std::find(sides.begin(), sides.end(), "down") != sides.end();
    const int positive = circuit.words.at(is_vertical ? "up" : "right");
    const int negative = circuit.words.at(is_vertical ? "down" : "left");
    for (const double angle : columns_[is_vertical ? kPreY : kPreX].values) {
      columns_[slot + 2].values.push_back(angle > kMidlineDeg ? positive : angle < -kMidlineDeg ? negative : 0);
    }
  }
}

void PairVariables::evaluate(const TypedExpression& expression, const PairBlock& block, std::vector<double>& out) {
  out.resize(block.size());
  if (expression.constant) {
    std::fill(out.begin(), out.end(), *expression.constant);
    return;
  }
  std::vector<EvalColumn> inputs(columns_.size());
  for (const std::uint32_t slot : slots_read(expression)) {
    const Column& column = columns_[slot];
    if (column.values.size() == 1) {
      inputs[slot] = {column.values.data(), 0};
      continue;
    }
    std::vector<double>& gathered = gathered_[slot];
    gathered.resize(block.size());
    const std::vector<std::uint32_t>& index = column.is_pre ? block.pre : block.post;
    for (std::size_t i = 0; i < block.size(); ++i) {
      gathered[i] = column.values[index[i]];
    }
    inputs[slot] = {gathered.data(), 1};
  }
  Evaluator(expression).evaluate(inputs, out);
}

}  // namespace tectum
