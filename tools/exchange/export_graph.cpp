#include "tools/exchange/export_graph.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tools/exchange/format_limits.h"
#include "tools/exchange/text_file.h"
#include "tools/report/svg.h"

namespace tectum {
namespace {

constexpr std::size_t kProgressEvery = 1 << 16;

/// All synapses of one pathway that have one sign.
struct PathwaySum {
  std::uint32_t pathway = 0;
  bool is_inhibitory = false;
  std::uint32_t synapse_count = 0;
  double weight_sum = 0;
  double shortest_ms = 0;
  double longest_ms = 0;

  [[nodiscard]] double mean_weight() const { return weight_sum / synapse_count; }
};

std::vector<PathwaySum> sum_pathways(const Network& network) {
  std::map<std::pair<std::uint32_t, bool>, PathwaySum> sums;
  for (std::size_t s = 0; s < network.synapses.size(); ++s) {
    const double weight = weight_of(network, s);
    const double delay_ms = network.synapses.delay_ticks[s] * network.tick_ms();
    const std::pair key(network.synapses.pathway[s], weight < 0);
    const auto [entry, is_new] = sums.emplace(key, PathwaySum{key.first, key.second, 0, 0, delay_ms, delay_ms});
    PathwaySum& sum = entry->second;
    ++sum.synapse_count;
    sum.weight_sum += weight;
    sum.shortest_ms = std::min(sum.shortest_ms, delay_ms);
    sum.longest_ms = std::max(sum.longest_ms, delay_ms);
  }
  std::vector<PathwaySum> result;
  for (const auto& [key, sum] : sums) {
    result.push_back(sum);
  }
  return result;
}

class GraphmlWriter {
 public:
  GraphmlWriter(const Wiring& wiring, TextFile& file)
      : circuit_(wiring.circuit), network_(wiring.network), file_(file) {}

  void header(GraphGrain grain) {
    file_.write("{}",
                "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                "<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\"\n"
                "         xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"\n"
                "         xsi:schemaLocation=\"http://graphml.graphdrawing.org/xmlns "
                "http://graphml.graphdrawing.org/xmlns/1.0/graphml.xsd\">\n");
    key("population", "node", "string");
    key("model", "node", "string");
    key("nucleus", "node", "string");
    if (grain == GraphGrain::Cell) {
      key("index", "node", "int");
      key("x", "node", "double");
      key("y", "node", "double");
    } else {
      key("size", "node", "int");
      key("synapses", "edge", "int");
    }
    key("weight", "edge", "double");
    key("unit", "edge", "string");
    key("delay_ms", "edge", "double");
    key("receptor", "edge", "string");
    key("projection", "edge", "string");
    file_.write("  <graph id=\"{}\" edgedefault=\"directed\">\n", network_.name);
  }

  void cells() {
    for (std::size_t p = 0; p < network_.populations.size(); ++p) {
      const NetworkPopulation& population = network_.populations[p];
      const Instance& instance = circuit_.instances[p];
      const bool has_place = instance.x.size() == population.size && instance.y.size() == population.size;
      for (std::uint32_t i = 0; i < population.size; ++i) {
        open_node(cell_name(population, i), population);
        data("index", i);
        if (has_place) {
          data("x", instance.x[i]);
          data("y", instance.y[i]);
        }
        file_.write("</node>\n");
      }
    }
  }

  void synapses(const ExchangeProgress& progress) {
    for (std::size_t s = 0; s < network_.synapses.size(); ++s) {
      const Pathway& pathway = network_.pathways[network_.synapses.pathway[s]];
      const NetworkPopulation& pre = network_.populations[pathway.pre_population];
      const NetworkPopulation& post = network_.populations[pathway.post_population];
      file_.write("    <edge source=\"{}.{}\" target=\"{}.{}\">", pre.name, network_.synapses.pre[s] - pre.first_neuron,
                  post.name, network_.synapses.post[s] - post.first_neuron);
      edge_data(pathway, weight_of(network_, s), network_.synapses.delay_ticks[s] * network_.tick_ms());
      if (s % kProgressEvery == 0) {
        progress(static_cast<double>(s) / static_cast<double>(network_.synapses.size()));
      }
    }
  }

  void populations() {
    for (const NetworkPopulation& population : network_.populations) {
      open_node(population.name, population);
      data("size", population.size);
      file_.write("</node>\n");
    }
  }

  void pathways() {
    for (const PathwaySum& sum : sum_pathways(network_)) {
      const Pathway& pathway = network_.pathways[sum.pathway];
      file_.write("    <edge source=\"{}\" target=\"{}\">", network_.populations[pathway.pre_population].name,
                  network_.populations[pathway.post_population].name);
      data("synapses", sum.synapse_count);
      edge_data(pathway, sum.mean_weight(), sum.shortest_ms);
    }
  }

  void footer() { file_.write("  </graph>\n</graphml>\n"); }

 private:
  void key(const char* name, const char* owner, const char* type) {
    file_.write("  <key id=\"{0}\" for=\"{1}\" attr.name=\"{0}\" attr.type=\"{2}\"/>\n", name, owner, type);
  }
  template <typename Value>
  void data(const char* name, const Value& value) {
    file_.write("<data key=\"{}\">{}</data>", name, value);
  }
  void open_node(const std::string& id, const NetworkPopulation& population) {
    file_.write("    <node id=\"{}\">", id);
    data("population", population.name);
    data("model", model_name(population));
    if (!population.nucleus.empty()) {
      data("nucleus", xml_escape(population.nucleus));
    }
  }
  void edge_data(const Pathway& pathway, double weight, double delay_ms) {
    const NetworkPopulation& post = network_.populations[pathway.post_population];
    data("weight", weight);
    data("unit", weight_unit(post, pathway.receptor));
    data("delay_ms", delay_ms);
    data("receptor", post.receptors[pathway.receptor].name);
    data("projection", pathway.name);
    file_.write("</edge>\n");
  }

