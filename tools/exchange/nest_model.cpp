#include "tools/exchange/nest_model.h"

#include <fmt/format.h>

#include <algorithm>

namespace tectum {
namespace {

constexpr double kPicoPerNano = 1000;

double value_at(const std::vector<double>& values, std::size_t i) { return values.size() == 1 ? values[0] : values[i]; }

template <typename Formula>
std::vector<double> combine(const std::vector<double>& a, const std::vector<double>& b, const Formula& formula) {
  std::vector<double> result(std::max(a.size(), b.size()));
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i] = formula(value_at(a, i), value_at(b, i));
  }
  return result;
}

std::vector<double> scaled(const std::vector<double>& values, double factor) {
  return combine(values, {factor}, [](double value, double by) { return value * by; });
}

class ToNest {
 public:
  ToNest(const NetworkPopulation& population, double tick_ms, bool splits_by_sign)
      : population_(population), tick_ms_(tick_ms), splits_by_sign_(splits_by_sign) {}

  NestModel run() {
    switch (population_.model) {
      case ModelKind::LifExp:
        lif_exp();
        break;
      case ModelKind::LifDelta:
        lif_delta();
        break;
      case ModelKind::Alif:
        alif();
        break;
      case ModelKind::Izhikevich:
        izhikevich();
        break;
      case ModelKind::Poisson:
        made_.name = "poisson_generator";
        made_.parameters["rate"] = of("rate");
        made_.mismatch = "poisson_generator sends each target spikes of its own, here all targets see the same";
        break;
      default:
        made_.mismatch = fmt::format("there is no counterpart of `{}`", model_name(population_));
        break;
    }
    return std::move(made_);
  }

 private:
  [[nodiscard]] std::vector<double> of(const char* name) const { return parameter_of(population_, name); }

  void membrane() {
    made_.weight_scale = kPicoPerNano;
    for (const char* name : {"E_L", "V_th", "V_reset", "t_ref"}) {
      made_.parameters[name] = of(name);
    }
    made_.parameters["C_m"] =
        combine(of("tau_m"), of("R_m"), [](double tau_m, double r_m) { return kPicoPerNano * tau_m / r_m; });
    made_.parameters["I_e"] = scaled(of("I_bias"), kPicoPerNano);
    made_.parameters["V_m"] = of("V_init");
  }

  [[nodiscard]] const Receptor* receptor(const char* name) const {
    const auto found = std::find_if(population_.receptors.begin(), population_.receptors.end(),
                                    [&](const Receptor& r) { return r.name == name; });
    return found == population_.receptors.end() ? nullptr : &*found;
  }
  /// The receptors are `ex` and `in`, or one of them, and the sign of a weight says which is meant.
  [[nodiscard]] bool has_usual_receptors() const {
    const std::size_t usual = (receptor("ex") != nullptr ? 1U : 0U) + (receptor("in") != nullptr ? 1U : 0U);
    return splits_by_sign_ && usual == population_.receptors.size() && usual > 0;
  }
  void usual_receptors() {
    const Receptor* ex = receptor("ex");
    const Receptor* in = receptor("in");
    made_.parameters["tau_syn_ex"] = {(ex != nullptr ? ex : in)->tau_ms};
    made_.parameters["tau_syn_in"] = {(in != nullptr ? in : ex)->tau_ms};
  }

  void lif_exp() {
    membrane();
    made_.parameters["tau_m"] = of("tau_m");
    if (has_usual_receptors()) {
      made_.name = "iaf_psc_exp";
      usual_receptors();
      return;
    }
    made_.name = "iaf_psc_exp_multisynapse";
    made_.has_ports = true;
    for (const Receptor& r : population_.receptors) {
      made_.lists["tau_syn"].push_back(r.tau_ms);
    }
  }

  void lif_delta() {
    const bool has_window = std::any_of(population_.receptors.begin(), population_.receptors.end(),
                                        [](const Receptor& r) { return r.kind != ReceptorKind::Instantaneous; });
    if (has_window) {
      made_.mismatch = "there is no counterpart of boxcar receptors";
      return;
    }
    membrane();
    made_.name = "iaf_psc_delta";
    made_.weight_scale = 1;  // mV
    made_.parameters["tau_m"] = of("tau_m");
  }

