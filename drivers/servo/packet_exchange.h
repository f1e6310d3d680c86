// The head's servos over Protocol 1.0.
//
// A round asks every servo once. Each is read for its position, and one of them in turn for everything from
// torque_enable to present_temperature. The two reads differ in size, so that a late answer of one is never taken for
// the other.
//
// What is trusted. An 8-bit sum lets about one in a hundred thousand damaged positions through at 1 % byte errors. So,
// as soon as the wire has shown one error in the last five seconds, and for the first five seconds, a position counts
// only when two readings in succession say exactly the same: any room for what the shaft moved in between is room for a
// damaged low bit (with it, 5 of 39 million positions were wrong in a soak of 24 hours, by up to 4 units). On a clean
// wire a position counts at once unless the shaft cannot have come there so fast. What is not confirmed is not
// reported: the joint is just not fresh. Alarms count when two answers in succession say so.
//
// Goals go out as one SyncWrite of goal and speed when a command comes and again at the start of each round, because
// nobody answers a SyncWrite: a goal that noise swallowed or changed stands for one round at most.
//
// A servo that shut itself down (overload, heat) is limp: its torque limit is 0. So is one to which a damaged packet
// wrote that, with no alarm to tell of it; the full reads notice. It rests, must be cool again, gets its
// own position as goal, and then its torque limit back (e-manual, "Torque Limit"). After three revivals in a minute it
// is given up. While it cannot follow, and from a loss until a command that was issued after it came back, it gets no
// goals.
#pragma once

#include <array>

#include "drivers/servo/ax12_bus.h"
#include "drivers/servo/servo_exchange.h"
#include "drivers/servo/servo_map.h"
#include "drivers/servo/servo_report.h"

namespace tectum {

struct PacketExchangeOptions {
  BusOptions bus;
  TimeNs lost_after_ns = 200'000'000;
  TimeNs ask_lost_every_ns = 100'000'000;
  TimeNs rest_ns = 2'000'000'000;  // after an overload
  int cool_down_c = 5;             // below its temperature limit before it is revived
  int most_revivals = 3;           // in revival_window_ns
  TimeNs revival_window_ns = 60'000'000'000;
  TimeNs noise_memory_ns = 5'000'000'000;
  bool locks_eeprom = true;
};

class PacketExchange final : public ServoExchange {
 public:
  /// Everything outlives it. `report` is written by whatever thread calls.
  PacketExchange(ByteLink& link, const ServoMap& map, const PacketExchangeOptions& options, HeadReport& report,
                 ServoEventLog& events);

  [[nodiscard]] ExchangeStatus begin() override;
  [[nodiscard]] ExchangeStatus send(const ServoCommand& command) override;
  [[nodiscard]] ExchangeStatus poll() override;
  void release() override;

 private:
  struct Reading {
    std::uint16_t units = 0;
    TimeNs at_ns = 0;
  };
  struct JointState {
    bool has_goal = false;
    std::uint16_t goal_units = 0;
    bool needs_torque = true;
    bool has_reading = false;
    Reading last;            // confirmed
    TimeNs answered_ns = 0;  // any whole answer
    TimeNs asked_ns = 0;
    int mute_signs = 0;          // times that it answered a ping and no read
    std::uint8_t last_bits = 0;  // alarms of the answer before
    std::uint8_t told_bits = 0;  // alarms that people have been told of
    bool is_told_hot = false;
    std::array<std::uint8_t, 4> compliance{};  // margins and slopes as they were found
    std::uint16_t punch = 0;
    int temperature_limit_c = 70;
    TimeNs revive_at_ns = 0;
    std::array<TimeNs, 8> revivals_ns{};  // a ring
    std::size_t revival_count = 0;
  };

  [[nodiscard]] bool is_present(std::size_t joint) const noexcept { return map_.joints[joint].is_present; }
  [[nodiscard]] std::uint8_t id(std::size_t joint) const noexcept { return map_.joints[joint].id; }
  [[nodiscard]] ServoHealth& health(std::size_t joint) noexcept { return report_.joints[joint].health; }
  [[nodiscard]] std::string name(std::size_t joint) const;
  void tell(std::size_t joint, const std::string& what);
  /// Remembers a vanished port.
  void note(const BusAnswer& answer) noexcept;

  void get_ready(std::size_t joint);
  /// Twice the same. No answer is trusted alone where much hangs on it.
  [[nodiscard]] BusAnswer read_surely(std::size_t joint, std::uint8_t address, std::span<std::uint8_t> out);
  void check_setup(std::size_t joint, std::span<const std::uint8_t> setup);
  void write_goals();
  void switch_torque_on(std::size_t joint);
  void switch_torque_off();

  void ask(std::size_t joint);
  [[nodiscard]] bool read_position(std::size_t joint, Reading& reading);
  [[nodiscard]] bool read_everything(std::size_t joint, Reading& reading);
  void take_ram(std::size_t joint, std::span<const std::uint8_t> ram);
  void put_settings_back(std::size_t joint, std::span<const std::uint8_t> ram);
  void take_reading(std::size_t joint, Reading reading);
  void note_answer(std::size_t joint, const BusAnswer& answer);
  void note_silence(std::size_t joint);
  void come_back(std::size_t joint);
  void check_shutdown(std::size_t joint);
  void tell_alarms(std::size_t joint, std::uint8_t bits);
  void revive(std::size_t joint);
  [[nodiscard]] bool has_revived_too_often(JointState& state) noexcept;
  [[nodiscard]] bool is_wire_noisy() noexcept;

  ServoMap map_;
  PacketExchangeOptions options_;
  HeadReport& report_;
  ServoEventLog& events_;
  Ax12Bus bus_;
  ByteLink& link_;
  std::array<JointState, kJointCount> joints_;
  bool is_link_gone_ = false;
  std::size_t next_joint_ = 0;
  std::size_t thorough_joint_ = 0;  // the one that is read for everything in this round
  std::uint64_t seen_troubles_ = 0;
  TimeNs noisy_until_ns_ = 0;
};

}  // namespace tectum
