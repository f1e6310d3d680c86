#include "tools/benchmark/measure.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <set>

#include "runtime/sense/retina.h"
#include "tools/analysis/simulated_run.h"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace tectum {
namespace {

// Currents that fade away become subnormal, and slow; a hand-written loop has the processor round them to 0.
class RoundSubnormalsToZero {
 public:
#if defined(__SSE__)
  RoundSubnormalsToZero() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040U); }  // FTZ and DAZ
  RoundSubnormalsToZero(const RoundSubnormalsToZero&) = delete;
  RoundSubnormalsToZero& operator=(const RoundSubnormalsToZero&) = delete;
  ~RoundSubnormalsToZero() { _mm_setcsr(before_); }

 private:
  unsigned before_;
#endif
};

double processor_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

namespace {

// Times the run as a whole and, where the plan has steps, each of them.
template <typename Step>
void time_steps(const RunPlan& plan, Timing& timing, const Step& step) {
  std::vector<double> steps_us;
  const std::uint64_t ticks_a_step = plan.ticks_a_step == 0 ? plan.ticks : plan.ticks_a_step;
  steps_us.reserve(plan.ticks / ticks_a_step + 1);
  const double begin = processor_seconds();
  const double wall_begin = wall_seconds();
  for (std::uint64_t tick = 0; tick < plan.ticks; tick += ticks_a_step) {
    const double step_begin = wall_seconds();
    step(tick, std::min(tick + ticks_a_step, plan.ticks));
    steps_us.push_back((wall_seconds() - step_begin) * 1e6);
  }
  timing.wall_seconds = wall_seconds() - wall_begin;
  timing.seconds = processor_seconds() - begin;
  if (plan.ticks_a_step > 0) {
    std::sort(steps_us.begin(), steps_us.end());
    timing.step_median_us = steps_us[steps_us.size() / 2];
    timing.step_99th_us = steps_us[steps_us.size() * 99 / 100];
  }
}

}  // namespace

Timing time_engine(const SpikeImage& image, const EngineOptions& options, const RunPlan& plan) {
  SpikeEngine engine(image, options);
  Timing timing;
  std::vector<std::uint32_t> read_out;
  time_steps(plan, timing, [&](std::uint64_t tick, std::uint64_t end) {
    read_out.clear();
    while (tick < end) {
      const std::uint32_t done = engine.advance(end - tick);
      for (std::uint32_t k = 0; k < done && plan.ticks_a_step > 0; ++k) {
        for (const NeuronId neuron : engine.spikes(k)) {
          read_out.push_back(static_cast<std::uint32_t>(neuron));
        }
      }
      tick += done;
    }
  });
  timing.spikes = engine.counters().spikes;
  timing.synaptic_events = engine.counters().synaptic_events;
  return timing;
}

Timing time_floor(Floor& floor, FloorKind kind, const Stimulus& stimulus, const RunPlan& plan) {
  floor.reset();
  const RoundSubnormalsToZero rounding;
  Timing timing;
  std::vector<std::uint32_t> read_out;
  time_steps(plan, timing, [&](std::uint64_t tick, std::uint64_t end) {
    read_out.clear();
    for (; tick < end; ++tick) {
      const auto fired =
          kind == FloorKind::Dense ? floor.step_dense(stimulus.of(tick)) : floor.step_silent(stimulus.of(tick));
      timing.spikes += fired.size() + stimulus.of(tick).size();
      if (plan.ticks_a_step > 0) {
        read_out.insert(read_out.end(), fired.begin(), fired.end());
      }
    }
  });
  return timing;
}

SeenRun see_moving_target(const SpikeImage& image, double duration_s) {
  SimulatedRunOptions options;
  options.duration_s = duration_s;
  options.head = fitted_to(image, options.head);
  options.head.scenario.kind = ScenarioKind::Random;
  const Recording recording = run_simulated_head(image, options);
  SeenRun seen;
  std::set<std::uint32_t> was_active;
  for (std::size_t turn = 0; turn < recording.frames.size(); ++turn) {
    const auto now_ns = static_cast<std::uint64_t>(options.head.frame_period_ns) * turn;
    std::set<std::uint32_t> active;
    std::array<std::uint32_t, kEyeCount> first_recorded{};
    for (const RetinaRecord& retina : image.retinas) {
      const auto eye = static_cast<std::size_t>(retina.eye);
      for (const std::uint32_t field : recording.frames[turn].active_fields[eye]) {
        if (field >= first_recorded[eye] && field < first_recorded[eye] + retina.field_count) {
          active.insert(retina.first_neuron + field - first_recorded[eye]);
        }
      }
      first_recorded[eye] += retina.field_count;
    }
    const std::uint64_t tick = now_ns / image.header.tick_ns;
    for (const std::uint32_t neuron : was_active) {
      if (!active.contains(neuron)) {
        seen.changes.push_back({tick, NeuronId{neuron}, false});
      }
    }
    for (const std::uint32_t neuron : active) {
      if (!was_active.contains(neuron)) {
        seen.changes.push_back({tick, NeuronId{neuron}, true});
      }
    }
    was_active = std::move(active);
  }
  seen.ticks = static_cast<std::uint64_t>(duration_s * 1e9) / image.header.tick_ns;
  return seen;
}

Timing time_seen(const SpikeImage& image, const EngineOptions& options, const SeenRun& seen) {
  SpikeEngine engine(image, options);
  Timing timing;
  std::size_t next = 0;
  time_steps({seen.ticks, 0}, timing, [&](std::uint64_t tick, std::uint64_t end) {
    while (tick < end) {
      for (; next < seen.changes.size() && seen.changes[next].tick <= tick; ++next) {
        engine.set_field_active(seen.changes[next].neuron, seen.changes[next].is_active);
      }
      const std::uint64_t stop = next < seen.changes.size() ? std::min(end, seen.changes[next].tick) : end;
      tick += engine.advance(stop - tick);
    }
  });
  timing.spikes = engine.counters().spikes;
  timing.synaptic_events = engine.counters().synaptic_events;
  return timing;
}

double time_retinas(const SpikeImage& image, int resolution_px) {
  constexpr double kDurationS = 2;
  SimulatedRunOptions options;
  options.duration_s = kDurationS;
  options.head = fitted_to(image, options.head);
  options.head.scenario.kind = ScenarioKind::Random;
  options.head.camera.width_px = resolution_px;
  options.head.camera.height_px = resolution_px;
  std::vector<Retina> retinas;
  for (std::uint32_t r = 0; r < image.retinas.size(); ++r) {
    retinas.emplace_back(image, r);
    if (!retinas.back().prepare(resolution_px, resolution_px)) {
      return 0;
    }
  }
  double seconds = 0;
  std::uint64_t frames = 0;
  RunObserver observer;
  observer.pictures = [&](const Frame& left, const Frame& right) {
    const double begin = processor_seconds();
    for (std::size_t r = 0; r < retinas.size(); ++r) {
      static_cast<void>(retinas[r].encode(image.retinas[r].eye == Eye::Left ? left : right));
    }
    seconds += processor_seconds() - begin;
    ++frames;
  };
  static_cast<void>(run_simulated_head(image, options, observer));
  return frames == 0 ? 0 : seconds / static_cast<double>(frames);
}

std::uint64_t resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t total_pages = 0;
  std::uint64_t resident_pages = 0;
  statm >> total_pages >> resident_pages;
  return resident_pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace tectum
