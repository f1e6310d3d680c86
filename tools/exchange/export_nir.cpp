#include "tools/exchange/export_nir.h"

#include <algorithm>
#include <map>
#include <set>

#include "tools/exchange/format_limits.h"
#include "tools/exchange/hdf5_file.h"
#include "tools/exchange/text_file.h"

namespace tectum {
namespace {

constexpr const char* kNirVersion = "1.0";
constexpr double kMsPerS = 1000;
constexpr std::size_t kMaxMatrix = std::size_t{1} << 26U;  // weights are dense in NIR: 512 MB

bool is_source(const NetworkPopulation& population) {
  return population.model == ModelKind::FieldSource || population.model == ModelKind::Poisson ||
         population.model == ModelKind::SpikeList;
}

class NirExport {
 public:
  NirExport(const Wiring& wiring, std::string path, const ExchangeProgress& progress)
      : wiring_(wiring), network_(wiring.network), path_(std::move(path)), progress_(progress) {
    for (std::size_t s = 0; s < network_.synapses.size(); ++s) {
      by_delay_[{network_.synapses.pathway[s], network_.synapses.delay_ticks[s]}].push_back(s);
    }
  }

  ExportReport run() {
    refuse();
    if (!report_.error.empty()) {
      return std::move(report_);
    }
    make_parent_folders(path_);
    file_ = Hdf5Writer::open(path_, report_.error);
    if (!file_) {
      return std::move(report_);
    }
    file_->write_text("/version", kNirVersion);
    file_->write_text("/node/type", "NIRGraph");
    for (std::uint32_t p = 0; p < network_.populations.size(); ++p) {
      write_population(p);
    }
    std::size_t done = 0;
    for (const auto& [key, synapses] : by_delay_) {
      write_pathway(key.first, key.second, synapses);
      progress_(static_cast<double>(++done) / static_cast<double>(by_delay_.size()));
    }
    write_outputs();
    write_edges();
    report_.error = file_->close();
    say_what_is_left_out();
    return std::move(report_);
  }

 private:
  void refuse() {
    std::map<std::string, std::vector<std::string>> reasons;
    for (const NetworkPopulation& population : network_.populations) {
      if (!is_source(population) && !can_say(population)) {
        reasons[std::string(model_name(population))].push_back(population.name);
      }
    }
    std::string text;
    for (const auto& [model, names] : reasons) {
      text += fmt::format("{}`{}` ({})", text.empty() ? "" : ", ", model, list_names(names));
    }
    for (const auto& [key, synapses] : by_delay_) {
      const Pathway& pathway = network_.pathways[key.first];
      if (std::size_t{network_.populations[pathway.pre_population].size} *
              network_.populations[pathway.post_population].size >
          kMaxMatrix) {
        report_.is_refused = true;
        report_.error =
            fmt::format("NIR has dense weights only, and those of `{}` would take more than 512 MB", pathway.name);
        return;
      }
    }
    if (!text.empty()) {
      report_.is_refused = true;
      report_.error = "NIR has no neurons of the model " + text;
    }
  }

  static bool can_say(const NetworkPopulation& population) {
    const bool is_instantaneous = std::all_of(population.receptors.begin(), population.receptors.end(),
                                              [](const Receptor& r) { return r.kind == ReceptorKind::Instantaneous; });
    switch (population.model) {
      case ModelKind::LifExp:
        return true;
      case ModelKind::LifDelta:
        return is_instantaneous;
      case ModelKind::Threshold:
        return is_instantaneous && parameter_of(population, "t_ref") == std::vector<double>{0};
      default:
        return false;
    }
  }

  static std::string node(const std::string& name) { return "/node/nodes/" + name; }

  /// One value a neuron.
  static std::vector<double> spread(const NetworkPopulation& population, const char* name, double factor = 1) {
    std::vector<double> values = parameter_of(population, name);
    values.resize(population.size, values.front());
    for (double& value : values) {
      value *= factor;
    }
    return values;
  }
  static std::vector<double> all(const NetworkPopulation& population, double value) {
    return std::vector<double>(population.size, value);
  }

  void write_shape(const std::string& name, const char* type, std::uint32_t size) {
    file_->write_text(node(name) + "/type", type);
    file_->write(node(name) + "/shape", std::vector<std::int64_t>{size});
  }

  void write_population(std::uint32_t p) {
    const NetworkPopulation& population = network_.populations[p];
    if (is_source(population)) {
      write_shape(population.name, "Input", population.size);
      return;
    }
    const std::string at = node(population.name) + "/";
    if (population.model == ModelKind::Threshold) {
      file_->write_text(at + "type", "Threshold");
      file_->write(at + "threshold", spread(population, "theta"));
      return;
    }
    const std::set<double> taus = time_constants(population);
    const bool is_cuba = population.model == ModelKind::LifExp && taus.size() == 1;
    file_->write_text(at + "type", is_cuba ? "CubaLIF" : "LIF");
    std::vector<double> leak = spread(population, "E_L");
    const std::vector<double> bias = spread(population, "I_bias");
    const std::vector<double> resistance = spread(population, "R_m");
    for (std::size_t i = 0; i < leak.size(); ++i) {
      leak[i] += resistance[i] * bias[i];
    }
    file_->write(at + (is_cuba ? "tau_mem" : "tau"), spread(population, "tau_m", 1 / kMsPerS));
    file_->write(at + "v_leak", leak);
    file_->write(at + "v_threshold", spread(population, "V_th"));
    file_->write(at + "v_reset", spread(population, "V_reset"));
    if (population.model == ModelKind::LifDelta) {
      // An input pulse of area w moves v by r w / tau: with r = tau it is w.
      file_->write(at + "r", spread(population, "tau_m", 1 / kMsPerS));
      return;
    }
    file_->write(at + "r", resistance);
    if (is_cuba) {
      file_->write(at + "tau_syn", all(population, *taus.begin() / kMsPerS));
      file_->write(at + "w_in", all(population, *taus.begin() / kMsPerS));  // so that a spike adds its weight to I
      return;
    }
    for (const Receptor& receptor : population.receptors) {
      const std::string name = population.name + "." + receptor.name;
      file_->write_text(node(name) + "/type", "LI");
      file_->write(node(name) + "/tau", all(population, receptor.tau_ms / kMsPerS));
      file_->write(node(name) + "/r", all(population, receptor.tau_ms / kMsPerS));
      file_->write(node(name) + "/v_leak", all(population, 0));
      edge(name, population.name);
    }
  }

