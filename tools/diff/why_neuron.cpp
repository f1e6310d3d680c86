#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "tools/diff/structure_diff.h"
#include "tools/diff/why.h"

namespace tectum {
namespace {

constexpr double kNearMs = 50;
constexpr std::size_t kMostSenders = 4;

std::string name_of(const CircuitView& view, std::uint32_t neuron) {
  const PopulationView& population = view.populations[view.population_of(neuron)];
  return fmt::format("{}[{}]", population.name, neuron - population.first_neuron);
}

NeuronShare share_of(const CircuitView& view, const PathwayInput& input, const InputShare& share, std::uint32_t tick) {
  const PathwayView& pathway = view.pathways[input.pathway];
  NeuronShare result;
  result.projection = pathway.projection;
  result.where =
      view.populations[pathway.pre_population].name + " -> " + view.populations[pathway.post_population].name;
  result.unit = view.populations[pathway.post_population].weight_unit;
  result.share = share;
  const auto recent_ticks = static_cast<std::uint32_t>(std::llround(kRecentMs / view.tick_ms()));
  std::map<std::uint32_t, std::size_t> senders;
  for (const Arrival& arrival : input.arrivals) {
    if (arrival.tick <= tick && arrival.tick + recent_ticks > tick) {
      ++result.recent_spikes;
      ++senders[arrival.pre];
    }
  }
  std::vector<std::pair<std::uint32_t, std::size_t>> order(senders.begin(), senders.end());
  std::stable_sort(order.begin(), order.end(), [](const auto& x, const auto& y) { return x.second > y.second; });
  for (std::size_t k = 0; k < std::min(order.size(), kMostSenders); ++k) {
    result.recent_neurons.push_back(fmt::format("{} {}x", name_of(view, order[k].first), order[k].second));
  }
  return result;
}

}  // namespace

NeuronWhy why_neuron(const RecordedCircuit& run, std::uint32_t neuron, double at_s) {
  const CircuitView& view = run.view;
  const SpikeTicks spikes = spike_ticks(run.recording.spikes, view.image.header.neuron_count);
  const auto at = static_cast<std::uint32_t>(std::llround(std::max(0.0, at_s) * 1e3 / view.tick_ms()));
  NeuronWhy why;
  why.neuron = name_of(view, neuron);
  std::uint32_t tick = at;
  std::uint32_t nearest = static_cast<std::uint32_t>(kNearMs / view.tick_ms());
  for (const std::uint32_t fired : spikes[neuron]) {
    const std::uint32_t gap = fired > at ? fired - at : at - fired;
    if (gap <= nearest) {
      nearest = gap;
      tick = fired;
      why.fires = true;
    }
  }
  const NeuronSetup setup = neuron_setup(view, spikes, neuron, tick);
  why.time_ms = tick * view.tick_ms();
  why.model = setup.model;
  why.account = account_of(setup, tick);
  for (std::size_t k = 0; k < setup.inputs.size(); ++k) {
    why.shares.push_back(share_of(view, setup.inputs[k], why.account.shares[k], tick));
  }
  std::stable_sort(why.shares.begin(), why.shares.end(), [](const NeuronShare& x, const NeuronShare& y) {
    return std::abs(x.share.potential) > std::abs(y.share.potential);
  });
  return why;
}

std::string why_text(const NeuronWhy& why) {
  constexpr double kWorthALine = 1e-4;
  std::string text = fmt::format("{} {} at {:.1f} ms", why.neuron, why.fires ? "fires" : "does not fire", why.time_ms);
  const NeuronAccount& account = why.account;
  const std::string unit = account.unit.empty() ? "" : " " + account.unit;
  if (account.has_potential) {
    const char* relation = account.is_refractory                    ? "refractory"
                           : account.potential >= account.threshold ? "reaches"
                                                                    : "stays below";
    text += account.is_refractory ? ": it is still refractory\n"
                                  : fmt::format(": its {} of {:.2f}{} {} the threshold of {:g}{}\n",
                                                account.unit.empty() ? "input" : "potential", account.potential, unit,
                                                relation, account.threshold, unit);
    if (!account.unit.empty()) {
      text += fmt::format("  {:>9.2f}{}  rest, bias and what its last reset left\n", account.own, unit);
    }
  } else {
    text += fmt::format(": a {} neuron, {}\n", why.model, why.shares.empty() ? "which takes no input" : "driven by");
  }
  bool has_line = false;
  for (const NeuronShare& share : why.shares) {
    if (std::abs(share.share.potential) < kWorthALine) {
      continue;
    }
    has_line = true;
    text += fmt::format("  {:>+9.2f}{}  {}, {}: {} spikes in the last {:g} ms", share.share.potential,
                        account.has_potential ? unit : " " + share.unit, share.where, share.projection,
                        share.recent_spikes, kRecentMs);
    text +=
        share.recent_neurons.empty() ? "\n" : fmt::format(", first of all {}\n", fmt::join(share.recent_neurons, ", "));
  }
  if (!has_line && !why.shares.empty()) {
    text += "  nothing has reached it\n";
  }
  return text;
}

double six_digits(double value) { return std::strtod(fmt::format("{:.6g}", value).c_str(), nullptr); }

std::string why_json(const NeuronWhy& why) {
  nlohmann::ordered_json json;
  json["neuron"] = why.neuron;
  json["time_ms"] = why.time_ms;
  json["fires"] = why.fires;
  json["model"] = why.model;
  if (why.account.has_potential) {
    json["unit"] = why.account.unit;
    json["potential"] = six_digits(why.account.potential);
    json["threshold"] = why.account.threshold;
    json["own"] = six_digits(why.account.own);
    json["refractory"] = why.account.is_refractory;
  }
  json["shares"] = nlohmann::ordered_json::array();
  for (const NeuronShare& share : why.shares) {
    json["shares"].push_back({{"projection", share.projection},
                              {"where", share.where},
                              {"potential", six_digits(share.share.potential)},
                              {"input", six_digits(share.share.input)},
                              {"input_unit", share.unit},
                              {"recent_spikes", share.recent_spikes},
                              {"recent_neurons", share.recent_neurons}});
  }
  return json.dump(2);
}

NamedNeuron find_neuron(const CircuitView& view, const std::string& name) {
  const std::size_t bracket = name.find('[');
  std::uint32_t index = 0;
  const char* const begin = bracket == std::string::npos ? nullptr : name.data() + bracket + 1;
  const auto read =
      begin == nullptr ? std::from_chars_result{} : std::from_chars(begin, name.data() + name.size(), index);
  if (begin == nullptr || read.ec != std::errc() || std::string_view(read.ptr) != "]") {
    return {std::nullopt, fmt::format("`{}` names no neuron; write it as EBN.left[3]", name)};
  }
  const std::string wanted = name.substr(0, bracket);
  for (const PopulationView& population : view.populations) {
    if (population.name != wanted) {
      continue;
    }
    if (index >= population.size) {
      return {std::nullopt, fmt::format("{} has neurons 0 to {}, and no {}", wanted, population.size - 1, index)};
    }
    return {population.first_neuron + index, ""};
  }
  std::string sides;
  for (const PopulationView& population : view.populations) {
    if (sided_name(population.name).base == wanted) {
      sides += (sides.empty() ? "" : " or ") + population.name;
    }
  }
  return {std::nullopt, fmt::format("no population `{}`{}", wanted, sides.empty() ? "" : "; there is " + sides)};
}

}  // namespace tectum
