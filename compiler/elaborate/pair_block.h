// Pairs of neurons on their way from a rule to synapses: expressions are evaluated a block of pairs at a time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "compiler/expression/expression.h"
#include "compiler/expression/random_stream.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// Local indices of the neurons of each pair, and what an edge list says of it.
struct PairBlock {
  std::vector<std::uint32_t> pre;
  std::vector<std::uint32_t> post;
  std::vector<std::vector<double>> edge_columns;
  double share_done = 0;  // of the rule's work between these two sides, for a progress bar

  [[nodiscard]] std::size_t size() const { return pre.size(); }
  void clear() {
    pre.clear();
    post.clear();
    for (std::vector<double>& column : edge_columns) {
      column.clear();
    }
  }
  void add(std::uint32_t pre_index, std::uint32_t post_index) {
    pre.push_back(pre_index);
    post.push_back(post_index);
  }
};

/// Only the pairs i of which keep(i) is true, in their order.
template <typename Keep>
void keep_pairs(PairBlock& block, const Keep& keep) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < block.size(); ++i) {
    if (keep(i)) {
      block.pre[kept] = block.pre[i];
      block.post[kept] = block.post[i];
      for (std::vector<double>& column : block.edge_columns) {
        column[kept] = column[i];
      }
      ++kept;
    }
  }
  block.pre.resize(kept);
  block.post.resize(kept);
  for (std::vector<double>& column : block.edge_columns) {
    column.resize(kept);
  }
}

inline constexpr std::size_t kPairBlockSize = 4096;

/// What an expression is for: each draws its own `random`.
enum class PairUse { Where, Probability, Weight, Delay };

/// Values of the pair variables between two population sides.
class PairVariables {
 public:
  /// `stream_name` names the random draws.
  PairVariables(const Circuit& circuit, const Instance& pre, const Instance& post, const std::string& stream_name);

  /// Evaluates `expression` for each pair of the block.
  void evaluate(PairUse use, const TypedExpression& expression, const PairBlock& block, std::vector<double>& out);

 private:
  /// One value for every neuron of a side, or one for all.
  struct Column {
    std::vector<double> values;
    bool is_pre = true;
  };
  void add_geometry(const Instance& instance, bool is_pre);
  EvalColumn gather(PairUse use, std::uint32_t slot, const PairBlock& block);
  void add_sides(const Circuit& circuit, const Instance& pre, const Instance& post);

  std::uint32_t first_edge_slot_ = 0;
  std::uint32_t post_size_ = 0;
  std::vector<RandomStream> random_;           // [PairUse]
  std::vector<Column> columns_;                // slot by slot; empty where the variable has no meaning here
  std::vector<std::vector<double>> gathered_;  // slot by slot, for the block in hand
};

/// Only the pairs for which the projection's `where` is true. `scratch` is overwritten.
void keep_where(const Projection& projection, PairVariables& variables, PairBlock& block, std::vector<double>& scratch);

}  // namespace tectum
