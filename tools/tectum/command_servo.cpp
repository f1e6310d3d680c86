// tectum servo: for a person with a cable.
#include "tools/tectum/command_servo.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "compiler/expression/expression.h"
#include "drivers/servo/servo_driver.h"
#include "tools/tectum/progress.h"
#include "tools/tectum/tectum_main.h"

namespace tectum {
namespace {

constexpr TimeNs kMs = 1'000'000;

struct ScanArguments {
  ServoPortArguments port;
  int first = 0;
  int last = dynamixel::kHighestId;
  bool all_rates = false;
};

struct PingArguments {
  ServoPortArguments port;
  int id = 1;
  int count = 1;
};

struct ReadArguments {
  ServoPortArguments port;
  int id = 1;
  std::vector<std::string> registers;
};

struct WriteArguments {
  ServoPortArguments port;
  int id = 1;
  std::string name;
  int value = 0;
};

struct CenterArguments {
  ServoPortArguments port;
  std::vector<int> ids;
  int units = 512;
  double speed_deg_s = 30;
  bool stays_on = false;
};

void fail(CommandContext& context, const std::string& line) {
  context.err << "tectum: " << line << '\n';
  context.exit_status = kExitTrouble;
}

// What went wrong with one servo, in one line.
std::string failure_of(int id, const BusAnswer& answer) {
  if (answer.status == BusStatus::Refused) {
    return fmt::format("servo {}: refused ({})", id, error_bit_text(answer.error_bits));
  }
  return fmt::format("servo {}: {}", id, describe(answer.status));
}

const ax12::Register* find_or_explain(const std::string& name, CommandContext& context) {
  const ax12::Register* row = ax12::find_register(name);
  if (row == nullptr) {
    std::vector<std::string> known;
    for (const ax12::Register& each : ax12::kRegisters) {
      known.emplace_back(each.name);
    }
    fail(context, fmt::format("an AX-12A has no register `{}`", name));
    const auto nearest = nearest_name(name, known);
    context.err << (nearest ? fmt::format("    = help: did you mean `{}`?\n", *nearest)
                            : fmt::format("    = help: it has {}\n", fmt::join(known, ", ")));
  }
  return row;
}

// --- scan ----------------------------------------------------------------------------------------------------------

std::size_t scan_at(const ServoPortArguments& port, const ScanArguments& arguments, CommandContext& context) {
  const OpenBus open = open_servo_bus(port, context);
  if (open.bus == nullptr) {
    return 0;
  }
  Progress progress(context.err, fmt::format("scanning at {} baud", open.bus->options().baud));
  const double all = arguments.last - arguments.first + 1;
  const auto found =
      open.bus->scan(static_cast<std::uint8_t>(arguments.first), static_cast<std::uint8_t>(arguments.last),
                     [&](std::uint8_t id) { progress.update((id - arguments.first) / all, fmt::format("ID {}", id)); });
  for (const std::uint8_t id : found) {
    std::uint16_t model = 0;
    std::uint16_t position = 0;
    const bool is_known = open.bus->read(id, *ax12::find_register("model_number"), model).is_ok() &&
                          open.bus->read(id, ax12::kPresentPosition, position).is_ok();
    if (!is_known) {
      context.out << fmt::format("ID {:3}  {} baud  answers, but not in whole packets: are there two with this ID?\n",
                                 id, open.bus->options().baud);
      continue;
    }
    context.out << fmt::format("ID {:3}  {} baud  {}  at {} units ({:.1f} deg)\n", id, open.bus->options().baud,
                               model == ax12::kModelNumber ? "AX-12A" : fmt::format("model {}", model), position,
                               position * ax12::kUnitDeg);
  }
  return found.size();
}

void scan(const ScanArguments& arguments, CommandContext& context) {
  std::size_t found = 0;
  if (arguments.all_rates) {
    for (const std::uint32_t baud : ax12::kBaudRates) {
      ServoPortArguments port = arguments.port;
      port.baud = baud;
      found += scan_at(port, arguments, context);
    }
  } else {
    found = scan_at(arguments.port, arguments, context);
  }
  if (found == 0 && context.exit_status == kExitOk) {
    fail(context, "no servo answers: check their power, the cable, and the baud rate (--all-rates tries every one)");
  }
}

// --- ping, read, write ---------------------------------------------------------------------------------------------

void ping(const PingArguments& arguments, CommandContext& context) {
  const OpenBus open = open_servo_bus(arguments.port, context);
  if (open.bus == nullptr) {
    return;
  }
  for (int i = 0; i < arguments.count; ++i) {
    const TimeNs start_ns = open.port->now_ns();
    const BusAnswer answer = open.bus->ping(static_cast<std::uint8_t>(arguments.id));
    if (!answer.is_ok()) {
      fail(context, failure_of(arguments.id, answer));
      continue;
    }
    context.out << fmt::format("servo {}: answered after {:.2f} ms, alarms: {}\n", arguments.id,
                               static_cast<double>(open.port->now_ns() - start_ns) * 1e-6,
                               error_bit_text(answer.error_bits));
  }
}

void print_register(const ax12::Register& row, std::uint16_t value, CommandContext& context) {
  std::string line = fmt::format("{:3}  {:22} {:5}  {:9}  {}", row.address, row.name, value, row.unit, row.meaning);
  line.erase(line.find_last_not_of(' ') + 1);
  context.out << line << '\n';
}

void read(const ReadArguments& arguments, CommandContext& context) {
  std::vector<const ax12::Register*> rows;
  for (const std::string& name : arguments.registers) {
    const ax12::Register* row = find_or_explain(name, context);
    if (row == nullptr) {
      return;
    }
    rows.push_back(row);
  }
  if (rows.empty()) {
    for (const ax12::Register& row : ax12::kRegisters) {
      rows.push_back(&row);
    }
  }
  const OpenBus open = open_servo_bus(arguments.port, context);
  if (open.bus == nullptr) {
    return;
  }
  for (const ax12::Register* row : rows) {
    std::uint16_t value = 0;
    const BusAnswer answer = open.bus->read(static_cast<std::uint8_t>(arguments.id), *row, value);
    if (!answer.is_ok()) {
      fail(context, failure_of(arguments.id, answer));
      return;
    }
    print_register(*row, value, context);
  }
}

void write(const WriteArguments& arguments, CommandContext& context) {
  const ax12::Register* row = find_or_explain(arguments.name, context);
  if (row == nullptr) {
    return;
  }
  if (row->access == ax12::Access::Read) {
    fail(context, fmt::format("`{}` can only be read", row->name));
    return;
  }
  if (arguments.value < row->min || arguments.value > row->max) {
    fail(context, fmt::format("`{}` takes {} to {}, not {}", row->name, row->min, row->max, arguments.value));
    return;
  }
  const OpenBus open = open_servo_bus(arguments.port, context);
  if (open.bus == nullptr) {
    return;
  }
  auto id = static_cast<std::uint8_t>(arguments.id);
  std::uint16_t level = 2;
  if (open.bus->read(id, ax12::kStatusReturnLevel, level).is_ok()) {
    open.bus->set_return_level(id, static_cast<std::uint8_t>(level));
  }
  const auto value = static_cast<std::uint16_t>(arguments.value);
  const BusAnswer answer = open.bus->write(id, *row, value);
  if (!answer.is_ok()) {
    fail(context, failure_of(arguments.id, answer) +
                      (answer.status == BusStatus::Refused && row->address < ax12::kFirstRamAddress
                           ? "; is its EEPROM locked? Only switching its power off and on unlocks it"
                           : ""));
    return;
  }
  if (row->address == ax12::kBaudRate.address) {
    context.out << fmt::format("servo {}: talks at {:.0f} baud from now on\n", id,
                               ax12::baud_of(static_cast<std::uint8_t>(value)));
    return;
  }
  if (row->address == ax12::kId.address) {
    id = static_cast<std::uint8_t>(value);
  }
  // The EEPROM is deaf for 6 ms a byte; an adapter that says "done" for the servo is not believed either.
  open.port->sleep_until(open.port->now_ns() + 20 * kMs);
  std::uint16_t now_there = 0;
  const BusAnswer check = open.bus->read(id, *row, now_there);
  if (!check.is_ok()) {
    fail(context, failure_of(id, check));
    return;
  }
  print_register(*row, now_there, context);
  if (now_there != value) {
    fail(context, fmt::format("servo {}: `{}` did not take {}", id, row->name, value));
  }
}

// --- center --------------------------------------------------------------------------------------------------------

// Slowly, and one after another, so that a hand can reach the plug.
bool center_one(Ax12Bus& bus, int id_given, const CenterArguments& arguments, CommandContext& context) {
  const auto id = static_cast<std::uint8_t>(id_given);
  const auto goal = static_cast<std::uint16_t>(arguments.units);
  const auto speed =
      static_cast<std::uint16_t>(std::clamp(std::lround(arguments.speed_deg_s / ax12::kSpeedUnitDegS), 1L, 1023L));
  std::uint16_t position = 0;
  BusAnswer answer = bus.read(id, ax12::kPresentPosition, position);
  for (const auto& [row, value] : {std::pair{ax12::kMovingSpeed, speed}, std::pair{ax12::kGoalPosition, goal},
                                   std::pair{ax12::kTorqueEnable, std::uint16_t{1}}}) {
    answer = answer.is_ok() ? bus.write(id, row, value) : answer;
  }
  if (!answer.is_ok()) {
    fail(context, failure_of(id, answer));
    return false;
  }
  const std::uint16_t start = position;
  const double way_s = std::abs(start - goal) * ax12::kUnitDeg / (speed * ax12::kSpeedUnitDegS);
  const TimeNs end_ns = bus.link().now_ns() + static_cast<TimeNs>((way_s * 1.5 + 1) * 1e9);
  int away = std::abs(position - goal);
  constexpr int kThereUnits = 5;  // margin, friction and load leave it that close
  while (away > kThereUnits && bus.link().now_ns() < end_ns) {
    bus.link().sleep_until(bus.link().now_ns() + 20 * kMs);
    answer = bus.read(id, ax12::kPresentPosition, position);
    away = answer.is_ok() ? std::abs(position - goal) : away;
  }
  if (!arguments.stays_on) {
    answer = bus.write(id, ax12::kTorqueEnable, 0);
  }
  context.out << fmt::format("servo {}: from {} to {} units, torque {}, alarms: {}\n", id, start, position,
                             arguments.stays_on ? "on" : "off", error_bit_text(answer.error_bits));
  if (away > kThereUnits) {
    fail(context, fmt::format("servo {}: stopped {} units short of {}", id, away, goal));
    return false;
  }
  return true;
}

void center(const CenterArguments& arguments, CommandContext& context) {
  const OpenBus open = open_servo_bus(arguments.port, context);
  for (std::size_t i = 0; open.bus != nullptr && i < arguments.ids.size(); ++i) {
    if (!center_one(*open.bus, arguments.ids[i], arguments, context)) {
      return;
    }
  }
}

void add_id(CLI::App& command, int& id) {
  command.add_option("ID", id, "the servo")->required()->check(CLI::Range(0, int{dynamixel::kHighestId}));
}

// --- options -------------------------------------------------------------------------------------------------------

void add_scan(CLI::App& servo, CommandContext& context) {
  CLI::App* command = servo.add_subcommand("scan", "find every servo on the bus");
  auto arguments = std::make_shared<ScanArguments>();
  add_servo_port_arguments(*command, arguments->port);
  command->add_option("--first", arguments->first, "lowest ID to ask")
      ->check(CLI::Range(0, 253))
      ->capture_default_str();
  command->add_option("--last", arguments->last, "highest ID to ask")->check(CLI::Range(0, 253))->capture_default_str();
  command->add_flag("--all-rates", arguments->all_rates, "at every baud rate of the manual, one after another");
  command->footer(
      "Examples:\n"
      "  tectum servo scan --port /dev/ttyUSB0 --last 10\n"
      "  tectum servo scan --all-rates                     a servo that nobody knows anything about\n");
  command->callback([arguments, &context] { scan(*arguments, context); });
}

void add_ping(CLI::App& servo, CommandContext& context) {
  CLI::App* command = servo.add_subcommand("ping", "see whether one servo answers, how fast, and its alarms");
  auto arguments = std::make_shared<PingArguments>();
  add_id(*command, arguments->id);
  add_servo_port_arguments(*command, arguments->port);
  command->add_option("--count", arguments->count, "times to ask")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->footer(
      "Examples:\n"
      "  tectum servo ping 3\n"
      "  tectum servo ping 3 --count 100      16 ms each: set the adapter's latency timer to 1 (drivers/README.md)\n");
  command->callback([arguments, &context] { ping(*arguments, context); });
}

void add_read(CLI::App& servo, CommandContext& context) {
  CLI::App* command = servo.add_subcommand("read", "print registers of one servo");
  auto arguments = std::make_shared<ReadArguments>();
  add_id(*command, arguments->id);
  command->add_option("REGISTER", arguments->registers, "by name; all of them when none is named");
  add_servo_port_arguments(*command, arguments->port);
  command->footer(
      "Examples:\n"
      "  tectum servo read 3\n"
      "  tectum servo read 3 present_position present_temperature\n");
  command->callback([arguments, &context] { read(*arguments, context); });
}

void add_write(CLI::App& servo, CommandContext& context) {
  CLI::App* command = servo.add_subcommand("write", "write one register of one servo, and read it back");
  auto arguments = std::make_shared<WriteArguments>();
  add_id(*command, arguments->id);
  command->add_option("REGISTER", arguments->name, "by name")->required();
  command->add_option("VALUE", arguments->value, "in the register's own units")->required();
  add_servo_port_arguments(*command, arguments->port);
  command->footer(
      "Examples:\n"
      "  tectum servo write 1 id 3                        with no other servo of ID 1 on the bus\n"
      "  tectum servo write 3 return_delay_time 0         answers half a millisecond sooner\n"
      "  tectum servo write 3 torque_limit 1023           revives a servo that shut down\n");
  command->callback([arguments, &context] { write(*arguments, context); });
}

void add_center(CLI::App& servo, CommandContext& context) {
  CLI::App* command = servo.add_subcommand("center", "turn servos slowly to the middle, one after another");
  auto arguments = std::make_shared<CenterArguments>();
  command->add_option("ID", arguments->ids, "the servos")->required()->check(CLI::Range(0, int{dynamixel::kHighestId}));
  add_servo_port_arguments(*command, arguments->port);
  command->add_option("--to", arguments->units, "units of 300/1023 deg")
      ->check(CLI::Range(0, 1023))
      ->capture_default_str();
  command->add_option("--speed", arguments->speed_deg_s, "at most this fast")
      ->check(CLI::Range(0.7, 354.0))
      ->capture_default_str()
      ->type_name("DEG/S");
  command->add_flag("--hold", arguments->stays_on, "leave torque on at the end");
  command->footer(
      "Examples:\n"
      "  tectum servo center 1 2 3 4 5 6                  before the head is put together\n"
      "  tectum servo center 3 --to 600 --speed 10\n");
  command->callback([arguments, &context] { center(*arguments, context); });
}

}  // namespace

void add_servo_port_arguments(CLI::App& command, ServoPortArguments& arguments) {
  command.add_option("--port", arguments.path, "serial device")->capture_default_str()->type_name("PATH");
  command.add_option("--baud", arguments.baud, "of the adapter's line [1000000; for an ArbotiX 115200]")
      ->check(CLI::Range(300U, 4'000'000U));
  command.add_option("--adapter", arguments.adapter, "direct (U2D2, USB2Dynamixel) or arbotix (the `ros` firmware)")
      ->check(CLI::IsMember({"direct", "arbotix"}))
      ->capture_default_str();
}

OpenBus open_servo_bus(const ServoPortArguments& arguments, CommandContext& context) {
  const bool is_arbotix = arguments.adapter == "arbotix";
  BusOptions options;
  options.adapter = is_arbotix ? BusAdapter::ArbotixRos : BusAdapter::Transparent;
  options.baud = arguments.baud;
  if (options.baud == 0) {
    options.baud = usual_baud(is_arbotix ? ServoLinkKind::ArbotixRos : ServoLinkKind::Direct);
  }
  // Nobody waits for a command line's answer in a loop: room for an adapter's latency timer of 16 ms.
  options.answer_margin_ns = 25 * kMs;
  options.gap_ns = 20 * kMs;
  OpenBus open;
  std::string error;
  open.port = SerialPort::open(arguments.path, options.baud, error);
  if (open.port == nullptr) {
    fail(context, error);
    return open;
  }
  open.bus = std::make_unique<Ax12Bus>(*open.port, options);
  return open;
}

std::string error_bit_text(std::uint8_t bits) {
  std::string text;
  for (std::size_t bit = 0; bit < dynamixel::kErrorBitNames.size(); ++bit) {
    if ((bits >> bit & 1U) != 0) {
      text += fmt::format("{}{}", text.empty() ? "" : ", ", dynamixel::kErrorBitNames[bit]);
    }
  }
  return text.empty() ? "none" : text;
}

void add_servo_command(CLI::App& app, CommandContext& context) {
  CLI::App* servo = app.add_subcommand("servo", "talk to AX-12A servos, or pretend to be some");
  servo->require_subcommand(1);
  servo->footer(
      "Examples:\n"
      "  tectum servo scan --port /dev/ttyUSB0 --last 10\n"
      "  tectum servo read 3\n"
      "  tectum servo emulate --link ./head                 a head without hardware; then, elsewhere:\n"
      "  tectum servo scan --port ./head --last 10\n");
  add_scan(*servo, context);
  add_ping(*servo, context);
  add_read(*servo, context);
  add_write(*servo, context);
  add_center(*servo, context);
  add_servo_emulate_command(*servo, context);
}

}  // namespace tectum
