#include "drivers/camera/live_camera.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>

namespace tectum {
namespace {

constexpr std::size_t kMostEvents = 1000;
constexpr int kWatchedRowStep = 8;  // black and frozen are looked for in every eighth row

TimeNs monotonic_ns() noexcept {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

std::string size_text(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

std::string seconds_text(TimeNs time_ns) {
  const TimeNs tenths = (time_ns + 50'000'000) / 100'000'000;
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " s";
}

/// A frame with its pixels.
struct Picture {
  std::vector<std::uint8_t> pixels;
  Frame frame;

  void copy(const Frame& from) {
    const std::size_t row = 3 * static_cast<std::size_t>(from.width_px);
    pixels.resize(row * static_cast<std::size_t>(from.height_px));
    for (int y = 0; y < from.height_px; ++y) {
      std::memcpy(pixels.data() + row * static_cast<std::size_t>(y),
                  from.bgr + from.stride_bytes * static_cast<std::size_t>(y), row);
    }
    frame = from;
    frame.bgr = pixels.data();
    frame.stride_bytes = row;
  }
};

/// A state that is told when it comes and when it goes.
enum class Trouble : std::uint8_t { None, NotOpen, Silent, MisSized, Black, Frozen };

}  // namespace

struct LiveCamera::Impl {
  Impl(const LiveCameraOptions& camera_options, FrameSourceOpener opener)
      : options(camera_options), open(std::move(opener)) {}

  // The capture thread.
  void run();
  void capture(FrameSource& source);
  void take(const Frame& whole);
  [[nodiscard]] bool cut(Frame& frame) const;
  [[nodiscard]] Trouble look_at(const Frame& frame);
  void set_trouble(Trouble now, const std::string& why = {});
  void pass_on(const Frame& frame);
  void tell(const std::string& what);
  void rest(TimeNs time_ns);

  LiveCameraOptions options;
  FrameSourceOpener open;
  Trouble trouble = Trouble::None;
  bool was_open = false;
  std::vector<std::uint8_t> watched;  // rows of the last frame
  TimeNs changed_ns = 0;              // when they last did
  std::uint64_t sequence = 0;

  // Three pictures: one is the thread's, one the loop's, the third changes hands.
  static constexpr std::uint32_t kSlot = 3, kIsNew = 4;
  std::array<Picture, 3> pictures;
  std::uint32_t writing = 0, reading = 1;
  std::atomic<std::uint32_t> middle = 2;
  std::atomic<CameraStatus> status = CameraStatus::NoNewFrame;  // when there is no new frame
  std::atomic<TimeNs> newest_at_ns = 0;

  mutable std::mutex mutex;
  std::condition_variable stop_signal;
  bool is_stopping = false;
  LiveCameraCounters counters;
  std::vector<CameraEvent> events;
  std::thread thread;
};

void LiveCamera::Impl::tell(const std::string& what) {
  const std::lock_guard lock(mutex);
  if (events.size() < kMostEvents) {
    events.push_back({monotonic_ns(), options.name + ": " + what});
  }
}

void LiveCamera::Impl::set_trouble(Trouble now, const std::string& why) {
  if (now == trouble) {
    return;
  }
  const bool is_over = now == Trouble::None;
  trouble = now;
  tell(is_over ? "sees again" : why);
}

void LiveCamera::Impl::rest(TimeNs time_ns) {
  std::unique_lock lock(mutex);
  stop_signal.wait_for(lock, std::chrono::nanoseconds(time_ns), [this] { return is_stopping; });
}

void LiveCamera::Impl::run() {
  if (options.in_thread) {
    options.in_thread();
  }
  const auto is_over = [this] {
    const std::lock_guard lock(mutex);
    return is_stopping;
  };
  while (!is_over()) {
    std::string error;
    const std::unique_ptr<FrameSource> source = open(error);
    if (source == nullptr) {
      status = CameraStatus::Failed;
      set_trouble(Trouble::NotOpen, error);
      rest(options.reopen_every_ns);
      continue;
    }
    status = CameraStatus::NoNewFrame;
    if (was_open) {
      const std::lock_guard lock(mutex);
      ++counters.reopened;
    }
    was_open = true;
    capture(*source);
    if (status == CameraStatus::Ended) {
      return;
    }
    if (!is_over()) {
      set_trouble(Trouble::NotOpen, "gone; is it unplugged?");
      rest(options.reopen_every_ns);
    }
  }
}

void LiveCamera::Impl::capture(FrameSource& source) {
  TimeNs last_ns = monotonic_ns();
  for (;;) {
    {
      const std::lock_guard lock(mutex);
      if (is_stopping) {
        return;
      }
    }
    Frame frame;
    const CameraStatus got = source.wait(frame);
    const TimeNs now_ns = monotonic_ns();
    if (got == CameraStatus::Failed || got == CameraStatus::Ended) {
      status = got;
      return;
    }
    if (got == CameraStatus::NewFrame) {
      last_ns = now_ns;
      take(frame);
    } else if (now_ns - last_ns >= options.silent_after_ns) {
      set_trouble(Trouble::Silent, "no frame for " + seconds_text(now_ns - last_ns));
    }
  }
}

bool LiveCamera::Impl::cut(Frame& frame) const {
  const CropPx& crop = options.crop;
  if (crop.width <= 0) {
    return true;
  }
  if (crop.x < 0 || crop.y < 0 || crop.x + crop.width > frame.width_px || crop.y + crop.height > frame.height_px) {
    return false;
  }
  frame.bgr += static_cast<std::size_t>(crop.y) * frame.stride_bytes + 3 * static_cast<std::size_t>(crop.x);
  frame.width_px = crop.width;
  frame.height_px = crop.height;
  return true;
}

Trouble LiveCamera::Impl::look_at(const Frame& frame) {
  const std::size_t row = 3 * static_cast<std::size_t>(frame.width_px);
  const std::size_t rows = (static_cast<std::size_t>(frame.height_px) + kWatchedRowStep - 1) / kWatchedRowStep;
  bool is_same = watched.size() == row * rows;
  watched.resize(row * rows);
  std::uint8_t brightest = 0;
  for (std::size_t r = 0; r < rows; ++r) {
    const std::uint8_t* const line = frame.bgr + frame.stride_bytes * r * kWatchedRowStep;
    std::uint8_t* const before = watched.data() + row * r;
    is_same = is_same && std::memcmp(line, before, row) == 0;
    std::memcpy(before, line, row);
    if (options.black_below > 0) {
      brightest = std::max(brightest, *std::max_element(line, line + row));
    }
  }
  const TimeNs now_ns = monotonic_ns();
  if (!is_same) {
    changed_ns = now_ns;
  }
  if (options.black_below > 0 && brightest < options.black_below) {
    return Trouble::Black;
  }
  return options.frozen_after_ns > 0 && now_ns - changed_ns >= options.frozen_after_ns ? Trouble::Frozen
                                                                                       : Trouble::None;
}

void LiveCamera::Impl::take(const Frame& whole) {
  Frame frame = whole;
  if (options.width_px == 0) {
    options.width_px = whole.width_px;
    options.height_px = whole.height_px;
  }
  const bool is_size_right = whole.width_px == options.width_px && whole.height_px == options.height_px;
  if (!is_size_right || !cut(frame)) {
    {
      const std::lock_guard lock(mutex);
      ++counters.mis_sized;
    }
    set_trouble(Trouble::MisSized, is_size_right
                                       ? "the crop does not fit into " + size_text(whole.width_px, whole.height_px)
                                       : "sends " + size_text(whole.width_px, whole.height_px) + " pixels, not " +
                                             size_text(options.width_px, options.height_px));
    return;
  }
  const Trouble seen = look_at(frame);
  if (seen == Trouble::None) {
    set_trouble(Trouble::None);
    pass_on(frame);
    return;
  }
  {
    const std::lock_guard lock(mutex);
    ++(seen == Trouble::Black ? counters.black : counters.frozen);
  }
  set_trouble(seen, seen == Trouble::Black
                        ? "black picture; is the lens covered?"
                        : "the same picture for " + seconds_text(options.frozen_after_ns) + "; is it frozen?");
}

void LiveCamera::Impl::pass_on(const Frame& frame) {
  Picture& picture = pictures[writing];
  picture.copy(frame);
  picture.frame.sequence = sequence++;
  const std::uint32_t given = middle.exchange(writing | kIsNew, std::memory_order_acq_rel);
  writing = given & kSlot;
  newest_at_ns.store(monotonic_ns(), std::memory_order_release);
  const std::lock_guard lock(mutex);
  ++counters.frames;
  counters.overwritten += (given & kIsNew) != 0 ? 1 : 0;
}

LiveCamera::LiveCamera(const LiveCameraOptions& options, FrameSourceOpener open)
    : impl_(std::make_unique<Impl>(options, std::move(open))) {
  impl_->thread = std::thread([this] { impl_->run(); });
}

LiveCamera::~LiveCamera() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->is_stopping = true;
  }
  impl_->stop_signal.notify_all();
  impl_->thread.join();
}

CameraStatus LiveCamera::read(TimeNs /*now_ns*/, Frame& out) noexcept {
  Impl& impl = *impl_;
  if ((impl.middle.load(std::memory_order_relaxed) & Impl::kIsNew) == 0) {
    return impl.status.load(std::memory_order_relaxed);
  }
  impl.reading = impl.middle.exchange(impl.reading, std::memory_order_acq_rel) & Impl::kSlot;
  out = impl.pictures[impl.reading].frame;
  return CameraStatus::NewFrame;
}

TimeNs LiveCamera::newest_at_ns() const noexcept { return impl_->newest_at_ns.load(std::memory_order_acquire); }

LiveCameraCounters LiveCamera::counters() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->counters;
}

std::vector<CameraEvent> LiveCamera::take_events() {
  const std::lock_guard lock(impl_->mutex);
  std::vector<CameraEvent> taken;
  taken.swap(impl_->events);
  return taken;
}

}  // namespace tectum
