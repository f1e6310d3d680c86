#include "drivers/servo/ax12_bus.h"

#include <algorithm>

namespace tectum {
namespace {

using namespace dynamixel;

constexpr std::uint8_t kFactoryDelay = 250;  // of register 5, until the servo has said otherwise
// The servo's own thinking (24 us + 6 us a byte written) and its 130 us interrupts, a few of which may fall together.
constexpr TimeNs kThinkingNs = 500'000;
constexpr TimeNs kEepromByteNs = 6'000'000;  // Xevel: writing one byte blocks for about this long
// The ArbotiX asks the servo itself before it answers: a second packet each way at 1 Mbps, and its own time-out.
constexpr TimeNs kArbotixNs = 10'000'000;
// A damaged length makes a servo swallow up to 255 bytes more. FE ends that and starts nothing: only FF FF is a header,
// which one damaged byte among FFs would make. And hardly a register takes FE, should a packet happen to end in them
// unharmed.
constexpr std::uint8_t kPaddingByte = 0xFE;
constexpr TimeNs kPatientMarginNs = 20'000'000;
constexpr std::size_t kPadding = 255;
constexpr std::size_t kArbotixMaxRead = 26;  // its buffer of 32 bytes, without the frame

}  // namespace

const char* describe(BusStatus status) noexcept {
  switch (status) {
    case BusStatus::Ok:
      return "ok";
    case BusStatus::NoAnswer:
      return "no answer";
    case BusStatus::Damaged:
      return "every answer came damaged";
    case BusStatus::Refused:
      return "refused";
    case BusStatus::Unsupported:
      return "the adapter does not pass this";
    case BusStatus::LinkGone:
      return "the port is gone";
  }
  return "";
}

Ax12Bus::Ax12Bus(ByteLink& link, const BusOptions& options) noexcept : link_(link), options_(options) {
  return_level_.fill(2);
  return_delay_ns_.fill(static_cast<TimeNs>(kFactoryDelay * ax12::kReturnDelayUnitNs));
}

TimeNs Ax12Bus::wire_ns(std::size_t bytes) const noexcept {
  return static_cast<TimeNs>(bytes) * 10 * 1'000'000'000 / options_.baud;
}

void Ax12Bus::collect_parser_counts() noexcept {
  const ParserCounters& now = parser_.counters();
  statistics_.bad_checksums += now.bad_checksums - counted_.bad_checksums;
  statistics_.skipped_bytes += now.skipped_bytes - counted_.skipped_bytes;
  counted_ = now;
}

void Ax12Bus::let_late_answers_pass(const Question& question) noexcept {
  const bool could_be_mistaken =
      question.id == last_id_ && question.answer_count == last_count_ && question.address != last_address_;
  if (may_answer_late_ && could_be_mistaken) {
    link_.sleep_until(link_.now_ns() + 2 * options_.answer_margin_ns);
  }
  if (!could_be_mistaken) {
    may_answer_late_ = false;
  }
  last_id_ = question.id;
  last_address_ = question.address;
  last_count_ = question.answer_count;
}

Ax12Bus::Outcome Ax12Bus::listen(const Question& question, Packet& answer) noexcept {
  const TimeNs adapter_ns = options_.adapter == BusAdapter::ArbotixRos ? kArbotixNs : 0;
  const TimeNs latest_ns = sent_ns_ + wire_ns(std::size_t{question.answer_count} + kPacketOverhead) +
                           return_delay_ns_[question.id] + kThinkingNs + question.extra_ns + adapter_ns +
                           options_.answer_margin_ns;
  TimeNs deadline_ns = latest_ns;
  bool has_begun = false;
  for (;;) {
    std::array<std::uint8_t, 256> bytes;
    std::size_t count = 0;
    switch (link_.read(bytes, count, deadline_ns)) {
      case LinkRead::Gone:
        return Outcome::LinkGone;
      case LinkRead::TimedOut:
        ++(has_begun ? statistics_.broken_off : statistics_.time_outs);
        may_answer_late_ = may_answer_late_ || !has_begun;
        return has_begun ? Outcome::Damaged : Outcome::Silence;
      case LinkRead::Bytes:
        break;
    }
    has_begun = true;
    deadline_ns = std::min(latest_ns, link_.now_ns() + options_.gap_ns);
    parser_.push(std::span(bytes).first(count));
    bool is_damaged = false;
    for (ParseResult result = parser_.next(answer); result != ParseResult::NeedMore; result = parser_.next(answer)) {
      if (result == ParseResult::Whole) {
        return Outcome::Whole;
      }
      is_damaged = true;
    }
    if (is_damaged && parser_.pending_bytes() == 0) {
      return Outcome::Damaged;
    }
  }
}

BusAnswer Ax12Bus::ask(const Question& question, int attempts, std::span<std::uint8_t> out) noexcept {
  ++statistics_.requests;
  let_late_answers_pass(question);
  BusAnswer result;
  bool was_silent = false;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    // On a slow line that takes longer than a time-out, and is kept for the last attempt.
    const bool is_worth_it = attempt == attempts - 1 || wire_ns(kPadding) <= options_.answer_margin_ns;
    if (was_silent && is_worth_it && has_answered_[question.id]) {
      wake_servos(question.id);
    }
    // Only now: a servo that still waits for bytes would swallow what is sent next.
    if (attempt > 0 && options_.gives_way && options_.gives_way()) {
      ++statistics_.given_way;
      return result;
    }
    statistics_.retries += attempt > 0 ? 1 : 0;
    link_.discard_input();
    parser_.clear();
    parser_.expect(question.id, question.answer_count);
    if (!write_to_link(question.frame)) {
      return {BusStatus::LinkGone, 0};
    }
    Packet answer;
    const Outcome outcome = listen(question, answer);
    was_silent = outcome == Outcome::Silence;
    collect_parser_counts();
    if (outcome == Outcome::LinkGone) {
      return {BusStatus::LinkGone, 0};
    }
    if (outcome != Outcome::Whole) {
      if (outcome == Outcome::Damaged) {
        result.status = BusStatus::Damaged;
      }
      continue;
    }
    has_answered_[question.id] = true;
    result.error_bits = answer.code;
    if ((answer.code & (kChecksumError | kInstructionError)) != 0) {
      ++statistics_.reported_checksums;  // only a damaged packet makes either of them
      result.status = BusStatus::Refused;
      continue;
    }
    const bool has_all = answer.parameter_count == question.answer_count;
    if (!has_all || (answer.code & (kRangeError | kAngleError)) != 0) {
      result.status = BusStatus::Refused;
      if (!has_all && answer.code == 0) {
        result.status = BusStatus::Damaged;  // the late answer to a write
        continue;
      }
      return result;
    }
    std::copy_n(answer.parameters.begin(), std::min<std::size_t>(out.size(), answer.parameter_count), out.begin());
    result.status = BusStatus::Ok;
    return result;
  }
  ++statistics_.failures;
  has_answered_[question.id] = has_answered_[question.id] && result.status != BusStatus::NoAnswer;
  return result;
}

