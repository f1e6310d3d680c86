// Text → Expression by precedence climbing. Recursion is bounded by kMaxExpressionDepth; chains of
// left-associative operators are loops, and later passes walk the flat post-order without recursion.
#include <charconv>
#include <cmath>
#include <utility>

#include "compiler/expression/expression.h"
#include "compiler/expression/expression_text.h"

namespace tectum {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
// Bytes of multi-byte UTF-8 count as letters, so that Ω, µ and Greek names work.
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

enum class TokenKind : std::uint8_t { End, Number, Name, Symbol };

struct Token {
  TokenKind kind = TokenKind::End;
  ExprSpan span;
  ExprSpan unit;  // Number: the unit's text, empty when there is none
  double value = 0;
  Dimension dimension;
};

struct BinaryOperator {
  std::string_view text;
  ExprOp op;
  int level;
};
constexpr int kPowerLevel = 7;
constexpr BinaryOperator kBinaryOperators[] = {
    {"or", ExprOp::Or, 1},           {"||", ExprOp::Or, 1},        {"and", ExprOp::And, 2},
    {"&&", ExprOp::And, 2},          {"==", ExprOp::Equal, 3},     {"!=", ExprOp::NotEqual, 3},
    {"<", ExprOp::Less, 3},          {"<=", ExprOp::LessEqual, 3}, {">", ExprOp::Greater, 3},
    {">=", ExprOp::GreaterEqual, 3}, {"+", ExprOp::Add, 4},        {"-", ExprOp::Subtract, 4},
    {"*", ExprOp::Multiply, 5},      {"/", ExprOp::Divide, 5},     {"^", ExprOp::Power, kPowerLevel},
};
constexpr int kNotLevel = 3;     // "not a == b" is not (a == b)
constexpr int kNegateLevel = 6;  // "-a * b" is (-a) * b, "-a ^ b" is -(a ^ b)

class Parser {
 public:
  Parser(std::string_view text, std::vector<ExprError>& errors) : errors_(errors) { expression_.text = text; }

  std::optional<Expression> parse() {
    if (expression_.text.size() > kMaxExpressionBytes) {
      fail(ExprErrorCode::TooComplex, {0, static_cast<std::uint32_t>(expression_.text.size())},
           "expression is longer than " + std::to_string(kMaxExpressionBytes) + " bytes");
      return std::nullopt;
    }
    advance();
    const std::uint32_t root = conditional();
    if (!failed_ && token_.kind != TokenKind::End) {
      unexpected("an operator");
    }
    if (failed_) {
      return std::nullopt;
    }
    static_cast<void>(root);  // the last node
    return std::move(expression_);
  }

 private:
  // ---- tokens ----
  std::string_view text() const { return expression_.text; }
  char at(std::size_t i) const { return i < text().size() ? text()[i] : '\0'; }
  std::string_view token_text() const { return expression_.text_of(token_.span); }
  bool is_token(std::string_view symbol) const {
    return (token_.kind == TokenKind::Symbol || token_.kind == TokenKind::Name) && token_text() == symbol;
  }

  void advance() {
    previous_end_ = token_.span.end;
    while (at_ < text().size() && is_blank(text()[at_])) {
      ++at_;
    }
    token_ = Token{};
    token_.span = {here(), here()};
    if (at_ == text().size() || failed_) {
      return;
    }
    const char c = text()[at_];
    if (is_digit(c) || (c == '.' && is_digit(at(at_ + 1)))) {
      read_number();
    } else if (is_letter(c)) {
      token_.kind = TokenKind::Name;
      at_ = name_end(at_);
      while (at(at_) == '.' && is_letter(at(at_ + 1))) {
        at_ = name_end(at_ + 1);
      }
    } else {
      token_.kind = TokenKind::Symbol;
      static constexpr std::string_view kPairs[] = {"==", "!=", "<=", ">=", "&&", "||"};
      std::size_t length = 1;
      for (const std::string_view pair : kPairs) {
        if (text().substr(at_, 2) == pair) {
          length = 2;
        }
      }
      at_ += length;
    }
    token_.span.end = here();
  }

