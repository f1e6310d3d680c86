#include "runtime/image/describe_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>

#include "runtime/image/models.h"
#include "runtime/image/program.h"
#include "runtime/image/section_table.h"

namespace tectum {
namespace {

constexpr std::array<const char*, kSectionKindCount + kPlasticSectionKindCount + 1> kSectionNames = {
    "",           "strings",          "populations", "groups",   "receptors",
    "parameters", "columns",          "tables",      "rows",     "segments",
    "targets",    "weights",          "projections", "retinas",  "fields",
    "outputs",    "output terms",     "joints",      "programs", "source spikes",
    "plasticity", "plastic synapses", "decays"};

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
  std::va_list arguments;
  va_start(arguments, pattern);
  std::va_list again;
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, pattern, arguments);
  va_end(arguments);
  std::string text(static_cast<std::size_t>(std::max(length, 0)), '\0');
  std::vsnprintf(text.data(), text.size() + 1, pattern, again);
  va_end(again);
  return text;
}

// A program has neither a name nor named parameters.
std::string_view model_name(ModelKind kind) {
  const ModelInfo* model = find_model(kind);
  return model == nullptr ? "equations" : model->name;
}
std::span<const ParameterInfo> parameters_of(const GroupRecord& group) {
  const ModelInfo* model = find_model(group.model);
  return model == nullptr ? std::span<const ParameterInfo>{} : model->parameters;
}

class Describer {
 public:
  Describer(const SpikeImage& image, const DescribeOptions& options) : image_(image), options_(options) {
    for (const GroupRecord& group : image.groups) {
      if (group.receptor_count > 0) {
        group_by_slot_[group.first_slot] = &group;
      }
    }
  }

  std::string describe();

 private:
  // Where `element` of the section lies in the file.
  template <typename T>
  std::uint64_t offset_of(const T* element) const {
    return static_cast<std::uint64_t>(reinterpret_cast<const char*>(element) - file_begin());
  }
  const char* file_begin() const {
    // The first section is never empty of position: its span starts right after the section table.
    return reinterpret_cast<const char*>(image_.strings.data()) - first_section_bytes();
  }
  std::uint64_t first_section_bytes() const {
    const std::size_t table_end = sizeof(FileHeader) + image_.header.section_count * sizeof(SectionEntry);
    return (table_end + kSectionAlignBytes - 1) / kSectionAlignBytes * kSectionAlignBytes;
  }

  void line(const std::string& text) { text_ += text + "\n"; }
  template <typename T>
  void record(const T& element, const std::string& text) {
    line(format("%10llu %6zu    ", static_cast<unsigned long long>(offset_of(&element)), sizeof(T)) + text);
  }

  // Calls show(element, index) for all elements or for the first few.
  template <typename T, typename Show>
  void section(SectionKind kind, std::span<const T> elements, Show show) {
    const auto k = static_cast<std::size_t>(kind);
    line(format("%10llu %6s  section %zu, %s: %zu x %zu bytes",
                static_cast<unsigned long long>(offset_of(elements.data())), "", k, kSectionNames[k], elements.size(),
                sizeof(T)));
    const std::size_t shown = options_.in_full ? elements.size() : std::min(elements.size(), options_.records_an_array);
    for (std::size_t i = 0; i < shown; ++i) {
      show(elements[i], i);
    }
    if (shown < elements.size()) {
      line(format("%17s    … %zu more", "", elements.size() - shown));
    }
  }

  std::string quoted(std::uint32_t offset) const {
    return offset == kNoString ? "none" : format("`%s`", std::string(image_.name(offset)).c_str());
  }
  std::string neurons(std::uint32_t first, std::uint32_t size) const {
    return format("neurons %u..%u", first, first + size - 1);
  }
  std::string neuron_name(std::uint32_t neuron) const;
  std::string slot_name(std::uint32_t slot, double* quantum) const;
  std::string group_flags(const GroupRecord& group) const;

  void header();
  void strings();
  void populations();
  void groups();
  void receptors();
  void parameters();
  void columns();
  void tables();
  void rows();
  void segments();
  void synapses();
  void projections();
  void senses();
  void actions();
  void source_spikes();
  void plasticity();

  const SpikeImage& image_;
  const DescribeOptions& options_;
  std::map<std::uint32_t, const GroupRecord*> group_by_slot_;
  std::string text_;
};

std::string Describer::neuron_name(std::uint32_t neuron) const {
  const auto after =
      std::upper_bound(image_.populations.begin(), image_.populations.end(), neuron,
                       [](std::uint32_t n, const PopulationRecord& population) { return n < population.first_neuron; });
  const PopulationRecord& population = *std::prev(after);
  return std::string(image_.name(population.name)) + format("[%u]", neuron - population.first_neuron);
}

