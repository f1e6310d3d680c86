// What the subcommands of `tectum servo` share.
#pragma once

#include <memory>
#include <string>

#include "drivers/servo/ax12_bus.h"
#include "drivers/servo/serial_port.h"
#include "tools/tectum/command.h"

namespace tectum {

struct ServoPortArguments {
  std::string path = "/dev/ttyUSB0";
  std::uint32_t baud = 0;  // 0 = what the adapter comes with
  std::string adapter = "direct";
};

/// Adds --port, --baud and --adapter.
void add_servo_port_arguments(CLI::App& command, ServoPortArguments& arguments);

struct OpenBus {
  std::unique_ptr<SerialPort> port;
  std::unique_ptr<Ax12Bus> bus;
};

/// Null bus, the reason printed and the exit status set, when the port cannot be opened.
[[nodiscard]] OpenBus open_servo_bus(const ServoPortArguments& arguments, CommandContext& context);

/// "voltage, overload", or "none".
[[nodiscard]] std::string error_bit_text(std::uint8_t bits);

void add_servo_emulate_command(CLI::App& servo, CommandContext& context);

}  // namespace tectum
