// One projection on its way from words to ids and typed expressions. Included by the files of its parts alone:
// validate_projections.cpp, projection_sides.cpp, projection_rule.cpp, projection_names.cpp, projection_values.cpp.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/validate/validation.h"

namespace tectum {

class ProjectionValidator {
 public:
  ProjectionValidator(Validation& v, const ProjectionDecl& decl, Projection& made) : v_(v), decl_(decl), made_(made) {}

  void run();

 private:
  // validate_projections.cpp
  void cites();
  std::vector<Endpoint> endpoints(const std::vector<NameDecl>& names);
  const Population& population(const Endpoint& endpoint) const;
  void sign();
  void receptors();
  void report_receptor(const Population& target, const NameDecl& name, const std::string& wanted);

  // projection_sides.cpp
  /// Axes that some source and some target share.
  std::vector<AxisId> shared_axes() const;
  void sides();
  std::optional<Relation> find_relation(const NameDecl& name);
  [[nodiscard]] std::vector<std::string> known_sides() const;
  void only_sides();

  // projection_names.cpp
  [[nodiscard]] bool has_fields(const std::vector<Endpoint>& ends) const;
  /// True for the axes whose sides a visual field has: left and right, up and down.
  static bool is_spatial(const Axis& axis);
  void make_environment();
  /// The dimension in which all of these populations have positions, if they do.
  [[nodiscard]] std::optional<Dimension> position_dimension(const std::vector<Endpoint>& ends) const;
  void place_names();
  /// What the names of geometry would need, for those that mean nothing here.
  void explain_absent_names();
  void side_names(bool pre_has_angles);

  // projection_rule.cpp
  void rule();
  void edge_table();
  /// Where both ends are cells of tables, the file names them; where neither is, it numbers them.
  bool find_cell_tables();
  void rule_argument(const KeyedValue& argument);
  void check_degree();
  void check_sizes();

  // projection_values.cpp
  [[nodiscard]] Unit weight_unit(const Endpoint& to) const;
  void weight();
  std::optional<TypedExpression> weight_of(const ValueDecl& value, const Unit& unit);
  /// Weights and delays that hold on one side only.
  void exceptions(const Unit& unit);
  void delay();
  std::optional<TypedExpression> delay_of(const ValueDecl& value);
  void where();
  /// What is wrong with the weight and the delay of a projection whose ends or edge list are unknown: names that these
  /// would bring are no news, and the weight may have any unit.
  void values_alone();

  Validation& v_;
  const ProjectionDecl& decl_;
  Projection& made_;
  Environment names_;
  std::optional<Span> degree_span_;
  bool is_sound_ = true;
};

}  // namespace tectum
