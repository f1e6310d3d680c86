// Edge lists that name cells: the rows, sorted by the populations that they join.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "compiler/elaborate/network.h"
#include "compiler/elaborate/pair_block.h"
#include "compiler/source/bad_rows.h"
#include "compiler/validate/circuit.h"

namespace tectum {

/// The rows between populations of a projection, as columns. Other rows, of cells that other projections join or that
/// no population holds, count for the sums alone.
class CellEdges {
 public:
  /// Reads the projection's edge list. `network` has its populations.
  CellEdges(const Circuit& circuit, const Network& network, const Projection& projection);

  /// Why the file cannot be used: rows at fault, or one line. Both empty: all is well.
  [[nodiscard]] const BadRows& bad_rows() const { return bad_; }
  [[nodiscard]] const std::string& error() const { return error_; }

  [[nodiscard]] std::size_t size() const { return pre_.size(); }

  /// Calls `visit` once for each two population sides that rows join, in ascending order, with the rows' numbers.
  void for_each_pathway(const std::function<bool(std::uint32_t pre_instance, std::uint32_t post_instance,
                                                 std::span<const std::uint32_t> rows)>& visit) const;
  /// Adds rows of one pathway to the block: indices within their populations, columns, and the sums that expressions
  /// may read.
  void fill(std::span<const std::uint32_t> rows, PairBlock& block) const;

 private:
  void read(const Projection& projection);
  void add_row(const std::vector<double>& values, const CellPlace& pre, const CellPlace& post,
               const std::vector<bool>& is_from, const std::vector<bool>& is_to);
  [[nodiscard]] std::uint32_t instance_of(std::uint32_t neuron) const { return instance_of_[neuron]; }

  const Circuit& circuit_;
  const Network& network_;
  std::vector<std::uint32_t> instance_of_;     // [neuron]
  std::vector<std::uint32_t> pre_, post_;      // neurons
  std::vector<std::vector<double>> columns_;   // as the file has them
  std::vector<std::vector<double>> pre_sums_;  // [column][neuron], of every row of the file
  std::vector<std::vector<double>> post_sums_;
  BadRows bad_;
  std::string error_;
};

}  // namespace tectum
