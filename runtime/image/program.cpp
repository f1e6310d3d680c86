#include "runtime/image/program.h"

#include <array>
#include <cstddef>
#include <cstring>
#include <utility>
#include <vector>

namespace tectum {
namespace {

struct OpInfo {
  const char* name;
  std::uint32_t operands;
};

constexpr std::array<OpInfo, kProgramOpCount + 1> kOps = {{
    {"unknown", 0},   {"copy", 1},       {"negate", 1},       {"not", 1},   {"add", 2},    {"subtract", 2},
    {"multiply", 2},  {"divide", 2},     {"multiply_add", 3}, {"power", 2}, {"equal", 2},  {"not_equal", 2},
    {"less", 2},      {"less_equal", 2}, {"and", 2},          {"or", 2},    {"select", 3}, {"exp", 1},
    {"exp_ratio", 1}, {"log", 1},        {"log2", 1},         {"log10", 1}, {"sqrt", 1},   {"abs", 1},
    {"floor", 1},     {"ceil", 1},       {"sign", 1},         {"sin", 1},   {"cos", 1},    {"tan", 1},
    {"asin", 1},      {"acos", 1},       {"atan", 1},         {"tanh", 1},  {"min", 2},    {"max", 2},
    {"atan2", 2},     {"hypot", 2},      {"mod", 2},
}};

const OpInfo& info(ProgramOp op) {
  const auto index = static_cast<std::uint32_t>(op);
  return kOps[index <= kProgramOpCount ? index : 0];
}

// What a step may read at one point of the program.
class OperandCheck {
 public:
  explicit OperandCheck(const ProgramHeader& header)
      : state_count_(header.state_count),
        first_temporary_(std::uint64_t{header.state_count} + header.input_count + header.column_count +
                         header.constant_count),
        is_written_(header.temporary_count) {}

  [[nodiscard]] bool is_readable(std::uint64_t operand) const {
    if (operand < first_temporary_) {
      return true;
    }
    const std::uint64_t temporary = operand - first_temporary_;
    return temporary < is_written_.size() && is_written_[temporary];
  }
  [[nodiscard]] bool write(std::uint64_t operand) {
    if (operand < state_count_) {
      return true;
    }
    if (operand < first_temporary_ || operand - first_temporary_ >= is_written_.size()) {
      return false;
    }
    is_written_[operand - first_temporary_] = true;
    return true;
  }