std::string Describer::slot_name(std::uint32_t slot, double* quantum) const {
  const GroupRecord& group = *std::prev(group_by_slot_.upper_bound(slot))->second;
  const std::uint32_t r = (slot - group.first_slot) / group.size;
  const ReceptorRecord& receptor = image_.receptors[group.first_receptor + r];
  if (quantum != nullptr) {
    *quantum = std::ldexp(1.0, receptor.quantum_log2);
  }
  return neuron_name(group.first_neuron + (slot - group.first_slot) % group.size) + "." +
         std::string(image_.name(receptor.name));
}

void Describer::header() {
  const FileHeader& h = image_.header;
  line("    offset  bytes    meaning");
  line(format("         0     64  header: magic TECTUM, version %u, %u sections, %llu bytes, checksum %016llx",
              h.version, h.section_count, static_cast<unsigned long long>(h.file_bytes),
              static_cast<unsigned long long>(h.checksum)));
  line(format("%17s    circuit %s, tick %g ms, seed %llu", "", quoted(h.circuit_name).c_str(),
              static_cast<double>(h.tick_ns) * 1e-6, static_cast<unsigned long long>(h.seed)));
  line(format("%17s    %u neurons, %u slots, %zu synapses, longest delay %u ticks", "", h.neuron_count, h.slot_count,
              image_.targets.size(), h.max_delay_ticks));
  line(format("        64 %6zu  section table", std::size_t{h.section_count} * sizeof(SectionEntry)));
}

void Describer::strings() {
  std::vector<std::pair<std::size_t, std::string_view>> names;
  for (std::size_t at = 0; at < image_.strings.size(); at += names.back().second.size() + 1) {
    names.emplace_back(at, std::string_view(image_.strings.data() + at));
  }
  line(format("%10llu %6s  section 1, strings: %zu x 1 bytes, %zu names",
              static_cast<unsigned long long>(offset_of(image_.strings.data())), "", image_.strings.size(),
              names.size()));
  const std::size_t shown = options_.in_full ? names.size() : std::min(names.size(), options_.records_an_array);
  for (std::size_t i = 0; i < shown; ++i) {
    line(format("%10llu %6zu    `", static_cast<unsigned long long>(offset_of(image_.strings.data() + names[i].first)),
                names[i].second.size() + 1) +
         std::string(names[i].second) + "`");
  }
  if (shown < names.size()) {
    line(format("%17s    … %zu more", "", names.size() - shown));
  }
}

void Describer::populations() {
  section(SectionKind::Populations, image_.populations, [&](const PopulationRecord& p, std::size_t i) {
    record(p, format("population %zu %s, nucleus %s, ", i, quoted(p.name).c_str(), quoted(p.nucleus).c_str()) +
                  neurons(p.first_neuron, p.size));
  });
}

std::string Describer::group_flags(const GroupRecord& group) const {
  std::string text = (group.flags & kGroupMaySleep) != 0 ? ", may sleep" : "";
  std::string varying;
  for (std::uint32_t p = 0; p < parameters_of(group).size(); ++p) {
    if (((group.flags >> (kGroupColumnShift + p)) & 1U) != 0) {
      varying += (varying.empty() ? "" : ", ") + std::string(parameters_of(group)[p].name);
    }
  }
  return varying.empty() ? text : text + ", one value a neuron: " + varying;
}

void Describer::groups() {
  section(SectionKind::Groups, image_.groups, [&](const GroupRecord& g, std::size_t i) {
    record(g, format("group %zu of %s: %s, ", i, quoted(image_.populations[g.population].name).c_str(),
                     std::string(model_name(g.model)).c_str()) +
                  neurons(g.first_neuron, g.size) +
                  format(", %u receptors, slots from %u", g.receptor_count, g.first_slot) + group_flags(g));
  });
}

void Describer::receptors() {
  section(SectionKind::Receptors, image_.receptors, [&](const ReceptorRecord& r, std::size_t i) {
    std::string owner = "?";
    for (const GroupRecord& group : image_.groups) {
      if (i >= group.first_receptor && i < group.first_receptor + group.receptor_count) {
        owner = std::string(image_.name(image_.populations[group.population].name));
      }
    }
    record(r, format("receptor %zu %s of `%s`: %s, quantum 2^%d", i, quoted(r.name).c_str(), owner.c_str(),
                     std::string(receptor_kind_name(r.kind)).c_str(), r.quantum_log2) +
                  (r.window_ticks > 0 ? format(", window %u ticks", r.window_ticks) : ""));
  });
}

