// The interpreter of equation programs on programs written by hand, and the verifier on broken ones.
#include "runtime/engine/program.h"

#include <doctest/doctest.h>

#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

namespace tectum {
namespace {

// One state v, one input, one column k, constants {decay 0.5, threshold 10, reset 1}, two temporaries:
//   v = v * decay + input * k;  fires: threshold <= v;  v = reset;  held for 2 ticks.
constexpr std::uint32_t kV = 0, kInput = 1, kColumn = 2, kDecay = 3, kThreshold = 4, kReset = 5, kTemp = 6, kFires = 7;

struct Program {
  ProgramHeader header{kProgramVersion, 1, 1, 1, 3, 2, 2, 1, 1, kFires, 2, 1};
  std::vector<std::uint32_t> initial = {kColumn};
  std::vector<ProgramStep> steps = {{ProgramOp::Multiply, kTemp, kInput, kColumn, 0},
                                    {ProgramOp::MultiplyAdd, kV, kV, kDecay, kTemp},
                                    {ProgramOp::LessEqual, kFires, kThreshold, kV, 0},
                                    {ProgramOp::Copy, kV, kReset, 0, 0}};

  [[nodiscard]] std::vector<std::uint32_t> words() const {
    const auto head = std::bit_cast<std::array<std::uint32_t, kProgramHeaderWords>>(header);
    std::vector<std::uint32_t> all(head.begin(), head.end());
    all.insert(all.end(), initial.begin(), initial.end());
    for (const ProgramStep& step : steps) {
      all.insert(all.end(), {static_cast<std::uint32_t>(step.op), step.target, step.a, step.b, step.c});
    }
    return all;
  }
};

using BlockArray = std::array<double, kProgramBlock>;

struct Run {
  BlockArray v{};
  BlockArray input{};
  BlockArray column{};
  std::array<std::uint32_t, kProgramBlock> refractory{};
  std::uint64_t is_refractory = 0;

