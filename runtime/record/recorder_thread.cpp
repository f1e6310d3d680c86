#include "runtime/record/recorder_thread.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "runtime/record/recording_file.h"

namespace tectum {
namespace {

// The loop wakes nobody, which would be a system call; the thread looks by itself, many times within the slots.
constexpr auto kLookEvery = std::chrono::milliseconds(5);

struct Slot {
  RecordedFrame frame;
  std::vector<RecordedSpike> spikes;
};

}  // namespace

struct RecorderThread::Impl {
  RecorderOptions options;
  Recording recording;
  RecordingWriter writer;
  bool has_file = false;
  std::vector<Slot> slots;
  std::atomic<std::uint64_t> filled = 0;   // by the loop
  std::atomic<std::uint64_t> emptied = 0;  // by the thread
  std::atomic<std::uint64_t> lost_frames = 0;
  std::atomic<std::uint64_t> lost_spikes = 0;
  std::atomic<bool> is_stopping = false;
  bool is_turn_lost = false;  // the loop's own, as is the next
  bool has_ended = false;
  std::thread thread;

  [[nodiscard]] bool is_full() const noexcept {
    return filled.load(std::memory_order_relaxed) - emptied.load(std::memory_order_acquire) == slots.size();
  }
  void run() {
    for (bool is_last_look = false; !is_last_look;) {
      is_last_look = is_stopping.load(std::memory_order_acquire);
      std::uint64_t next = emptied.load(std::memory_order_relaxed);
      for (; next != filled.load(std::memory_order_acquire); ++next) {
        empty(slots[next % slots.size()]);
        emptied.store(next + 1, std::memory_order_release);
      }
      if (!is_last_look) {
        std::this_thread::sleep_for(kLookEvery);
      }
    }
  }
  void empty(Slot& slot);
};

void RecorderThread::Impl::empty(Slot& slot) {
  if (has_file) {
    std::vector<NeuronId> of_tick;
    for (std::size_t i = 0; i < slot.spikes.size();) {
      const std::uint64_t tick = slot.spikes[i].tick;
      of_tick.clear();
      for (; i < slot.spikes.size() && slot.spikes[i].tick == tick; ++i) {
        of_tick.push_back(NeuronId{slot.spikes[i].neuron});
      }
      writer.take(tick, of_tick);
    }
    (void)writer.frame(slot.frame);  // the writer remembers a failure until finish()
  }
  if (options.watch) {
    options.watch(slot.frame, slot.spikes);
  }
  if (options.keeps) {
    recording.frames.push_back(slot.frame);
    recording.spikes.insert(recording.spikes.end(), slot.spikes.begin(), slot.spikes.end());
  }
  slot.spikes.clear();
}

RecorderThread::RecorderThread() : impl_(std::make_unique<Impl>()) {}

RecorderThread::~RecorderThread() {
  if (impl_->thread.joinable()) {
    impl_->is_stopping = true;
    impl_->thread.join();
  }
}

std::string RecorderThread::start(const Recording& run, const RecorderOptions& options) {
  Impl& impl = *impl_;
  impl.options = options;
  impl.recording = run;
  impl.has_file = !options.path.empty();
  if (impl.has_file && !impl.writer.open(options.path, run)) {
    return impl.writer.error();
  }
  impl.slots.resize(options.slots);
  std::array<std::size_t, kEyeCount> field_count{};
  for (const RecordedRetina& retina : run.retinas) {
    field_count[static_cast<std::size_t>(retina.eye)] += retina.fields.size();
  }
  for (Slot& slot : impl.slots) {
    slot.spikes.reserve(options.spikes_per_turn);
    for (std::size_t e = 0; e < kEyeCount; ++e) {
      slot.frame.active_fields[e].reserve(field_count[e]);
    }
  }
  impl.thread = std::thread([&impl] { impl.run(); });
  return "";
}

void RecorderThread::take(std::uint64_t tick, std::span<const NeuronId> spikes) noexcept {
  Impl& impl = *impl_;
  impl.is_turn_lost = impl.is_turn_lost || impl.is_full();
  if (impl.has_ended || impl.is_turn_lost) {
    return;  // frame() counts it
  }
  std::vector<RecordedSpike>& kept = impl.slots[impl.filled.load(std::memory_order_relaxed) % impl.slots.size()].spikes;
  for (const NeuronId neuron : spikes) {
    if (kept.size() == kept.capacity()) {
      impl.lost_spikes.fetch_add(1, std::memory_order_relaxed);
      continue;
    }
    kept.push_back({tick, static_cast<std::uint32_t>(neuron)});
  }
}

void RecorderThread::frame(const RecordedFrame& frame) noexcept {
  Impl& impl = *impl_;
  if (impl.has_ended) {
    return;
  }
  if (impl.is_turn_lost || impl.is_full()) {
    impl.is_turn_lost = false;
    impl.lost_frames.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  const std::uint64_t at = impl.filled.load(std::memory_order_relaxed);
  // Assigning a vector allocates only beyond its capacity, which was reserved for every field of the eye.
  impl.slots[at % impl.slots.size()].frame = frame;
  impl.filled.store(at + 1, std::memory_order_release);
}

void RecorderThread::end_turns() noexcept { impl_->has_ended = true; }

std::string RecorderThread::finish(double duration_s) {
  Impl& impl = *impl_;
  if (impl.thread.joinable()) {
    impl.is_stopping.store(true, std::memory_order_release);
    impl.thread.join();
  }
  impl.recording.duration_s = duration_s;
  return impl.has_file && !impl.writer.finish(duration_s) ? impl.writer.error() : "";
}

std::uint64_t RecorderThread::lost_frames() const noexcept { return impl_->lost_frames; }
std::uint64_t RecorderThread::lost_spikes() const noexcept { return impl_->lost_spikes; }
Recording& RecorderThread::recording() noexcept { return impl_->recording; }

}  // namespace tectum