 private:
  std::uint64_t state_count_;
  std::uint64_t first_temporary_;
  std::vector<bool> is_written_;
};

bool refuse(std::string& why, std::string reason) {
  why = std::move(reason);
  return false;
}

bool verify_header(std::span<const std::uint32_t> words, std::string& why) {
  if (words.size() < kProgramHeaderWords) {
    return refuse(why, "program without a header");
  }
  const ProgramHeader header = program_header(words);
  if (header.version != kProgramVersion) {
    return refuse(why, "program of version " + std::to_string(header.version));
  }
  if (header.state_count > kMaxProgramStates) {
    return refuse(why, "program with " + std::to_string(header.state_count) + " states");
  }
  if (header.state_count < 32 && (header.hold_mask >> header.state_count) != 0) {
    return refuse(why, "program holds a state that does not exist");
  }
  const std::uint64_t steps = std::uint64_t{header.update_count} + header.threshold_count + header.reset_count;
  if (words.size() != kProgramHeaderWords + header.state_count + steps * kProgramStepWords) {
    return refuse(why, "program of " + std::to_string(words.size()) + " words does not fit its header");
  }
  // Each temporary is written by a step; more of them would only cost memory.
  if (header.temporary_count > steps) {
    return refuse(why, "program with more temporaries than steps");
  }
  return true;
}

std::string operand_name(const ProgramHeader& header, std::uint32_t operand) {
  const std::pair<const char*, std::uint32_t> kinds[] = {{"state ", header.state_count},
                                                         {"input ", header.input_count},
                                                         {"column ", header.column_count},
                                                         {"constant ", header.constant_count}};
  for (const auto& [kind, count] : kinds) {
    if (operand < count) {
      return kind + std::to_string(operand);
    }
    operand -= count;
  }
  return "temporary " + std::to_string(operand);
}

}  // namespace

std::uint32_t operand_count(ProgramOp op) { return info(op).operands; }
const char* program_op_name(ProgramOp op) { return info(op).name; }

ProgramHeader program_header(std::span<const std::uint32_t> words) {
  ProgramHeader header;
  std::memcpy(&header, words.data(), sizeof(header));
  return header;
}

ProgramStep program_step(std::span<const std::uint32_t> words, std::size_t index) {
  const std::size_t first = kProgramHeaderWords + program_header(words).state_count;
  ProgramStep step;
  std::memcpy(&step, words.data() + first + index * kProgramStepWords, sizeof(step));
  return step;
}

std::vector<std::string> describe_program(std::span<const std::uint32_t> words) {
  constexpr const char* kFields[kProgramHeaderWords] = {
      "version",      "states",          "inputs",      "columns", "constants",        "temporaries",
      "update steps", "threshold steps", "reset steps", "fires",   "refractory ticks", "held states, by bit"};
  constexpr std::size_t kFiresWord = offsetof(ProgramHeader, fires) / sizeof(std::uint32_t);
  const ProgramHeader header = program_header(words);
  std::vector<std::string> meaning;
  for (std::size_t w = 0; w < kProgramHeaderWords; ++w) {
    meaning.push_back("program: " + std::string(kFields[w]) + " " +
                      (w == kFiresWord ? operand_name(header, header.fires) : std::to_string(words[w])));
  }
  for (std::uint32_t s = 0; s < header.state_count; ++s) {
    meaning.push_back("  state " + std::to_string(s) + " starts from " +
                      operand_name(header, words[kProgramHeaderWords + s]));
  }
  const std::size_t before_reset = std::size_t{header.update_count} + header.threshold_count;
  for (std::size_t k = 0; k < before_reset + header.reset_count; ++k) {
    const ProgramStep step = program_step(words, k);
    const std::uint32_t reads = operand_count(step.op);
    const char* part = k < header.update_count ? "update" : k < before_reset ? "threshold" : "reset";
    meaning.push_back("  step " + std::to_string(k) + ", " + part + ": " + program_op_name(step.op));
    meaning.push_back("    to " + operand_name(header, step.target));
    const std::uint32_t operands[] = {step.a, step.b, step.c};
    for (std::uint32_t o = 0; o < 3; ++o) {
      meaning.push_back(o < reads ? "    of " + operand_name(header, operands[o]) : "    unused");
    }
  }
  return meaning;
}

bool verify_program(std::span<const std::uint32_t> words, std::string& why) {
  if (!verify_header(words, why)) {
    return false;
  }
  const ProgramHeader header = program_header(words);
  const std::uint64_t first_constant = std::uint64_t{header.state_count} + header.input_count + header.column_count;
  for (std::uint32_t s = 0; s < header.state_count; ++s) {
    const std::uint64_t initial = words[kProgramHeaderWords + s];
    const bool is_column_or_constant = initial >= std::uint64_t{header.state_count} + header.input_count &&
                                       initial < first_constant + header.constant_count;
    if (!is_column_or_constant) {
      return refuse(why, "program state " + std::to_string(s) + " starts from no column or constant");
    }
  }
  OperandCheck operands(header);
  const std::size_t before_reset = std::size_t{header.update_count} + header.threshold_count;
  for (std::size_t k = 0; k < before_reset + header.reset_count; ++k) {
    if (k == before_reset && !operands.is_readable(header.fires)) {
      return refuse(why, "program fires on an operand that does not exist");
    }
    const ProgramStep step = program_step(words, k);
    const std::uint32_t reads = operand_count(step.op);
    const bool is_readable = operands.is_readable(step.a) && (reads < 2 || operands.is_readable(step.b)) &&
                             (reads < 3 || operands.is_readable(step.c));
    const bool is_unused_zero = (reads > 1 || step.b == 0) && (reads > 2 || step.c == 0);
    if (reads == 0 || !is_readable || !is_unused_zero || !operands.write(step.target)) {
      return refuse(why, "program step " + std::to_string(k) + " is malformed");
    }
    // Threshold steps look at the states; only update and reset change them.
    const bool is_threshold = k >= header.update_count && k < before_reset;
    if (is_threshold && step.target < header.state_count) {
      return refuse(why, "program step " + std::to_string(k) + " changes a state while testing the threshold");
    }
  }
  if (header.reset_count == 0 && !operands.is_readable(header.fires)) {
    return refuse(why, "program fires on an operand that does not exist");
  }
  return true;
}

}  // namespace tectum
