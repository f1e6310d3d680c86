#include "compiler/lower/lower_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "runtime/image/models.h"

namespace tectum {
namespace {

using Values = std::vector<double>;

// Value of a parameter for neuron i, where one value may stand for all.
double value_at(const Values& values, std::size_t i) { return values.size() == 1 ? values[0] : values[i]; }

// The parameter as given, or its default: a number, another parameter, or b * V_init.
Values resolve(const ModelPhysics& physics, const ModelInfo& info, std::string_view name) {
  const auto given = physics.parameters.find(std::string(name));
  if (given != physics.parameters.end()) {
    return given->second;
  }
  const ParameterInfo& parameter = info.parameters[find_parameter(info, name).value()];
  if (parameter.default_text.empty()) {
    return {parameter.default_value};
  }
  if (parameter.default_text != "b * V_init") {
    return resolve(physics, info, parameter.default_text);
  }
  const Values b = resolve(physics, info, "b");
  const Values v_mv = resolve(physics, info, "V_init");
  Values product(std::max(b.size(), v_mv.size()));
  for (std::size_t i = 0; i < product.size(); ++i) {
    product[i] = value_at(b, i) * value_at(v_mv, i);
  }
  return product;
}

// What a unit current (1 nA) at time 0 has made of u after `t_ms`, in mV: the solution of
// tau_m du/dt = -u + R_m I, tau dI/dt = -I. Rotter & Diesmann 1999, doi:10.1007/s004220050570.
//   B(t) = R_m tau / (tau - tau_m) (exp(-t/tau) - exp(-t/tau_m)),   tau -> tau_m:  R_m t/tau_m exp(-t/tau_m)
// expm1 keeps the digits when the two time constants are close.
double current_gain_mv(double t_ms, double tau_m_ms, double tau_ms, double r_m_mohm) {
  const double rate_difference = 1 / tau_m_ms - 1 / tau_ms;  // 1/ms
  const double x = t_ms * rate_difference;
  const double ratio = std::abs(x) < 1e-12 ? 1.0 : std::expm1(x) / x;
  if (x > 600) {  // expm1 would overflow: the slower exponential alone is left
    return r_m_mohm / (tau_m_ms * rate_difference) * std::exp(-t_ms / tau_ms);
  }
  return r_m_mohm * t_ms / tau_m_ms * std::exp(-t_ms / tau_m_ms) * ratio;
}

// The largest B over whole ticks. B has one maximum, at ln(tau_m/tau) / (1/tau - 1/tau_m).
double peak_gain_mv(double tick_ms, double tau_m_ms, double tau_ms, double r_m_mohm) {
  const double difference = 1 / tau_ms - 1 / tau_m_ms;
  const double peak_ms = std::abs(difference) * tau_m_ms < 1e-9 ? tau_m_ms : std::log(tau_m_ms / tau_ms) / difference;
  const double before = std::max(1.0, std::floor(peak_ms / tick_ms)) * tick_ms;
  return std::max(current_gain_mv(before, tau_m_ms, tau_ms, r_m_mohm),
                  current_gain_mv(before + tick_ms, tau_m_ms, tau_ms, r_m_mohm));
}

struct Membrane {
  double tick_ms = 0;
  double tau_m_ms = 0;
  double r_m_mohm = 0;
  Values tau_ms;  // of each current
  Values sign;    // +1 for a receptor's current, -1 for the adaptation current
};

// A number too small for a normal float is written as 0: subnormals are slow and say nothing here.
float to_float(double value) {
  return std::abs(value) < static_cast<double>(std::numeric_limits<float>::min()) ? 0.0F : static_cast<float>(value);
}

void append_entry(const Membrane& membrane, double ticks, std::vector<float>& tables) {
  const double t_ms = ticks * membrane.tick_ms;
  tables.push_back(to_float(std::exp(-t_ms / membrane.tau_m_ms)));
  for (std::size_t c = 0; c < membrane.tau_ms.size(); ++c) {
    const double gain_mv = current_gain_mv(t_ms, membrane.tau_m_ms, membrane.tau_ms[c], membrane.r_m_mohm);
    tables.push_back(to_float(membrane.sign[c] * gain_mv));
  }
  for (const double tau_ms : membrane.tau_ms) {
    tables.push_back(to_float(std::exp(-t_ms / tau_ms)));
  }
}

void append_propagators(const Membrane& membrane, std::uint32_t group_size, bool may_sleep,
                        std::vector<float>& tables) {
  append_entry(membrane, 1, tables);
  for (std::size_t c = 0; c < membrane.tau_ms.size(); ++c) {
    const double peak_mv = peak_gain_mv(membrane.tick_ms, membrane.tau_m_ms, membrane.tau_ms[c], membrane.r_m_mohm);
    tables.push_back(to_float(membrane.sign[c] * peak_mv));
  }
  if (!may_sleep) {
    return;
  }
  const auto layout = PropagatorTable::of(static_cast<std::uint32_t>(membrane.tau_ms.size()), group_size);
  for (std::uint32_t k = 0; k < layout.entry_count(); ++k) {
    const std::uint32_t level = k / layout.digits();
    append_entry(membrane, std::ldexp(k % layout.digits(), static_cast<int>(level * layout.digit_bits)), tables);
  }
}

bool is_membrane(ModelKind kind) {
  return kind == ModelKind::LifDelta || kind == ModelKind::LifExp || kind == ModelKind::Alif;
}

Membrane membrane_of(const ModelPhysics& physics, const ModelInfo& info, double tick_ms) {
  Membrane membrane;
  membrane.tick_ms = tick_ms;
  membrane.tau_m_ms = resolve(physics, info, "tau_m")[0];
  membrane.r_m_mohm = resolve(physics, info, "R_m")[0];
  if (physics.model != ModelKind::LifDelta) {
    for (const ReceptorPhysics& receptor : physics.receptors) {
      membrane.tau_ms.push_back(receptor.tau_ms);
      membrane.sign.push_back(1);
    }
  }
  if (physics.model == ModelKind::Alif) {
    membrane.tau_ms.push_back(resolve(physics, info, "tau_w")[0]);
    membrane.sign.push_back(-1);
  }
  return membrane;
}

}  // namespace

bool parameter_may_vary(ModelKind model, std::string_view name) {
  const ModelInfo* info = find_model(model);
  const auto p = info == nullptr ? std::nullopt : find_parameter(*info, name);
  return p && info->parameters[*p].may_vary;
}

bool rests_below_threshold(const ModelPhysics& physics) {
  const ModelInfo* info = find_model(physics.model);
  if (info == nullptr || !info->may_sleep) {
    return false;
  }
  const Values rest_mv = resolve(physics, *info, "E_L");
  const Values bias_na = resolve(physics, *info, "I_bias");
  const Values threshold_mv = resolve(physics, *info, "V_th");
  const double r_m_mohm = resolve(physics, *info, "R_m")[0];
  const std::size_t count = std::max({rest_mv.size(), bias_na.size(), threshold_mv.size()});
  for (std::size_t i = 0; i < count; ++i) {
    if (value_at(rest_mv, i) + r_m_mohm * value_at(bias_na, i) >= value_at(threshold_mv, i)) {
      return false;
    }
  }
  return true;
}

std::vector<double> parameter_values(const ModelPhysics& physics, std::string_view name) {
  const ModelInfo* info = find_model(physics.model);
  assert(info != nullptr);
  return resolve(physics, *info, name);
}

void lower_model(const ModelPhysics& physics, double tick_ms, ImageContents& image, GroupRecord& group) {
  const ModelInfo* info = find_model(physics.model);
  assert(info != nullptr);
  const bool may_sleep = physics.may_sleep && info->may_sleep;
  group.model = physics.model;
  group.flags = may_sleep ? std::uint32_t{kGroupMaySleep} : 0U;

  group.parameter_begin = static_cast<std::uint32_t>(image.parameters.size());
  group.column_begin = static_cast<std::uint32_t>(image.columns.size());
  group.column_count = 0;
  for (std::uint32_t p = 0; p < info->parameters.size(); ++p) {
    const Values values = resolve(physics, *info, info->parameters[p].name);
    assert(values.size() == 1 || values.size() == physics.size);
    image.parameters.push_back(values[0]);
    const bool varies = std::any_of(values.begin(), values.end(), [&](double value) { return value != values[0]; });
    if (varies) {
      assert(info->parameters[p].may_vary);
      image.columns.insert(image.columns.end(), values.begin(), values.end());
      group.flags |= 1U << (kGroupColumnShift + p);
      ++group.column_count;
    }
  }
  for (const ReceptorPhysics& receptor : physics.receptors) {
    image.parameters.push_back(receptor.kind == ReceptorKind::Exponential ? receptor.tau_ms : 0);
  }
  for (const ReceptorPhysics& receptor : physics.receptors) {
    const bool is_exponential = receptor.kind == ReceptorKind::Exponential;
    image.parameters.push_back(is_exponential ? std::exp(-tick_ms / receptor.tau_ms) : 0);
  }
  group.parameter_count = static_cast<std::uint32_t>(image.parameters.size()) - group.parameter_begin;

  group.table_begin = static_cast<std::uint32_t>(image.tables.size());
  if (is_membrane(physics.model)) {
    append_propagators(membrane_of(physics, *info, tick_ms), physics.size, may_sleep, image.tables);
  }
  group.table_count = static_cast<std::uint32_t>(image.tables.size()) - group.table_begin;
}

}  // namespace tectum