  std::uint64_t tick(ProgramRunner& runner, std::size_t count = kProgramBlock) {
    double* states[] = {v.data()};
    const double* inputs[] = {input.data()};
    const double* columns[] = {column.data()};
    return runner.run({states, inputs, columns, refractory.data(), &is_refractory, count});
  }
};

constexpr double kConstants[] = {0.5, 10, 1};

}  // namespace

TEST_CASE("update, threshold, reset and refractory hold, neuron by neuron") {
  const std::vector<std::uint32_t> words = Program().words();
  std::string why;
  REQUIRE_MESSAGE(verify_program(words, why), why);
  for (const SimdLevel simd : {SimdLevel::Portable, SimdLevel::Avx2, SimdLevel::Avx512}) {
    ProgramRunner runner(words, kConstants, simd);
    Run run;
    run.column.fill(1);
    run.column[5] = 2;
    CHECK(runner.initial_state(0, run.column, kProgramBlock, 5) == 2);
    run.v.fill(4);
    run.input[3] = 8;
    CHECK(run.tick(runner) == std::uint64_t{1} << 3U);  // 4/2 + 8 = 10
    CHECK(run.v[3] == 1);
    CHECK(run.v[5] == 2);
    run.input.fill(8);
    CHECK(run.tick(runner) == std::uint64_t{1} << 5U);  // only 2/2 + 2 * 8 reaches 10; neuron 3 is held
    CHECK(run.v[3] == 1);
    CHECK(run.v[4] == 9);
    CHECK(run.v[5] == 1);
  }
}

TEST_CASE("a neuron is silent for exactly its refractory ticks") {
  ProgramRunner runner(Program().words(), kConstants, SimdLevel::Automatic);
  Run run;
  run.column.fill(1);
  run.input.fill(20);
  std::string raster;
  for (int tick = 0; tick < 7; ++tick) {
    raster += (run.tick(runner) & 1U) != 0 ? '|' : '.';
  }
  CHECK(raster == "|..|..|");
}

TEST_CASE("values beyond the last neuron never fire") {
  ProgramRunner runner(Program().words(), kConstants, SimdLevel::Automatic);
  Run run;
  run.column.fill(1);
  run.input.fill(20);
  CHECK(run.tick(runner, 3) == 7);
}

TEST_CASE("a state that fades away becomes 0 and not subnormal") {
  ProgramRunner runner(Program().words(), kConstants, SimdLevel::Automatic);
  Run run;
  run.v.fill(1);
  for (int tick = 0; tick < 499; ++tick) {
    static_cast<void>(run.tick(runner));
  }
  CHECK(run.v[0] == 0x1p-499);
  static_cast<void>(run.tick(runner));
  static_cast<void>(run.tick(runner));
  CHECK(run.v[0] == 0);
}

TEST_CASE("every operation, on every instruction set") {
  struct Row {
    ProgramOp op;
    double a, b, c, expected;
  };
  const Row rows[] = {
      {ProgramOp::Copy, 3, 0, 0, 3},      {ProgramOp::Negate, 3, 0, 0, -3},      {ProgramOp::Not, 3, 0, 0, 0},
      {ProgramOp::Add, 3, 4, 0, 7},       {ProgramOp::Subtract, 3, 4, 0, -1},    {ProgramOp::Multiply, 3, 4, 0, 12},
      {ProgramOp::Divide, 3, 4, 0, 0.75}, {ProgramOp::MultiplyAdd, 3, 4, 5, 17}, {ProgramOp::Power, 2, 5, 0, 32},
      {ProgramOp::Equal, 3, 3, 0, 1},     {ProgramOp::NotEqual, 3, 3, 0, 0},     {ProgramOp::Less, 3, 3, 0, 0},
      {ProgramOp::LessEqual, 3, 3, 0, 1}, {ProgramOp::And, 1, 2, 0, 1},          {ProgramOp::Or, 0, 0, 0, 0},
      {ProgramOp::Select, 0, 4, 5, 5},    {ProgramOp::Exp, 0, 0, 0, 1},          {ProgramOp::ExpRatio, 0, 0, 0, 1},
      {ProgramOp::Log, 1, 0, 0, 0},       {ProgramOp::Log2, 8, 0, 0, 3},         {ProgramOp::Log10, 1, 0, 0, 0},
      {ProgramOp::Sqrt, 9, 0, 0, 3},      {ProgramOp::Abs, -9, 0, 0, 9},         {ProgramOp::Floor, -1.5, 0, 0, -2},
      {ProgramOp::Ceil, -1.5, 0, 0, -1},  {ProgramOp::Sign, -1.5, 0, 0, -1},     {ProgramOp::Sin, 0, 0, 0, 0},
      {ProgramOp::Cos, 0, 0, 0, 1},       {ProgramOp::Tan, 0, 0, 0, 0},          {ProgramOp::Asin, 0, 0, 0, 0},
      {ProgramOp::Acos, 1, 0, 0, 0},      {ProgramOp::Atan, 0, 0, 0, 0},         {ProgramOp::Tanh, 0, 0, 0, 0},
      {ProgramOp::Min, 3, 4, 0, 3},       {ProgramOp::Max, 3, 4, 0, 4},          {ProgramOp::Atan2, 0, 1, 0, 0},
      {ProgramOp::Hypot, 3, 4, 0, 5},     {ProgramOp::Mod, -1, 4, 0, 3},
  };
  static_assert(std::size(rows) == kProgramOpCount);
  for (const Row& row : rows) {
    CAPTURE(program_op_name(row.op));
    const std::uint32_t reads = operand_count(row.op);
    Program program;
    program.header = {kProgramVersion, 1, 0, 0, 3, 0, 1, 0, 0, 1, 0, 0};
    program.initial = {1};
    program.steps = {{row.op, 0, 1, reads > 1 ? 2U : 0U, reads > 2 ? 3U : 0U}};
    std::string why;
    REQUIRE_MESSAGE(verify_program(program.words(), why), why);
    for (const SimdLevel simd : {SimdLevel::Portable, SimdLevel::Avx2, SimdLevel::Avx512}) {
      const double constants[] = {row.a, row.b, row.c};
      ProgramRunner runner(program.words(), constants, simd);
      Run run;
      double* states[] = {run.v.data()};
      static_cast<void>(runner.run({states, {}, {}, run.refractory.data(), &run.is_refractory, kProgramBlock}));
      CHECK(run.v[0] == row.expected);
      CHECK(run.v[kProgramBlock - 1] == row.expected);
    }
  }
}

TEST_CASE("broken programs are refused with a reason") {
  struct Row {
    const char* what;
    void (*spoil)(Program&);
    const char* why;
  };
  const Row rows[] = {
      {"version", [](Program& p) { p.header.version = 9; }, "version 9"},
      {"states", [](Program& p) { p.header.state_count = 33; }, "33 states"},
      {"hold", [](Program& p) { p.header.hold_mask = 2; }, "holds a state"},
      {"steps", [](Program& p) { p.header.update_count = 0xffffffffU; }, "does not fit its header"},
      {"missing step", [](Program& p) { p.steps.pop_back(); }, "does not fit its header"},
      {"temporaries", [](Program& p) { p.header.temporary_count = 1000; }, "more temporaries"},
      {"initial", [](Program& p) { p.initial[0] = kInput; }, "starts from no column"},
      {"initial beyond", [](Program& p) { p.initial[0] = kTemp; }, "starts from no column"},
      {"operation", [](Program& p) { p.steps[0].op = ProgramOp{0}; }, "step 0 is malformed"},
      {"operation beyond", [](Program& p) { p.steps[0].op = ProgramOp{kProgramOpCount + 1}; }, "step 0 is malformed"},
      {"operand", [](Program& p) { p.steps[1].c = 99; }, "step 1 is malformed"},
      {"unwritten", [](Program& p) { p.steps[0].a = kTemp; }, "step 0 is malformed"},
      {"unused operand", [](Program& p) { p.steps[3].c = 1; }, "step 3 is malformed"},
      {"writes a constant", [](Program& p) { p.steps[0].target = kDecay; }, "step 0 is malformed"},
      {"writes an input", [](Program& p) { p.steps[0].target = kInput; }, "step 0 is malformed"},
      {"threshold writes", [](Program& p) { p.steps[2].target = kV; }, "changes a state"},
      {"fires", [](Program& p) { p.header.fires = 99; }, "fires on an operand"},
      {"fires unwritten", [](Program& p) { p.steps[2].target = kTemp; }, "fires on an operand"},
      {"huge counts", [](Program& p) { p.header.constant_count = 0xffffffffU; }, ""},
  };
  for (const Row& row : rows) {
    CAPTURE(row.what);
    Program program;
    row.spoil(program);
    std::string why;
    CHECK_FALSE(verify_program(program.words(), why));
    CHECK(why.find(row.why) != std::string::npos);
  }
  std::string why;
  CHECK_FALSE(verify_program({}, why));
  CHECK(why == "program without a header");
}

TEST_CASE("the dump says what each word means") {
  const std::vector<std::uint32_t> words = Program().words();
  const std::vector<std::string> meaning = describe_program(words);
  REQUIRE(meaning.size() == words.size());
  CHECK(meaning[1] == "program: states 1");
  CHECK(meaning[9] == "program: fires temporary 1");
  CHECK(meaning[12] == "  state 0 starts from column 0");
  CHECK(meaning[18] == "  step 1, update: multiply_add");
  CHECK(meaning[19] == "    to state 0");
  CHECK(meaning[22] == "    of temporary 0");
}

}  // namespace tectum
