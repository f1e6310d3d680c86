// The driver on a wire that damages one byte in a hundred, in virtual time. Short here; tests/servo/soak runs it long,
// with
//   TECTUM_SOAK_PACKETS   random packets (1 000 000 there)
//   TECTUM_SOAK_HOURS     hours of the head's life (24 there)
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "drivers/servo/ax12_emulator.h"
#include "drivers/servo/emulated_link.h"
#include "drivers/servo/packet_exchange.h"

using namespace tectum;

namespace {

constexpr TimeNs kMs = 1'000'000;
constexpr TimeNs kSecond = 1000 * kMs;
constexpr double kByteErrors = 0.01;
constexpr std::uint8_t kServos = 6;

double setting(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::atof(text);
}

// The emulator's motion, which remembers what it said.
class RememberingMotion final : public ServoMotion {
 public:
  void drive(TimeNs now_ns, const ServoDrive& drive) noexcept override { motion_.drive(now_ns, drive); }
  ShaftState shaft(TimeNs now_ns) noexcept override {
    const ShaftState state = motion_.shaft(now_ns);
    said_units_[next_++ % said_units_.size()] = static_cast<int>(std::lround(state.position_deg / ax12::kUnitDeg));
    return state;
  }
  // Among the last ones, more than a round's worth.
  bool has_said(int units) const { return std::count(said_units_.begin(), said_units_.end(), units) > 0; }
  int nearest(int units) const {
    int least = 1024;
    for (const int said : said_units_) {
      least = std::min(least, std::abs(said - units));
    }
    return least;
  }

 private:
  Ax12Motion motion_;
  std::array<int, 16> said_units_{};
  std::size_t next_ = 0;
};

struct Head {
  explicit Head(std::uint64_t seed) : emulator({.seed = seed}) {
    for (std::uint8_t id = 1; id <= kServos; ++id) {
      auto motion = std::make_unique<RememberingMotion>();
      motions[id] = motion.get();
      emulator.add_servo(id, std::move(motion)).set(ax12::kReturnDelayTime, 0, 0);
    }
    emulator.noise.faults = WireFaults::bytes(kByteErrors);
    emulator.noise.faults.missing_answers = 0.001;
  }
  std::array<RememberingMotion*, kServos + 1> motions{};
  Ax12Emulator emulator;
  EmulatedLink link{emulator};
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct PacketSoak {
  std::uint64_t asked = 0, ok = 0, refused = 0, failed = 0;
  std::uint64_t wrong_values = 0;  // whole packets that hold something else than the servo's register
  TimeNs longest_ns = 0;
};

// One random question; RAM registers only, so that the servos stay who they are.
void ask_at_random(Ax12Bus& bus, Head& head, std::mt19937_64& random, PacketSoak& soak) {
  const auto below = [&](unsigned limit) { return static_cast<unsigned>(random() % limit); };
  const auto id = static_cast<std::uint8_t>(1 + below(kServos));
  const TimeNs start_ns = head.link.now_ns();
  std::array<std::uint8_t, 20> bytes{};
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
  }
  BusAnswer answer;
  switch (below(8)) {
    case 0:
      answer = bus.ping(id);
      break;
    case 1:
      answer = bus.write(id, ax12::kGoalPosition, static_cast<std::uint16_t>(below(1200)));
      break;
    case 2:
      answer = bus.write(id, static_cast<std::uint8_t>(24 + below(26)), std::span(bytes).first(1 + below(6)));
      break;
    case 3:
      answer = bus.reg_write(id, 30, std::span(bytes).first(2));
      break;
    case 4:
      answer = bus.action();
      break;
    case 5: {
      const std::array<std::uint8_t, 4> ids = {1, 2, 3, 4};
      answer = bus.sync_write(30, 4, ids, std::span(bytes).first(16));
      break;
    }
    default: {
      const ax12::Register& row = ax12::kPresentPosition;
      std::uint16_t value = 0;
      answer = bus.read(id, row, value);
      if (answer.is_ok() && !head.motions[id]->has_said(value)) {
        ++soak.wrong_values;
      }
    }
  }
  ++soak.asked;
  soak.ok += answer.status == BusStatus::Ok ? 1 : 0;
  soak.refused += answer.status == BusStatus::Refused ? 1 : 0;
  soak.failed += answer.status == BusStatus::NoAnswer || answer.status == BusStatus::Damaged ? 1 : 0;
  soak.longest_ns = std::max(soak.longest_ns, head.link.now_ns() - start_ns);
}

struct DriverSoak {
  std::uint64_t wrong_positions = 0;
  int worst_units = 0;
  std::uint64_t wrong_goals = 0;  // standing in a servo at the end of a round
  std::uint64_t longest_wrong_goal_rounds = 0;
  std::uint64_t stale_joint_rounds = 0;  // rounds without a new position of a joint
  std::uint64_t longest_stale_rounds = 0;
  TimeNs longest_step_ns = 0;
  std::uint64_t moving_joint_rounds = 0;                      // whose shaft was elsewhere a round before
  std::array<std::uint64_t, kJointCount> last_moved_round{};  // of each joint: a head at rest would prove little
  std::uint64_t rounds = 0;
};

class HeadSoak {
 public:
  explicit HeadSoak(std::uint64_t seed) : head_(seed), exchange_(head_.link, map_, {}, report_, events_) {}

