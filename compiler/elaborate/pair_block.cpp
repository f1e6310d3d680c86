#include "compiler/elaborate/pair_block.h"

#include <algorithm>
#include <cmath>

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

PairVariables::PairVariables(const Circuit& circuit, const Instance& pre, const Instance& post,
                             const std::string& stream_name) {
  first_edge_slot_ = kFirstAxisVariable + 3 * static_cast<std::uint32_t>(circuit.axes.size());
  columns_.resize(first_edge_slot_);
  gathered_.resize(columns_.size());
  const std::uint32_t pre_size = circuit.populations[index_of(pre.population)].size;
  const std::uint32_t post_size = circuit.populations[index_of(post.population)].size;
  post_size_ = post_size;
  for (const char* use : {"where", "probability", "weight", "delay"}) {
    random_.emplace_back(circuit.seed, stream_name + "\n" + use);
  }
  columns_[kPreIndex] = {indices(pre_size), true};
  columns_[kPostIndex] = {indices(post_size), false};
  columns_[kPreSize] = {{static_cast<double>(pre_size)}, true};
  columns_[kPostSize] = {{static_cast<double>(post_size)}, false};
  columns_[kPrePosition] = {positions(pre_size), true};
  columns_[kPostPosition] = {positions(post_size), false};
  add_geometry(pre, true);
  add_geometry(post, false);
  add_sides(circuit, pre, post);
}

void PairVariables::add_geometry(const Instance& instance, bool is_pre) {
  const std::uint32_t first = is_pre ? kPreX : kPostX;
  columns_[first] = {instance.x, is_pre};
  columns_[first + 1] = {instance.y, is_pre};
  columns_[first + 2] = {instance.ecc, is_pre};
}

void PairVariables::add_sides(const Circuit& circuit, const Instance& pre, const Instance& post) {
  for (std::uint32_t a = 0; a < circuit.axes.size(); ++a) {
    const std::uint32_t slot = kFirstAxisVariable + 3 * a;
    const std::vector<std::string>& sides = circuit.axes[a].sides;
    columns_[slot] = {{side_word(circuit, pre, static_cast<AxisId>(a))}, true};
    columns_[slot + 1] = {{side_word(circuit, post, static_cast<AxisId>(a))}, false};
    const bool is_vertical = std::find(sides.begin(), sides.end(), "up") != sides.end() ||
                             std::find(sides.begin(), sides.end(), "down") != sides.end();
    const int positive = circuit.words.at(is_vertical ? "up" : "right");
    const int negative = circuit.words.at(is_vertical ? "down" : "left");
    for (const double angle : columns_[is_vertical ? kPreY : kPreX].values) {
      columns_[slot + 2].values.push_back(angle > kMidlineDeg ? positive : angle < -kMidlineDeg ? negative : 0);
    }
  }
}

EvalColumn PairVariables::gather(PairUse use, std::uint32_t slot, const PairBlock& block) {
  if (slot >= first_edge_slot_) {
    return {block.edge_columns[slot - first_edge_slot_].data(), 1};
  }
  std::vector<double>& gathered = gathered_[slot];
  if (slot == kPairRandom) {
    const RandomStream& random = random_[static_cast<std::size_t>(use)];
    gathered.resize(block.size());
    for (std::size_t i = 0; i < block.size(); ++i) {
      gathered[i] = random.uniform(std::uint64_t{block.pre[i]} * post_size_ + block.post[i]);
    }
    return {gathered.data(), 1};
  }
  if (slot == kDistance) {
    gathered.resize(block.size());
    for (std::size_t i = 0; i < block.size(); ++i) {
      gathered[i] = std::hypot(columns_[kPreX].values[block.pre[i]] - columns_[kPostX].values[block.post[i]],
                               columns_[kPreY].values[block.pre[i]] - columns_[kPostY].values[block.post[i]]);
    }
    return {gathered.data(), 1};
  }
  const Column& column = columns_[slot];
  if (column.values.size() == 1) {
    return {column.values.data(), 0};
  }
  gathered.resize(block.size());
  const std::vector<std::uint32_t>& index = column.is_pre ? block.pre : block.post;
  for (std::size_t i = 0; i < block.size(); ++i) {
    gathered[i] = column.values[index[i]];
  }
  return {gathered.data(), 1};
}

void PairVariables::evaluate(PairUse use, const TypedExpression& expression, const PairBlock& block,
                             std::vector<double>& out) {
  out.resize(block.size());
  if (expression.constant) {
    std::fill(out.begin(), out.end(), *expression.constant);
    return;
  }
  std::vector<EvalColumn> inputs(columns_.size() + block.edge_columns.size());
  for (const std::uint32_t slot : slots_read(expression)) {
    inputs[slot] = gather(use, slot, block);
  }
  Evaluator(expression).evaluate(inputs, out);
}

void keep_where(const Projection& projection, PairVariables& variables, PairBlock& block,
                std::vector<double>& scratch) {
  if (projection.where && block.size() > 0) {
    variables.evaluate(PairUse::Where, *projection.where, block, scratch);
    keep_pairs(block, [&](std::size_t i) { return scratch[i] != 0; });
  }
}

}  // namespace tectum
