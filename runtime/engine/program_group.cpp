#include "runtime/engine/program_group.h"

#include <algorithm>
#include <bit>

namespace tectum {

ProgramGroup::ProgramGroup(const SpikeImage& image, const GroupRecord& group, SimdLevel simd)
    : size_(group.size),
      padded_((std::size_t{group.size} + kProgramBlock - 1) / kProgramBlock * kProgramBlock),
      runner_(image.programs.subspan(group.data_begin, group.data_count),
              image.parameters.subspan(group.parameter_begin, group.parameter_count), simd),
      inputs_(image, group) {
  const ProgramHeader& header = runner_.header();
  initial_.resize(header.state_count * padded_);
  columns_.resize(header.column_count * padded_);
  refractory_.resize(padded_);
  is_refractory_.resize(padded_ / kProgramBlock);
  last_inputs_.resize(header.input_count * kProgramBlock);
  state_places_.resize(header.state_count);
  input_places_.resize(header.input_count);
  column_places_.resize(header.column_count);
  const auto columns = image.columns.subspan(group.column_begin, std::size_t{group.column_count} * size_);
  for (std::size_t c = 0; c < header.column_count; ++c) {
    const auto column = columns.subspan(c * size_, size_);
    std::copy(column.begin(), column.end(), columns_.begin() + static_cast<std::ptrdiff_t>(c * padded_));
  }
  for (std::uint32_t s = 0; s < header.state_count; ++s) {
    for (std::size_t i = 0; i < size_; ++i) {
      initial_[s * padded_ + i] = runner_.initial_state(s, columns, size_, i);
    }
  }
  states_ = initial_;
}

void ProgramGroup::reset() noexcept {
  std::copy(initial_.begin(), initial_.end(), states_.begin());
  std::fill(refractory_.begin(), refractory_.end(), 0U);
  std::fill(is_refractory_.begin(), is_refractory_.end(), std::uint64_t{0});
  inputs_.reset();
}

void ProgramGroup::advance(GroupTick& tick) noexcept {
  inputs_.advance(tick.tick, tick.inputs);
  for (std::size_t begin = 0; begin < size_; begin += kProgramBlock) {
    const std::size_t count = std::min(kProgramBlock, size_ - begin);
    for (std::size_t s = 0; s < state_places_.size(); ++s) {
      state_places_[s] = states_.data() + s * padded_ + begin;
    }
    for (std::size_t c = 0; c < column_places_.size(); ++c) {
      column_places_[c] = columns_.data() + c * padded_ + begin;
    }
    for (std::uint32_t r = 0; r < input_places_.size(); ++r) {
      const double* const values = inputs_.values(r) + begin;
      double* const last = last_inputs_.data() + r * kProgramBlock;
      if (count < kProgramBlock) {
        std::copy_n(values, count, last);
      }
      input_places_[r] = count < kProgramBlock ? last : values;
    }
    std::uint64_t fired = runner_.run({state_places_, input_places_, column_places_, refractory_.data() + begin,
                                       &is_refractory_[begin / kProgramBlock], count});
    for (; fired != 0; fired &= fired - 1) {
      tick.fire(static_cast<std::uint32_t>(begin) + static_cast<std::uint32_t>(std::countr_zero(fired)));
    }
  }
}

double ProgramGroup::probe(std::uint32_t neuron, std::uint32_t column, std::uint64_t) const noexcept {
  const std::uint32_t state_count = runner_.header().state_count;
  if (column < state_count) {
    return states_[column * padded_ + neuron];
  }
  return column - state_count < inputs_.receptor_count() ? inputs_.value(column - state_count, neuron) : 0;
}

}  // namespace tectum
