// Expressions in a circuit's strings: "0.9 nA * ln(1 + ecc / 12 deg)", "hemifield == side".
//
//   parse_expression    text → Expression (flat tree with byte spans)
//   type_expression     Expression + Environment → TypedExpression (dimension, constant or program)
//   Evaluator           TypedExpression over arrays of variables, block by block
//   evaluate_constant   text + Environment → Quantity, all of the above for a plain value
//
// Grammar, loosest first; all binary operators associate to the left except ^ and ?: .
//   or ||    and &&    not !    == != < <= > >=    + -    * /    unary -    ^    c ? a : b (loosest of all)
//   primary: number [unit] | name[.name]* | function(argument, ...) | ( expression )
// A number may be followed by a unit; the unit goes on over * / and ^ only while these are written
// without blanks and unit names follow: "x / 5 mV/ms" is x / (5 mV/ms), "x / 5 mV / ms" is (x / 5 mV) / ms.
// A name that the environment does not know but that is a unit means one of that unit ("1/ms").
//
// Nothing here throws, and hostile text (deep nesting, huge input) ends in an error value.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/expression/dimension.h"
#include "compiler/expression/quantity.h"

namespace tectum {

/// Half-open byte range of the expression's own text.
struct ExprSpan {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  friend bool operator==(const ExprSpan&, const ExprSpan&) = default;
};

enum class ExprErrorCode : std::uint8_t {
  // parse_expression; at most one of these a text
  Syntax,       // something else was expected here, or the text ended too soon
  BadNumber,    // "1.2.3", or out of double range
  TooComplex,   // longer than kMaxExpressionBytes or nested deeper than kMaxExpressionDepth
  UnknownUnit,  // "3 mX"
  // type_expression; all of them, in source order, none that only follows from another
  UnknownName,
  UnknownFunction,
  AmbiguousUnit,      // "100 mV/m" where m is also a name of the environment
  WrongArity,         // function with too few or too many arguments
  DimensionMismatch,  // mV + nA, mV < nA, if(c, mV, nA)
  NotANumber,         // ln, exp, sin ... of something that has a unit
  NotAQuantity,       // arithmetic on a truth value or a word
  NotATruthValue,     // and, or, not, ?: on something else
  BadPower,           // dimensional base with a non-constant or non-whole exponent, sqrt of an odd power
  NotFinite,          // a constant part divides by zero or leaves the range of double
  NotConstant,        // evaluate_constant only: a variable appears in it
};

/// One error as plain data. `message` and `help` follow the style of diagnostics (lower case, no
/// full stop, code in backticks) and are complete; `other` is the second place of a clash.
struct ExprError {
  ExprErrorCode code = ExprErrorCode::Syntax;
  ExprSpan span;
  std::string message;
  std::string help;  // empty when there is nothing to suggest
  std::optional<ExprSpan> other;
  std::string other_label;  // e.g. "this is voltage (mV)"
};

enum class ExprOp : std::uint8_t {
  Number,  // value, dimension
  Name,    // text of `token`
  Negate,
  Not,
  Add,
  Subtract,
  Multiply,
  Divide,
  Power,
  Equal,
  NotEqual,
  Less,
  LessEqual,
  Greater,
  GreaterEqual,
  And,
  Or,
  If,    // condition, then, else; also written c ? a : b
  Call,  // function named by `token`
};

struct ExprNode {
  ExprOp op = ExprOp::Number;
  ExprSpan span;                    // the whole subexpression with its brackets
  ExprSpan token;                   // the operator, the name, or the number without its unit
  ExprSpan unit;                    // Number: the unit as written, empty when there is none
  std::uint32_t first_operand = 0;  // into Expression::operands
  std::uint32_t operand_count = 0;
  double value = 0;     // Number: coherent value
  Dimension dimension;  // Number only
};

inline constexpr std::size_t kMaxExpressionBytes = 16384;
inline constexpr int kMaxExpressionDepth = 200;
inline constexpr std::size_t kMaxArguments = 16;

/// Nodes in post-order: operands come before their operator, the root is the last node.
struct Expression {
  std::string text;
  std::vector<ExprNode> nodes;
  std::vector<std::uint32_t> operands;
  [[nodiscard]] std::string_view text_of(ExprSpan span) const {
    return std::string_view(text).substr(span.begin, span.end - span.begin);
  }
};

/// Reads the whole of `text`. On failure returns nothing and appends exactly one error.
std::optional<Expression> parse_expression(std::string_view text, std::vector<ExprError>& errors);

/// A name (not a function) and where it stands. In source order, every occurrence.
struct NameUse {
  std::string_view name;  // into expression.text
  ExprSpan span;
};
std::vector<NameUse> names_in(const Expression& expression);

/// What a name stands for: a constant, or a variable that the evaluator finds in column `slot`.
struct Symbol {
  Dimension dimension;
  bool is_variable = false;
  double value = 0;        // constant, coherent
  std::uint32_t slot = 0;  // variable
};

/// Names in scope. Words (left, right, up, down) are constants of dimension kWord. Looked up here
/// first, then in `outer`, then among `pi`, `true`, `false` and the unit names.
struct Environment {
  std::map<std::string, Symbol, std::less<>> symbols;
  const Environment* outer = nullptr;

