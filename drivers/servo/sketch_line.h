// The lines of the 2020 head's own ArbotiX program: 57600 baud, ASCII.
//
//   to the head    neck_pan,neck_tilt,left_pan,left_tilt,right_pan,right_tilt\n     units of 300/1023 deg
//   back           the six positions it has reached, then an empty line
//
// The program compares 340 < position < 700. A neck goal outside makes it wait for ever for a place that it does not go
// to, and only its reset button helps. So no line that could hold one can be made here.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "runtime/image/spike_image.h"

namespace tectum::sketch {

inline constexpr std::uint32_t kBaud = 57600;
inline constexpr std::uint16_t kLowestUnits = 341;
inline constexpr std::uint16_t kHighestUnits = 699;
inline constexpr std::size_t kFields = 6;

/// The line's order. IDs are 1 to 6 in the same order.
inline constexpr std::array<Joint, kFields> kFieldJoints = {
    Joint::NeckPan, Joint::NeckTilt, Joint::LeftEyePan, Joint::LeftEyeTilt, Joint::RightEyePan, Joint::RightEyeTilt};

/// In the order of tectum::Joint.
using JointUnits = std::array<std::uint16_t, kJointCount>;

/// Units outside the gate are cut to it.
[[nodiscard]] std::string encode_line(const JointUnits& units);

/// Collects bytes until an empty line ends an answer.
class AnswerParser {
 public:
  /// The answer, if these bytes complete one that holds six positions between 0 and 1023.
  [[nodiscard]] std::optional<JointUnits> push(std::span<const std::uint8_t> bytes) noexcept;
  void clear() noexcept;
  [[nodiscard]] std::uint64_t bad_answers() const noexcept { return bad_answers_; }

 private:
  [[nodiscard]] std::optional<JointUnits> end_line() noexcept;
  void end_number() noexcept;

  std::array<std::uint16_t, kFields> numbers_{};
  std::size_t count_ = 0;
  std::uint32_t number_ = 0;
  bool is_in_number_ = false;
  bool is_line_empty_ = true;
  bool is_bad_ = false;
  std::uint64_t bad_answers_ = 0;
};

}  // namespace tectum::sketch
