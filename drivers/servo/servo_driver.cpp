#include "drivers/servo/servo_driver.h"

#include <semaphore.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>

#include "drivers/servo/latest_value.h"
#include "drivers/servo/serial_port.h"

namespace tectum {
namespace {

constexpr TimeNs kSecondNs = 1'000'000'000;

TimeNs monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<TimeNs>(now.tv_sec) * kSecondNs + now.tv_nsec;
}

struct HandedCommand {
  ServoCommand command;
  TimeNs handed_ns = 0;
};

}  // namespace

std::uint32_t usual_baud(ServoLinkKind kind) noexcept {
  switch (kind) {
    case ServoLinkKind::Direct:
      return 1'000'000;  // the servos' own from the factory
    case ServoLinkKind::ArbotixRos:
      return 115200;
    case ServoLinkKind::ArbotixAscii:
      return sketch::kBaud;
  }
  return 0;
}

LinkOpener serial_link(std::string path, std::uint32_t baud) {
  return [path = std::move(path), baud](std::string& error) -> std::unique_ptr<ByteLink> {
    return SerialPort::open(path, baud, error);
  };
}

struct ServoDriver::Impl {
  Impl(const ServoDriverOptions& driver_options, LinkOpener opener)
      : options(driver_options), open_link(std::move(opener)) {
    sem_init(&wake, 0, 0);
    options.packets.bus.baud = options.baud != 0 ? options.baud : usual_baud(options.kind);
    options.packets.bus.adapter =
        options.kind == ServoLinkKind::ArbotixRos ? BusAdapter::ArbotixRos : BusAdapter::Transparent;
    // Not while a command itself is under way: its questions switch torque on and off.
    options.packets.bus.gives_way = [this] { return is_asking && command_box.has_new(); };
  }
  ~Impl() { sem_destroy(&wake); }

  // The driver's thread.
  void run();
  [[nodiscard]] bool connect();
  void converse();
  [[nodiscard]] ExchangeStatus send_newest();
  void publish(bool is_round_over);
  void wait_until(TimeNs when_ns);

  ServoDriverOptions options;
  LinkOpener open_link;
  ServoEventLog events;
  HeadReport working_report;  // the thread's own
  std::unique_ptr<ByteLink> link;
  std::unique_ptr<ServoExchange> exchange;
  bool was_connected = false;
  bool is_asking = false;
  std::string last_error;

  // Between the loop and the thread.
  LatestValue<HandedCommand> command_box;
  LatestValue<HeadReport> report_box;
  std::atomic<bool> is_connected = false;
  std::atomic<bool> is_stopping = false;
  std::atomic<TimeNs> hush_until_ns = 0;
  sem_t wake;

  // The loop's own.
  ServoCommand merged;
  HeadReport newest_report;
  std::array<TimeNs, kJointCount> delivered_ns{};
  std::uint32_t trusted_mask = 0;  // joints that the loop has seen fresh, and not failing since

  mutable std::mutex shared_mutex;  // for people, not for the loop
  HeadReport shared_report;
  LatencyHistogram latency, issue_latency;

  std::thread thread;
};

bool ServoDriver::Impl::connect() {
  std::string error;
  link = open_link(error);
  if (link == nullptr) {
    if (error != last_error) {
      events.add(monotonic_ns(), error);
      last_error = error;
    }
    return false;
  }
  last_error.clear();
  if (was_connected) {
    ++working_report.reconnections;
    events.add(monotonic_ns(), "the port is back");
  }
  if (options.kind == ServoLinkKind::ArbotixAscii) {
    exchange = std::make_unique<SketchExchange>(*link, options.map, options.sketch, working_report, events);
  } else {
    exchange = std::make_unique<PacketExchange>(*link, options.map, options.packets, working_report, events);
  }
  was_connected = true;
  return exchange->begin() != ExchangeStatus::LinkGone;
}

void ServoDriver::Impl::publish(bool is_round_over) {
  report_box.put(working_report);
  if (is_round_over) {
    const std::lock_guard lock(shared_mutex);
    shared_report = working_report;
  }
}

void ServoDriver::Impl::wait_until(TimeNs when_ns) {
  const timespec when{static_cast<time_t>(when_ns / kSecondNs), static_cast<long>(when_ns % kSecondNs)};
  sem_clockwait(&wake, CLOCK_MONOTONIC, &when);  // a command, the time or a signal: all are looked at alike
}

ExchangeStatus ServoDriver::Impl::send_newest() {
  HandedCommand handed;
  if (!command_box.take(handed)) {
    return ExchangeStatus::RoundOver;
  }
  const ExchangeStatus status = exchange->send(handed.command);
  const std::lock_guard lock(shared_mutex);
  const TimeNs sent_ns = monotonic_ns();
  latency.add(sent_ns - handed.handed_ns);
  issue_latency.add(sent_ns - handed.command.issued_ns);
  return status;
}

