// Dynamixel Protocol 1.0 as bytes (ROBOTIS e-manual, "Protocol 1.0").
//
//   instruction   FF FF ID LEN INST P1 .. PN CHK      LEN = N + 2
//   status        FF FF ID LEN ERR  P1 .. PN CHK      CHK = ~(ID + LEN + INST or ERR + P1 + .. + PN) & FF
//
// Two-byte values are little-endian. A sum of 8 bits does not notice two errors that cancel each other, so whoever
// reads a value over a noisy wire has to ask twice: see drivers/servo/packet_exchange.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tectum::dynamixel {

inline constexpr std::uint8_t kHeader = 0xFF;  // twice
inline constexpr std::size_t kIdAt = 2;
inline constexpr std::size_t kLengthAt = 3;
inline constexpr std::size_t kCodeAt = 4;           // instruction, or error bits
inline constexpr std::size_t kPacketOverhead = 6;   // header, ID, LEN, code, checksum
inline constexpr std::size_t kLengthOverhead = 2;   // LEN counts the code and the checksum
inline constexpr std::size_t kMaxParameters = 253;  // LEN is one byte
inline constexpr std::size_t kMaxPacket = kMaxParameters + kPacketOverhead;
inline constexpr std::uint8_t kHighestId = 0xFD;
inline constexpr std::uint8_t kBroadcastId = 0xFE;  // everybody acts, nobody answers

enum class Instruction : std::uint8_t {
  Ping = 0x01,
  Read = 0x02,
  Write = 0x03,
  RegWrite = 0x04,  // write, but only at the next Action
  Action = 0x05,
  FactoryReset = 0x06,
  SyncWrite = 0x83,
  SyncRead = 0x84,  // not of ROBOTIS: the ArbotiX `ros` firmware's
  BulkRead = 0x92,  // MX and X series; an AX-12A does not know it
};

/// Bits of a status packet's ERR byte.
enum ErrorBit : std::uint8_t {
  kVoltageError = 1U << 0,      // supply outside registers 12 and 13
  kAngleError = 1U << 1,        // goal outside registers 6 and 8
  kHeatError = 1U << 2,         // hotter than register 11
  kRangeError = 1U << 3,        // parameter out of range
  kChecksumError = 1U << 4,     // of the instruction packet
  kOverloadError = 1U << 5,     // the load cannot be held with the set torque
  kInstructionError = 1U << 6,  // unknown instruction, or Action without RegWrite
};
inline constexpr std::array<const char*, 7> kErrorBitNames = {"voltage",  "angle limit", "overheating", "range",
                                                              "checksum", "overload",    "instruction"};

struct Packet {
  std::uint8_t id = 0;
  std::uint8_t code = 0;  // Instruction, or error bits
  std::uint8_t parameter_count = 0;
  std::array<std::uint8_t, kMaxParameters> parameters{};

  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return std::span(parameters).first(parameter_count);
  }
};

/// Whether the instruction can have as many parameters as the packet has; true for an unknown one.
[[nodiscard]] bool has_fitting_length(const Packet& instruction) noexcept;

/// A packet's bytes, ready for the wire.
struct PacketBytes {
  std::array<std::uint8_t, kMaxPacket> data;
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> bytes() const noexcept { return std::span(data).first(size); }
};

/// Of everything between header and checksum.
[[nodiscard]] std::uint8_t checksum(std::span<const std::uint8_t> id_to_last_parameter) noexcept;

/// At most kMaxParameters parameters; more are cut off, which no caller here does.
[[nodiscard]] PacketBytes encode(std::uint8_t id, std::uint8_t code, std::span<const std::uint8_t> parameters) noexcept;

[[nodiscard]] PacketBytes encode_ping(std::uint8_t id) noexcept;
[[nodiscard]] PacketBytes encode_read(std::uint8_t id, std::uint8_t address, std::uint8_t count) noexcept;
[[nodiscard]] PacketBytes encode_write(std::uint8_t id, std::uint8_t address,
                                       std::span<const std::uint8_t> data) noexcept;
[[nodiscard]] PacketBytes encode_reg_write(std::uint8_t id, std::uint8_t address,
                                           std::span<const std::uint8_t> data) noexcept;
[[nodiscard]] PacketBytes encode_action() noexcept;
[[nodiscard]] PacketBytes encode_factory_reset(std::uint8_t id) noexcept;
/// `data` holds `size_each` bytes for each ID, in the same order.
[[nodiscard]] PacketBytes encode_sync_write(std::uint8_t address, std::uint8_t size_each,
                                            std::span<const std::uint8_t> ids,
                                            std::span<const std::uint8_t> data) noexcept;
[[nodiscard]] PacketBytes encode_sync_read(std::uint8_t address, std::uint8_t size_each,
                                           std::span<const std::uint8_t> ids) noexcept;
struct BulkReadItem {
  std::uint8_t id, address, count;
};
[[nodiscard]] PacketBytes encode_bulk_read(std::span<const BulkReadItem> items) noexcept;
[[nodiscard]] PacketBytes encode_status(std::uint8_t id, std::uint8_t error_bits,
                                        std::span<const std::uint8_t> parameters) noexcept;

[[nodiscard]] constexpr std::uint16_t word(std::uint8_t low, std::uint8_t high) noexcept {
  return static_cast<std::uint16_t>(low | (high << 8));
}
[[nodiscard]] constexpr std::array<std::uint8_t, 2> bytes_of(std::uint16_t value) noexcept {
  return {static_cast<std::uint8_t>(value & 0xFF), static_cast<std::uint8_t>(value >> 8)};
}

}  // namespace tectum::dynamixel
