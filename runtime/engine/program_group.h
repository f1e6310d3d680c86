// Neurons whose model a circuit declares by its equations.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/engine/program.h"
#include "runtime/engine/receptor_inputs.h"
#include "runtime/engine/update_group.h"

namespace tectum {

class ProgramGroup final : public UpdateGroup {
 public:
  ProgramGroup(const SpikeImage& image, const GroupRecord& group, SimdLevel simd);

  void reset() noexcept override;
  void advance(GroupTick& tick) noexcept override;
  /// Columns: the states in their order, then each receptor's input.
  [[nodiscard]] double probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t tick) const noexcept override;

 private:
  std::uint32_t size_;
  std::size_t padded_;  // size_ rounded up to whole blocks
  ProgramRunner runner_;
  ReceptorInputs inputs_;
  std::vector<double> initial_;  // [state][padded]
  std::vector<double> states_;   // [state][padded]
  std::vector<double> columns_;  // [column][padded]
  std::vector<std::uint32_t> refractory_;
  std::vector<std::uint64_t> is_refractory_;  // [block]
  std::vector<double> last_inputs_;           // [receptor][kProgramBlock], of the block that is not full
  std::vector<double*> state_places_;
  std::vector<const double*> input_places_;
  std::vector<const double*> column_places_;
};

}  // namespace tectum
