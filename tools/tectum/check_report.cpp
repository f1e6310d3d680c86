#include "tools/tectum/check_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "compiler/diagnostics/render.h"
#include "compiler/elaborate/symmetry.h"
#include "compiler/lower/worst_case.h"
#include "tools/tectum/provenance_text.h"

namespace tectum {
namespace {

constexpr std::size_t kNamesShown = 6;

std::string count(std::size_t n, const char* what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

/// "mirror left/right (horizontal): symmetric", or what breaks it.
std::string mirror_text(const SymmetryVerdict& verdict, std::size_t synapse_count) {
  std::string text = fmt::format("  mirror {} ({}): ", verdict.sides, verdict.axes.empty() ? "by name" : verdict.axes);
  if (verdict.is_symmetric()) {
    return text + "symmetric\n";
  }
  text +=
      fmt::format("{} of {} synapses without a mirror image; broken by ", verdict.unmatched_synapses, synapse_count);
  const std::size_t shown = std::min(kNamesShown, verdict.broken_by.size());
  text += fmt::format(
      "{}", fmt::join(verdict.broken_by.begin(), verdict.broken_by.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
  return text +
         (shown < verdict.broken_by.size() ? fmt::format(" and {} more\n", verdict.broken_by.size() - shown) : "\n");
}

std::string mirror_json(const SymmetryVerdict& verdict) {
  std::vector<std::string> names;
  for (const std::string& name : verdict.broken_by) {
    names.push_back(json_quoted(name));
  }
  return fmt::format(
      "{{\"sides\": {}, \"axes\": {}, \"symmetric\": {}, \"unmatched_synapses\": {}, \"broken_by\": [{}]}}",
      json_quoted(verdict.sides), json_quoted(verdict.axes), verdict.is_symmetric(), verdict.unmatched_synapses,
      fmt::join(names, ", "));
}

}  // namespace

std::string check_text(const std::string& path, const CompileResult& result) {
  const Network& network = *result.network;
  std::string text = fmt::format("{}: ok, {}, {}, {}\n", path, count(result.circuit->instances.size(), "population"),
                                 count(network.neuron_count(), "neuron"), count(network.synapses.size(), "synapse"));
  for (const SymmetryVerdict& verdict : mirror_symmetry(*result.circuit, network)) {
    text += mirror_text(verdict, network.synapses.size());
  }
  if (result.image) {
    text += fmt::format("  at most {} in one tick; the image takes at most {} bytes\n",
                        count(worst_case(*result.image).synaptic_events, "synaptic event"),
                        write_image(*result.image).size());
  }
  return text;
}

std::string check_json(const CompileResult& result, bool shows_provenance) {
  const Network& network = *result.network;
  std::vector<std::string> mirrors;
  for (const SymmetryVerdict& verdict : mirror_symmetry(*result.circuit, network)) {
    mirrors.push_back("\n  " + mirror_json(verdict));
  }
  std::string text = fmt::format("\"populations\": {}, \"neurons\": {}, \"synapses\": {}, \"mirrors\": [{}]",
                                 result.circuit->instances.size(), network.neuron_count(), network.synapses.size(),
                                 fmt::join(mirrors, ","));
  if (result.image) {
    text += fmt::format(", \"worst_tick_synaptic_events\": {}, \"image_bytes\": {}",
                        worst_case(*result.image).synaptic_events, write_image(*result.image).size());
  }
  if (shows_provenance) {
    text += ", \"provenance\": " + provenance_json(result);
  }
  return text;
}

}  // namespace tectum