  void run(TimeNs duration_ns) {
    REQUIRE(exchange_.begin() != ExchangeStatus::LinkGone);
    std::mt19937_64 random(7);
    for (TimeNs next_command_ns = 0; head_.link.now_ns() < duration_ns;) {
      const TimeNs round_end_ns = head_.link.now_ns() + 10 * kMs;
      if (head_.link.now_ns() >= next_command_ns) {  // 45 Hz; every so often a new place to look at
        if (random() % 20 == 0) {
          before_ = command_;
          for (double& deg : command_.goal_deg) {
            deg = static_cast<double>(random() % 8000) / 100 - 40;
          }
        }
        next_command_ns = head_.link.now_ns() + 22 * kMs;
        REQUIRE(exchange_.send(command_) != ExchangeStatus::LinkGone);
      }
      for (ExchangeStatus status = ExchangeStatus::Busy; status == ExchangeStatus::Busy;) {
        const TimeNs start_ns = head_.link.now_ns();
        status = exchange_.poll();
        REQUIRE(status != ExchangeStatus::LinkGone);
        soak.longest_step_ns = std::max(soak.longest_step_ns, head_.link.now_ns() - start_ns);
        check_positions();
      }
      check_round();
      head_.link.sleep_until(round_end_ns);
    }
  }

  DriverSoak soak;
  [[nodiscard]] const HeadReport& report() const { return report_; }
  [[nodiscard]] std::uint64_t damaged_bytes() const { return head_.emulator.noise.damaged_bytes(); }
  [[nodiscard]] std::vector<ServoEvent> take_events() { return events_.take(); }

 private:
  void check_positions() {
    for (std::size_t joint = 0; joint < kJointCount; ++joint) {
      const JointReport& told = report_.joints[joint];
      if (told.measured_ns == seen_ns_[joint]) {
        continue;
      }
      seen_ns_[joint] = told.measured_ns;
      is_fresh_[joint] = true;
      const int units = *units_of(map_.joints[joint], told.position_deg);
      const int off = head_.motions[map_.joints[joint].id]->nearest(units);
      soak.wrong_positions += off > 0 ? 1 : 0;
      soak.worst_units = std::max(soak.worst_units, off);
    }
  }
  void check_round() {
    ++soak.rounds;
    for (std::size_t joint = 0; joint < kJointCount; ++joint) {
      stale_rounds_[joint] = is_fresh_[joint] ? 0 : stale_rounds_[joint] + 1;
      is_fresh_[joint] = false;
      soak.stale_joint_rounds += stale_rounds_[joint] > 0 ? 1 : 0;
      soak.longest_stale_rounds = std::max(soak.longest_stale_rounds, stale_rounds_[joint]);
      const EmulatedServo& servo = *head_.emulator.find(map_.joints[joint].id);
      const std::uint16_t place = servo.get(ax12::kPresentPosition);
      if (place != place_[joint]) {
        place_[joint] = place;
        ++soak.moving_joint_rounds;
        soak.last_moved_round[joint] = soak.rounds;
      }
      const std::uint16_t goal = servo.get(ax12::kGoalPosition);
      // The one before may still stand: noise swallowed the packet, and the next round's comes in 10 ms.
      const bool is_wrong = report_.joints[joint].health == ServoHealth::Working &&
                            goal != *units_of(map_.joints[joint], command_.goal_deg[joint]) &&
                            goal != *units_of(map_.joints[joint], before_.goal_deg[joint]);
      wrong_goal_rounds_[joint] = is_wrong ? wrong_goal_rounds_[joint] + 1 : 0;
      soak.wrong_goals += is_wrong ? 1 : 0;
      soak.longest_wrong_goal_rounds = std::max(soak.longest_wrong_goal_rounds, wrong_goal_rounds_[joint]);
    }
  }

  Head head_;
  ServoMap map_;
  HeadReport report_;
  ServoEventLog events_;
  PacketExchange exchange_;
  ServoCommand command_;
  ServoCommand before_;
  std::array<TimeNs, kJointCount> seen_ns_{};
  std::array<std::uint16_t, kJointCount> place_{};
  std::array<bool, kJointCount> is_fresh_{};
  std::array<std::uint64_t, kJointCount> stale_rounds_{};
  std::array<std::uint64_t, kJointCount> wrong_goal_rounds_{};
};

}  // namespace

