#include "runtime/engine/update_group.h"

#include "runtime/engine/membrane_group.h"
#include "runtime/engine/point_groups.h"
#include "runtime/engine/program_group.h"
#include "runtime/engine/source_groups.h"

namespace tectum {

std::unique_ptr<UpdateGroup> make_update_group(const SpikeImage& image, const GroupRecord& group,
                                               const EngineOptions& options) {
  switch (group.model) {
    case ModelKind::FieldSource:
      return std::make_unique<FieldGroup>(image, group);
    case ModelKind::Threshold:
      return std::make_unique<ThresholdGroup>(image, group);
    case ModelKind::LifDelta:
    case ModelKind::LifExp:
    case ModelKind::Alif:
      return std::make_unique<MembraneGroup>(image, group, options);
    case ModelKind::Izhikevich:
      return std::make_unique<IzhikevichGroup>(image, group);
    case ModelKind::Poisson:
      return std::make_unique<PoissonGroup>(image, group);
    case ModelKind::SpikeList:
      return std::make_unique<SpikeListGroup>(image, group);
    case ModelKind::Program:
      return std::make_unique<ProgramGroup>(image, group, options.simd);
  }
  return nullptr;
}

}  // namespace tectum
