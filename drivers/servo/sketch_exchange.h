// The 2020 head through its own ArbotiX program (sketch_line.h).
//
// It measures only in answer to a line, and has no line for torque. So the first line sends the head home, which shows
// where it is, and torque stays on until its power is cut. It turns the neck by one unit a millisecond before it lets
// the eyes move: a line moves the neck by no more than max_neck_step_units, so that the eyes are never held up for
// longer.
#pragma once

#include "drivers/servo/byte_link.h"
#include "drivers/servo/servo_exchange.h"
#include "drivers/servo/servo_map.h"
#include "drivers/servo/servo_report.h"
#include "drivers/servo/sketch_line.h"

namespace tectum {

struct SketchExchangeOptions {
  int max_neck_step_units = 10;
  TimeNs answer_timeout_ns = 250'000'000;  // two lines, the neck's steps, delay(5), with room
  TimeNs lost_after_ns = 1'000'000'000;
  /// The first line walks the neck home from wherever it stands: at most 180 units a ms each, tilt after pan.
  TimeNs first_answer_timeout_ns = 3'000'000'000;
};

class SketchExchange final : public ServoExchange {
 public:
  /// Everything outlives it.
  SketchExchange(ByteLink& link, const ServoMap& map, const SketchExchangeOptions& options, HeadReport& report,
                 ServoEventLog& events);

  [[nodiscard]] ExchangeStatus begin() override;
  [[nodiscard]] ExchangeStatus send(const ServoCommand& command) override;
  [[nodiscard]] ExchangeStatus poll() override;
  void release() override;

 private:
  [[nodiscard]] ExchangeStatus exchange_line(const sketch::JointUnits& units, TimeNs timeout_ns);
  [[nodiscard]] sketch::JointUnits next_units() const noexcept;
  void take(const sketch::JointUnits& units);

  ByteLink& link_;
  ServoMap map_;
  SketchExchangeOptions options_;
  HeadReport& report_;
  ServoEventLog& events_;
  sketch::AnswerParser parser_;
  sketch::JointUnits goal_units_{};
  sketch::JointUnits sent_units_{};
  sketch::JointUnits read_units_{};  // of the last answer, believed or not
  TimeNs read_ns_ = 0;               // 0 = none yet
  TimeNs answered_ns_ = 0;
  bool is_lost_ = false;
  bool is_told_of_torque_ = false;
};

}  // namespace tectum