TEST_CASE("soak: random packets at 1 % byte errors never hang the bus") {
  const auto wanted = static_cast<std::uint64_t>(setting("TECTUM_SOAK_PACKETS", 50'000));
  const auto start = std::chrono::steady_clock::now();
  Head head(1);
  Ax12Bus bus(head.link);
  for (std::uint8_t id = 1; id <= kServos; ++id) {
    bus.set_return_delay(id, 0);
  }
  std::mt19937_64 random(2);
  PacketSoak soak;
  while (soak.asked < wanted) {
    ask_at_random(bus, head, random, soak);
  }
  const BusStatistics& wire = bus.statistics();
  std::printf(
      "packets %llu: ok %llu, refused %llu, failed after 3 attempts %llu, retries %llu\n"
      "  damaged bytes %llu, bad checksums %llu, silences %llu, broken answers %llu, longest question %.1f ms\n"
      "  whole packets with a wrong position (what Protocol 1.0 itself lets through): %llu\n"
      "  took %.1f s\n",
      static_cast<unsigned long long>(soak.asked), static_cast<unsigned long long>(soak.ok),
      static_cast<unsigned long long>(soak.refused), static_cast<unsigned long long>(soak.failed),
      static_cast<unsigned long long>(wire.retries),
      static_cast<unsigned long long>(head.emulator.noise.damaged_bytes()),
      static_cast<unsigned long long>(wire.bad_checksums), static_cast<unsigned long long>(wire.time_outs),
      static_cast<unsigned long long>(wire.broken_off), static_cast<double>(soak.longest_ns) * 1e-6,
      static_cast<unsigned long long>(soak.wrong_values), seconds_since(start));
  // Three attempts of at most: a packet each way at 1 Mbps, 0.5 ms of thinking, the margin of 3 ms; and a late answer's
  // wait.
  CHECK(soak.longest_ns < 3 * 5 * kMs + 6 * kMs);
  CHECK(soak.ok > wanted / 2);
  CHECK(static_cast<double>(soak.failed) < 0.02 * static_cast<double>(wanted));
  CHECK(static_cast<double>(soak.wrong_values) <= 1 + 2e-5 * static_cast<double>(wanted));
}

TEST_CASE("soak: no wrong position is ever taken as right at 1 % byte errors") {
  const double hours = setting("TECTUM_SOAK_HOURS", 0.02);
  const auto start = std::chrono::steady_clock::now();
  HeadSoak head(3);
  head.run(static_cast<TimeNs>(hours * 3600) * kSecond);
  const HeadReport& report = head.report();
  const auto events = head.take_events();
  std::printf(
      "virtual time %.2f h: %llu rounds, %llu questions, %llu damaged bytes, %llu retries, %llu failures\n"
      "  positions taken %llu, thrown away %llu, wrong %llu (worst %d units)\n"
      "  joint-rounds without a new position %llu, at most %llu in succession\n"
      "  joint-rounds that ended with a goal that nobody sent %llu, at most %llu in succession\n"
      "  longest step %.1f ms, %zu events told, took %.1f s\n",
      hours, static_cast<unsigned long long>(report.rounds), static_cast<unsigned long long>(report.wire.requests),
      static_cast<unsigned long long>(head.damaged_bytes()), static_cast<unsigned long long>(report.wire.retries),
      static_cast<unsigned long long>(report.wire.failures), static_cast<unsigned long long>(report.positions),
      static_cast<unsigned long long>(report.unconfirmed), static_cast<unsigned long long>(head.soak.wrong_positions),
      head.soak.worst_units, static_cast<unsigned long long>(head.soak.stale_joint_rounds),
      static_cast<unsigned long long>(head.soak.longest_stale_rounds),
      static_cast<unsigned long long>(head.soak.wrong_goals),
      static_cast<unsigned long long>(head.soak.longest_wrong_goal_rounds),
      static_cast<double>(head.soak.longest_step_ns) * 1e-6, events.size(), seconds_since(start));
  std::printf("  joint-rounds in motion %llu; rounds since each joint last moved:",
              static_cast<unsigned long long>(head.soak.moving_joint_rounds));
  for (const std::uint64_t round : head.soak.last_moved_round) {
    std::printf(" %llu", static_cast<unsigned long long>(head.soak.rounds - round));
  }
  std::printf("\n");
  for (const std::uint64_t round : head.soak.last_moved_round) {
    CHECK(head.soak.rounds - round < 3000);  // half a minute: a revival takes two seconds
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(events.size(), 20); ++i) {
    std::printf("  %10.3f s  %s\n", static_cast<double>(events[i].at_ns) * 1e-9, events[i].text.c_str());
  }
  CHECK(head.soak.wrong_positions == 0);
  CHECK(report.positions > 0.95 * 6 * static_cast<double>(report.rounds));
  CHECK(head.soak.longest_step_ns < 200 * kMs);
  CHECK(head.soak.longest_stale_rounds < 20);  // the guard takes a joint for lost after half a second
}
