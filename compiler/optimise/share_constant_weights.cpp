#include "compiler/optimise/passes.h"

namespace tectum {

std::string share_constant_weights(Network& network) {
  network.shares_constant_weights = true;
  return "";  // lowering finds the runs of one weight once the rows are sorted
}

}  // namespace tectum
