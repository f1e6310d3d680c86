#include "tools/live/emulated_head.h"

#include <algorithm>
#include <vector>

#include "runtime/loop/real_time.h"
#include "tools/live/head_motion.h"

namespace tectum {

struct EmulatedHead::World {
  World(const SimHeadParams& params, ServoLinkKind link)
      : head(params), bus({.seed = params.seed}), has_board(link == ServoLinkKind::ArbotixRos) {}

  TimeNs start_ns = PtyDevice::now_ns();
  std::mutex mutex;  // guards the head
  SimHead head;
  Ax12Emulator bus;
  bool has_board;
  std::unique_ptr<EmulatedArbotix> board;
  std::unique_ptr<PtyDevice> plug;
  std::array<std::atomic<EyeFault>, kEyeCount> faults{};
};

namespace {

/// Draws an eye's exposures in the thread of whoever waits for them.
class SimulatedEye final : public FrameSource {
 public:
  SimulatedEye(EmulatedHead::World& world, Eye eye) : world_(world), eye_(index_of(eye)) {}

  [[nodiscard]] CameraStatus wait(Frame& out) override {
    const TimeNs period_ns = world_.head.params().frame_period_ns;
    // The next multiple of the period, on the head's own time, is when an exposure becomes readable.
    const TimeNs head_ns = clock_.now_ns() - world_.start_ns;
    clock_.sleep_until(world_.start_ns + (head_ns / period_ns + 1) * period_ns);
    const EyeFault fault = world_.faults[eye_].load();
    if (fault == EyeFault::Unplugged) {
      return CameraStatus::Failed;
    }
    HeadExposure exposure;
    {
      const std::lock_guard lock(world_.mutex);
      const TimeNs now_ns = std::max(clock_.now_ns() - world_.start_ns, world_.head.now_ns());
      world_.head.sleep_until(now_ns);
      if (world_.head.take_exposure(static_cast<Eye>(eye_), now_ns, exposure) != CameraStatus::NewFrame) {
        return CameraStatus::NoNewFrame;
      }
    }
    Frame frame;
    world_.head.draw(static_cast<Eye>(eye_), exposure, frame);  // the bus need not wait for this
    frame.captured_ns += world_.start_ns;
    return suffer(fault, frame, out);
  }

 private:
  CameraStatus suffer(EyeFault fault, Frame& frame, Frame& out) {
    const std::size_t bytes = frame.stride_bytes * static_cast<std::size_t>(frame.height_px);
    switch (fault) {
      case EyeFault::Silent:
        return CameraStatus::NoNewFrame;
      case EyeFault::Black:
        kept_.assign(bytes, 0);
        frame.bgr = kept_.data();
        break;
      case EyeFault::Frozen:
        if (!is_frozen_) {
          kept_.assign(frame.bgr, frame.bgr + bytes);
        }
        frame.bgr = kept_.data();
        break;
      case EyeFault::WrongSize:
        frame.height_px /= 2;
        break;
      case EyeFault::None:
      case EyeFault::Unplugged:
        break;
    }
    is_frozen_ = fault == EyeFault::Frozen;
    out = frame;
    return CameraStatus::NewFrame;
  }

  EmulatedHead::World& world_;
  std::size_t eye_;
  MonotonicClock clock_;
  std::vector<std::uint8_t> kept_;
  bool is_frozen_ = false;
};

}  // namespace

EmulatedHead::EmulatedHead(std::unique_ptr<World> world) : world_(std::move(world)) {}
EmulatedHead::~EmulatedHead() = default;

std::unique_ptr<EmulatedHead> EmulatedHead::open(const SimHeadParams& params, const ServoMap& map, ServoLinkKind board,
                                                 const std::function<void()>& in_thread, std::string& error) {
  auto world = std::make_unique<World>(params, board);
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const ServoJoint& joint = map.joints[j];
    if (joint.is_present) {
      auto motion = make_head_motion(world->head, world->mutex, map, static_cast<Joint>(j), world->start_ns);
      world->bus.add_servo(joint.id, std::move(motion)).set(ax12::kReturnDelayTime, 0, world->start_ns);
    }
  }
  EmulatedDevice* device = &world->bus;
  if (world->has_board) {
    world->board = std::make_unique<EmulatedArbotix>(world->bus);
    device = world->board.get();
  }
  world->plug = PtyDevice::open(*device, {.link_path = {}, .has_timing = true, .in_thread = in_thread}, error);
  if (world->plug == nullptr) {
    return nullptr;
  }
  return std::unique_ptr<EmulatedHead>(new EmulatedHead(std::move(world)));
}

std::string EmulatedHead::port() const { return world_->plug->path(); }

FrameSourceOpener EmulatedHead::eye(Eye eye) {
  return [world = world_.get(), eye](std::string& error) -> std::unique_ptr<FrameSource> {
    if (world->faults[index_of(eye)].load() == EyeFault::Unplugged) {
      error = "no such device; is it plugged in?";
      return nullptr;
    }
    return std::make_unique<SimulatedEye>(*world, eye);
  };
}

void EmulatedHead::set_fault(Eye eye, EyeFault fault) noexcept { world_->faults[index_of(eye)] = fault; }
PtyDevice& EmulatedHead::plug() noexcept { return *world_->plug; }
Ax12Emulator& EmulatedHead::bus() noexcept { return world_->bus; }

HeadTruth EmulatedHead::truth() {
  const std::lock_guard lock(world_->mutex);
  world_->head.sleep_until(std::max(PtyDevice::now_ns() - world_->start_ns, world_->head.now_ns()));
  return world_->head.truth_at_now();
}

}  // namespace tectum
