// The AX-12A's control table (ROBOTIS e-manual, "AX-12A"; ranges from the AX-12 manual of 2006, "Control Table Data
// Range"). EEPROM keeps its values without power; RAM starts from `initial`.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tectum::ax12 {

enum class Access : std::uint8_t { Read, ReadWrite };

struct Register {
  std::uint8_t address;
  std::uint8_t size;  // bytes, little-endian
  std::string_view name;
  Access access;
  std::uint16_t min;  // what may be written
  std::uint16_t max;
  std::uint16_t initial;
  std::string_view unit;
  std::string_view meaning;
};

inline constexpr std::uint8_t kFirstRamAddress = 24;
inline constexpr std::uint8_t kTableSize = 50;  // addresses [0, 50); 10, 19 to 23 and 45 are reserved
inline constexpr std::uint16_t kModelNumber = 12;

inline constexpr Access R = Access::Read;
inline constexpr Access RW = Access::ReadWrite;

// clang-format off
inline constexpr std::array<Register, 32> kRegisters = {{
    // address, size, name, access, min, max, initial, unit, meaning
    { 0, 2, "model_number",          R,   0, 65535, kModelNumber, "", "12 is an AX-12A"},
    { 2, 1, "firmware_version",      R,   0,  255,   24, "", ""},
    { 3, 1, "id",                    RW,  0,  253,    1, "", "every new servo is 1"},
    { 4, 1, "baud_rate",             RW,  0,  254,    1, "", "2 Mbps / (value + 1): 1 is 1 Mbps, 34 is 57600"},
    { 5, 1, "return_delay_time",     RW,  0,  254,  250, "2 us", "waited before every answer"},
    { 6, 2, "cw_angle_limit",        RW,  0, 1023,    0, "0.29 deg", "lowest goal; both limits 0 is wheel mode"},
    { 8, 2, "ccw_angle_limit",       RW,  0, 1023, 1023, "0.29 deg", "highest goal"},
    {11, 1, "temperature_limit",     RW,  0,  150,   70, "deg C", ""},
    {12, 1, "min_voltage_limit",     RW, 50,  250,   60, "0.1 V", ""},
    {13, 1, "max_voltage_limit",     RW, 50,  250,  140, "0.1 V", ""},
    {14, 2, "max_torque",            RW,  0, 1023, 1023, "0.1 %", "copied to torque_limit when power comes on"},
    {16, 1, "status_return_level",   RW,  0,    2,    2, "", "answers 0: pings, 1: and reads, 2: everything"},
    {17, 1, "alarm_led",             RW,  0,  127,   36, "error bits", "that make the LED blink"},
    {18, 1, "shutdown",              RW,  0,  127,   36, "error bits", "that set torque_limit to 0"},
    {24, 1, "torque_enable",         RW,  0,    1,    0, "", ""},
    {25, 1, "led",                   RW,  0,    1,    0, "", ""},
    {26, 1, "cw_compliance_margin",  RW,  0,  254,    1, "0.29 deg", "no torque so close to the goal"},
    {27, 1, "ccw_compliance_margin", RW,  0,  254,    1, "0.29 deg", ""},
    {28, 1, "cw_compliance_slope",   RW,  1,  254,   32, "0.29 deg", "torque falls over this much; acts as 2, 4, .. 128"},
    {29, 1, "ccw_compliance_slope",  RW,  1,  254,   32, "0.29 deg", ""},
    {30, 2, "goal_position",         RW,  0, 1023,  512, "0.29 deg", "512 is the middle of 300 deg"},
    {32, 2, "moving_speed",          RW,  0, 1023,    0, "0.111 rpm", "0 is as fast as it can; wheel mode up to 2047"},
    {34, 2, "torque_limit",          RW,  0, 1023, 1023, "0.1 %", "0 after a shutdown; write another value to revive"},
    {36, 2, "present_position",      R,   0, 1023,  512, "0.29 deg", ""},
    {38, 2, "present_speed",         R,   0, 2047,    0, "0.111 rpm", "bit 10: clockwise"},
    {40, 2, "present_load",          R,   0, 2047,    0, "0.1 %", "bit 10: clockwise; inferred, not measured"},
    {42, 1, "present_voltage",       R,   0,  255,  111, "0.1 V", ""},
    {43, 1, "present_temperature",   R,   0,  255,   30, "deg C", ""},
    {44, 1, "registered",            R,   0,    1,    0, "", "a RegWrite waits for its Action"},
    {46, 1, "moving",                R,   0,    1,    0, "", ""},
    {47, 1, "lock",                  RW,  0,    1,    0, "", "1 protects the EEPROM until power goes off"},
    {48, 2, "punch",                 RW,  0, 1023,   32, "0.1 %", "least drive outside the margin"},
}};
// clang-format on

