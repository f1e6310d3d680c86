// Collects the steps of an equation program and numbers its operands.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compiler/expression/expression.h"
#include "runtime/image/program.h"

namespace tectum {

/// A place before the operands are numbered.
struct ProgramPlace {
  enum class Kind : std::uint8_t { State, Input, Column, Constant, Temporary };
  Kind kind = Kind::Constant;
  std::uint32_t index = 0;
  friend bool operator==(const ProgramPlace&, const ProgramPlace&) = default;
};

enum class ProgramPart : std::uint8_t { Update, Threshold, Reset };

class ProgramBuilder {
 public:
  ProgramBuilder(std::uint32_t state_count, std::uint32_t input_count)
      : state_count_(state_count), input_count_(input_count) {}

  [[nodiscard]] static ProgramPlace state(std::uint32_t s) { return {ProgramPlace::Kind::State, s}; }
  [[nodiscard]] static ProgramPlace input(std::uint32_t r) { return {ProgramPlace::Kind::Input, r}; }
  ProgramPlace constant(double value);
  ProgramPlace column(std::vector<double> values);
  /// A constant when there is one value, else a column.
  ProgramPlace values(const std::vector<double>& values);

  /// Steps that follow belong to this part; its temporaries are free again.
  void begin(ProgramPart part);
  /// A temporary that stays in use until the part ends or release() is called.
  ProgramPlace new_temporary();
  /// Frees temporaries taken since `mark` = temporaries_in_use().
  [[nodiscard]] std::uint32_t temporaries_in_use() const { return in_use_; }
  void release(std::uint32_t mark) { in_use_ = mark; }

  void emit(ProgramOp op, ProgramPlace target, ProgramPlace a, ProgramPlace b = {}, ProgramPlace c = {});
  /// Copies, or lets the step that computed the temporary write the target itself.
  void assign(ProgramPlace target, ProgramPlace value);

  /// `fires` is what decides; `initial` has one place a state.
  [[nodiscard]] std::vector<std::uint32_t> words(ProgramPlace fires, const std::vector<ProgramPlace>& initial,
                                                 std::uint32_t refractory_ticks, std::uint32_t hold_mask) const;
  [[nodiscard]] const std::vector<double>& constants() const { return constants_; }
  [[nodiscard]] std::vector<std::vector<double>>& columns() { return columns_; }

 private:
  struct Step {
    ProgramOp op;
    ProgramPlace target, a, b, c;
  };
  [[nodiscard]] std::uint32_t operand(ProgramPlace place) const;

  std::uint32_t state_count_;
  std::uint32_t input_count_;
  std::vector<double> constants_;
  std::vector<std::vector<double>> columns_;
  std::vector<Step> parts_[3];
  std::size_t part_ = 0;
  std::uint32_t in_use_ = 0;
  std::uint32_t temporary_count_ = 0;
};

/// Appends a typed expression's steps; slot k stands for slots[k]. A result in a temporary stays in use.
ProgramPlace append_expression(const TypedExpression& expression, const std::vector<ProgramPlace>& slots,
                               ProgramBuilder& builder);

}  // namespace tectum
