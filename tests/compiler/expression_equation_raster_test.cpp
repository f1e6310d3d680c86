// Models declared by their equations, run by the engine, against the built-in models and against
// plain double-precision references: the same raster over 10 s.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "compiler/expression/equation_model.h"
#include "compiler/lower/lower_program.h"
#include "tests/support/reference_simulator.h"
#include "tests/support/test_network.h"

namespace tectum::test {
namespace {

constexpr double kTickMs = 0.1;
constexpr std::uint32_t kTicks = 100'000;  // 10 s

EquationProgram compiled(const EquationModelText& text, const EquationParameterValues& values, std::uint32_t size) {
  std::vector<EquationError> errors;
  const auto model = check_equation_model(text, {}, errors);
  for (const EquationError& error : errors) {
    FAIL(error.error.message);
  }
  auto program = compile_equations(*model, values, size, kTickMs, errors);
  for (const EquationError& error : errors) {
    FAIL(error.error.message);
  }
  return *program;
}

// Spike trains with periods that never fall into step; neuron i of the driven population gets train k
// with its own delay and a weight that is exact in quanta.
constexpr std::uint32_t kTrains = 8;
TestNetwork driven(ModelPhysics physics, double weight, std::uint32_t ticks = kTicks) {
  TestNetwork network;
  std::vector<std::vector<std::uint32_t>> trains(kTrains);
  for (std::uint32_t k = 0; k < kTrains; ++k) {
    for (std::uint32_t tick = 5 + 3 * k; tick < ticks; tick += 223 + 37 * k) {
      trains[k].push_back(tick);
    }
  }
  network.add_spikes("trains", trains);
  const std::uint32_t size = physics.size;
  const std::uint32_t first = network.add("driven", std::move(physics));
  for (std::uint32_t i = 0; i < size; ++i) {
    for (std::uint32_t k = 0; k < kTrains; ++k) {
      const double exact = std::round(weight * (1 + 0.1 * i + 0.05 * k) * 256) / 256;
      network.connect(k, first + i, 1 + (i + 3 * k) % 40, exact);
    }
  }
  return network;
}

// The same network with the driven population's model replaced by the program.
Raster run_program(TestNetwork network, const EquationProgram& program, std::vector<ReceptorPhysics> receptors,
                   const EngineOptions& options = {}) {
  ModelPhysics& physics = network.populations[1].physics;
  physics.model = ModelKind::Izhikevich;  // takes any kind of receptor; only its place is used
  physics.parameters.clear();
  physics.receptors = receptors;
  ImageContents image = lower_network(network);
  lower_program(program, receptors, kTickMs, image, image.groups[1]);
  LoadedImage loaded = load_image(write_image(image));
  REQUIRE_MESSAGE(loaded.image.has_value(), loaded.error);
  return run_image(*loaded.image, kTicks, options);
}

std::size_t spikes_of(const Raster& raster, std::uint32_t neuron) {
  return static_cast<std::size_t>(
      std::count_if(raster.begin(), raster.end(), [&](const auto& spike) { return spike.second == neuron; }));
}

EquationModelText lif_equations() {
  EquationModelText text;
  text.parameters = {{"tau_m", "20 ms"}, {"E_L", "-70 mV"},    {"V_th", "-50 mV"}, {"V_reset", "-65 mV"},
                     {"R_m", "10 MOhm"}, {"I_bias", "0.9 nA"}, {"tau_ex", "5 ms"}, {"t_ref", "2 ms"}};
  text.inputs = {{"ex", kCurrent}};
  text.states = {{"v", "E_L"}, {"I_ex", "0 nA"}};
  text.equations = {
      {"dv/dt", "(E_L - v + R_m * (I_ex + I_bias)) / tau_m"}, {"dI_ex/dt", "-I_ex / tau_ex"}, {"I_ex", "I_ex + ex"}};
  text.threshold = "v >= V_th";
  text.reset = {{"v", "V_reset"}};
  text.refractory = "t_ref";
  return text;
}

}  // namespace

// The built-in keeps its state in 32-bit floats: where v passes within 1e-6 of the threshold it may fire a
// tick earlier or later, about one spike in 7000 under this drive. The reference in double may not.
TEST_CASE("LIF declared by its equations agrees with the double-precision reference spike for spike") {
  constexpr std::uint32_t kSize = 30;
  ModelPhysics physics;
  physics.model = ModelKind::LifExp;
  physics.size = kSize;
  physics.parameters = {{"I_bias", {0.9}}};
  physics.receptors = {exponential("ex", 5)};
  const TestNetwork network = driven(physics, 1.0);
  const Raster equations = run_program(network, compiled(lif_equations(), {}, kSize), {instantaneous("ex")});
  CHECK(equations.size() > 10000);
  CHECK(equations == run_reference(network, kTicks).raster);
}

TEST_CASE("LIF declared by its equations gives the raster of the built-in lif_exp") {
  constexpr std::uint32_t kSize = 50;
  ModelPhysics physics;
  physics.model = ModelKind::LifExp;
  physics.size = kSize;
  physics.parameters = {{"I_bias", {0.9}}};
  physics.receptors = {exponential("ex", 5)};
  // Strong arrivals cross the threshold steeply.
  const TestNetwork network = driven(physics, 6.0);
  const Raster built_in = run_image(build_image(network), kTicks);
  CHECK(built_in.size() > 10000);
  CHECK(run_program(network, compiled(lif_equations(), {}, kSize), {instantaneous("ex")}) == built_in);
}

TEST_CASE("LIF with parameters of its own for each neuron agrees with the reference") {
  constexpr std::uint32_t kSize = 30;
  std::vector<double> threshold_mv;
  std::vector<double> rest_mv;
  for (std::uint32_t i = 0; i < kSize; ++i) {
    threshold_mv.push_back(-50 + 0.03 * i);
    rest_mv.push_back(-70 + 0.02 * i);
  }
  ModelPhysics physics;
  physics.model = ModelKind::LifExp;
  physics.size = kSize;
  physics.parameters = {{"I_bias", {0.9}}, {"V_th", threshold_mv}, {"E_L", rest_mv}};
  physics.receptors = {exponential("ex", 5)};
  const TestNetwork network = driven(physics, 1.0);
  const EquationProgram program = compiled(lif_equations(), {{"V_th", threshold_mv}, {"E_L", rest_mv}}, kSize);
  CHECK(run_program(network, program, {instantaneous("ex")}) == run_reference(network, kTicks).raster);
}

TEST_CASE("delta LIF declared by its equations gives the raster of the built-in lif_delta") {
  constexpr std::uint32_t kSize = 40;
  EquationModelText text;
  text.parameters = {{"tau_m", "20 ms"}, {"E_L", "-70 mV"}};
  text.inputs = {{"in", kVoltage}};
  text.states = {{"v", "E_L"}};
  text.equations = {{"dv/dt", "(E_L - v) / tau_m"}, {"v", "v + in"}};
  text.threshold = "v >= -50 mV";
  text.reset = {{"v", "-65 mV"}};
  text.refractory = "2 ms";
  ModelPhysics physics;
  physics.model = ModelKind::LifDelta;
  physics.size = kSize;
  physics.receptors = {instantaneous("in")};
  const TestNetwork network = driven(physics, 9.0);
  const Raster built_in = run_image(build_image(network), kTicks);
  CHECK(spikes_of(built_in, kTrains) > 50);
  CHECK(run_program(network, compiled(text, {}, kSize), {instantaneous("in")}) == built_in);
}

TEST_CASE("Izhikevich declared by per-tick updates gives the raster of the built-in") {
  constexpr std::uint32_t kSize = 50;
  EquationModelText text;
  text.parameters = {{"a", "0.02 /ms"}, {"b", "0.2 /ms"}, {"c", "-65 mV"}, {"d", "8 mV/ms"}};
  text.inputs = {{"ex", kVoltageRate}};
  text.states = {{"v", "c"}, {"u", "b * c"}};
  text.equations = {{"v", "v + dt * (0.04 /mV/ms * v ^ 2 + 5 /ms * v + 140 mV/ms - u + (ex + 6 mV/ms))"},
                    {"u", "u + dt * a * (b * v - u)"}};
  text.threshold = "v > 30 mV";
  text.reset = {{"v", "c"}, {"u", "u + d"}};
  ModelPhysics physics;
  physics.model = ModelKind::Izhikevich;
  physics.size = kSize;
  physics.parameters = {{"I_bias", {6}}};
  physics.receptors = {exponential("ex", 3)};
  const TestNetwork network = driven(physics, 2.0);
  const Raster built_in = run_image(build_image(network), kTicks);
  CHECK(spikes_of(built_in, kTrains) > 50);
  CHECK(run_program(network, compiled(text, {}, kSize), {exponential("ex", 3)}) == built_in);
}

namespace {

// Brette & Gerstner 2005, doi:10.1152/jn.00686.2005: adaptive exponential integrate-and-fire, forward Euler.
EquationModelText adex_equations() {
  EquationModelText text;
  text.parameters = {{"C", "281 pF"},     {"g_L", "30 nS"}, {"E_L", "-70.6 mV"}, {"V_T", "-50.4 mV"}, {"D_T", "2 mV"},
                     {"tau_w", "144 ms"}, {"a", "4 nS"},    {"b", "80.5 pA"},    {"I_bias", "0.8 nA"}};
  text.inputs = {{"ex", kCurrent}};
  text.states = {{"v", "E_L"}, {"w", "0 nA"}};
  text.equations = {{"dv/dt", "(-g_L * (v - E_L) + g_L * D_T * exp((v - V_T) / D_T) - w + ex + I_bias) / C"},
                    {"dw/dt", "(a * (v - E_L) - w) / tau_w"}};
  text.threshold = "v >= 20 mV";
  text.reset = {{"v", "E_L"}, {"w", "w + b"}};
  text.method = EquationMethod::Euler;
  return text;
}

// The same model written as plainly as possible, with libm's exp.
Raster adex_reference(const TestNetwork& network, std::uint32_t size) {
  std::vector<double> v(size, -70.6), w(size, 0.0);
  std::vector<std::vector<double>> arrivals(kTicks + 64, std::vector<double>());
  Raster raster;
  for (const auto& [tick, train] : network.populations[0].spikes) {
    raster.emplace_back(tick, train);
  }
  std::vector<std::vector<double>> input(kTicks + 64);
  for (auto& tick : input) {
    tick.assign(size, 0.0);
  }
  for (const TestSynapse& synapse : network.synapses) {
    for (const auto& [tick, train] : network.populations[0].spikes) {
      if (train == synapse.pre) {
        input[tick + synapse.delay_ticks][synapse.post - kTrains] += synapse.weight;
      }
    }
  }
  for (std::uint32_t tick = 0; tick < kTicks; ++tick) {
    for (std::uint32_t i = 0; i < size; ++i) {
      const double spike_current = 0.030 * 2.0 * std::exp((v[i] + 50.4) / 2.0);
      const double dv = (-0.030 * (v[i] + 70.6) + spike_current - w[i] + input[tick][i] + 0.8) / 0.281;
      const double dw = (0.004 * (v[i] + 70.6) - w[i]) / 144.0;
      v[i] += kTickMs * dv;
      w[i] += kTickMs * dw;
      if (v[i] >= 20) {
        v[i] = -70.6;
        w[i] += 0.0805;
        raster.emplace_back(tick, kTrains + i);
      }
    }
  }
  std::sort(raster.begin(), raster.end());
  return raster;
}

}  // namespace

TEST_CASE("AdEx declared by its equations agrees with a double-precision reference spike for spike") {
  constexpr std::uint32_t kSize = 20;
  ModelPhysics physics;
  physics.model = ModelKind::Izhikevich;
  physics.size = kSize;
  physics.receptors = {instantaneous("ex")};
  const TestNetwork network = driven(physics, 20.0);
  const Raster reference = adex_reference(network, kSize);
  const Raster equations = run_program(network, compiled(adex_equations(), {}, kSize), {instantaneous("ex")});
  CHECK(spikes_of(equations, kTrains) > 50);
  CHECK(equations == reference);
}

TEST_CASE("every instruction set gives the same raster") {
  constexpr std::uint32_t kSize = 130;  // two blocks and a part
  ModelPhysics physics;
  physics.model = ModelKind::Izhikevich;
  physics.size = kSize;
  physics.receptors = {instantaneous("ex")};
  const TestNetwork network = driven(physics, 20.0);
  const EquationProgram program = compiled(adex_equations(), {}, kSize);
  const auto run = [&](SimdLevel simd) {
    EngineOptions options;
    options.simd = simd;
    return run_program(network, program, {instantaneous("ex")}, options);
  };
  const Raster portable = run(SimdLevel::Portable);
  CHECK(run(SimdLevel::Avx2) == portable);
  CHECK(run(SimdLevel::Avx512) == portable);
}

TEST_CASE("exponential Euler is exact where the coefficients are constant") {
  EquationModelText text;
  text.parameters = {{"tau", "10 ms"}};
  text.states = {{"x", "1"}, {"y", "0"}};
  text.equations = {{"dx/dt", "-x / tau"}, {"dy/dt", "(x - y) / (2 * tau)"}};
  text.threshold = "x < 0.5";
  text.reset = {{"x", "1"}};
  const auto raster_of = [&](EquationMethod method) {
    text.method = method;
    TestNetwork network = driven({ModelKind::Izhikevich, 1, {}, {}, false}, 0);
    network.synapses.clear();
    return run_program(network, compiled(text, {}, 1), {});
  };
  // From 1 to 0.5 takes tau ln 2 = 6.93 ms: 70 ticks.
  const Raster exponential_euler = raster_of(EquationMethod::ExponentialEuler);
  CHECK(spikes_of(exponential_euler, kTrains) == kTicks / 70);
  CHECK(exponential_euler == raster_of(EquationMethod::Exact));
}

TEST_CASE("Hodgkin and Huxley's membrane runs by exponential Euler and fires at the textbook rate") {
  // Hodgkin & Huxley 1952, doi:10.1113/jphysiol.1952.sp004764, for 1 cm^2 / 1e6 of membrane, rest at -65 mV.
  EquationModelText text;
  text.parameters = {{"C", "1 nF"},     {"g_Na", "120 uS"}, {"g_K", "36 uS"},      {"g_L", "0.3 uS"},
                     {"E_Na", "50 mV"}, {"E_K", "-77 mV"},  {"E_L", "-54.387 mV"}, {"I_bias", "10 nA"}};
  text.states = {{"v", "-65 mV"}, {"m", "0.05"}, {"h", "0.6"}, {"n", "0.32"}, {"was_up", "0"}, {"is_up", "0"}};
  text.equations = {
      {"dv/dt", "(I_bias - g_Na * m ^ 3 * h * (v - E_Na) - g_K * n ^ 4 * (v - E_K) - g_L * (v - E_L)) / C"},
      {"dm/dt",
       "(0.1 * (v + 40 mV) / 1 mV / (1 - exp(-(v + 40 mV) / 10 mV)) * (1 - m) - 4 * exp(-(v + 65 mV) / 18 mV) * m) / 1 "
       "ms"},
      {"dh/dt", "(0.07 * exp(-(v + 65 mV) / 20 mV) * (1 - h) - 1 / (1 + exp(-(v + 35 mV) / 10 mV)) * h) / 1 ms"},
      {"dn/dt",
       "(0.01 * (v + 55 mV) / 1 mV / (1 - exp(-(v + 55 mV) / 10 mV)) * (1 - n) - 0.125 * exp(-(v + 65 mV) / 80 mV) * "
       "n) "
       "/ 1 ms"},
      {"was_up", "is_up"},
      {"is_up", "if(v > 0 mV, 1, 0)"}};
  text.threshold = "is_up == 1 and was_up == 0";
  text.method = EquationMethod::ExponentialEuler;
  TestNetwork network = driven({ModelKind::Izhikevich, 1, {}, {}, false}, 0);
  network.synapses.clear();
  const Raster raster = run_program(network, compiled(text, {}, 1), {});
  // About 68 Hz at 10 uA/cm^2 and 6.3 degrees Celsius.
  const double rate_hz = static_cast<double>(spikes_of(raster, kTrains)) / 10.0;
  CHECK(rate_hz > 60);
  CHECK(rate_hz < 75);
}

}  // namespace tectum::test