  void add_constant(std::string name, Quantity quantity);
  void add_word(std::string name, int value);
  void add_variable(std::string name, Dimension dimension, std::uint32_t slot);
  [[nodiscard]] const Symbol* find(std::string_view name) const;
};

/// The nearest of `names` to `misspelt` (edit distance at most a third of its length, at least 1), if any.
std::optional<std::string> nearest_name(std::string_view misspelt, std::span<const std::string> names);

/// The steps of a typed expression's flat program. Numbers are doubles; truth values are 0 and 1.
enum class EvalOp : std::uint8_t {
  Negate,
  Not,
  Add,
  Subtract,
  Multiply,
  Divide,
  Power,
  Equal,
  NotEqual,
  Less,
  LessEqual,
  And,
  Or,
  Select,
  Exp,
  Log,
  Log2,
  Log10,
  Sqrt,
  Abs,
  Floor,
  Ceil,
  Sign,
  Sin,
  Cos,
  Tan,
  Asin,
  Acos,
  Atan,
  Tanh,
  Min,
  Max,
  Atan2,
  Hypot,
  Mod,
};

/// Where a step finds a value: a folded constant, the column of a slot, or an earlier step's target.
struct EvalOperand {
  enum class Kind : std::uint8_t { Constant, Slot, Temporary };
  Kind kind = Kind::Constant;
  std::uint16_t index = 0;
};

/// temporaries[target] = op(a, b, c); unused operands are constant 0's place.
struct EvalInstruction {
  EvalOp op = EvalOp::Negate;
  std::uint16_t target = 0;
  EvalOperand a;
  EvalOperand b;
  EvalOperand c;
};

/// A checked expression with its constant parts folded.
struct TypedExpression {
  Dimension dimension;
  std::optional<double> constant;  // coherent value, when no variable matters
  std::vector<EvalInstruction> program;
  std::vector<double> constants;
  EvalOperand result;
  std::uint32_t temporary_count = 0;
  std::uint32_t slot_count = 0;  // 1 + the largest slot read, 0 when none
};

/// Checks names, arity and dimensions term by term; appends every error and returns nothing if there
/// was one. The caller compares `dimension` with what the key wants (see dimension_error).
std::optional<TypedExpression> type_expression(const Expression& expression, const Environment& environment,
                                               std::vector<ExprError>& errors);

/// The error for a value of the wrong dimension: "expected current (nA), found voltage (mV)", spanning all of it.
ExprError dimension_error(const Expression& expression, const Dimension& expected, const Dimension& found);

/// A plain value: parses, types and folds. Numbers without unit are kNumber.
std::optional<Quantity> evaluate_constant(std::string_view text, const Environment& environment,
                                          std::vector<ExprError>& errors);

/// One input of a block evaluation: value i is data[i * stride]; stride 0 repeats one value.
struct EvalColumn {
  const double* data = nullptr;
  std::size_t stride = 1;
};

/// Evaluates a program over arrays; keeps its scratch, so make one and reuse it. Angles of sin, cos and
/// tan are taken in degrees when they carry a unit and in radians when plain numbers, as type_expression
/// has already arranged. Results may be infinite or NaN where the data make them so: check the output.
class Evaluator {
 public:
  /// Keeps a reference: the expression must outlive it.
  explicit Evaluator(const TypedExpression& expression);
  /// columns.size() >= slot_count; writes out.size() values.
  void evaluate(std::span<const EvalColumn> columns, std::span<double> out);
  /// One value a slot.
  double evaluate_one(std::span<const double> slots);

 private:
  const TypedExpression* expression_;
  std::vector<double> scratch_;  // temporaries, then constants, then broadcast slots: one block each
};

}  // namespace tectum
