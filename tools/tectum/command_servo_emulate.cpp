// tectum servo emulate: a bus of AX-12As that is not there.
#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <optional>
#include <sstream>
#include <thread>
#include <vector>

#include "drivers/servo/emulated_arbotix.h"
#include "drivers/servo/emulated_sketch.h"
#include "drivers/servo/pty_device.h"
#include "drivers/servo/servo_map.h"
#include "tools/live/head_motion.h"
#include "tools/tectum/command_servo.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

constexpr double kNsPerS = 1e9;

struct EmulateArguments {
  std::string link_path;
  std::vector<int> ids = {1, 2, 3, 4, 5, 6};
  std::string board = "none";
  bool has_head = false;
  int return_delay = 0;
  double byte_errors = 0;
  double missing = 0;
  double late = 0;
  double lateness_ms = 5;
  bool is_instant = false;
  double duration_s = 0;
  std::uint64_t seed = 1;
  std::vector<std::string> events;
};

struct Event {
  double at_s = 0;
  std::string action;
  int id = 0;
  double value = 0;
  std::string text;
};

volatile sig_atomic_t is_interrupted = 0;
void interrupt(int) { is_interrupted = 1; }

// "5 drop 3": a time, an action, and what the action needs.
std::optional<Event> parse_event(const std::string& text) {
  std::istringstream words(text);
  Event event;
  event.text = text;
  if (!(words >> event.at_s >> event.action)) {
    return std::nullopt;
  }
  const auto takes = [&](std::initializer_list<const char*> names) {
    return std::find(names.begin(), names.end(), event.action) != names.end();
  };
  bool is_read = false;
  if (takes({"drop", "return", "block", "free"})) {
    is_read = static_cast<bool>(words >> event.id);
  } else if (takes({"heat", "supply"})) {
    is_read = static_cast<bool>(words >> event.id >> event.value);
  } else if (takes({"errors"})) {
    is_read = static_cast<bool>(words >> event.value);
  } else if (takes({"unplug", "plug"})) {
    is_read = true;
  }
  std::string rest;
  return is_read && event.at_s >= 0 && !(words >> rest) ? std::optional(event) : std::nullopt;
}

class Emulation {
 public:
  Emulation(const EmulateArguments& arguments, CommandContext& context)
      : arguments_(arguments), context_(context), bus_({.seed = arguments.seed, .has_timing = !arguments.is_instant}) {}

  void run();

 private:
  void add_servos();
  [[nodiscard]] EmulatedDevice& device();
  void do_event(const Event& event);
  void change_bus(const Event& event, TimeNs now_ns);
  void sum_up();

  const EmulateArguments& arguments_;
  CommandContext& context_;
  std::mutex head_mutex_;
  std::unique_ptr<SimHead> head_;
  Ax12Emulator bus_;
  std::unique_ptr<EmulatedArbotix> arbotix_;
  EmulatedSketch sketch_;
  std::unique_ptr<PtyDevice> pty_;
};

void Emulation::add_servos() {
  const TimeNs start_ns = PtyDevice::now_ns();
  const ServoMap map;
  if (arguments_.has_head) {
    SimHeadParams params;
    params.seed = arguments_.seed;
    head_ = std::make_unique<SimHead>(params);
  }
  for (const int given : arguments_.ids) {
    const auto id = static_cast<std::uint8_t>(given);
    std::optional<Joint> joint;
    for (std::size_t j = 0; head_ != nullptr && j < kJointCount; ++j) {
      joint = map.joints[j].id == id ? std::optional(static_cast<Joint>(j)) : joint;
    }
    EmulatedServo& servo =
        joint ? bus_.add_servo(id, make_head_motion(*head_, head_mutex_, map, *joint, start_ns)) : bus_.add_servo(id);
    servo.set(ax12::kReturnDelayTime, static_cast<std::uint16_t>(arguments_.return_delay), start_ns);
  }
  bus_.noise.faults = WireFaults::bytes(arguments_.byte_errors);
  bus_.noise.faults.missing_answers = arguments_.missing;
  bus_.noise.faults.late_answers = arguments_.late;
  bus_.noise.faults.lateness_ns = static_cast<TimeNs>(arguments_.lateness_ms * 1e6);
}

EmulatedDevice& Emulation::device() {
  if (arguments_.board == "sketch") {
    return sketch_;
  }
  if (arguments_.board == "arbotix") {
    arbotix_ = std::make_unique<EmulatedArbotix>(bus_);
    return *arbotix_;
  }
  return bus_;
}

void Emulation::change_bus(const Event& event, TimeNs now_ns) {
  const auto id = static_cast<std::uint8_t>(event.id);
  EmulatedServo* servo = bus_.find(id);
  Ax12Motion* motion = bus_.find_motion(id);
  bool is_done = true;
  if (event.action == "drop") {
    is_done = bus_.pull_plug(id, now_ns);
  } else if (event.action == "return") {
    is_done = bus_.plug_in(id, now_ns);
  } else if (event.action == "errors") {
    bus_.noise.faults = WireFaults::bytes(event.value);
  } else if (event.action == "heat" && servo != nullptr) {
    servo->set_temperature_c(static_cast<int>(event.value));
  } else if (event.action == "supply" && servo != nullptr) {
    servo->set_supply_v(event.value);
  } else if ((event.action == "block" || event.action == "free") && motion != nullptr) {
    motion->block(event.action == "block");
  } else {
    is_done = false;
  }
  if (!is_done) {
    context_.err << fmt::format("{:.1f} s: `{}` cannot be done: no such servo here\n", event.at_s, event.text);
  }
}