void ServoDriver::Impl::converse() {
  TimeNs next_round_ns = monotonic_ns();
  while (!is_stopping) {
    if (send_newest() == ExchangeStatus::LinkGone) {
      return;
    }
    const TimeNs quiet_until_ns = std::max(next_round_ns, hush_until_ns.load(std::memory_order_relaxed));
    if (monotonic_ns() < quiet_until_ns) {
      wait_until(quiet_until_ns);
      continue;
    }
    is_asking = true;
    const ExchangeStatus status = exchange->poll();
    is_asking = false;
    publish(status != ExchangeStatus::Busy);
    if (status == ExchangeStatus::LinkGone) {
      return;
    }
    if (status == ExchangeStatus::RoundOver) {
      // A round that took longer than its time is followed by the next at once; none is caught up.
      next_round_ns = std::max(next_round_ns + options.round_ns, monotonic_ns());
    }
  }
}

void ServoDriver::Impl::run() {
  if (options.in_thread) {
    options.in_thread();
  }
  while (!is_stopping) {
    if (connect()) {
      is_connected = true;
      publish(true);
      converse();
    }
    if (is_connected && !is_stopping) {
      events.add(monotonic_ns(), "the port is gone");
    }
    is_connected = false;
    working_report.is_connected = false;
    if (is_stopping) {
      break;
    }
    for (JointReport& joint : working_report.joints) {
      joint.health = joint.health == ServoHealth::Unknown ? ServoHealth::Unknown : ServoHealth::Lost;
    }
    publish(true);
    exchange.reset();
    link.reset();
    const TimeNs again_ns = monotonic_ns() + options.reopen_every_ns;
    while (!is_stopping && monotonic_ns() < again_ns) {
      wait_until(again_ns);
    }
  }
  if (exchange != nullptr && options.releases_at_end) {
    exchange->release();
  }
  publish(true);
}

ServoDriver::ServoDriver(const ServoDriverOptions& options, LinkOpener open_link)
    : impl_(std::make_unique<Impl>(options, std::move(open_link))) {
  impl_->merged.joint_mask = 0;
  impl_->thread = std::thread([this] { impl_->run(); });
}

ServoDriver::~ServoDriver() { stop(); }

void ServoDriver::stop() {
  if (impl_->thread.joinable()) {
    impl_->is_stopping = true;
    sem_post(&impl_->wake);
    impl_->thread.join();
  }
}

bool ServoDriver::write(const ServoCommand& command) noexcept {
  Impl& impl = *impl_;
  if (!impl.is_connected.load(std::memory_order_relaxed)) {
    return false;
  }
  ServoCommand& merged = impl.merged;
  merged.issued_ns = command.issued_ns;
  merged.torque_on = command.torque_on;
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    if ((command.joint_mask >> joint & 1U) != 0) {
      merged.goal_deg[joint] = command.goal_deg[joint];
    }
  }
  // What was overwritten before it was sent is sent with this one. A joint that fails drops out until it is commanded
  // anew.
  merged.joint_mask = (merged.joint_mask | command.joint_mask) & impl.trusted_mask;
  impl.command_box.put({merged, monotonic_ns()});
  impl.hush_until_ns.store(0, std::memory_order_relaxed);
  int waiting = 0;
  if (sem_getvalue(&impl.wake, &waiting) == 0 && waiting == 0) {
    sem_post(&impl.wake);
  }
  return true;
}

void ServoDriver::read(TimeNs /*now_ns*/, ServoFeedback& out) noexcept {
  Impl& impl = *impl_;
  impl.hush_until_ns.store(monotonic_ns() + impl.options.hush_ns, std::memory_order_relaxed);
  (void)impl.report_box.take(impl.newest_report);
  out.fresh_mask = 0;
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    const JointReport& told = impl.newest_report.joints[joint];
    const std::uint32_t bit = 1U << joint;
    if (told.health != ServoHealth::Working) {
      impl.trusted_mask &= ~bit;
      continue;
    }
    if (told.measured_ns == impl.delivered_ns[joint]) {
      continue;
    }
    impl.delivered_ns[joint] = told.measured_ns;
    impl.trusted_mask |= bit;
    out.position_deg[joint] = told.position_deg;
    out.measured_ns = std::max(out.measured_ns, told.measured_ns);
    out.fresh_mask |= bit;
  }
}

bool ServoDriver::wait_until_ready(TimeNs timeout_ns) {
  std::uint32_t wanted = 0;
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    wanted |= impl_->options.map.joints[joint].is_present ? 1U << joint : 0U;
  }
  const TimeNs end_ns = monotonic_ns() + timeout_ns;
  while (monotonic_ns() < end_ns) {
    const HeadReport now = report();
    std::uint32_t measured = 0;
    for (std::size_t joint = 0; joint < kJointCount; ++joint) {
      const bool is_there = now.joints[joint].health == ServoHealth::Working && now.joints[joint].measured_ns != 0;
      measured |= is_there ? 1U << joint : 0U;
    }
    if ((measured & wanted) == wanted) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

HeadReport ServoDriver::report() const {
  const std::lock_guard lock(impl_->shared_mutex);
  return impl_->shared_report;
}

std::vector<ServoEvent> ServoDriver::take_events() { return impl_->events.take(); }

LatencyHistogram ServoDriver::command_latency() const {
  const std::lock_guard lock(impl_->shared_mutex);
  return impl_->latency;
}

LatencyHistogram ServoDriver::issue_latency() const {
  const std::lock_guard lock(impl_->shared_mutex);
  return impl_->issue_latency;
}

}  // namespace tectum
