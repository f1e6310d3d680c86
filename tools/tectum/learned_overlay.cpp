#include "tools/tectum/learned_overlay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "compiler/format/format_circuit.h"
#include "runtime/image/plasticity.h"

namespace tectum {
namespace {

namespace fs = std::filesystem;

/// Half of 2^-28 is 1.9e-9: nine decimals tell all factors apart.
std::string factor_text(std::int32_t scale) {
  std::string text = fmt::format("{:.9f}", std::ldexp(scale, -kScaleBits));
  text.erase(text.find_last_not_of('0') + 1);
  return text.back() == '.' ? text + "0" : text;
}

std::string pathway_name(const SpikeImage& image, const PlasticityRecord& rule) {
  const ProjectionRecord& projection = image.projections[rule.projection];
  return fmt::format("{}->{}", image.name(image.populations[projection.pre_population].name),
                     image.name(image.populations[projection.post_population].name));
}

/// Factors in the order in which the circuit makes the synapses; 1 for those that a lesion took.
std::vector<std::int32_t> declared_order(const SpikeImage& image, const PlasticityRecord& rule,
                                         std::span<const std::int32_t> scales) {
  std::vector<std::int32_t> ordered(rule.listed_count, kScaleOne);
  for (std::uint32_t s = rule.first_synapse; s < rule.first_synapse + rule.synapse_count; ++s) {
    ordered[image.plastic_synapses[s].ordinal] = scales[s];
  }
  return ordered;
}

std::string json_text(std::string_view text) { return nlohmann::json(std::string(text)).dump(); }

std::string relative_to(const std::string& circuit_path, const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::absolute(path, error).parent_path();
  const fs::path relative = fs::absolute(circuit_path, error).lexically_relative(folder);
  return relative.empty() ? circuit_path : relative.generic_string();
}

}  // namespace

std::string learned_overlay(const SpikeImage& image, std::span<const std::int32_t> scales,
                            const std::string& circuit_path, const std::string& path) {
  std::vector<std::int32_t> initial;
  for (const PlasticSynapseRecord& synapse : image.plastic_synapses) {
    initial.push_back(synapse.scale);
  }
  std::map<std::string, std::string> projections;  // "pathway": [factors], ...
  for (const PlasticityRecord& rule : image.plasticity) {
    const std::vector<std::int32_t> factors = declared_order(image, rule, scales);
    if (factors == declared_order(image, rule, initial)) {
      continue;
    }
    std::string list;
    for (const std::int32_t scale : factors) {
      list += (list.empty() ? "" : ", ") + factor_text(scale);
    }
    std::string& of_projection = projections[std::string(image.name(image.projections[rule.projection].name))];
    of_projection +=
        fmt::format("{}{}: [{}]", of_projection.empty() ? "" : ",\n", json_text(pathway_name(image, rule)), list);
  }
  std::string text = "// Factors on the declared weights, as `tectum run --learn --save-weights` left them.\n";
  text += fmt::format("{{\n\"tectum\": 1, \"extends\": {},\n\"projections\": {{\n",
                      json_text(relative_to(circuit_path, path)));
  bool is_first = true;
  for (const auto& [name, pathways] : projections) {
    text += fmt::format("{}{}: {{\n\"plasticity\": {{\n\"learned\": {{\n{}\n}}\n}}\n}}", is_first ? "" : ",\n",
                        json_text(name), pathways);
    is_first = false;
  }
  text += "\n}\n}\n";
  return format_circuit(text).text.value_or(text);
}

std::string learned_text(const SpikeImage& image, std::span<const std::int32_t> scales) {
  std::string text =
      "learned                                             weights   mean    least   most, of the declared ones\n";
  for (const PlasticityRecord& rule : image.plasticity) {
    const auto own = scales.subspan(rule.first_synapse, rule.synapse_count);
    double sum = 0;
    for (const std::int32_t scale : own) {
      sum += std::ldexp(scale, -kScaleBits);
    }
    const auto [least, most] = std::minmax_element(own.begin(), own.end());
    text += fmt::format("{:<18}  {:<28}  {:>9}  {:>5.3f}  {:>7.3f}  {:>5.3f}\n",
                        image.name(image.projections[rule.projection].name), pathway_name(image, rule), own.size(),
                        sum / static_cast<double>(own.size()), std::ldexp(*least, -kScaleBits),
                        std::ldexp(*most, -kScaleBits));
  }
  return text;
}

}  // namespace tectum