  static std::set<double> time_constants(const NetworkPopulation& population) {
    std::set<double> taus;
    for (const Receptor& receptor : population.receptors) {
      taus.insert(receptor.tau_ms);
    }
    return taus;
  }

  void write_pathway(std::uint32_t p, std::uint32_t delay_ticks, const std::vector<std::size_t>& synapses) {
    const Pathway& pathway = network_.pathways[p];
    const NetworkPopulation& pre = network_.populations[pathway.pre_population];
    const NetworkPopulation& post = network_.populations[pathway.post_population];
    const std::string name = fmt::format("{}.{}_to_{}.{}", pathway.name, pre.name, post.name, delay_ticks);
    std::vector<double> weight(std::size_t{pre.size} * post.size, 0);
    for (const std::size_t s : synapses) {
      const std::size_t row = network_.synapses.post[s] - post.first_neuron;
      const std::size_t column = network_.synapses.pre[s] - pre.first_neuron;
      weight[row * pre.size + column] += weight_of(network_, s);
    }
    file_->write_text(node(name) + "/type", "Linear");
    const std::size_t shape[] = {post.size, pre.size};
    file_->write(node(name) + "/weight", weight, shape);
    std::string before = pre.name;
    if (delay_ticks > 0) {
      const std::string delay = fmt::format("{}.delay.{}", pre.name, delay_ticks);
      if (delays_.insert(delay).second) {
        file_->write_text(node(delay) + "/type", "Delay");
        file_->write(node(delay) + "/delay", all(pre, delay_ticks * network_.tick_ms() / kMsPerS));
        edge(pre.name, delay);
      }
      before = delay;
    }
    edge(before, name);
    const bool has_filters = post.model == ModelKind::LifExp && time_constants(post).size() > 1;
    edge(name, has_filters ? post.name + "." + post.receptors[pathway.receptor].name : post.name);
  }

  void write_outputs() {
    std::set<std::uint32_t> read;
    for (const Output& output : network_.outputs) {
      for (const OutputTerm& term : output.terms) {
        read.insert(static_cast<std::uint32_t>(index_of(term.instance)));
      }
    }
    if (read.empty()) {
      for (std::uint32_t p = 0; p < network_.populations.size(); ++p) {
        read.insert(p);
      }
      for (const Pathway& pathway : network_.pathways) {
        read.erase(pathway.pre_population);
      }
    }
    for (const std::uint32_t p : read) {
      const NetworkPopulation& population = network_.populations[p];
      write_shape(population.name + ".output", "Output", population.size);
      edge(population.name, population.name + ".output");
    }
  }

  void edge(const std::string& from, const std::string& to) {
    edges_.push_back(from);
    edges_.push_back(to);
  }

  void write_edges() {
    const std::size_t shape[] = {edges_.size() / 2, 2};
    file_->write_texts("/node/edges", edges_, shape);
  }

  void say_what_is_left_out() {
    std::vector<std::string> refractory, initial, sources;
    for (const NetworkPopulation& population : network_.populations) {
      if (is_source(population)) {
        sources.push_back(population.name);
      } else if (population.model != ModelKind::Threshold) {
        if (parameter_of(population, "t_ref") != std::vector<double>{0}) {
          refractory.push_back(population.name);
        }
        if (parameter_of(population, "V_init") != parameter_of(population, "E_L")) {
          initial.push_back(population.name);
        }
      }
    }
    warn("NIR has no refractory period: t_ref is left out of", refractory);
    warn("NIR has no initial potential: V_init is left out of", initial);
    warn("NIR has no sources of spikes: inputs of the graph are", sources);
    for (std::string& limit : learning_limits(wiring_, "NIR")) {
      report_.warnings.push_back(std::move(limit));
    }
    for (std::string& limit : head_outputs()) {
      report_.warnings.push_back(std::move(limit));
    }
  }

  std::vector<std::string> head_outputs() const {
    std::vector<std::string> names;
    for (const Output& output : network_.outputs) {
      names.push_back(output.name);
    }
    return names.empty() ? std::vector<std::string>{}
                         : std::vector<std::string>{
                               "NIR has no joints to move: left out are the gains and windows of " + list_names(names)};
  }

  void warn(const char* text, const std::vector<std::string>& names) {
    if (!names.empty()) {
      report_.warnings.push_back(fmt::format("{} {}", text, list_names(names)));
    }
  }

  const Wiring wiring_;
  const Network& network_;
  std::string path_;
  const ExchangeProgress& progress_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> by_delay_;  // pathway, delay in ticks
  std::unique_ptr<Hdf5Writer> file_;
  std::set<std::string> delays_;
  std::vector<std::string> edges_;
  ExportReport report_;
};

}  // namespace

ExportReport export_nir(const Wiring& wiring, const std::string& path, const ExchangeProgress& progress) {
  return NirExport(wiring, path, progress).run();
}

}  // namespace tectum