  std::uint32_t here() const { return static_cast<std::uint32_t>(at_); }

  std::size_t name_end(std::size_t i) const {
    while (is_letter(at(i)) || (i < text().size() && is_digit(at(i)))) {
      ++i;
    }
    return i;
  }

  void read_number() {
    token_.kind = TokenKind::Number;
    const char* first = text().data() + at_;
    const auto [end, error] = std::from_chars(first, text().data() + text().size(), token_.value);
    at_ = static_cast<std::size_t>(end - text().data());
    token_.span.end = here();
    const bool runs_on = at(at_) == '.' || is_digit(at(at_));
    if (error != std::errc{} || !std::isfinite(token_.value) || runs_on) {
      while (is_digit(at(at_)) || at(at_) == '.') {
        ++at_;
      }
      fail(ExprErrorCode::BadNumber, {token_.span.begin, here()},
           error == std::errc::result_out_of_range ? "number is out of range" : "malformed number");
      return;
    }
    read_unit();
  }

  // The unit after a number. `at_` stands behind the number and moves behind the unit.
  void read_unit() {
    std::size_t i = at_;
    while (is_blank(at(i))) {
      ++i;
    }
    const std::size_t begin = i;
    i = unit_name_end(begin);
    const std::string_view name = text().substr(begin, i - begin);
    if (name.empty() || name == "and" || name == "or" || name == "not") {
      return;
    }
    if (!find_unit(name)) {
      unknown_unit(begin, name_end(i));
      return;
    }
    for (i = skip_exponent(i); at(i) == '*' || at(i) == '/'; i = skip_exponent(i)) {
      const std::size_t end = name_end(i + 1);
      const bool is_call_or_path = at(end) == '(' || at(end) == '.';
      if (is_call_or_path || !find_unit(text().substr(i + 1, end - i - 1))) {
        break;
      }
      i = end;
    }
    token_.unit = {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(i)};
    const std::optional<Unit> unit = parse_unit(expression_.text_of(token_.unit));
    if (!unit) {
      unknown_unit(begin, i);
      return;
    }
    token_.value = to_coherent(token_.value, *unit);
    token_.dimension = unit->dimension;
    if (!std::isfinite(token_.value)) {
      fail(ExprErrorCode::BadNumber, {token_.span.begin, static_cast<std::uint32_t>(i)}, "number is out of range");
    }
    at_ = i;
  }

  std::size_t unit_name_end(std::size_t i) const { return at(i) == '%' ? i + 1 : is_letter(at(i)) ? name_end(i) : i; }

  std::size_t skip_exponent(std::size_t i) const {
    const std::size_t digits = at(i + 1) == '-' ? i + 2 : i + 1;
    if (at(i) != '^' || !is_digit(at(digits))) {
      return i;
    }
    std::size_t end = digits;
    while (is_digit(at(end))) {
      ++end;
    }
    return end;
  }