[[nodiscard]] constexpr const Register* find_register(std::string_view name) noexcept {
  for (const Register& row : kRegisters) {
    if (row.name == name) {
      return &row;
    }
  }
  return nullptr;
}

/// The register that the byte at `address` belongs to; null for reserved bytes and beyond the table.
[[nodiscard]] constexpr const Register* register_at(std::uint8_t address) noexcept {
  for (const Register& row : kRegisters) {
    if (address >= row.address && address < row.address + row.size) {
      return &row;
    }
  }
  return nullptr;
}

/// A name that is in no row does not compile.
consteval Register named(std::string_view name) { return *find_register(name); }

inline constexpr Register kId = named("id");
inline constexpr Register kBaudRate = named("baud_rate");
inline constexpr Register kReturnDelayTime = named("return_delay_time");
inline constexpr Register kCwAngleLimit = named("cw_angle_limit");
inline constexpr Register kCcwAngleLimit = named("ccw_angle_limit");
inline constexpr Register kTemperatureLimit = named("temperature_limit");
inline constexpr Register kMinVoltageLimit = named("min_voltage_limit");
inline constexpr Register kMaxVoltageLimit = named("max_voltage_limit");
inline constexpr Register kMaxTorque = named("max_torque");
inline constexpr Register kStatusReturnLevel = named("status_return_level");
inline constexpr Register kShutdown = named("shutdown");
inline constexpr Register kTorqueEnable = named("torque_enable");
inline constexpr Register kCwComplianceMargin = named("cw_compliance_margin");
inline constexpr Register kCcwComplianceMargin = named("ccw_compliance_margin");
inline constexpr Register kCwComplianceSlope = named("cw_compliance_slope");
inline constexpr Register kCcwComplianceSlope = named("ccw_compliance_slope");
inline constexpr Register kGoalPosition = named("goal_position");
inline constexpr Register kMovingSpeed = named("moving_speed");
inline constexpr Register kTorqueLimit = named("torque_limit");
inline constexpr Register kPresentPosition = named("present_position");
inline constexpr Register kPresentSpeed = named("present_speed");
inline constexpr Register kPresentLoad = named("present_load");
inline constexpr Register kPresentVoltage = named("present_voltage");
inline constexpr Register kPresentTemperature = named("present_temperature");
inline constexpr Register kRegistered = named("registered");
inline constexpr Register kMoving = named("moving");
inline constexpr Register kLock = named("lock");
inline constexpr Register kPunch = named("punch");

inline constexpr std::uint16_t kHighestPosition = 1023;
inline constexpr double kUnitDeg = 300.0 / 1023.0;   // positions
inline constexpr double kSpeedUnitDegS = 0.111 * 6;  // 0.111 rpm
inline constexpr double kNoLoadSpeedDegS = 354;      // 59 rpm at 12 V
inline constexpr double kReturnDelayUnitNs = 2000;
inline constexpr std::uint16_t kDirectionBit = 1U << 10;  // of speed and load

/// Baud rates that the manual lists; others work as far as the divider comes near them.
inline constexpr std::array<std::uint32_t, 9> kBaudRates = {1000000, 500000, 400000, 250000, 200000,
                                                            115200,  57600,  19200,  9600};
[[nodiscard]] constexpr double baud_of(std::uint8_t value) noexcept { return 2e6 / (value + 1.0); }

}  // namespace tectum::ax12