void Emulation::do_event(const Event& event) {
  context_.out << fmt::format("{:.1f} s: {}\n", event.at_s, event.text) << std::flush;
  std::string error;
  if (event.action == "unplug") {
    pty_->unplug();
  } else if (event.action == "plug") {
    if (!pty_->plug_in(error)) {
      context_.err << "tectum: " << error << '\n';
      context_.exit_status = kExitTrouble;
    }
  } else {
    pty_->with_device([&](TimeNs now_ns) { change_bus(event, now_ns); });
  }
}

void Emulation::run() {
  std::vector<Event> events;
  for (const std::string& text : arguments_.events) {
    const auto event = parse_event(text);
    if (!event) {
      context_.err << fmt::format("tectum: `--at {}` is not understood; say for example --at '5 drop 3'\n", text);
      context_.exit_status = kExitUsage;
      return;
    }
    events.push_back(*event);
  }
  std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) { return a.at_s < b.at_s; });
  add_servos();
  std::string error;
  pty_ = PtyDevice::open(device(), {.link_path = arguments_.link_path, .has_timing = !arguments_.is_instant}, error);
  if (pty_ == nullptr) {
    context_.err << "tectum: " << error << '\n';
    context_.exit_status = kExitTrouble;
    return;
  }
  context_.out << fmt::format("{}\n", pty_->path()) << std::flush;

  is_interrupted = 0;
  const auto old_handler = signal(SIGINT, interrupt);
  const auto old_terminate = signal(SIGTERM, interrupt);
  const TimeNs start_ns = PtyDevice::now_ns();
  std::size_t next_event = 0;
  for (double now_s = 0; is_interrupted == 0 && (arguments_.duration_s <= 0 || now_s < arguments_.duration_s);) {
    for (; next_event < events.size() && events[next_event].at_s <= now_s; ++next_event) {
      do_event(events[next_event]);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    now_s = static_cast<double>(PtyDevice::now_ns() - start_ns) / kNsPerS;
  }
  signal(SIGINT, old_handler);
  signal(SIGTERM, old_terminate);
  sum_up();
}

void Emulation::sum_up() {
  pty_->with_device([&](TimeNs) {
    if (arguments_.board == "sketch") {
      context_.out << fmt::format("{} lines{}\n", sketch_.lines(),
                                  sketch_.is_hung() ? "; hung on a neck goal outside 340 to 700" : "");
      return;
    }
    const EmulatorCounters& counters = bus_.counters();
    context_.out << fmt::format("{} instructions, {} answers, {} bad checksums, {} damaged and {} collided bytes\n",
                                counters.instructions, counters.answers, counters.bad_checksums,
                                bus_.noise.damaged_bytes(), counters.collided_bytes);
  });
}

void add_wire_options(CLI::App& command, EmulateArguments& arguments) {
  const CLI::Range share(0.0, 1.0);
  command
      .add_option("--byte-errors", arguments.byte_errors, "share of bytes that are flipped, changed, lost or invented")
      ->check(share)
      ->capture_default_str();
  command.add_option("--missing", arguments.missing, "share of answers that never come")
      ->check(share)
      ->capture_default_str();
  command.add_option("--late", arguments.late, "share of answers that come late")->check(share)->capture_default_str();
  command.add_option("--lateness", arguments.lateness_ms, "how late")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str()
      ->type_name("MS");
  command.add_flag("--instant", arguments.is_instant, "no byte times and no delays");
  command
      .add_option("--at", arguments.events,
                  "at a time in seconds, do something: drop ID, return ID, block ID, free ID, heat ID C, supply ID V, "
                  "errors SHARE, unplug, plug")
      ->type_name("'S ACTION'");
}

}  // namespace

void add_servo_emulate_command(CLI::App& servo, CommandContext& context) {
  CLI::App* command = servo.add_subcommand("emulate", "be a bus of AX-12As on a pseudo-terminal");
  auto arguments = std::make_shared<EmulateArguments>();
  command->add_option("--link", arguments->link_path, "also make this symbolic link to the terminal")
      ->type_name("PATH");
  command->add_option("--ids", arguments->ids, "the servos")
      ->check(CLI::Range(0, int{dynamixel::kHighestId}))
      ->capture_default_str();
  command->add_option("--board", arguments->board, "what is between: none, arbotix (`ros` firmware), sketch (of 2020)")
      ->check(CLI::IsMember({"none", "arbotix", "sketch"}))
      ->capture_default_str();
  command->add_flag("--head", arguments->has_head, "IDs 1 to 6 turn the simulated head");
  command->add_option("--return-delay", arguments->return_delay, "register 5 of every servo; 250 from the factory")
      ->check(CLI::Range(0, 254))
      ->capture_default_str();
  add_wire_options(*command, *arguments);
  command->add_option("--duration", arguments->duration_s, "seconds; 0 is until Ctrl-C")->capture_default_str();
  command->add_option("--seed", arguments->seed, "of everything that is random")->capture_default_str();
  command->footer(
      "The first line printed is the terminal to open.\n\n"
      "Examples:\n"
      "  tectum servo emulate --link ./head\n"
      "  tectum servo emulate --link ./head --byte-errors 0.01 --at '5 drop 3' --at '8 return 3'\n"
      "  tectum servo emulate --link ./head --at '10 unplug' --at '12 plug' --at '20 block 4'\n"
      "  tectum servo emulate --board sketch --link ./head           the head of 2020, at 57600 baud\n");
  command->callback([arguments, &context] { Emulation(*arguments, context).run(); });
}

}  // namespace tectum