  const Circuit& circuit_;
  const Network& network_;
  TextFile& file_;
};

constexpr const char* kExcitatoryInk = "#2b6cb0";
constexpr const char* kInhibitoryInk = "#c53030";

std::string dot_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    escaped += (c == '"' || c == '\\') ? std::string("\\") + c : std::string(1, c);
  }
  return escaped;
}

void dot_header(const Network& network, TextFile& file) {
  file.write(
      "// Excitation is blue with an arrow, inhibition red with a bar. Draw it: dot -Tsvg FILE -o circuit.svg\n");
  file.write("digraph \"{}\" {{\n", network.name);
  file.write("  rankdir=LR; ranksep=1.2; nodesep=0.25; fontname=\"Helvetica\";\n");
  file.write(
      "  node [shape=box, style=\"rounded,filled\", fillcolor=\"#f7fafc\", color=\"#4a5568\", "
      "fontname=\"Helvetica\", fontsize=12];\n");
  file.write("  edge [fontname=\"Helvetica\", fontsize=9];\n");
}

void dot_edge_style(double weight, double width, TextFile& file) {
  const bool is_inhibitory = weight < 0;
  file.write("color=\"{}\", arrowhead={}, penwidth={:.2f}", is_inhibitory ? kInhibitoryInk : kExcitatoryInk,
             is_inhibitory ? "tee" : "normal", width);
}

void dot_populations(const Wiring& wiring, TextFile& file) {
  const Network& network = wiring.network;
  std::map<std::string, std::vector<const NetworkPopulation*>> nuclei;
  for (const NetworkPopulation& population : network.populations) {
    nuclei[population.nucleus].push_back(&population);
  }
  std::size_t cluster = 0;
  for (const auto& [nucleus, populations] : nuclei) {
    const bool is_cluster = !nucleus.empty();
    if (is_cluster) {
      file.write("  subgraph cluster_{} {{ label=\"{}\"; color=\"#a0aec0\"; fontsize=12;\n", cluster++,
                 dot_text(nucleus));
    }
    for (const NetworkPopulation* population : populations) {
      file.write("  \"{0}\" [label=\"{0}\\n{1} {2}\"];\n", population->name, population->size, model_name(*population));
    }
    file.write("{}", is_cluster ? "  }\n" : "");
  }
  for (const PathwaySum& sum : sum_pathways(network)) {
    const Pathway& pathway = network.pathways[sum.pathway];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    file.write("  \"{}\" -> \"{}\" [", network.populations[pathway.pre_population].name, post.name);
    dot_edge_style(sum.weight_sum, 0.6 + 0.35 * std::log10(static_cast<double>(sum.synapse_count)), file);
    const std::string unit = weight_unit(post, pathway.receptor);
    file.write(", tooltip=\"{}: {} synapses, mean {:.3g}{}{}, {:g} to {:g} ms\"];\n", pathway.name, sum.synapse_count,
               sum.mean_weight(), unit.empty() ? "" : " ", unit, sum.shortest_ms, sum.longest_ms);
  }
}

void dot_cells(const Network& network, const ExchangeProgress& progress, TextFile& file) {
  for (const NetworkPopulation& population : network.populations) {
    for (std::uint32_t i = 0; i < population.size; ++i) {
      file.write("  \"{}\";\n", cell_name(population, i));
    }
  }
  for (std::size_t s = 0; s < network.synapses.size(); ++s) {
    const Pathway& pathway = network.pathways[network.synapses.pathway[s]];
    const NetworkPopulation& pre = network.populations[pathway.pre_population];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    const double weight = weight_of(network, s);
    file.write("  \"{}.{}\" -> \"{}.{}\" [", pre.name, network.synapses.pre[s] - pre.first_neuron, post.name,
               network.synapses.post[s] - post.first_neuron);
    dot_edge_style(weight, 1, file);
    file.write(", weight_exact=\"{}\", delay_ms=\"{}\"];\n", weight,
               network.synapses.delay_ticks[s] * network.tick_ms());
    if (s % kProgressEvery == 0) {
      progress(static_cast<double>(s) / static_cast<double>(network.synapses.size()));
    }
  }
}

}  // namespace

ExportReport export_graphml(const Wiring& wiring, GraphGrain grain, const std::string& path,
                            const ExchangeProgress& progress) {
  ExportReport report;
  report.warnings = head_and_model_limits(wiring, "GraphML");
  TextFile file(path);
  GraphmlWriter writer(wiring, file);
  writer.header(grain);
  if (grain == GraphGrain::Cell) {
    writer.cells();
    writer.synapses(progress);
  } else {
    writer.populations();
    writer.pathways();
  }
  writer.footer();
  report.error = file.close();
  return report;
}

ExportReport export_dot(const Wiring& wiring, GraphGrain grain, const std::string& path,
                        const ExchangeProgress& progress) {
  ExportReport report;
  report.warnings = head_and_model_limits(wiring, "DOT");
  TextFile file(path);
  dot_header(wiring.network, file);
  if (grain == GraphGrain::Cell) {
    dot_cells(wiring.network, progress, file);
  } else {
    dot_populations(wiring, file);
  }
  file.write("}}\n");
  report.error = file.close();
  return report;
}

}  // namespace tectum
