#include "runtime/image/models.h"

#include <array>
#include <bit>
#include <limits>

namespace tectum {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kMaxRefractoryMs = 1e6;

constexpr ParameterInfo required(std::string_view name, std::string_view unit, bool may_vary, double minimum,
                                 bool minimum_is_allowed, std::string_view symbol, std::string_view meaning) {
  return {name, unit, 0, {}, true, may_vary, minimum, minimum_is_allowed, kInf, symbol, meaning};
}
constexpr ParameterInfo optional(std::string_view name, std::string_view unit, double value, bool may_vary,
                                 double minimum, bool minimum_is_allowed, std::string_view symbol,
                                 std::string_view meaning) {
  return {name, unit, value, {}, false, may_vary, minimum, minimum_is_allowed, kInf, symbol, meaning};
}
constexpr ParameterInfo derived(std::string_view name, std::string_view unit, std::string_view from,
                                std::string_view symbol, std::string_view meaning) {
  return {name, unit, 0, from, false, true, -kInf, true, kInf, symbol, meaning};
}

constexpr ParameterInfo kTauM = optional("tau_m", "ms", 20, false, 0, false, "tau_m", "membrane time constant");
constexpr ParameterInfo kRest =
    optional("E_L", "mV", -70, true, -kInf, true, "E_L", "leak reversal (resting) potential");
constexpr ParameterInfo kThreshold = optional("V_th", "mV", -50, true, -kInf, true, "V_th", "spike threshold");
constexpr ParameterInfo kReset =
    optional("V_reset", "mV", -65, true, -kInf, true, "V_reset", "potential after a spike");
constexpr ParameterInfo kRefractory = {"t_ref",
                                       "ms",
                                       2,
                                       {},
                                       false,
                                       false,
                                       0,
                                       true,
                                       kMaxRefractoryMs,
                                       "t_ref",
                                       "absolute refractory period, a whole number of ticks"};
constexpr ParameterInfo kResistance = optional("R_m", "MOhm", 10, false, 0, false, "R_m", "membrane resistance");
constexpr ParameterInfo kBias = optional("I_bias", "nA", 0, true, -kInf, true, "I_bias", "constant current");
constexpr ParameterInfo kInitial = derived("V_init", "mV", "E_L", "v(0)", "potential at the start");

constexpr std::array kLifParameters = {kTauM, kRest, kThreshold, kReset, kRefractory, kResistance, kBias, kInitial};
constexpr std::array kAlifParameters = {
    kTauM,
    kRest,
    kThreshold,
    kReset,
    kRefractory,
    kResistance,
    kBias,
    kInitial,
    optional("tau_w", "ms", 100, false, 0, false, "tau_w", "time constant of the adaptation current"),
    optional("b_w", "nA", 0.1, false, -kInf, true, "b_w", "adaptation current added by each own spike")};
constexpr std::array kIzhikevichParameters = {
    optional("a", "1/ms", 0.02, true, -kInf, true, "a", "rate of the recovery variable"),
    optional("b", "1/ms", 0.2, true, -kInf, true, "b", "coupling of the recovery variable to v"),
    optional("c", "mV", -65, true, -kInf, true, "c", "potential after a spike"),
    optional("d", "mV/ms", 8, true, -kInf, true, "d", "recovery added by a spike"),
    optional("k2", "1/(mV ms)", 0.04, false, -kInf, true, "k2", "quadratic coefficient"),
    optional("k1", "1/ms", 5, false, -kInf, true, "k1", "linear coefficient"),
    optional("k0", "mV/ms", 140, false, -kInf, true, "k0", "constant coefficient"),
    optional("V_peak", "mV", 30, true, -kInf, true, "V_peak", "a spike is called above this potential"),
    optional("time_scale", "", 1, false, 0, false, "s", "multiplies both derivatives"),
    ParameterInfo{"rectify", "", 0, {}, false, false, 0, true, 1, "", "1: a net input below 0 counts as 0"},
    optional("I_bias", "mV/ms", 0, true, -kInf, true, "I_bias", "constant input"),
    ParameterInfo{"V_init", "mV", 0, "c", false, true, -kInf, true, kInf, "v(0)", "potential at the start"},
    derived("u_init", "mV/ms", "b * V_init", "u(0)", "recovery at the start")};
constexpr std::array kThresholdParameters = {
    required("theta", "", true, -kInf, true, "theta", "fires when the summed input reaches it"),
    ParameterInfo{"t_ref",
                  "ms",
                  0,
                  {},
                  false,
                  false,
                  0,
                  true,
                  kMaxRefractoryMs,
                  "t_ref",
                  "absolute refractory period, a whole number of ticks"}};
constexpr std::array kRateParameters = {required("rate", "Hz", true, 0, true, "rate", "mean firing rate")};
constexpr std::array kFieldParameters = {
    required("rate", "Hz", true, 0, false, "rate", "firing rate while the field is active")};

constexpr std::array kMembraneStates = {StateInfo{"v", "mV", "membrane potential"}};
constexpr std::array kAlifStates = {StateInfo{"v", "mV", "membrane potential"},
                                    StateInfo{"w", "nA", "adaptation current"}};
constexpr std::array kIzhikevichStates = {StateInfo{"v", "mV", "membrane potential"},
                                          StateInfo{"u", "mV/ms", "recovery variable"}};
constexpr std::array kThresholdStates = {StateInfo{"s", "", "summed input of the last tick"}};
constexpr std::array kFieldStates = {StateInfo{"active", "", "1 while the receptive field is active"}};

constexpr std::uint32_t bit(ReceptorKind kind) { return 1U << static_cast<std::uint32_t>(kind); }
constexpr std::uint32_t kAnyReceptor =
    bit(ReceptorKind::Instantaneous) | bit(ReceptorKind::Exponential) | bit(ReceptorKind::Boxcar);

constexpr std::array<ModelInfo, 8> kModels = {{
    {ModelKind::FieldSource, "field", "input neuron of a retina",
     "fires in the first tick after its field became active, and every 1 / rate while it stays active", "as above",
     "none", kFieldParameters, kFieldStates, "our own", "1 / rate is rounded to whole ticks, at least one", "", 0, 0, 0,
     false},
    {ModelKind::Threshold, "threshold", "McCulloch-Pitts unit",
     "s = sum of all receptors' input: this tick's (instantaneous) or the last k ticks' (boxcar)", "s >= theta",
     "silent for t_ref", kThresholdParameters, kThresholdStates, "McCulloch & Pitts 1943, doi:10.1007/BF02478259",
     "a boxcar window keeps its content while refractory", "1",
     bit(ReceptorKind::Instantaneous) | bit(ReceptorKind::Boxcar), 1, kMaxReceptors, false},
    {ModelKind::LifDelta, "lif_delta", "leaky integrate-and-fire, delta synapses",
     "tau_m dv/dt = (E_L - v) + R_m I_bias;  v += weight at each arrival", "v >= V_th",
     "v = V_reset, held for t_ref; input in t_ref is lost", kLifParameters, kMembraneStates,
     "Rotter & Diesmann 1999, doi:10.1007/s004220050570", "spikes fall on ticks; state in 32-bit floats", "mV",
     bit(ReceptorKind::Instantaneous), 1, kMaxReceptors, true},
    {ModelKind::LifExp, "lif_exp", "leaky integrate-and-fire, exponential currents",
     "tau_m dv/dt = (E_L - v) + R_m (sum_r I_r + I_bias);  tau_r dI_r/dt = -I_r;  I_r += weight at each arrival",
     "v >= V_th", "v = V_reset, held for t_ref while the currents go on", kLifParameters, kMembraneStates,
     "Rotter & Diesmann 1999, doi:10.1007/s004220050570",
     "spikes fall on ticks; an arrival moves v from the next tick on; state in 32-bit floats", "nA",
     bit(ReceptorKind::Exponential), 1, kMaxReceptors, true},
    {ModelKind::Alif, "alif", "adaptive leaky integrate-and-fire, exponential currents",
     "tau_m dv/dt = (E_L - v) + R_m (sum_r I_r + I_bias - w);  tau_r dI_r/dt = -I_r;  tau_w dw/dt = -w", "v >= V_th",
     "v = V_reset, held for t_ref while the currents go on; w += b_w", kAlifParameters, kAlifStates,
     "Benda & Herz 2003, doi:10.1162/089976603322385063; integration as lif_exp",
     "spikes fall on ticks; state in 32-bit floats", "nA", bit(ReceptorKind::Exponential), 1, kMaxReceptors, true},
    {ModelKind::Izhikevich, "izhikevich", "Izhikevich's simple model",
     "dv/dt = s (k2 v^2 + k1 v + k0 - u + I);  du/dt = s a (b v - u)", "v > V_peak", "v = c, u += d",
     kIzhikevichParameters, kIzhikevichStates, "Izhikevich 2003, doi:10.1109/TNN.2003.820440",
     "forward Euler, u with the new v: the spike times depend on the tick", "mV/ms", kAnyReceptor, 0, kMaxReceptors,
     false},
    {ModelKind::Poisson,
     "poisson",
     "Poisson source",
     "fires in each tick with probability rate h, independently",
     "the wait drawn with a Philox4x32-10 block is over",
     "none",
     kRateParameters,
     {},
     "Salmon et al. 2011, doi:10.1145/2063384.2063405",
     "at most one spike a tick",
     "",
     0,
     0,
     0,
     false},
    {ModelKind::SpikeList,
     "spike_list",
     "given spike times",
     "fires in the listed ticks",
     "as listed",
     "none",
     {},
     {},
     "our own",
     "at most one spike a tick",
     "",
     0,
     0,
     0,
     false},
}};

}  // namespace