void Ax12Bus::wake_servos(std::uint8_t id) noexcept {
  std::array<std::uint8_t, kPadding> padding;
  padding.fill(kPaddingByte);
  sent_ns_ = std::max(sent_ns_, link_.now_ns()) + wire_ns(padding.size());
  if (link_.write(padding)) {
    // It may now answer that what it collected was damaged.
    link_.sleep_until(sent_ns_ + return_delay_ns_[id] + kThinkingNs + wire_ns(kPacketOverhead));
  }
}

bool Ax12Bus::write_to_link(const PacketBytes& frame) noexcept {
  // The kernel takes the bytes at once; the line is busy with them, and with those before them, for longer.
  sent_ns_ = std::max(sent_ns_, link_.now_ns()) + wire_ns(frame.size);
  return link_.write(frame.bytes());
}

BusAnswer Ax12Bus::send_only(const PacketBytes& frame) noexcept {
  ++statistics_.broadcasts;
  return {write_to_link(frame) ? BusStatus::Ok : BusStatus::LinkGone, 0};
}

BusAnswer Ax12Bus::ping(std::uint8_t id) noexcept {
  if (options_.adapter == BusAdapter::ArbotixRos) {  // which does not pass pings on
    std::uint16_t answered_id = 0;
    return read(id, ax12::kId, answered_id);
  }
  const PacketBytes frame = encode_ping(id);
  return ask({frame, id, 0, 0}, options_.attempts, {});
}

BusAnswer Ax12Bus::read(std::uint8_t id, std::uint8_t address, std::span<std::uint8_t> out) noexcept {
  if (options_.adapter == BusAdapter::ArbotixRos && out.size() > kArbotixMaxRead) {
    return {BusStatus::Unsupported, 0};
  }
  const auto count = static_cast<std::uint8_t>(out.size());
  const PacketBytes frame = encode_read(id, address, count);
  return ask({frame, id, address, count}, options_.attempts, out);
}

BusAnswer Ax12Bus::read(std::uint8_t id, const ax12::Register& row, std::uint16_t& value) noexcept {
  std::array<std::uint8_t, 2> bytes{};
  const BusAnswer answer = read(id, row.address, std::span(bytes).first(row.size));
  if (answer.is_ok()) {
    value = word(bytes[0], bytes[1]);
  }
  return answer;
}

BusAnswer Ax12Bus::write_frame(const PacketBytes& frame, std::uint8_t id, std::uint8_t address,
                               std::size_t size) noexcept {
  if (id == kBroadcastId) {
    return send_only(frame);
  }
  if (return_level_[id] < 2 && options_.adapter == BusAdapter::Transparent) {
    return send_only(frame);
  }
  const TimeNs eeprom_ns = address < ax12::kFirstRamAddress ? kEepromByteNs * static_cast<TimeNs>(size) : 0;
  return ask({frame, id, address, 0, eeprom_ns}, options_.attempts, {});
}

BusAnswer Ax12Bus::write(std::uint8_t id, std::uint8_t address, std::span<const std::uint8_t> data) noexcept {
  if (options_.adapter == BusAdapter::ArbotixRos && data.size() > 2) {
    return write_in_words(id, address, data);
  }
  return write_frame(encode_write(id, address, data), id, address, data.size());
}