  void alif() {
    if (!has_usual_receptors()) {
      made_.mismatch = "aeif_psc_exp has no receptors but one for each sign";
      return;
    }
    membrane();
    made_.name = "aeif_psc_exp";
    made_.parameters["g_L"] = combine(of("R_m"), {kPicoPerNano}, [](double r_m, double by) { return by / r_m; });
    made_.parameters["Delta_T"] = {0};
    made_.parameters["V_peak"] = of("V_th");
    made_.parameters["a"] = {0};
    made_.parameters["b"] = scaled(of("b_w"), kPicoPerNano);
    made_.parameters["tau_w"] = of("tau_w");
    usual_receptors();
    made_.mismatch = "aeif_psc_exp solves the same equations with an adaptive step, so that late spikes move";
  }

  void izhikevich() {
    const auto is = [&](const char* name, double value) { return of(name) == std::vector<double>{value}; };
    const bool is_plain = is("k2", 0.04) && is("k1", 5) && is("k0", 140) && is("rectify", 0) && is("time_scale", 1);
    const bool is_instantaneous = std::all_of(population_.receptors.begin(), population_.receptors.end(),
                                              [](const Receptor& r) { return r.kind == ReceptorKind::Instantaneous; });
    if (!is_plain || !is_instantaneous) {
      made_.mismatch = "izhikevich has fixed coefficients and no receptors with a time course";
      return;
    }
    made_.name = "izhikevich";
    made_.weight_scale = tick_ms_;  // one tick of mV/ms is a step of mV
    for (const char* name : {"a", "b", "c", "d"}) {
      made_.parameters[name] = of(name);
    }
    made_.parameters["V_th"] = of("V_peak");
    made_.parameters["I_e"] = of("I_bias");
    made_.parameters["V_m"] = of("V_init");
    made_.parameters["U_m"] = of("u_init");
    made_.flags["consistent_integration"] = true;
    made_.mismatch = "izhikevich moves u by the old v, Tectum by the new one: spikes move";
  }

  const NetworkPopulation& population_;
  double tick_ms_;
  bool splits_by_sign_;
  NestModel made_;
};

class FromNest {
 public:
  FromNest(const std::map<std::string, double>& parameters, const std::map<std::string, std::vector<double>>& lists)
      : parameters_(parameters), lists_(lists) {}

  std::optional<NativeModel> run(const std::string& name, double tick_ms, std::string& error) {
    if (name == "iaf_psc_exp" || name == "iaf_psc_exp_multisynapse") {
      membrane(10, 250, 2);
      made_.model = "lif_exp";
      if (name == "iaf_psc_exp") {
        receptors(2);
      } else {
        ports();
      }
    } else if (name == "iaf_psc_delta") {
      membrane(10, 250, 2);
      made_.model = "lif_delta";
      made_.is_delta = true;
      made_.weight_scale = 1;
    } else if (name == "aeif_psc_exp") {
      adaptive(error);
    } else if (name == "izhikevich") {
      izhikevich(tick_ms);
    } else if (name == "poisson_generator") {
      made_.model = "poisson";
      made_.parameters["rate"] = take("rate", 0);
    } else {
      error = "Tectum has no counterpart of `" + name + "`";
    }
    check_leftovers(name, error);
    return error.empty() ? std::optional(std::move(made_)) : std::nullopt;
  }

 private:
  /// The parameter, or NEST's default.
  double take(const char* name, double fallback) {
    used_.push_back(name);
    const auto found = parameters_.find(name);
    return found == parameters_.end() ? fallback : found->second;
  }

  /// What is given and was not taken must be named: silence would change the model.
  void check_leftovers(const std::string& name, std::string& error) const {
    for (const auto& [key, value] : parameters_) {
      if (error.empty() && std::find(used_.begin(), used_.end(), key) == used_.end()) {
        error = fmt::format("`{}` of {} has no counterpart", key, name);
      }
    }
  }

