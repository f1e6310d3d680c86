// Tectum's neuron models in NEST's names and units, and back.
//
//   lif_exp     iaf_psc_exp, or iaf_psc_exp_multisynapse where the receptors are not `ex` (> 0) and `in` (< 0): the
//   same
//               equations and the same exact integration (Rotter & Diesmann 1999)
//   lif_delta   iaf_psc_delta: the same
//   alif        aeif_psc_exp with Delta_T = 0 and a = 0: the same equations, integrated adaptively
//   izhikevich  izhikevich with consistent_integration: u follows the old v, where Tectum's follows the new one
//   poisson     poisson_generator: every target gets spikes of its own
// NEST counts in mV, ms, pA, pF and nS:  C_m = 1000 tau_m / R_m,  g_L = 1000 / R_m,  current = 1000 I (nA).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/exchange/wiring.h"

namespace tectum {

/// One value for all neurons, or one a neuron.
using NeuronValues = std::map<std::string, std::vector<double>>;

struct NestModel {
  std::string name;         // empty: NEST has no counterpart
  double weight_scale = 1;  // NEST's weight = weight * weight_scale
  bool has_ports = false;   // receptor r of the population is port r + 1
  NeuronValues parameters;
  std::map<std::string, std::vector<double>> lists;  // parameters that are lists, the same for all neurons
  std::map<std::string, bool> flags;
  std::string mismatch;  // what does not match, as the end of a sentence about the population; empty when all does
};

/// `splits_by_sign`: nothing negative reaches `ex` and nothing positive reaches `in`.
[[nodiscard]] NestModel nest_model(const NetworkPopulation& population, double tick_ms, bool splits_by_sign);

/// A model of NEST in Tectum's words.
struct NativeModel {
  std::string model;                         // "lif_exp"
  std::map<std::string, double> parameters;  // in Tectum's units
  std::map<std::string, double> tau_syn_ms;  // receptors, by name; for numbered ports "port_1", ...
  bool is_delta = false;                     // receptors without a time course
  double weight_scale = 1;                   // as in NestModel
};

/// Nothing when Tectum has no counterpart of the model with these parameters: `error` then says why, as the end of a
/// sentence about the node type.
[[nodiscard]] std::optional<NativeModel> native_model(const std::string& nest_name,
                                                      const std::map<std::string, double>& parameters,
                                                      const std::map<std::string, std::vector<double>>& lists,
                                                      double tick_ms, std::string& error);

}  // namespace tectum
