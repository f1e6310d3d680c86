// Puts an equation program into the image.
#pragma once

#include <vector>

#include "compiler/expression/equation_model.h"
#include "compiler/lower/lower_model.h"
#include "runtime/image/image_contents.h"

namespace tectum {

/// Appends the program's words, constants and columns to `image` and fills the model part of `group`
/// (model, flags and the parameter, column, table and data ranges). Leaves the neuron, slot and
/// receptor ranges alone: the caller sets them. `receptors` are in the order of the model's inputs.
/// Needs: groups are lowered in the order in which the image lists them.
void lower_program(const EquationProgram& program, const std::vector<ReceptorPhysics>& receptors, double tick_ms,
                   ImageContents& image, GroupRecord& group);

}  // namespace tectum
