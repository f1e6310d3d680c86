#include "tools/exchange/format_limits.h"

#include <fmt/format.h>

namespace tectum {
namespace {

constexpr std::size_t kNamesShown = 6;

}  // namespace

std::string list_names(const std::vector<std::string>& names) {
  std::string text;
  const std::size_t shown = names.size() <= kNamesShown + 1 ? names.size() : kNamesShown;
  for (std::size_t i = 0; i < shown; ++i) {
    const bool is_last = i + 1 == names.size();
    text += (i == 0 ? "" : is_last ? " and " : ", ") + ("`" + names[i] + "`");
  }
  return shown < names.size() ? fmt::format("{} and {} more", text, names.size() - shown) : text;
}

std::vector<std::string> head_limits(const Wiring& wiring, std::string_view format) {
  std::vector<std::string> limits;
  std::vector<std::string> names;
  for (const NetworkRetina& retina : wiring.network.retinas) {
    names.push_back(retina.retina.name);
  }
  if (!names.empty()) {
    limits.push_back(fmt::format("{} has no retinas: left out {}", format, list_names(names)));
  }
  names.clear();
  for (const Output& output : wiring.network.outputs) {
    names.push_back(output.name);
  }
  if (!names.empty()) {
    limits.push_back(fmt::format("{} has no joints to move: left out the outputs {}", format, list_names(names)));
  }
  for (std::string& limit : learning_limits(wiring, format)) {
    limits.push_back(std::move(limit));
  }
  return limits;
}

std::vector<std::string> learning_limits(const Wiring& wiring, std::string_view format) {
  std::vector<std::string> names;
  for (const Projection& projection : wiring.circuit.projections) {
    if (projection.plasticity) {
      names.push_back(projection.name);
    }
  }
  if (names.empty()) {
    return {};
  }
  return {fmt::format("{} does not learn by reward: the weights of {} stay as they are at the start", format,
                      list_names(names))};
}

std::vector<std::string> head_and_model_limits(const Wiring& wiring, std::string_view format) {
  std::vector<std::string> limits = head_limits(wiring, format);
  limits.push_back(
      fmt::format("{} has no neuron models: the parameters of {} populations are left out, their models are named",
                  format, wiring.network.populations.size()));
  return limits;
}

}  // namespace tectum
