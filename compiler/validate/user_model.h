// A neuron model that the circuit declares by its equations, in the form of the built-in ones.
#pragma once

#include <string>
#include <vector>

#include "compiler/expression/equation_model.h"
#include "runtime/image/models.h"

namespace tectum {

/// `info` points into the other members: made once, held by shared pointers, never copied.
struct UserModel {
  std::string name;
  EquationModel equations;
  std::vector<ParameterInfo> parameters;
  ModelInfo info{};

  UserModel() = default;
  UserModel(const UserModel&) = delete;
  UserModel& operator=(const UserModel&) = delete;
};

}  // namespace tectum