  void membrane(double tau_m_ms, double c_m_pf, double t_ref_ms) {
    made_.weight_scale = kPicoPerNano;
    const double tau_m = take("tau_m", tau_m_ms);
    made_.parameters["tau_m"] = tau_m;
    made_.parameters["R_m"] = kPicoPerNano * tau_m / take("C_m", c_m_pf);
    made_.parameters["E_L"] = take("E_L", -70);
    made_.parameters["V_th"] = take("V_th", -55);
    made_.parameters["V_reset"] = take("V_reset", -70);
    made_.parameters["t_ref"] = take("t_ref", t_ref_ms);
    made_.parameters["I_bias"] = take("I_e", 0) / kPicoPerNano;
    made_.parameters["V_init"] = take("V_m", made_.parameters["E_L"]);
  }

  void receptors(double default_tau_ms) {
    made_.tau_syn_ms["ex"] = take("tau_syn_ex", default_tau_ms);
    made_.tau_syn_ms["in"] = take("tau_syn_in", default_tau_ms);
  }

  void ports() {
    const auto found = lists_.find("tau_syn");
    const std::vector<double> tau_syn = found == lists_.end() ? std::vector<double>{2} : found->second;
    for (std::size_t r = 0; r < tau_syn.size(); ++r) {
      made_.tau_syn_ms[fmt::format("port_{}", r + 1)] = tau_syn[r];
    }
  }

  void adaptive(std::string& error) {
    const double g_l = take("g_L", 30);
    const double c_m = take("C_m", 281);
    if (take("Delta_T", 2) != 0 || take("a", 4) != 0) {
      error = "aeif_psc_exp has a counterpart only with Delta_T = 0 and a = 0";
      return;
    }
    static_cast<void>(take("V_peak", 0));  // without the exponential, the spike is called at V_th
    made_.model = "alif";
    made_.weight_scale = kPicoPerNano;
    made_.parameters["R_m"] = kPicoPerNano / g_l;
    made_.parameters["tau_m"] = c_m / g_l;
    made_.parameters["E_L"] = take("E_L", -70.6);
    made_.parameters["V_th"] = take("V_th", -50.4);
    made_.parameters["V_reset"] = take("V_reset", -60);
    made_.parameters["t_ref"] = take("t_ref", 0);
    made_.parameters["I_bias"] = take("I_e", 0) / kPicoPerNano;
    made_.parameters["V_init"] = take("V_m", -70.6);
    made_.parameters["tau_w"] = take("tau_w", 144);
    made_.parameters["b_w"] = take("b", 80.5) / kPicoPerNano;
    receptors(0.2);
  }

  void izhikevich(double tick_ms) {
    made_.model = "izhikevich";
    made_.is_delta = true;
    made_.weight_scale = take("consistent_integration", 1) != 0 ? tick_ms : 1;
    made_.parameters["a"] = take("a", 0.02);
    made_.parameters["b"] = take("b", 0.2);
    made_.parameters["c"] = take("c", -65);
    made_.parameters["d"] = take("d", 8);
    made_.parameters["V_peak"] = take("V_th", 30);
    made_.parameters["I_bias"] = take("I_e", 0);
    made_.parameters["V_init"] = take("V_m", -65);
    made_.parameters["u_init"] = take("U_m", 0);
  }

  const std::map<std::string, double>& parameters_;
  const std::map<std::string, std::vector<double>>& lists_;
  std::vector<std::string> used_;
  NativeModel made_;
};

}  // namespace

NestModel nest_model(const NetworkPopulation& population, double tick_ms, bool splits_by_sign) {
  return ToNest(population, tick_ms, splits_by_sign).run();
}

std::optional<NativeModel> native_model(const std::string& nest_name, const std::map<std::string, double>& parameters,
                                        const std::map<std::string, std::vector<double>>& lists, double tick_ms,
                                        std::string& error) {
  return FromNest(parameters, lists).run(nest_name, tick_ms, error);
}

}  // namespace tectum