// The ArbotiX passes one register a write and drops the rest.
BusAnswer Ax12Bus::write_in_words(std::uint8_t id, std::uint8_t address, std::span<const std::uint8_t> data) noexcept {
  BusAnswer answer{BusStatus::Unsupported, 0};
  std::size_t at = 0;
  while (at < data.size()) {
    const auto here = static_cast<std::uint8_t>(address + at);
    const ax12::Register* row = ax12::register_at(here);
    const std::size_t size = row == nullptr ? 1 : row->size;
    if (at + size > data.size()) {
      return {BusStatus::Unsupported, 0};
    }
    answer = write_frame(encode_write(id, here, data.subspan(at, size)), id, here, size);
    if (!answer.is_ok()) {
      return answer;
    }
    at += size;
  }
  return answer;
}

BusAnswer Ax12Bus::write(std::uint8_t id, const ax12::Register& row, std::uint16_t value) noexcept {
  const auto bytes = bytes_of(value);
  return write(id, row.address, std::span(bytes).first(row.size));
}

BusAnswer Ax12Bus::reg_write(std::uint8_t id, std::uint8_t address, std::span<const std::uint8_t> data) noexcept {
  if (options_.adapter == BusAdapter::ArbotixRos) {
    return {BusStatus::Unsupported, 0};
  }
  return write_frame(encode_reg_write(id, address, data), id, address, 0);
}

BusAnswer Ax12Bus::factory_reset(std::uint8_t id) noexcept {
  if (options_.adapter == BusAdapter::ArbotixRos) {
    return {BusStatus::Unsupported, 0};
  }
  // Once only: after the first, the servo answers to ID 1.
  const PacketBytes frame = encode_factory_reset(id);
  return ask({frame, id, 0, 0, kEepromByteNs * ax12::kFirstRamAddress}, 1, {});
}

BusAnswer Ax12Bus::action() noexcept {
  if (options_.adapter == BusAdapter::ArbotixRos) {
    return {BusStatus::Unsupported, 0};
  }
  return send_only(encode_action());
}

BusAnswer Ax12Bus::sync_write(std::uint8_t address, std::uint8_t size_each, std::span<const std::uint8_t> ids,
                              std::span<const std::uint8_t> data) noexcept {
  return send_only(encode_sync_write(address, size_each, ids, data));
}

BusAnswer Ax12Bus::sync_read(std::uint8_t address, std::uint8_t size_each, std::span<const std::uint8_t> ids,
                             std::span<std::uint8_t> out) noexcept {
  if (options_.adapter != BusAdapter::ArbotixRos || size_each > kArbotixMaxRead) {
    return {BusStatus::Unsupported, 0};
  }
  const PacketBytes frame = encode_sync_read(address, size_each, ids);
  const auto count = static_cast<std::uint8_t>(size_each * ids.size());
  // A servo that is away costs the board its own time-out.
  const TimeNs extra_ns = kArbotixNs * static_cast<TimeNs>(ids.size());
  return ask({frame, kBroadcastId, address, count, extra_ns}, options_.attempts, out);
}

std::vector<std::uint8_t> Ax12Bus::scan(std::uint8_t first, std::uint8_t last,
                                        const std::function<void(std::uint8_t)>& progress) {
  std::vector<std::uint8_t> found;
  bool is_slow = false;  // some answers came so late that others may have come too late
  const auto look_for = [&](int id) {
    const auto asked = static_cast<std::uint8_t>(id);
    if (progress) {
      progress(asked);
    }
    const TimeNs before_ns = link_.now_ns();
    const std::uint64_t retries = statistics_.retries;
    BusStatus status = ping(asked).status;
    if (status == BusStatus::Damaged) {
      // Two colliding servos of one ID, or what a servo asked before says late: that passes.
      link_.sleep_until(link_.now_ns() + kPatientMarginNs);
      status = ping(asked).status;
      is_slow = true;
    }
    if (status == BusStatus::Ok || status == BusStatus::Damaged || status == BusStatus::Refused) {
      found.push_back(asked);
      is_slow = is_slow || statistics_.retries > retries ||
                link_.now_ns() - before_ns > wire_ns(2 * kPacketOverhead) + options_.answer_margin_ns / 2;
    }
    return status != BusStatus::LinkGone;
  };
  const int end = std::min(last, kHighestId) + 1;
  for (int id = first; id < end; ++id) {
    if (!look_for(id)) {
      return found;
    }
  }
  if (is_slow || found.empty()) {
    const BusOptions usual = options_;
    options_.answer_margin_ns = kPatientMarginNs;
    options_.attempts = 1;
    const std::vector<std::uint8_t> quick = found;
    for (int id = first; id < end; ++id) {
      if (!std::binary_search(quick.begin(), quick.end(), id) && !look_for(id)) {
        break;
      }
    }
    options_ = usual;
    std::sort(found.begin(), found.end());
  }
  return found;
}

}  // namespace tectum
