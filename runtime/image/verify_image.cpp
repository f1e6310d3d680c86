#include "runtime/image/verify_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "runtime/image/models.h"
#include "runtime/image/program.h"
#include "runtime/image/verify_parts.h"

namespace tectum {

namespace {

std::string number(std::uint64_t value) { return std::to_string(value); }

bool is_range(std::uint64_t first, std::uint64_t count, std::uint64_t limit) {
  return first <= limit && count <= limit - first;
}

bool is_name(const SpikeImage& image, std::uint32_t offset) { return offset < image.strings.size(); }
bool is_name_or_none(const SpikeImage& image, std::uint32_t offset) {
  return offset == kNoString || is_name(image, offset);
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

std::string verify_header(const SpikeImage& image) {
  constexpr std::uint64_t kMaxTickNs = 1'000'000'000;
  if (image.header.tick_ns == 0 || image.header.tick_ns > kMaxTickNs) {
    return "tick of " + number(image.header.tick_ns) + " ns is outside 1 ns to 1 s";
  }
  if (!image.strings.empty() && image.strings.back() != '\0') {
    return "the strings do not end with NUL";
  }
  if (!is_name_or_none(image, image.header.circuit_name)) {
    return "the circuit's name is outside the strings";
  }
  return {};
}

std::string verify_populations(const SpikeImage& image) {
  std::uint64_t next = 0;
  for (std::size_t p = 0; p < image.populations.size(); ++p) {
    const PopulationRecord& population = image.populations[p];
    const std::string where = "population " + number(p);
    if (!is_name(image, population.name) || !is_name_or_none(image, population.nucleus)) {
      return where + ": name outside the strings";
    }
    if (population.first_neuron != next || population.size == 0) {
      return where + ": neurons [" + number(population.first_neuron) + ", +" + number(population.size) +
             ") do not follow the last population";
    }
    next += population.size;
  }
  if (next != image.header.neuron_count) {
    return "the populations have " + number(next) + " neurons, the header says " + number(image.header.neuron_count);
  }
  return {};
}

// Values of parameter p: the shared one, or the column's.
std::span<const double> parameter_values(const SpikeImage& image, const GroupRecord& group, std::uint32_t p) {
  const std::uint32_t mask = group.flags >> kGroupColumnShift;
  if (((mask >> p) & 1U) == 0) {
    return image.parameters.subspan(group.parameter_begin + p, 1);
  }
  const auto column = static_cast<std::size_t>(std::popcount(mask & ((1U << p) - 1U)));
  return image.columns.subspan(group.column_begin + column * group.size, group.size);
}

std::string verify_parameters(const SpikeImage& image, const GroupRecord& group, const ModelInfo& model) {
  const auto parameter_count = static_cast<std::uint32_t>(model.parameters.size());
  const std::uint32_t mask = group.flags >> kGroupColumnShift;
  if (group.parameter_count != parameter_count + 2 * group.receptor_count ||
      !is_range(group.parameter_begin, group.parameter_count, image.parameters.size())) {
    return "parameters outside their section or of the wrong number";
  }
  if (parameter_count < 24 && (mask >> parameter_count) != 0) {
    return "a column for a parameter that does not exist";
  }
  const auto columns = static_cast<std::uint32_t>(std::popcount(mask));
  if (group.column_count != columns ||
      !is_range(group.column_begin, std::uint64_t{columns} * group.size, image.columns.size())) {
    return "columns outside their section or of the wrong number";
  }
  for (std::uint32_t p = 0; p < parameter_count; ++p) {
    const ParameterInfo& info = model.parameters[p];
    if (((mask >> p) & 1U) != 0 && !info.may_vary) {
      return std::string(info.name) + " must not vary from neuron to neuron";
    }
    for (const double value : parameter_values(image, group, p)) {
      const bool is_above = info.minimum_is_allowed ? value >= info.minimum : value > info.minimum;
      if (!std::isfinite(value) || !is_above || value > info.maximum) {
        return std::string(info.name) + " is " + std::to_string(value);
      }
    }
  }
  return {};
}

std::string verify_ticks(const SpikeImage& image, const GroupRecord& group, const ModelInfo& model) {
  const auto refractory = find_parameter(model, "t_ref");
  if (refractory) {
    const double ticks =
        image.parameters[group.parameter_begin + *refractory] * 1e6 / static_cast<double>(image.header.tick_ns);
    if (ticks > kMaxRefractoryTicks || std::abs(ticks - std::round(ticks)) > 1e-6 * std::max(1.0, ticks)) {
      return "t_ref is " + std::to_string(ticks) + " ticks";
    }
  }
  if (group.model == ModelKind::Poisson || group.model == ModelKind::FieldSource) {
    const double max_rate_hz = 1e9 / static_cast<double>(image.header.tick_ns) * (1 + 1e-9);
    for (const double rate_hz : parameter_values(image, group, source_parameter::kRate)) {
      if (rate_hz > max_rate_hz) {
        return "rate of " + std::to_string(rate_hz) + " Hz is more than one spike a tick";
      }
    }
  }
  return {};
}

std::string verify_receptors(const SpikeImage& image, const GroupRecord& group, std::size_t parameter_count,
                             std::uint32_t receptor_kinds) {
  for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
    const ReceptorRecord& receptor = image.receptors[group.first_receptor + r];
    const auto kind = static_cast<std::uint32_t>(receptor.kind);
    if (!is_name(image, receptor.name)) {
      return "receptor name outside the strings";
    }
    if (kind > 31 || ((receptor_kinds >> kind) & 1U) == 0) {
      return "receptor of kind " + number(kind);
    }
    if (receptor.quantum_log2 < kMinQuantumLog2 || receptor.quantum_log2 > kMaxQuantumLog2) {
      return "receptor with a quantum of 2^" + std::to_string(receptor.quantum_log2);
    }
    const bool is_boxcar = receptor.kind == ReceptorKind::Boxcar;
    if (is_boxcar != (receptor.window_ticks > 0) || receptor.window_ticks > kMaxWindowTicks) {
      return "receptor with a window of " + number(receptor.window_ticks) + " ticks";
    }
    const std::size_t at = group.parameter_begin + parameter_count + r;
    const double tau_ms = image.parameters[at];
    const double decay = image.parameters[at + group.receptor_count];
    const bool is_exponential = receptor.kind == ReceptorKind::Exponential;
    const bool is_right =
        is_exponential ? std::isfinite(tau_ms) && tau_ms > 0 && decay >= 0 && decay < 1 : tau_ms == 0 && decay == 0;
    if (!is_right) {
      return "receptor with tau " + std::to_string(tau_ms) + " ms and decay " + std::to_string(decay);
    }
  }
  return {};
}

std::string verify_tables(const SpikeImage& image, const GroupRecord& group, const ModelInfo& model) {
  const bool may_sleep = (group.flags & kGroupMaySleep) != 0;
  if (may_sleep && !model.may_sleep) {
    return "its model cannot sleep";
  }
  if (group.table_count != table_size(group.model, group.receptor_count, group.size, may_sleep) ||
      !is_range(group.table_begin, group.table_count, image.tables.size())) {
    return "table outside its section or of the wrong size";
  }
  const auto table = image.tables.subspan(group.table_begin, group.table_count);
  if (!std::all_of(table.begin(), table.end(), [](float value) { return std::isfinite(value); })) {
    return "a table entry is no number";
  }
  return {};
}

std::string verify_source_spikes(const SpikeImage& image, const GroupRecord& group) {
  if (group.model != ModelKind::SpikeList) {
    return group.data_count == 0 && group.data_begin == 0 ? "" : "data where the model has none";
  }
  if (group.data_count % 2 != 0 || !is_range(group.data_begin, group.data_count, image.source_spikes.size())) {
    return "spike list outside its section";
  }
  const auto words = image.source_spikes.subspan(group.data_begin, group.data_count);
  for (std::size_t k = 0; k < words.size(); k += 2) {
    const bool follows = k == 0 || words[k] > words[k - 2] || (words[k] == words[k - 2] && words[k + 1] > words[k - 1]);
    if (!follows || words[k + 1] >= group.size) {
      return "spike list entry " + number(k / 2) + " is out of order or of no neuron";
    }
  }
  return {};
}

// Any kind of receptor, and the layout of runtime/image/program.h.
std::string verify_program_group(const SpikeImage& image, const GroupRecord& group) {
  constexpr std::uint32_t kAnyReceptor = 0b1110;  // bit k: ReceptorKind k
  if (group.flags != 0 || group.table_count != 0 || group.receptor_count > kMaxReceptors ||
      !is_range(group.data_begin, group.data_count, image.programs.size())) {
    return "program outside its section, or with flags, a table or too many receptors";
  }
  std::string error;
  if (!verify_program(image.programs.subspan(group.data_begin, group.data_count), error)) {
    return error;
  }
  const ProgramHeader header = program_header(image.programs.subspan(group.data_begin, group.data_count));
  const std::uint64_t parameter_count = std::uint64_t{header.constant_count} + 2 * group.receptor_count;
  if (header.input_count != group.receptor_count || header.column_count != group.column_count ||
      group.parameter_count != parameter_count || header.refractory_ticks > kMaxRefractoryTicks ||
      !is_range(group.parameter_begin, group.parameter_count, image.parameters.size()) ||
      !is_range(group.column_begin, std::uint64_t{group.column_count} * group.size, image.columns.size())) {
    return "program does not fit its group's parameters, columns or receptors";
  }
  return verify_receptors(image, group, header.constant_count, kAnyReceptor);
}

std::string verify_group(const SpikeImage& image, const GroupRecord& group) {
  if (group.model == ModelKind::Program) {
    return verify_program_group(image, group);
  }
  const ModelInfo* model = find_model(group.model);
  if (model == nullptr) {
    return "unknown model " + number(static_cast<std::uint32_t>(group.model));
  }
  if ((group.flags & ~(kGroupMaySleep | (~0U << kGroupColumnShift))) != 0) {
    return "unknown flags";
  }
  if (group.receptor_count < model->min_receptors || group.receptor_count > model->max_receptors) {
    return number(group.receptor_count) + " receptors";
  }
  std::string error = verify_parameters(image, group, *model);
  if (error.empty()) {
    error = verify_ticks(image, group, *model);
  }
  if (error.empty()) {
    error = verify_receptors(image, group, model->parameters.size(), model->receptor_kinds);
  }
  if (error.empty()) {
    error = verify_tables(image, group, *model);
  }
  if (error.empty()) {
    error = verify_source_spikes(image, group);
  }
  return error;
}

// Groups tile the neurons (each inside one population), the receptors and the slots.
std::string verify_groups(const SpikeImage& image) {
  struct Range {
    std::uint64_t first, count;
  };
  std::vector<Range> neurons;
  std::vector<Range> slots;
  std::uint64_t next_receptor = 0;
  std::uint64_t next_program_word = 0;
  for (std::size_t g = 0; g < image.groups.size(); ++g) {
    const GroupRecord& group = image.groups[g];
    const std::string where = "group " + number(g) + ": ";
    if (group.population >= image.populations.size()) {
      return where + "population " + number(group.population) + " does not exist";
    }
    const PopulationRecord& population = image.populations[group.population];
    if (group.size == 0 || group.first_neuron < population.first_neuron ||
        !is_range(group.first_neuron - population.first_neuron, group.size, population.size)) {
      return where + "neurons outside its population";
    }
    if (group.first_receptor != next_receptor ||
        !is_range(group.first_receptor, group.receptor_count, image.receptors.size())) {
      return where + "receptors do not follow the last group's";
    }
    next_receptor += group.receptor_count;
    if (group.model == ModelKind::Program) {
      if (group.data_begin != next_program_word) {
        return where + "program does not follow the last group's";
      }
      next_program_word += group.data_count;
    }
    neurons.push_back({group.first_neuron, group.size});
    slots.push_back({group.first_slot, std::uint64_t{group.receptor_count} * group.size});
    const std::string error = verify_group(image, group);
    if (!error.empty()) {
      return where + error;
    }
  }
  if (next_receptor != image.receptors.size()) {
    return "receptors that belong to no group";
  }
  if (next_program_word != image.programs.size()) {
    return "equation programs that belong to no group";
  }
  const auto tile = [](std::vector<Range>& ranges, std::uint64_t total) {
    std::erase_if(ranges, [](const Range& range) { return range.count == 0; });
    std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
    std::uint64_t next = 0;
    for (const Range& range : ranges) {
      if (range.first != next) {
        return false;
      }
      next += range.count;
    }
    return next == total;
  };
  if (!tile(neurons, image.header.neuron_count)) {
    return "the groups leave out or share neurons";
  }
  if (!tile(slots, image.header.slot_count)) {
    return "the groups leave out or share slots";
  }
  return {};
}

}  // namespace

std::string verify_image(const SpikeImage& image) {
  for (const auto check :
       {verify_header, verify_populations, verify_groups, verify_synapses, verify_plasticity, verify_ports}) {
    std::string error = check(image);
    if (!error.empty()) {
      return error;
    }
  }
  return all_finite(image.columns) && all_finite(image.parameters) ? "" : "a parameter is no number";
}

}  // namespace tectum