void Describer::parameters() {
  std::vector<std::string> meaning(image_.parameters.size(), "unused");
  for (std::size_t g = 0; g < image_.groups.size(); ++g) {
    const GroupRecord& group = image_.groups[g];
    const std::string owner = std::string(image_.name(image_.populations[group.population].name));
    std::size_t at = group.parameter_begin;
    if (group.model == ModelKind::Program) {
      for (std::uint32_t k = 0; k + 2 * group.receptor_count < group.parameter_count; ++k) {
        meaning[at++] = owner + format(" constant %u", k);
      }
    }
    for (const ParameterInfo& info : parameters_of(group)) {
      meaning[at++] = owner + "." + std::string(info.name) + (info.unit.empty() ? "" : ", " + std::string(info.unit));
    }
    for (const char* what : {"tau, ms", "decay a tick"}) {
      for (std::uint32_t r = 0; r < group.receptor_count; ++r) {
        const std::uint32_t name = image_.receptors[group.first_receptor + r].name;
        meaning[at++] = owner + "." + std::string(image_.name(name)) + " " + what;
      }
    }
  }
  section(SectionKind::Parameters, image_.parameters,
          [&](const double& value, std::size_t i) { record(value, format("%.17g  ", value) + meaning[i]); });
}

void Describer::columns() {
  section(SectionKind::Columns, image_.columns,
          [&](const double& value, std::size_t) { record(value, format("%.17g", value)); });
}

void Describer::tables() {
  section(SectionKind::Tables, image_.tables,
          [&](const float& value, std::size_t) { record(value, format("%.9g", static_cast<double>(value))); });
}

void Describer::rows() {
  section(SectionKind::RowBegin, image_.row_begin, [&](const std::uint32_t& first, std::size_t i) {
    record(first, i < image_.header.neuron_count ? format("row of neuron %zu %s starts at segment %u", i,
                                                          neuron_name(static_cast<std::uint32_t>(i)).c_str(), first)
                                                 : format("end of the last row: segment %u", first));
  });
}

void Describer::segments() {
  section(SectionKind::Segments, image_.segments, [&](const SegmentRecord& s, std::size_t i) {
    if (i + 1 == image_.segments.size()) {
      record(s, format("sentinel: %u targets, %u weights", s.target_begin, s.weight_begin));
      return;
    }
    const auto row =
        std::upper_bound(image_.row_begin.begin(), image_.row_begin.end(), i) - image_.row_begin.begin() - 1;
    record(s, format("segment %zu of %s: delay %u ticks, %u targets from %u, %s %u", i,
                     neuron_name(static_cast<std::uint32_t>(row)).c_str(), s.delay_ticks,
                     image_.segments[i + 1].target_begin - s.target_begin, s.target_begin,
                     (s.flags & kSegmentOneWeight) != 0 ? "all with weight" : "weights from", s.weight_begin));
  });
}

void Describer::synapses() {
  std::size_t segment = 0;
  section(SectionKind::Targets, image_.targets, [&](const std::uint32_t& slot, std::size_t i) {
    while (image_.segments[segment + 1].target_begin <= i) {
      ++segment;
    }
    const SegmentRecord& record_of = image_.segments[segment];
    const bool has_one_weight = (record_of.flags & kSegmentOneWeight) != 0;
    const std::size_t w = record_of.weight_begin + (has_one_weight ? 0 : i - record_of.target_begin);
    const auto row =
        std::upper_bound(image_.row_begin.begin(), image_.row_begin.end(), segment) - image_.row_begin.begin() - 1;
    double quantum = 0;
    const std::string target = slot_name(slot, &quantum);
    record(slot, format("slot %u: %s -> %s, %u ticks, weight %d quanta = %.9g", slot,
                        neuron_name(static_cast<std::uint32_t>(row)).c_str(), target.c_str(), record_of.delay_ticks,
                        image_.weights[w], quantum * image_.weights[w]));
  });
  section(SectionKind::Weights, image_.weights,
          [&](const std::int32_t& weight, std::size_t) { record(weight, format("%d quanta", weight)); });
}

void Describer::projections() {
  section(SectionKind::Projections, image_.projections, [&](const ProjectionRecord& p, std::size_t i) {
    record(p, format("projection %zu %s: %s -> %s, receptor %u, %u synapses, cites %s", i, quoted(p.name).c_str(),
                     quoted(image_.populations[p.pre_population].name).c_str(),
                     quoted(image_.populations[p.post_population].name).c_str(), p.receptor, p.synapse_count,
                     quoted(p.cite).c_str()));
  });
}

void Describer::senses() {
  section(SectionKind::Retinas, image_.retinas, [&](const RetinaRecord& r, std::size_t i) {
    record(r, format("retina %zu %s: %s eye, frame %u x %u px over %g deg, lit when %s > %u on >= %g %% of a field, "
                     "fields %u..+%u drive neurons %u..+%u",
                     i, quoted(r.name).c_str(), r.eye == Eye::Left ? "left" : "right", r.frame_width, r.frame_height,
                     r.field_of_view_deg, std::string(lit_channel_name(r.lit_channel)).c_str(), r.lit_above,
                     r.lit_share * 100, r.first_field, r.field_count, r.first_neuron, r.field_count));
  });
  section(SectionKind::Fields, image_.fields, [&](const FieldRecord& f, std::size_t i) {
    record(f, format("field %zu: x %g..%g, y %g..%g px", i, static_cast<double>(f.x0), static_cast<double>(f.x1),
                     static_cast<double>(f.y0), static_cast<double>(f.y1)));
  });
}

