#include "drivers/servo/emulated_arbotix.h"

#include <algorithm>

namespace tectum {
namespace {

using namespace dynamixel;

constexpr std::uint32_t kBusBaud = 1'000'000;
constexpr TimeNs kBusTimeoutNs = 3'000'000;
constexpr std::size_t kReadBuffer = 26;  // data bytes of a servo's answer that fit

TimeNs bytes_ns(std::size_t count, std::uint32_t baud) {
  return static_cast<TimeNs>(count) * 10 * 1'000'000'000 / baud;
}

}  // namespace

EmulatedArbotix::EmulatedArbotix(Ax12Emulator& bus) : bus_(bus) { bus_.set_line_baud(kBusBaud); }

void EmulatedArbotix::receive(TimeNs now_ns, std::span<const std::uint8_t> bytes) {
  host_end_ns_ = std::max(host_end_ns_, now_ns);
  if (host_baud_ != kHostBaud) {
    return;
  }
  for (const std::uint8_t byte : bytes) {
    host_end_ns_ += bytes_ns(1, kHostBaud);
    parser_.push(std::span(&byte, 1));
    Packet packet;
    for (ParseResult result = parser_.next(packet); result != ParseResult::NeedMore; result = parser_.next(packet)) {
      busy_until_ns_ = std::max(busy_until_ns_, host_end_ns_);
      if (result == ParseResult::Whole) {
        act(packet);
      } else {
        reply(encode_status(packet.id, kChecksumError, {}).bytes());
      }
    }
  }
}

void EmulatedArbotix::act(const Packet& packet) {
  if (!has_fitting_length(packet)) {
    return;
  }
  const auto instruction = static_cast<Instruction>(packet.code);
  if (packet.id == kBoardId) {
    answer_for_board(packet);
  } else if (packet.id == kBroadcastId && instruction == Instruction::SyncRead) {
    read_from_all(packet);
  } else if (packet.id == kBroadcastId) {
    const PacketBytes raw = encode(packet.id, packet.code, packet.payload());
    std::vector<std::uint8_t> leaked(raw.bytes().begin(), raw.bytes().end());
    leaked.push_back(0);
    send_on_bus(leaked);
  } else if (instruction == Instruction::Read) {
    const auto answer = ask_bus(encode(packet.id, packet.code, packet.payload()));
    reply(answer);
  } else if (instruction == Instruction::Write) {
    pass_write(packet);
  }
}

void EmulatedArbotix::answer_for_board(const Packet& packet) {
  if (static_cast<Instruction>(packet.code) == Instruction::Write) {
    reply(encode_status(kBoardId, 0, {}).bytes());
  } else if (static_cast<Instruction>(packet.code) == Instruction::Read) {
    std::vector<std::uint8_t> data(packet.parameters[1], 0);
    const auto model = bytes_of(kBoardModel);
    for (std::size_t i = 0; i < data.size(); ++i) {
      const std::size_t address = packet.parameters[0] + i;
      data[i] = address < 2 ? model[address] : address == 3 ? kBoardId : std::uint8_t{0};
    }
    reply(encode_status(kBoardId, 0, data).bytes());
  }
}

void EmulatedArbotix::read_from_all(const Packet& packet) {
  const std::uint8_t address = packet.parameters[0];
  const std::uint8_t size_each = packet.parameters[1];
  std::vector<std::uint8_t> data;
  for (const std::uint8_t id : packet.payload().subspan(2)) {
    const auto answer = ask_bus(encode_read(id, address, size_each));
    if (answer.size() == kPacketOverhead + size_each) {
      data.insert(data.end(), answer.begin() + kCodeAt + 1, answer.end() - 1);
    } else {
      data.insert(data.end(), size_each, 0xFF);
    }
  }
  reply(encode_status(kBroadcastId, 0, data).bytes());
}

void EmulatedArbotix::pass_write(const Packet& packet) {
  const std::size_t size = packet.parameter_count == 2 ? 1 : 2;
  std::vector<std::uint8_t> data(packet.parameters.begin() + 1,
                                 packet.parameters.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  // The board does not listen to what the servo says to it.
  (void)ask_bus(encode_write(packet.id, packet.parameters[0], data));
  reply(encode_status(packet.id, 0, {}).bytes());
}

void EmulatedArbotix::send_on_bus(std::span<const std::uint8_t> bytes) {
  bus_.receive(busy_until_ns_, bytes);
  busy_until_ns_ += bytes_ns(bytes.size(), kBusBaud);
}

std::vector<std::uint8_t> EmulatedArbotix::ask_bus(const PacketBytes& question) {
  std::array<std::uint8_t, 512> heard;
  send_on_bus(question.bytes());
  const TimeNs deadline_ns = busy_until_ns_ + kBusTimeoutNs;
  std::vector<std::uint8_t> answer;
  while (bus_.next_ns() <= deadline_ns) {
    busy_until_ns_ = std::max(busy_until_ns_, bus_.next_ns());
    const std::size_t count = bus_.transmit(busy_until_ns_, heard);
    answer.insert(answer.end(), heard.begin(), heard.begin() + static_cast<std::ptrdiff_t>(count));
  }
  if (answer.empty()) {
    busy_until_ns_ = deadline_ns;
  }
  if (answer.size() > kReadBuffer + kPacketOverhead) {
    answer.clear();
  }
  return answer;
}

void EmulatedArbotix::reply(std::span<const std::uint8_t> bytes) {
  reply_end_ns_ = std::max(reply_end_ns_, busy_until_ns_);
  for (const std::uint8_t byte : bytes) {
    reply_end_ns_ += bytes_ns(1, kHostBaud);
    outgoing_.push_back({reply_end_ns_, byte});
  }
}

TimeNs EmulatedArbotix::next_ns() const { return outgoing_.empty() ? kNever : outgoing_.front().end_ns; }

std::size_t EmulatedArbotix::transmit(TimeNs now_ns, std::span<std::uint8_t> out) {
  std::size_t count = 0;
  while (count < out.size() && !outgoing_.empty() && outgoing_.front().end_ns <= now_ns) {
    out[count++] = outgoing_.front().value;
    outgoing_.pop_front();
  }
  return count;
}

}  // namespace tectum
