#include "drivers/servo/packet.h"

#include <algorithm>

namespace tectum::dynamixel {
namespace {

// Parameters of a frame under construction.
class Parameters {
 public:
  void add(std::uint8_t byte) noexcept {
    if (size_ < bytes_.size()) {
      bytes_[size_++] = byte;
    }
  }
  void add(std::span<const std::uint8_t> bytes) noexcept {
    for (const std::uint8_t byte : bytes) {
      add(byte);
    }
  }
  [[nodiscard]] std::span<const std::uint8_t> all() const noexcept { return std::span(bytes_).first(size_); }

 private:
  std::array<std::uint8_t, kMaxParameters> bytes_{};
  std::size_t size_ = 0;
};

PacketBytes encode_instruction(std::uint8_t id, Instruction instruction, const Parameters& parameters) noexcept {
  return encode(id, static_cast<std::uint8_t>(instruction), parameters.all());
}

PacketBytes encode_addressed(std::uint8_t id, Instruction instruction, std::uint8_t address,
                             std::span<const std::uint8_t> data) noexcept {
  Parameters parameters;
  parameters.add(address);
  parameters.add(data);
  return encode_instruction(id, instruction, parameters);
}

}  // namespace

std::uint8_t checksum(std::span<const std::uint8_t> id_to_last_parameter) noexcept {
  unsigned sum = 0;
  for (const std::uint8_t byte : id_to_last_parameter) {
    sum += byte;
  }
  return static_cast<std::uint8_t>(~sum & 0xFFU);
}

bool has_fitting_length(const Packet& instruction) noexcept {
  const std::size_t count = instruction.parameter_count;
  switch (static_cast<Instruction>(instruction.code)) {
    case Instruction::Ping:
    case Instruction::Action:
    case Instruction::FactoryReset:
      return count == 0;
    case Instruction::Read:
      return count == 2;
    case Instruction::Write:
    case Instruction::RegWrite:
      return count >= 2;
    case Instruction::SyncWrite:
    case Instruction::SyncRead:
      return count >= 3;
    case Instruction::BulkRead:
      return count >= 4 && count % 3 == 1;
  }
  return true;
}

PacketBytes encode(std::uint8_t id, std::uint8_t code, std::span<const std::uint8_t> parameters) noexcept {
  const std::size_t count = std::min(parameters.size(), kMaxParameters);
  PacketBytes frame;
  frame.data[0] = kHeader;
  frame.data[1] = kHeader;
  frame.data[kIdAt] = id;
  frame.data[kLengthAt] = static_cast<std::uint8_t>(count + kLengthOverhead);
  frame.data[kCodeAt] = code;
  std::copy_n(parameters.begin(), count, frame.data.begin() + kCodeAt + 1);
  frame.size = count + kPacketOverhead;
  frame.data[frame.size - 1] = checksum(std::span(frame.data).subspan(kIdAt, frame.size - kIdAt - 1));
  return frame;
}

PacketBytes encode_ping(std::uint8_t id) noexcept { return encode_instruction(id, Instruction::Ping, Parameters{}); }

PacketBytes encode_read(std::uint8_t id, std::uint8_t address, std::uint8_t count) noexcept {
  return encode_addressed(id, Instruction::Read, address, std::array{count});
}

PacketBytes encode_write(std::uint8_t id, std::uint8_t address, std::span<const std::uint8_t> data) noexcept {
  return encode_addressed(id, Instruction::Write, address, data);
}

PacketBytes encode_reg_write(std::uint8_t id, std::uint8_t address, std::span<const std::uint8_t> data) noexcept {
  return encode_addressed(id, Instruction::RegWrite, address, data);
}

PacketBytes encode_action() noexcept { return encode_instruction(kBroadcastId, Instruction::Action, Parameters{}); }

PacketBytes encode_factory_reset(std::uint8_t id) noexcept {
  return encode_instruction(id, Instruction::FactoryReset, Parameters{});
}

PacketBytes encode_sync_write(std::uint8_t address, std::uint8_t size_each, std::span<const std::uint8_t> ids,
                              std::span<const std::uint8_t> data) noexcept {
  Parameters parameters;
  parameters.add(address);
  parameters.add(size_each);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    parameters.add(ids[i]);
    parameters.add(data.subspan(i * size_each, size_each));
  }
  return encode_instruction(kBroadcastId, Instruction::SyncWrite, parameters);
}

PacketBytes encode_sync_read(std::uint8_t address, std::uint8_t size_each, std::span<const std::uint8_t> ids) noexcept {
  Parameters parameters;
  parameters.add(address);
  parameters.add(size_each);
  parameters.add(ids);
  return encode_instruction(kBroadcastId, Instruction::SyncRead, parameters);
}

PacketBytes encode_bulk_read(std::span<const BulkReadItem> items) noexcept {
  Parameters parameters;
  parameters.add(std::uint8_t{0});
  for (const BulkReadItem& item : items) {
    parameters.add(item.count);
    parameters.add(item.id);
    parameters.add(item.address);
  }
  return encode_instruction(kBroadcastId, Instruction::BulkRead, parameters);
}

PacketBytes encode_status(std::uint8_t id, std::uint8_t error_bits, std::span<const std::uint8_t> parameters) noexcept {
  return encode(id, error_bits, parameters);
}

}  // namespace tectum::dynamixel
