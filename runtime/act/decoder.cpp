#include "runtime/act/decoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace tectum {
namespace {

/// Spikes of one term in the last `window_ticks` ticks.
struct TermWindow {
  std::uint32_t first_neuron = 0;
  std::uint32_t end_neuron = 0;
  double gain_per_spike = 0;            // gain / size / window: deg or deg/s for each spike in the window
  std::vector<std::uint32_t> per_tick;  // ring of the window's ticks
  std::uint64_t in_window = 0;
};

struct DecodedOutput {
  OutputKind kind = OutputKind::Position;
  std::uint32_t joint_mask = 0;
  double offset_deg = 0;
  std::uint32_t window_ticks = 1;
  std::uint32_t next_slot = 0;  // of every term's ring
  std::vector<TermWindow> terms;

  /// Sum of gain * rate: an angle or an angular velocity.
  [[nodiscard]] double drive() const noexcept {
    double sum = 0;
    for (const TermWindow& term : terms) {
      sum += term.gain_per_spike * static_cast<double>(term.in_window);
    }
    return sum;
  }
};

bool drives(const DecodedOutput& output, std::size_t joint) noexcept { return (output.joint_mask >> joint & 1U) != 0; }

}  // namespace

struct Decoder::Impl {
  double tick_s = 0;
  std::vector<DecodedOutput> outputs;
  std::array<double, kJointCount> start_deg{};       // where the integrals start
  std::array<double, kJointCount> integral_deg{};    // of the joint's Velocity outputs
  std::array<double, kJointCount> integrated_deg{};  // change of the integral since the last accept()
  std::array<bool, kJointCount> has_velocity{}, has_position{};

  void add_output(const SpikeImage& image, const OutputRecord& record);
  [[nodiscard]] double position_part_deg(std::size_t joint) const noexcept;
};

void Decoder::Impl::add_output(const SpikeImage& image, const OutputRecord& record) {
  DecodedOutput output;
  output.kind = record.kind;
  output.joint_mask = record.joint_mask;
  output.offset_deg = record.offset_deg;
  output.window_ticks = std::max(record.window_ticks, 1U);
  const double window_s = tick_s * output.window_ticks;
  for (const OutputTermRecord& term : image.output_terms.subspan(record.first_term, record.term_count)) {
    output.terms.push_back({.first_neuron = term.first_neuron,
                            .end_neuron = term.first_neuron + term.size,
                            .gain_per_spike = term.gain / (std::max(term.size, 1U) * window_s),
                            .per_tick = std::vector<std::uint32_t>(output.window_ticks, 0),
                            .in_window = 0});
  }
  for (std::size_t j = 0; j < kJointCount; ++j) {
    if (!drives(output, j)) {
      continue;
    }
    if (record.kind == OutputKind::Velocity) {
      has_velocity[j] = true;
      start_deg[j] += record.offset_deg;
    } else {
      has_position[j] = true;
    }
  }
  outputs.push_back(std::move(output));
}

double Decoder::Impl::position_part_deg(std::size_t joint) const noexcept {
  double angle_deg = 0;
  for (const DecodedOutput& output : outputs) {
    if (output.kind == OutputKind::Position && drives(output, joint)) {
      angle_deg += output.offset_deg + output.drive();
    }
  }
  return angle_deg;
}

Decoder::Decoder(const SpikeImage& image) : impl_(std::make_unique<Impl>()) {
  impl_->tick_s = static_cast<double>(image.header.tick_ns) * 1e-9;
  for (const OutputRecord& record : image.outputs) {
    impl_->add_output(image, record);
  }
  impl_->integral_deg = impl_->start_deg;
}

Decoder::~Decoder() = default;
Decoder::Decoder(Decoder&&) noexcept = default;
Decoder& Decoder::operator=(Decoder&&) noexcept = default;

void Decoder::reset() noexcept {
  for (DecodedOutput& output : impl_->outputs) {
    output.next_slot = 0;
    for (TermWindow& term : output.terms) {
      std::fill(term.per_tick.begin(), term.per_tick.end(), 0U);
      term.in_window = 0;
    }
  }
  impl_->integral_deg = impl_->start_deg;
  impl_->integrated_deg = {};
}

void Decoder::tick(std::span<const NeuronId> spikes) noexcept {
  const auto first_at_or_after = [spikes](std::uint32_t neuron) {
    return std::lower_bound(spikes.begin(), spikes.end(), NeuronId{neuron});
  };
  for (DecodedOutput& output : impl_->outputs) {
    for (TermWindow& term : output.terms) {
      const auto count =
          static_cast<std::uint32_t>(first_at_or_after(term.end_neuron) - first_at_or_after(term.first_neuron));
      std::uint32_t& slot = term.per_tick[output.next_slot];
      term.in_window += count;
      term.in_window -= slot;
      slot = count;
    }
    output.next_slot = output.next_slot + 1 == output.window_ticks ? 0 : output.next_slot + 1;
    if (output.kind == OutputKind::Velocity) {
      const double step_deg = output.drive() * impl_->tick_s;
      for (std::size_t j = 0; j < kJointCount; ++j) {
        if (drives(output, j)) {
          impl_->integral_deg[j] += step_deg;
          impl_->integrated_deg[j] += step_deg;
        }
      }
    }
  }
}

void Decoder::decode(std::span<double, kJointCount> goal_deg) const noexcept {
  for (std::size_t j = 0; j < kJointCount; ++j) {
    goal_deg[j] = impl_->position_part_deg(j) + (impl_->has_velocity[j] ? impl_->integral_deg[j] : 0.0);
  }
}

void Decoder::accept(std::span<const double, kJointCount> guarded_deg) noexcept {
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const double integrated_deg = impl_->integrated_deg[j];
    impl_->integrated_deg[j] = 0;
    if (!impl_->has_velocity[j] || !std::isfinite(guarded_deg[j])) {
      continue;
    }
    if (!impl_->has_position[j]) {
      impl_->integral_deg[j] = guarded_deg[j];
      continue;
    }
    // Only what was integrated since the last call is taken back: the rest of the difference is the Position outputs'.
    const double refused_deg = impl_->position_part_deg(j) + impl_->integral_deg[j] - guarded_deg[j];
    impl_->integral_deg[j] -= integrated_deg > 0 ? std::clamp(refused_deg, 0.0, integrated_deg)
                                                 : std::clamp(refused_deg, integrated_deg, 0.0);
  }
}

}  // namespace tectum
