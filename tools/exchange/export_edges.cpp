#include "tools/exchange/export_edges.h"

#include <filesystem>

#include "tools/exchange/format_limits.h"
#include "tools/exchange/text_file.h"

namespace tectum {
namespace {

constexpr std::size_t kProgressEvery = 1 << 16;

std::string write_cells(const Wiring& wiring, const std::string& path) {
  TextFile file(path);
  file.write("cell,population,index,model,nucleus,side,x,y\n");
  for (std::size_t p = 0; p < wiring.network.populations.size(); ++p) {
    const NetworkPopulation& population = wiring.network.populations[p];
    const Instance& instance = wiring.circuit.instances[p];
    const Population& declared = wiring.circuit.population_of(static_cast<InstanceId>(p));
    std::string sides;
    for (std::size_t a = 0; a < instance.sides.size(); ++a) {
      const Axis& axis = wiring.circuit.axes[index_of(declared.axes[a])];
      sides += (a == 0 ? "" : " ") + axis.sides[instance.sides[a]];
    }
    for (std::uint32_t i = 0; i < population.size; ++i) {
      file.write("{},{},{},{},{},{},", cell_name(population, i), declared.name, i, model_name(population),
                 population.nucleus, sides);
      if (instance.x.size() == population.size && instance.y.size() == population.size) {
        file.write("{},{}\n", instance.x[i], instance.y[i]);
      } else {
        file.write(",\n");
      }
    }
  }
  return file.close();
}

}  // namespace

std::string cells_path(const std::string& edges_path) {
  std::filesystem::path path(edges_path);
  return path.replace_filename(path.stem().string() + "_cells" + path.extension().string()).string();
}

ExportReport export_edges(const Wiring& wiring, const std::string& path, const ExchangeProgress& progress) {
  const Network& network = wiring.network;
  ExportReport report;
  report.warnings = head_and_model_limits(wiring, "a list of edges");
  TextFile file(path);
  file.write("pre,post,weight,unit,delay_ms,receptor,projection\n");
  for (std::size_t s = 0; s < network.synapses.size(); ++s) {
    const Pathway& pathway = network.pathways[network.synapses.pathway[s]];
    const NetworkPopulation& pre = network.populations[pathway.pre_population];
    const NetworkPopulation& post = network.populations[pathway.post_population];
    file.write("{}.{},{}.{},{},{},{},{},{}\n", pre.name, network.synapses.pre[s] - pre.first_neuron, post.name,
               network.synapses.post[s] - post.first_neuron, weight_of(network, s), weight_unit(post, pathway.receptor),
               network.synapses.delay_ticks[s] * network.tick_ms(), post.receptors[pathway.receptor].name,
               pathway.name);
    if (s % kProgressEvery == 0) {
      progress(static_cast<double>(s) / static_cast<double>(network.synapses.size()));
    }
  }
  report.error = file.close();
  if (report.error.empty()) {
    report.error = write_cells(wiring, cells_path(path));
  }
  return report;
}

}  // namespace tectum
