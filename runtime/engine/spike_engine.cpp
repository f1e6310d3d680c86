#include "runtime/engine/spike_engine.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>
#include <vector>

#include "runtime/engine/block_runner.h"
#include "runtime/engine/group_parameters.h"
#include "runtime/engine/ring_runner.h"
#include "runtime/engine/slot_ranges.h"
#include "runtime/engine/update_group.h"

namespace tectum {
namespace {

constexpr std::int32_t kMaxInjectedQuanta = 1 << 30;

UpdateGroups make_groups(const SpikeImage& image, const EngineOptions& options) {
  UpdateGroups groups;
  for (const GroupRecord& group : image.groups) {
    groups.push_back(make_update_group(image, group, options));
  }
  return groups;
}

std::unique_ptr<Runner> make_runner(const SpikeImage& image, const UpdateGroups& groups, unsigned threads) {
  const bool ring_is_slow = RingRunner::fitting_ticks(image) < shortest_delay_ticks(image);
  const bool wants_blocks = threads > 1 || ring_is_slow;
  if (wants_blocks && !has_same_tick_synapses(image)) {
    return std::make_unique<BlockRunner>(image, groups, threads);
  }
  return std::make_unique<RingRunner>(image, groups);
}

// Seconds that the first ticks take. Leaves the groups as they were built.
double trial_seconds(const SpikeImage& image, const UpdateGroups& groups, unsigned threads) {
  constexpr std::uint64_t kTrialTicks = 256;
  const std::unique_ptr<Runner> runner = make_runner(image, groups, threads);
  const std::vector<std::uint64_t> nothing_injected((image.header.neuron_count + kWordBits - 1) / kWordBits);
  const auto begin = std::chrono::steady_clock::now();
  for (std::uint64_t tick = 0; tick < kTrialTicks;) {
    tick += runner->advance(tick, kTrialTicks - tick, {nothing_injected.data(), false});
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  for (const auto& group : groups) {
    group->reset();
  }
  return taken.count();
}

// Threads have to meet twice a slice; only large circuits gain by them, and only on a machine that has nothing else to
// do.
unsigned thread_count(const SpikeImage& image, const UpdateGroups& groups, const EngineOptions& options) {
  constexpr std::uint32_t kWorthTrying = 16384;  // neurons
  constexpr double kWorthHaving = 1.2;           // times as fast
  constexpr unsigned kMostTried = 8;
  const unsigned available = std::min(std::thread::hardware_concurrency(), kMostTried);
  if (options.threads != 0) {
    return options.threads;
  }
  if (available < 2 || image.header.neuron_count < kWorthTrying || has_same_tick_synapses(image)) {
    return 1;
  }
  return trial_seconds(image, groups, 1) > kWorthHaving * trial_seconds(image, groups, available) ? available : 1;
}

/// The image over weights of the engine's own, if it has some.
SpikeImage with_weights(SpikeImage image, std::span<const std::int32_t> weights) {
  if (!weights.empty()) {
    image.weights = weights;
  }
  return image;
}

}  // namespace

struct SpikeEngine::Impl {
  Impl(const SpikeImage& loaded, const EngineOptions& options)
      : original_weights(loaded.weights),
        weights(loaded.plasticity.empty() ? std::vector<std::int32_t>{}
                                          : std::vector<std::int32_t>(loaded.weights.begin(), loaded.weights.end())),
        image(with_weights(loaded, weights)),
        groups(make_groups(image, options)),
        runner(make_runner(image, groups, thread_count(image, groups, options))),
        ranges(image),
        injected((image.header.neuron_count + kWordBits - 1) / kWordBits) {
    for (std::uint32_t g = 0; g < groups.size(); ++g) {
      first_neurons.emplace_back(image.groups[g].first_neuron, g);
    }
    std::sort(first_neurons.begin(), first_neurons.end());
  }

  void reset() noexcept;
  std::uint32_t advance(std::uint64_t at_most) noexcept;
  [[nodiscard]] std::uint32_t group_of(std::uint32_t neuron) const noexcept;

