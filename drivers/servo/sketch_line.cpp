#include "drivers/servo/sketch_line.h"

#include <algorithm>

namespace tectum::sketch {
namespace {

constexpr std::uint32_t kHighestPosition = 1023;

}  // namespace

std::string encode_line(const JointUnits& units) {
  std::string line;
  for (const Joint joint : kFieldJoints) {
    const std::uint16_t in_gate = std::clamp(units[static_cast<std::size_t>(joint)], kLowestUnits, kHighestUnits);
    line += (line.empty() ? "" : ",") + std::to_string(in_gate);
  }
  return line + '\n';
}

void AnswerParser::clear() noexcept {
  count_ = 0;
  number_ = 0;
  is_in_number_ = false;
  is_line_empty_ = true;
  is_bad_ = false;
}

void AnswerParser::end_number() noexcept {
  if (!is_in_number_) {
    return;
  }
  is_in_number_ = false;
  if (number_ > kHighestPosition || count_ == kFields) {
    is_bad_ = true;
  } else {
    numbers_[count_++] = static_cast<std::uint16_t>(number_);
  }
  number_ = 0;
}

std::optional<JointUnits> AnswerParser::end_line() noexcept {
  end_number();
  const bool was_empty = is_line_empty_;
  is_line_empty_ = true;
  if (!was_empty || (count_ == 0 && !is_bad_)) {
    return std::nullopt;
  }
  std::optional<JointUnits> answer;
  if (count_ == kFields && !is_bad_) {
    answer.emplace();
    for (std::size_t field = 0; field < kFields; ++field) {
      (*answer)[static_cast<std::size_t>(kFieldJoints[field])] = numbers_[field];
    }
  } else {
    ++bad_answers_;
  }
  clear();
  return answer;
}

std::optional<JointUnits> AnswerParser::push(std::span<const std::uint8_t> bytes) noexcept {
  std::optional<JointUnits> newest;
  for (const std::uint8_t byte : bytes) {
    if (byte == '\n') {
      if (auto answer = end_line()) {
        newest = answer;
      }
    } else if (byte >= '0' && byte <= '9') {
      is_line_empty_ = false;
      is_in_number_ = true;
      number_ = std::min<std::uint32_t>(number_ * 10 + (byte - '0'), 100'000);
    } else if (byte == ',' || byte == ' ' || byte == '\t') {
      is_line_empty_ = false;
      end_number();
    } else if (byte != '\r') {
      is_line_empty_ = false;
      is_bad_ = true;
    }
  }
  return newest;
}

}  // namespace tectum::sketch
