// The arithmetic of one step, shared by constant folding and the block evaluator.
#pragma once

#include "compiler/expression/expression.h"

namespace tectum {

/// One value of one step; unused operands are ignored.
double apply_step(EvalOp op, double a, double b, double c);

}  // namespace tectum
