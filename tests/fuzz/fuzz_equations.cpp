// Any text as an equation model, one part a line: checked, compiled, verified, run for a few ticks.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/expression/equation_model.h"
#include "runtime/engine/program.h"
#include "tests/fuzz/expect.h"

using namespace tectum;

namespace {

// "p name = text" parameter, "s" state, "e" equation, "r" reset, "t text" threshold, "f text" refractory time,
// "i name" input, "h name" hold, "m digit" method.
EquationModelText read_model(std::string_view data) {
  EquationModelText model;
  while (!data.empty()) {
    const std::size_t end = std::min(data.find('\n'), data.size());
    const std::string_view line = data.substr(0, end);
    data.remove_prefix(std::min(end + 1, data.size()));
    if (line.size() < 3 || line[1] != ' ') {
      continue;
    }
    const std::string_view rest = line.substr(2);
    const std::size_t equals = std::min(rest.find(" = "), rest.size());
    const EquationText named{std::string(rest.substr(0, equals)),
                             std::string(rest.substr(std::min(equals + 3, rest.size())))};
    switch (line[0]) {
      case 'p':
        model.parameters.push_back(named);
        break;
      case 's':
        model.states.push_back(named);
        break;
      case 'e':
        model.equations.push_back(named);
        break;
      case 'r':
        model.reset.push_back(named);
        break;
      case 't':
        model.threshold = rest;
        break;
      case 'f':
        model.refractory = rest;
        break;
      case 'i':
        model.inputs.push_back({std::string(rest), kCurrent});
        break;
      case 'h':
        if (!model.hold) {
          model.hold.emplace();
        }
        model.hold->push_back(std::string(rest));
        break;
      case 'm':
        model.method = static_cast<EquationMethod>(static_cast<unsigned char>(rest[0]) % 4);
        break;
      default:
        break;
    }
  }
  return model;
}

void run(const EquationProgram& program) {
  ProgramRunner runner(program.words, program.constants, SimdLevel::Automatic);
  const ProgramHeader& header = runner.header();
  std::vector<double> states(header.state_count * kProgramBlock);
  const std::vector<double> input(kProgramBlock, 0.5);
  std::vector<double*> state_places;
  const std::vector<const double*> inputs(header.input_count, input.data());
  for (std::size_t s = 0; s < header.state_count; ++s) {
    state_places.push_back(states.data() + s * kProgramBlock);
  }
  std::vector<std::uint32_t> refractory(kProgramBlock);
  std::uint64_t is_refractory = 0;
  for (int tick = 0; tick < 5; ++tick) {
    const std::uint64_t before = is_refractory;
    const std::uint64_t fired =
        runner.run({state_places, inputs, {}, refractory.data(), &is_refractory, kProgramBlock});
    TECTUM_EXPECT((fired & before) == 0);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const EquationModelText text = read_model({reinterpret_cast<const char*>(data), size});
  if (text.inputs.size() > 8) {
    return 0;
  }
  std::vector<EquationError> errors;
  const auto model = check_equation_model(text, {}, errors);
  TECTUM_EXPECT(model.has_value() == errors.empty());
  if (!model) {
    return 0;
  }
  const auto program = compile_equations(*model, {}, 1, 0.1, errors);
  TECTUM_EXPECT(program.has_value() == errors.empty());
  if (!program) {
    return 0;
  }
  std::string why;
  TECTUM_EXPECT(verify_program(program->words, why));
  run(*program);
  return 0;
}