  std::span<const std::int32_t> original_weights;  // in the image's storage
  std::vector<std::int32_t> weights;               // of an image that learns, else none
  SpikeImage image;
  UpdateGroups groups;
  std::unique_ptr<Runner> runner;
  SlotRanges ranges;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> first_neurons;  // (first neuron, group), ascending
  std::vector<std::uint64_t> injected;  // bit a neuron: fires next tick whatever it does itself
  bool has_injected_spikes = false;
  std::uint32_t last_ticks = 0;  // of the last advance()
  std::uint64_t tick = 0;
  EngineCounters counters;
};

void SpikeEngine::Impl::reset() noexcept {
  std::copy_n(original_weights.begin(), weights.size(), weights.begin());
  for (const auto& group : groups) {
    group->reset();
  }
  runner->reset();
  std::fill(injected.begin(), injected.end(), std::uint64_t{0});
  has_injected_spikes = false;
  last_ticks = 0;
  tick = 0;
  counters = {};
}

std::uint32_t SpikeEngine::Impl::advance(std::uint64_t at_most) noexcept {
  last_ticks = runner->advance(tick, at_most, {injected.data(), has_injected_spikes});
  if (has_injected_spikes) {
    std::fill(injected.begin(), injected.end(), std::uint64_t{0});
    has_injected_spikes = false;
  }
  tick += last_ticks;
  counters.ticks += last_ticks;
  for (std::uint32_t k = 0; k < last_ticks; ++k) {
    counters.spikes += runner->spikes(k).size();
  }
  counters.synaptic_events = runner->synaptic_events();
  counters.dropped_rows = runner->dropped_rows();
  return last_ticks;
}

std::uint32_t SpikeEngine::Impl::group_of(std::uint32_t neuron) const noexcept {
  const auto after = std::upper_bound(first_neurons.begin(), first_neurons.end(), std::pair{neuron, ~std::uint32_t{0}});
  return std::prev(after)->second;
}

SpikeEngine::SpikeEngine(const SpikeImage& image, const EngineOptions& options)
    : impl_(std::make_unique<Impl>(image, options)) {}
SpikeEngine::~SpikeEngine() = default;
SpikeEngine::SpikeEngine(SpikeEngine&&) noexcept = default;
SpikeEngine& SpikeEngine::operator=(SpikeEngine&&) noexcept = default;

void SpikeEngine::reset() noexcept { impl_->reset(); }
void SpikeEngine::step() noexcept { impl_->advance(1); }
std::uint32_t SpikeEngine::advance(std::uint64_t at_most) noexcept { return impl_->advance(at_most); }
std::uint64_t SpikeEngine::tick() const noexcept { return impl_->tick; }
std::span<const NeuronId> SpikeEngine::spikes() const noexcept {
  return impl_->last_ticks == 0 ? std::span<const NeuronId>{} : impl_->runner->spikes(impl_->last_ticks - 1);
}
std::span<const NeuronId> SpikeEngine::spikes(std::uint32_t k) const noexcept { return impl_->runner->spikes(k); }
std::span<std::int32_t> SpikeEngine::plastic_weights() noexcept { return impl_->weights; }
const EngineCounters& SpikeEngine::counters() const noexcept { return impl_->counters; }

void SpikeEngine::set_field_active(NeuronId neuron, bool is_active) noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  const std::uint32_t g = impl_->group_of(n);
  impl_->groups[g]->set_active(n - impl_->image.groups[g].first_neuron, is_active);
  impl_->runner->rouse(g);
}

void SpikeEngine::inject_spike(NeuronId neuron) noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  impl_->injected[n / kWordBits] |= std::uint64_t{1} << (n % kWordBits);
  impl_->has_injected_spikes = true;
}

void SpikeEngine::inject_input(SlotId slot, double weight) noexcept {
  const auto s = static_cast<std::uint32_t>(slot);
  const SlotRange& range = impl_->ranges.of(s);
  const double quantum = GroupParameters(impl_->image, impl_->image.groups[range.group]).quantum(range.receptor);
  // Between ticks the accumulators hold nothing but what was injected.
  const std::int32_t before = impl_->runner->waiting_input(s);
  const double total = before + std::nearbyint(weight / quantum);
  const bool fits = total >= -kMaxInjectedQuanta && total <= kMaxInjectedQuanta;  // false for NaN, too
  if (!fits) {
    ++impl_->counters.saturated_inputs;
  }
  const double clipped = fits ? total : (total > 0 ? kMaxInjectedQuanta : (total < 0 ? -kMaxInjectedQuanta : before));
  impl_->runner->add_input(s, static_cast<std::int32_t>(clipped) - before);
}

double SpikeEngine::probe(NeuronId neuron, std::uint32_t column) const noexcept {
  const auto n = static_cast<std::uint32_t>(neuron);
  const std::uint32_t g = impl_->group_of(n);
  return impl_->groups[g]->probe(n - impl_->image.groups[g].first_neuron, column, impl_->tick);
}

}  // namespace tectum
