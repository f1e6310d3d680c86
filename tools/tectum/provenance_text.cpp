#include "tools/tectum/provenance_text.h"

#include <fmt/format.h>

namespace tectum {
namespace {

std::string place(const Sources& sources, const Span& span) {
  const SourceFile& file = sources.file(span.file);
  return fmt::format("{}:{}", file.name, position_of(file.bytes, span.begin).line);
}

template <typename Decls>
std::string uncited(const char* kind, const Decls& decls, const Sources& sources) {
  std::string lines;
  std::size_t count = 0;
  for (const auto& decl : decls) {
    if (decl.provenance.cites.empty()) {
      lines += fmt::format("  {:<24} {}\n", decl.name.text, place(sources, decl.name.span));
      ++count;
    }
  }
  return fmt::format("{} of {} {} cite no source{}\n{}", count, decls.size(), kind, count == 0 ? "" : ":", lines);
}

}  // namespace

std::string provenance_text(const CompileResult& result) {
  const CircuitDecl& decl = *result.decl;
  const Network& network = *result.network;
  std::vector<std::size_t> synapses(result.circuit->projections.size(), 0);
  for (const std::uint32_t pathway : network.synapses.pathway) {
    ++synapses[index_of(network.pathways[pathway].projection)];
  }
  std::string lines;
  std::size_t count = 0;
  std::size_t uncited_synapses = 0;
  for (std::size_t p = 0; p < synapses.size(); ++p) {
    const Projection& projection = result.circuit->projections[p];
    if (projection.cite.empty()) {
      lines += fmt::format("  {:<24} {:>9} synapses  {}\n", projection.name, synapses[p],
                           place(result.sources, projection.name_span));
      ++count;
      uncited_synapses += synapses[p];
    }
  }
  const double share = network.synapses.size() == 0 ? 0
                                                    : 100.0 * static_cast<double>(uncited_synapses) /
                                                          static_cast<double>(network.synapses.size());
  return uncited("neuron types", decl.neurons, result.sources) +
         uncited("populations", decl.populations, result.sources) +
         fmt::format("{} of {} projections cite no source, {:.3g} % of {} synapses{}\n{}", count, synapses.size(),
                     share, network.synapses.size(), count == 0 ? "" : ":", lines);
}

}  // namespace tectum
