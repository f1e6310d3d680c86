#include "tools/evaluate/movements.h"

namespace tectum {

MeasuredProtocol measure_movements(const SpikeImage& image, const Protocol& protocol, unsigned threads,
                                   const std::function<void(double)>& progress) {
  switch (protocol.kind) {
    case ProtocolKind::Saccades:
      return measure_saccades(image, protocol, threads, progress);
    case ProtocolKind::Pursuit:
      return measure_pursuit(image, protocol, threads, progress);
    case ProtocolKind::Vergence:
      return measure_vergence(image, protocol, threads, progress);
    case ProtocolKind::Gaze:
      return measure_gaze_shifts(image, protocol, threads, progress);
    case ProtocolKind::Fixation:
      return measure_fixation(image, protocol, threads, progress);
    case ProtocolKind::Tracking:
    case ProtocolKind::Physiology:
    case ProtocolKind::Learning:
    case ProtocolKind::Clinic:
    case ProtocolKind::Robustness:
      break;
  }
  return {};
}

}  // namespace tectum
