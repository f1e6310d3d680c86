#include "compiler/lower/lower_program.h"

#include <cmath>

namespace tectum {

void lower_program(const EquationProgram& program, const std::vector<ReceptorPhysics>& receptors, double tick_ms,
                   ImageContents& image, GroupRecord& group) {
  group.model = ModelKind::Program;
  group.flags = 0;
  group.parameter_begin = static_cast<std::uint32_t>(image.parameters.size());
  image.parameters.insert(image.parameters.end(), program.constants.begin(), program.constants.end());
  for (const ReceptorPhysics& receptor : receptors) {
    image.parameters.push_back(receptor.kind == ReceptorKind::Exponential ? receptor.tau_ms : 0);
  }
  for (const ReceptorPhysics& receptor : receptors) {
    const bool is_exponential = receptor.kind == ReceptorKind::Exponential;
    image.parameters.push_back(is_exponential ? std::exp(-tick_ms / receptor.tau_ms) : 0);
  }
  group.parameter_count = static_cast<std::uint32_t>(image.parameters.size()) - group.parameter_begin;

  group.column_begin = static_cast<std::uint32_t>(image.columns.size());
  group.column_count = static_cast<std::uint32_t>(program.columns.size());
  for (const std::vector<double>& column : program.columns) {
    image.columns.insert(image.columns.end(), column.begin(), column.end());
  }
  group.table_begin = static_cast<std::uint32_t>(image.tables.size());
  group.table_count = 0;
  group.data_begin = static_cast<std::uint32_t>(image.programs.size());
  group.data_count = static_cast<std::uint32_t>(program.words.size());
  image.programs.insert(image.programs.end(), program.words.begin(), program.words.end());
}

}  // namespace tectum
