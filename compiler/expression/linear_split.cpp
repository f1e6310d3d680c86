#include "compiler/expression/linear_split.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tectum {
namespace {

constexpr std::uint32_t kNothing = ~0U;

// A tree that shares nodes; written out in post-order at the end.
struct TreeNode {
  ExprNode node;  // operands unused
  std::vector<std::uint32_t> children;
};

struct Form {
  std::vector<std::uint32_t> slopes;  // empty: no variable in it
  std::uint32_t offset = kNothing;
  bool is_linear = true;
};

class Splitter {
 public:
  Splitter(const Expression& expression, std::size_t variable_count) : source_(expression), count_(variable_count) {}

  LinearSplit split(const std::function<std::optional<std::size_t>(std::string_view)>& variable_of) {
    std::vector<Form> stack;
    for (const ExprNode& node : source_.nodes) {
      const std::size_t first = stack.size() - node.operand_count;
      const std::vector<Form> operands(std::make_move_iterator(stack.begin() + static_cast<std::ptrdiff_t>(first)),
                                       std::make_move_iterator(stack.end()));
      stack.resize(first);
      const auto variable = node.op == ExprOp::Name ? variable_of(source_.text_of(node.token)) : std::nullopt;
      stack.push_back(variable ? variable_form(node, *variable) : combine(node, operands));
    }
    LinearSplit result;
    result.slopes.resize(count_);
    if (!stack.back().is_linear) {
      result.nonlinear = nonlinear_;
      return result;
    }
    for (std::size_t v = 0; v < stack.back().slopes.size(); ++v) {
      result.slopes[v] = written_out(stack.back().slopes[v]);
    }
    result.offset = written_out(stack.back().offset);
    return result;
  }

 private:
  static bool is_free(const Form& form) { return form.slopes.empty(); }

  Form variable_form(const ExprNode& node, std::size_t variable) {
    Form form;
    form.slopes.assign(count_, kNothing);
    form.slopes[variable] = number(node, 1);
    return form;
  }

  Form combine(const ExprNode& node, const std::vector<Form>& operands) {
    Form form;
    form.is_linear = std::all_of(operands.begin(), operands.end(), [](const Form& f) { return f.is_linear; });
    if (!form.is_linear) {
      return form;
    }
    if (std::all_of(operands.begin(), operands.end(), is_free)) {
      std::vector<std::uint32_t> children;
      for (const Form& operand : operands) {
        children.push_back(operand.offset);
      }
      form.offset = add(node, node.op, std::move(children));
      return form;
    }
    switch (node.op) {
      case ExprOp::Negate:
        return map(operands[0], [&](std::uint32_t x) { return add(node, ExprOp::Negate, {x}); });
      case ExprOp::Add:
      case ExprOp::Subtract:
        return zip(operands[0], operands[1], [&](std::uint32_t a, std::uint32_t b) { return sum(node, a, b); });
      case ExprOp::Multiply:
        if (is_free(operands[0])) {
          return map(operands[1], [&](std::uint32_t x) { return add(node, node.op, {operands[0].offset, x}); });
        }
        [[fallthrough]];
      case ExprOp::Divide:
        if (is_free(operands[1])) {
          return map(operands[0], [&](std::uint32_t x) { return add(node, node.op, {x, operands[1].offset}); });
        }
        break;
      case ExprOp::If:
        if (is_free(operands[0])) {
          const auto choose = [&](std::uint32_t a, std::uint32_t b) { return choice(node, operands[0].offset, a, b); };
          return zip(operands[1], operands[2], choose);
        }
        break;
      default:
        break;
    }
    if (!nonlinear_) {
      nonlinear_ = node.span;
    }
    form.is_linear = false;
    return form;
  }

  template <typename Function>
  Form map(const Form& x, Function f) {
    return zip(x, x, [&](std::uint32_t a, std::uint32_t) { return f(a); });
  }

  template <typename Function>
  Form zip(const Form& a, const Form& b, Function f) {
    const auto both = [&](std::uint32_t p, std::uint32_t q) {
      return p == kNothing && q == kNothing ? kNothing : f(p, q);
    };
    Form form;
    form.slopes.resize(count_);
    for (std::size_t v = 0; v < count_; ++v) {
      form.slopes[v] = both(is_free(a) ? kNothing : a.slopes[v], is_free(b) ? kNothing : b.slopes[v]);
    }
    form.offset = both(a.offset, b.offset);
    return form;
  }

  std::uint32_t sum(const ExprNode& node, std::uint32_t a, std::uint32_t b) {
    if (b == kNothing) {
      return a;
    }
    if (a != kNothing) {
      return add(node, node.op, {a, b});
    }
    return node.op == ExprOp::Subtract ? add(node, ExprOp::Negate, {b}) : b;
  }

  // A missing side is zero in the unit of the other.
  std::uint32_t choice(const ExprNode& node, std::uint32_t condition, std::uint32_t a, std::uint32_t b) {
    if (a == kNothing) {
      a = add(node, ExprOp::Multiply, {number(node, 0), b});
    }
    if (b == kNothing) {
      b = add(node, ExprOp::Multiply, {number(node, 0), a});
    }
    return add(node, ExprOp::If, {condition, a, b});
  }

  std::uint32_t number(const ExprNode& origin, double value) {
    const std::uint32_t index = add(origin, ExprOp::Number, {});
    tree_[index].node.value = value;
    tree_[index].node.dimension = kNumber;
    tree_[index].node.unit = {};
    return index;
  }

  std::uint32_t add(const ExprNode& origin, ExprOp op, std::vector<std::uint32_t> children) {
    tree_.push_back({origin, std::move(children)});
    tree_.back().node.op = op;
    return static_cast<std::uint32_t>(tree_.size() - 1);
  }

  // Without recursion: a sum of thousands of terms is a deep tree.
  std::optional<Expression> written_out(std::uint32_t root) const {
    if (root == kNothing) {
      return std::nullopt;
    }
    struct Visit {
      std::uint32_t tree;
      std::size_t next_child;
      std::vector<std::uint32_t> written;
    };
    Expression out;
    out.text = source_.text;
    std::vector<Visit> stack = {{root, 0, {}}};
    while (true) {
      const TreeNode& tree = tree_[stack.back().tree];
      if (stack.back().next_child < tree.children.size()) {
        const std::uint32_t child = tree.children[stack.back().next_child++];
        stack.push_back({child, 0, {}});
        continue;
      }
      ExprNode node = tree.node;
      node.first_operand = static_cast<std::uint32_t>(out.operands.size());
      node.operand_count = static_cast<std::uint32_t>(stack.back().written.size());
      out.operands.insert(out.operands.end(), stack.back().written.begin(), stack.back().written.end());
      out.nodes.push_back(node);
      stack.pop_back();
      if (stack.empty()) {
        return out;
      }
      stack.back().written.push_back(static_cast<std::uint32_t>(out.nodes.size() - 1));
    }
  }

  const Expression& source_;
  std::size_t count_;
  std::vector<TreeNode> tree_;
  std::optional<ExprSpan> nonlinear_;
};

}  // namespace

LinearSplit split_linear(const Expression& expression, std::size_t variable_count,
                         const std::function<std::optional<std::size_t>(std::string_view)>& variable_of) {
  assert(!expression.nodes.empty());
  return Splitter(expression, variable_count).split(variable_of);
}

}  // namespace tectum