  void unknown_unit(std::size_t begin, std::size_t end) {
    const ExprSpan span{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    const std::string name = quoted(expression_.text_of(span));
    const std::optional<std::string> nearest = suggest_unit(expression_.text_of(span));
    fail(ExprErrorCode::UnknownUnit, span, "unknown unit " + name,
         nearest ? "did you mean " + quoted(*nearest) + "?" : "to multiply, write `*` between the number and the name");
  }

  // ---- grammar; every function returns the index of its node, meaningless once failed_ ----
  std::uint32_t conditional() {
    const Descent descent(*this);
    if (failed_) {
      return 0;
    }
    const std::uint32_t condition = binary(1);
    if (failed_ || !is_token("?")) {
      return condition;
    }
    const ExprSpan question = token_.span;
    advance();
    const std::uint32_t then = conditional();
    if (failed_ || !expect(":")) {
      return 0;
    }
    const std::uint32_t otherwise = conditional();
    if (failed_) {
      return 0;
    }
    const ExprSpan span{node(condition).span.begin, node(otherwise).span.end};
    return add(ExprOp::If, span, question, {condition, then, otherwise});
  }

  std::uint32_t binary(int level) {
    const Descent descent(*this);
    std::uint32_t left = unary(level);
    while (!failed_) {
      const BinaryOperator* found = binary_operator();
      if (!found || found->level < level) {
        return left;
      }
      const ExprSpan token = token_.span;
      advance();
      // ^ associates to the right, and its exponent may carry a sign.
      const bool is_power = found->op == ExprOp::Power;
      const std::uint32_t right = is_power ? binary(kNegateLevel) : binary(found->level + 1);
      if (failed_) {
        return 0;
      }
      left = add(found->op, {node(left).span.begin, node(right).span.end}, token, {left, right});
    }
    return 0;
  }

  const BinaryOperator* binary_operator() {
    for (const BinaryOperator& candidate : kBinaryOperators) {
      if (is_token(candidate.text)) {
        return &candidate;
      }
    }
    return nullptr;
  }

  std::uint32_t unary(int level) {
    const bool is_not = is_token("not") || is_token("!");
    if (!is_not && !is_token("-") && !is_token("+")) {
      return primary();
    }
    const ExprSpan token = token_.span;
    const bool is_plus = is_token("+");
    advance();
    // A sign inside a product still binds tighter than the product: "2 * -x".
    const int operand_level = is_not ? kNotLevel : kNegateLevel;
    const std::uint32_t operand = binary(std::max(operand_level, std::min(level, kNegateLevel)));
    if (failed_ || is_plus) {
      return operand;
    }
    return add(is_not ? ExprOp::Not : ExprOp::Negate, {token.begin, node(operand).span.end}, token, {operand});
  }

  std::uint32_t primary() {
    if (failed_) {
      return 0;
    }
    const Token token = token_;
    if (token.kind == TokenKind::Number) {
      advance();
      const std::uint32_t end = token.unit.end > 0 ? token.unit.end : token.span.end;
      const std::uint32_t number = add(ExprOp::Number, {token.span.begin, end}, token.span, {});
      node(number).unit = token.unit;
      node(number).value = token.value;
      node(number).dimension = token.dimension;
      return number;
    }
    if (token.kind == TokenKind::Name && !binary_operator()) {
      advance();
      return is_token("(") ? call(token.span) : add(ExprOp::Name, token.span, token.span, {});
    }
    if (!is_token("(")) {
      unexpected("a value");
      return 0;
    }
    advance();
    const std::uint32_t inner = conditional();
    if (failed_ || !close_bracket(token.span)) {
      return 0;
    }
    node(inner).span = {token.span.begin, previous_end_};
    return inner;
  }

  std::uint32_t call(ExprSpan name) {
    const ExprSpan open = token_.span;
    advance();
    std::vector<std::uint32_t> arguments;
    while (!is_token(")")) {
      if (arguments.size() == kMaxArguments) {
        fail(ExprErrorCode::TooComplex, token_.span,
             "function call has more than " + std::to_string(kMaxArguments) + " arguments");
        return 0;
      }
      arguments.push_back(conditional());
      if (failed_) {
        return 0;
      }
      if (!is_token(",")) {
        break;
      }
      advance();
      if (is_token(")")) {
        unexpected("an argument");
      }
    }
    if (failed_ || !close_bracket(open)) {
      return 0;
    }
    const bool is_if = expression_.text_of(name) == "if" && arguments.size() == 3;
    return add(is_if ? ExprOp::If : ExprOp::Call, {name.begin, previous_end_}, name, arguments);
  }

  // ---- building ----
  ExprNode& node(std::uint32_t index) { return expression_.nodes[index]; }

  std::uint32_t add(ExprOp op, ExprSpan span, ExprSpan token, const std::vector<std::uint32_t>& operands) {
    ExprNode added;
    added.op = op;
    added.span = span;
    added.token = token;
    added.first_operand = static_cast<std::uint32_t>(expression_.operands.size());
    added.operand_count = static_cast<std::uint32_t>(operands.size());
    expression_.operands.insert(expression_.operands.end(), operands.begin(), operands.end());
    expression_.nodes.push_back(added);
    return static_cast<std::uint32_t>(expression_.nodes.size() - 1);
  }

  // ---- errors: the first one stops the parse ----
  void fail(ExprErrorCode code, ExprSpan span, std::string message, std::string help = {}) {
    if (failed_) {
      return;
    }
    failed_ = true;
    errors_.push_back({code, span, std::move(message), std::move(help), std::nullopt, {}});
  }

  bool expect(std::string_view symbol) {
    if (!is_token(symbol)) {
      unexpected(quoted(symbol));
      return false;
    }
    advance();
    return !failed_;
  }

  bool close_bracket(ExprSpan open) {
    if (is_token(")")) {
      advance();
      return !failed_;
    }
    if (token_.kind == TokenKind::End) {
      fail(ExprErrorCode::Syntax, open, "`(` is never closed");
    } else {
      unexpected("an operator or `)`");
    }
    return false;
  }

  void unexpected(std::string_view expected) {
    const std::string wanted = "expected " + std::string(expected);
    if (token_.kind == TokenKind::End) {
      // Points behind the last token, one byte wide so that there is something to underline.
      const auto end = std::min(std::max(previous_end_, std::uint32_t{1}), static_cast<std::uint32_t>(text().size()));
      fail(ExprErrorCode::Syntax, {end == 0 ? 0 : end - 1, end},
           text().find_first_not_of(" \t\r\n") == std::string_view::npos ? "expression is empty"
                                                                         : wanted + ", the expression ends here");
      return;
    }
    std::string help;
    if (is_token("=")) {
      help = "comparison is written `==`";
    }
    if (is_token("&")) {
      help = "write `and`";
    }
    if (is_token("|")) {
      help = "write `or`";
    }
    const bool is_juxtaposed = token_.kind != TokenKind::Symbol && expected == "an operator";
    if (is_juxtaposed) {
      help = "to multiply, write `*`";
    }
    ExprSpan span = token_.span;
    if (token_.kind == TokenKind::Number && token_.unit.end > 0) {
      span.end = token_.unit.end;
    }
    fail(ExprErrorCode::Syntax, span, wanted + ", found " + quoted(expression_.text_of(span)), std::move(help));
  }

  // Counts nesting for as long as it lives.
  struct Descent {
    explicit Descent(Parser& p) : parser(p) {
      // conditional() and binary() both count, hence the factor.
      if (++parser.depth_ > 2 * kMaxExpressionDepth) {
        parser.fail(ExprErrorCode::TooComplex, parser.token_.span,
                    "expression is nested deeper than " + std::to_string(kMaxExpressionDepth) + " levels");
      }
    }
    ~Descent() { --parser.depth_; }
    Descent(const Descent&) = delete;
    Descent& operator=(const Descent&) = delete;
    Parser& parser;
  };

  Expression expression_;
  std::vector<ExprError>& errors_;
  std::size_t at_ = 0;
  Token token_;
  std::uint32_t previous_end_ = 0;
  int depth_ = 0;
  bool failed_ = false;
};

}  // namespace

std::optional<Expression> parse_expression(std::string_view text, std::vector<ExprError>& errors) {
  return Parser(text, errors).parse();
}

std::vector<NameUse> names_in(const Expression& expression) {
  std::vector<NameUse> names;
  for (const ExprNode& node : expression.nodes) {
    if (node.op == ExprOp::Name) {
      names.push_back({expression.text_of(node.token), node.token});
    }
  }
  return names;
}

}  // namespace tectum