void Describer::actions() {
  section(SectionKind::Outputs, image_.outputs, [&](const OutputRecord& o, std::size_t i) {
    std::string joints;
    for (std::uint32_t j = 0; j < kJointCount; ++j) {
      if (((o.joint_mask >> j) & 1U) != 0) {
        joints += std::string(" ") + kJointNames[j];
      }
    }
    record(o, format("output %zu %s: %s, terms %u..+%u, window %u ticks, offset %g deg, to%s", i,
                     quoted(o.name).c_str(), o.kind == OutputKind::Position ? "position" : "velocity", o.first_term,
                     o.term_count, o.window_ticks, o.offset_deg, joints.empty() ? " no joint" : joints.c_str()));
  });
  section(SectionKind::OutputTerms, image_.output_terms, [&](const OutputTermRecord& t, std::size_t i) {
    record(t, format("term %zu: rate of ", i) + neurons(t.first_neuron, t.size) + " (" + neuron_name(t.first_neuron) +
                  format(" on) times %g", t.gain));
  });
  section(SectionKind::Joints, image_.joints, [&](const JointRecord& j, std::size_t) {
    record(j, format("joint %s: %g..%g deg, ", kJointNames[static_cast<std::size_t>(j.joint)], j.min_deg, j.max_deg) +
                  (j.max_speed_deg_s > 0 ? format("at most %g deg/s", j.max_speed_deg_s) : "no slew limit"));
  });
}

void Describer::source_spikes() {
  std::vector<std::string> meaning;
  for (const GroupRecord& group : image_.groups) {
    if (group.model == ModelKind::Program) {
      const auto words = describe_program(image_.programs.subspan(group.data_begin, group.data_count));
      meaning.insert(meaning.end(), words.begin(), words.end());
    }
  }
  section(SectionKind::Programs, image_.programs,
          [&](const std::uint32_t& word, std::size_t i) { record(word, meaning[i]); });
  section(SectionKind::SourceSpikes, image_.source_spikes, [&](const std::uint32_t& word, std::size_t i) {
    record(word, i % 2 == 0 ? format("tick %u", word) : format("  neuron %u of its group", word));
  });
}

void Describer::plasticity() {
  if (image_.plasticity.empty()) {
    return;
  }
  section(SectionKind::Plasticity, image_.plasticity, [&](const PlasticityRecord& p, std::size_t i) {
    record(p, format("plasticity %zu of projection %u %s: %s by reward %s, %u of %u synapses from %u, decays from %u, "
                     "eta %g Hz, r0 %g Hz, %g to %g times the weight",
                     i, p.projection, quoted(image_.projections[p.projection].name).c_str(),
                     kPlasticityFormNames[static_cast<std::size_t>(p.form)],
                     kRewardChannelNames[static_cast<std::size_t>(p.channel)], p.synapse_count, p.listed_count,
                     p.first_synapse, p.first_decay, p.learning_rate_hz, p.reference_rate_hz,
                     std::ldexp(p.lowest, -kScaleBits), std::ldexp(p.highest, -kScaleBits)));
  });
  section(SectionKind::PlasticSynapses, image_.plastic_synapses, [&](const PlasticSynapseRecord& s, std::size_t) {
    record(s, format("target %u, from neuron %u to %u of its populations, declared as number %u: %d quanta times %.9g",
                     s.target, s.pre, s.post, s.ordinal, s.base_quanta, std::ldexp(s.scale, -kScaleBits)));
  });
  constexpr std::array<const char*, kDecaysOfRule> kWhat = {"rate", "mean rate", "eligibility", "expected reward"};
  section(SectionKind::Decays, image_.decays, [&](const double& decay, std::size_t i) {
    record(decay, format("%.17g  what is left of a %s after 2^%zu ticks", decay,
                         kWhat[i / kDecayPowers % kDecaysOfRule], i % kDecayPowers));
  });
}

std::string Describer::describe() {
  header();
  strings();
  populations();
  groups();
  receptors();
  parameters();
  columns();
  tables();
  rows();
  segments();
  synapses();
  projections();
  senses();
  actions();
  source_spikes();
  plasticity();
  line(format("%10llu         end of file", static_cast<unsigned long long>(image_.header.file_bytes)));
  return std::move(text_);
}

}  // namespace

std::string describe_image(const SpikeImage& image, const DescribeOptions& options) {
  return Describer(image, options).describe();
}

}  // namespace tectum