std::span<const ModelInfo> all_models() { return kModels; }

const ModelInfo* find_model(ModelKind kind) {
  for (const ModelInfo& model : kModels) {
    if (model.kind == kind) {
      return &model;
    }
  }
  return nullptr;
}

const ModelInfo* find_model(std::string_view name) {
  for (const ModelInfo& model : kModels) {
    if (model.name == name) {
      return &model;
    }
  }
  return nullptr;
}

std::optional<std::uint32_t> find_parameter(const ModelInfo& model, std::string_view name) {
  for (std::uint32_t p = 0; p < model.parameters.size(); ++p) {
    if (model.parameters[p].name == name) {
      return p;
    }
  }
  return std::nullopt;
}

std::string_view receptor_kind_name(ReceptorKind kind) {
  switch (kind) {
    case ReceptorKind::Instantaneous:
      return "instantaneous";
    case ReceptorKind::Exponential:
      return "exponential";
    case ReceptorKind::Boxcar:
      return "boxcar";
  }
  return "unknown";
}

std::string_view lit_channel_name(LitChannel channel) {
  switch (channel) {
    case LitChannel::Red:
      return "red";
    case LitChannel::Green:
      return "green";
    case LitChannel::Blue:
      return "blue";
    case LitChannel::Luma:
      return "luma";
    case LitChannel::RedOverGreenBlue:
      return "red over green and blue";
    case LitChannel::GreenOverRedBlue:
      return "green over red and blue";
    case LitChannel::BlueOverRedGreen:
      return "blue over red and green";
    case LitChannel::Brightest:
      return "brightest";
  }
  return "unknown";
}

std::uint32_t current_count(ModelKind kind, std::uint32_t receptor_count) {
  switch (kind) {
    case ModelKind::LifExp:
      return receptor_count;
    case ModelKind::Alif:
      return receptor_count + 1;
    default:
      return 0;
  }
}

std::uint32_t table_size(ModelKind kind, std::uint32_t receptor_count, std::uint32_t group_size, bool may_sleep) {
  switch (kind) {
    case ModelKind::LifDelta:
    case ModelKind::LifExp:
    case ModelKind::Alif:
      return PropagatorTable::of(current_count(kind, receptor_count), group_size).size(may_sleep);
    default:
      return 0;
  }
}

}  // namespace tectum
