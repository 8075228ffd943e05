// Symbolic derivatives by reverse accumulation (Griewank, Walther 2008, section 3.2): every node of the
// root's cone is visited once, from the root down, and passes its adjoint times the local partial derivative
// on to its operands. Products with 0 and 1 never become nodes. Steps and comparisons have derivative 0.
#include <algorithm>

#include "engine/math/expression/graph.h"

namespace truestep {

using O = Operator;
using Node = ExpressionGraph::Node;

void ExpressionGraph::accumulate(Node n, Node term) {
  if (adjoints_.size() < entries_.size()) adjoints_.resize(entries_.size(), kNone);
  Node& sum = adjoints_[static_cast<size_t>(n)];
  if (sum == kNone) touched_.push_back(n);
  sum = sum == kNone ? term : binary(O::add, sum, term);
}

void ExpressionGraph::add_partials(Node n, Node g) {
  const Entry e = at(n);
  const auto add = [&](Node operand, Node term) {
    const O op = at(operand).op;
    if (op != O::constant) accumulate(operand, term);
  };
  const auto times = [&](Node p) { return binary(O::multiply, g, p); };
  const auto over = [&](Node p) { return binary(O::divide, g, p); };
  const Node one = constant(1);
  const auto complement = [&] {  // 1 - a^2
    return binary(O::subtract, one, binary(O::multiply, e.a, e.a));
  };
  switch (e.op) {
    case O::negate:
      return add(e.a, unary(O::negate, g));
    case O::sqrt:
      return add(e.a, binary(O::divide, binary(O::multiply, constant(0.5), g), n));
    case O::abs:
      return add(e.a, times(unary(O::sign, e.a)));
    case O::exp:
      return add(e.a, times(n));
    case O::log:
      return add(e.a, over(e.a));
    case O::sin:
      return add(e.a, times(unary(O::cos, e.a)));
    case O::cos:
      return add(e.a, unary(O::negate, times(unary(O::sin, e.a))));
    case O::tan:
      return add(e.a, times(binary(O::add, one, binary(O::multiply, n, n))));
    case O::asin:
      return add(e.a, over(unary(O::sqrt, complement())));
    case O::acos:
      return add(e.a, unary(O::negate, over(unary(O::sqrt, complement()))));
    case O::atan:
      return add(e.a, over(binary(O::add, one, binary(O::multiply, e.a, e.a))));
    case O::add:
      add(e.a, g);
      return add(e.b, g);
    case O::subtract:
      add(e.a, g);
      return add(e.b, unary(O::negate, g));
    case O::multiply:
      add(e.a, times(e.b));
      return add(e.b, times(e.a));
    case O::divide: {
      const Node q = over(e.b);
      add(e.a, q);
      return add(e.b, unary(O::negate, binary(O::multiply, q, n)));
    }
    case O::power:
      add(e.a, times(binary(O::multiply, e.b, power(e.a, binary(O::subtract, e.b, one)))));
      return add(e.b, times(binary(O::multiply, n, unary(O::log, e.a))));
    case O::atan2: {  // e.a = y, e.b = x
      const Node q = over(binary(O::add, binary(O::multiply, e.a, e.a), binary(O::multiply, e.b, e.b)));
      add(e.a, binary(O::multiply, q, e.b));
      return add(e.b, unary(O::negate, binary(O::multiply, q, e.a)));
    }
    case O::min:
    case O::max: {
      const Node second = e.op == O::min ? binary(O::less, e.b, e.a) : binary(O::less, e.a, e.b);
      const Node zero = constant(0);
      add(e.a, choose(second, zero, g));
      return add(e.b, choose(second, g, zero));
    }
    case O::choose: {
      const Node zero = constant(0);
      add(e.b, choose(e.a, g, zero));
      return add(e.c, choose(e.a, zero, g));
    }
    default:  // constants, variables, steps, comparisons
      return;
  }
}

void ExpressionGraph::differentiate(Node root, int32_t first, int32_t count, std::vector<Partial>& out) {
  // Operands come before their users, so descending numbers are a topological order of the root's cone.
  in_cone_.resize(entries_.size());
  stack_.push_back(root);
  while (!stack_.empty()) {
    const Node n = stack_.back();
    stack_.pop_back();
    if (in_cone_[static_cast<size_t>(n)]) continue;
    in_cone_[static_cast<size_t>(n)] = 1;
    cone_.push_back(n);
    const Entry& e = at(n);
    for (const Node operand : {e.a, e.b, e.c}) {
      if (arity(e.op) > 0 && operand != kNone) stack_.push_back(operand);
    }
  }
  std::sort(cone_.begin(), cone_.end(), std::greater<>());
  accumulate(root, constant(1));
  const size_t begin = out.size();
  for (const Node n : cone_) {
    const Node g = adjoints_[static_cast<size_t>(n)];
    if (g == kNone) continue;
    charge(0);
    const Entry e = at(n);
    if (e.op == O::variable) {
      if (e.a >= first && e.a < first + count) out.push_back({e.a - first, g});
    } else {
      add_partials(n, g);
    }
  }
  std::sort(out.begin() + static_cast<std::ptrdiff_t>(begin), out.end(),
            [](const Partial& p, const Partial& q) { return p.variable < q.variable; });
  for (const Node n : cone_) in_cone_[static_cast<size_t>(n)] = 0;
  for (const Node n : touched_) adjoints_[static_cast<size_t>(n)] = kNone;
  cone_.clear();
  touched_.clear();
}

}  // namespace truestep
