// Any words as an equation program: refused, or described and run. Every instruction set leaves the same bits.
#include <cstdint>
#include <cstring>
#include <vector>

#include "runtime/engine/program.h"
#include "tests/fuzz/expect.h"

using namespace tectum;

namespace {

std::vector<double> run(std::span<const std::uint32_t> words, std::span<const double> constants, SimdLevel simd) {
  ProgramRunner runner(words, constants, simd);
  const ProgramHeader& header = runner.header();
  std::vector<double> states(header.state_count * kProgramBlock, 0.25);
  const std::vector<double> input(kProgramBlock, 0.5);
  std::vector<double*> state_places;
  for (std::size_t s = 0; s < header.state_count; ++s) {
    state_places.push_back(states.data() + s * kProgramBlock);
  }
  const std::vector<const double*> inputs(header.input_count, input.data());
  const std::vector<const double*> columns(header.column_count, input.data());
  std::vector<std::uint32_t> refractory(kProgramBlock);
  std::uint64_t is_refractory = 0;
  for (int tick = 0; tick < 4; ++tick) {
    static_cast<void>(runner.run({state_places, inputs, columns, refractory.data(), &is_refractory, 60}));
  }
  return states;
}

// NaNs count as equal: their payloads say nothing.
bool is_same(const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool both_nan = a[i] != a[i] && b[i] != b[i];
    if (!both_nan && std::memcmp(&a[i], &b[i], sizeof(double)) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::uint32_t> words(size / sizeof(std::uint32_t));
  if (!words.empty()) {
    std::memcpy(words.data(), data, words.size() * sizeof(std::uint32_t));
  }
  std::string why;
  if (!verify_program(words, why)) {
    TECTUM_EXPECT(!why.empty());
    return 0;
  }
  TECTUM_EXPECT(describe_program(words).size() == words.size());
  const ProgramHeader header = program_header(words);
  constexpr std::uint32_t kMostOperands = 10'000;  // memory, not a finding
  if (std::uint64_t{header.input_count} + header.column_count + header.constant_count > kMostOperands) {
    return 0;
  }
  std::vector<double> constants(header.constant_count);
  for (std::size_t k = 0; k < constants.size(); ++k) {
    constants[k] = (static_cast<double>(k) - 3) * 1.7;
  }
  const std::vector<double> portable = run(words, constants, SimdLevel::Portable);
  TECTUM_EXPECT(is_same(portable, run(words, constants, SimdLevel::Avx2)));
  TECTUM_EXPECT(is_same(portable, run(words, constants, SimdLevel::Avx512)));
  return 0;
}
