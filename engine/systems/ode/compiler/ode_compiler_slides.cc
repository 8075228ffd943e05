// Signs of expressions of the states: each becomes a parameter of the model, its side, which switches where
// the expression crosses zero (ode_slides.h).
#include <algorithm>

#include "engine/systems/ode/compiler/ode_compiler.h"

namespace truestep::ode {

namespace {
/// More than this would cost more than it saves; their signs stay as they are.
constexpr size_t kMostSides = 16;
}  // namespace

void OdeCompiler::find_signs() {
  std::vector<Node> open = roots_;
  std::vector<uint8_t> seen(graph_.size());
  while (!open.empty()) {
    const Node n = open.back();
    open.pop_back();
    if (n < 0 || seen[static_cast<size_t>(n)]) continue;
    seen[static_cast<size_t>(n)] = 1;
    const ExpressionGraph::Entry& e = graph_.at(n);
    for (const Node operand : {e.a, e.b, e.c}) {
      if (arity(e.op) > 0) open.push_back(operand);
    }
    if (e.op != Operator::sign) continue;
    const std::vector<Node> of{e.a};
    const auto used = graph_.variables_of(of);
    if (!used.empty() && used.back() >= first_state_) signs_.push_back(n);
  }
  std::ranges::sort(signs_);
  if (signs_.size() > kMostSides) signs_.clear();
}

std::vector<OdeCompiler::Node> OdeCompiler::with_sides(const std::vector<Node>& roots) {
  const size_t size = graph_.size();
  std::vector<Node> copy(size);
  const int32_t first = first_state_ - static_cast<int32_t>(switched_);
  for (size_t i = 0; i < size; ++i) {
    const auto n = static_cast<Node>(i);
    const ExpressionGraph::Entry e = graph_.at(n);
    copy[i] = n;
    if (const auto at = std::ranges::find(signs_, n); at != signs_.end()) {
      copy[i] = graph_.variable(first + static_cast<int32_t>(at - signs_.begin()));
      continue;
    }
    const int operands = arity(e.op);
    const auto of = [&](Node operand) { return copy[static_cast<size_t>(operand)]; };
    const Node a = operands > 0 ? of(e.a) : e.a, b = operands > 1 ? of(e.b) : e.b,
               c = operands > 2 ? of(e.c) : e.c;
    if (a == e.a && b == e.b && c == e.c) continue;
    copy[i] = operands == 1   ? graph_.unary(e.op, a)
              : operands == 2 ? graph_.binary(e.op, a, b)
                              : graph_.choose(a, b, c);
  }
  std::vector<Node> out;
  for (const Node n : roots) out.push_back(copy[static_cast<size_t>(n)]);
  return out;
}

bool OdeCompiler::slides() {
  std::vector<Node> outputs;
  const int32_t first = first_state_ - static_cast<int32_t>(switched_);
  const auto on_sides = [&](Node n) {
    const std::vector<Node> root{n};
    return std::ranges::any_of(graph_.variables_of(root),
                               [&](int32_t v) { return v >= first && v < first_state_; });
  };
  for (const Node g : slide_guards_) {
    const Node rate = rate_of(g);
    if (on_sides(g)) return false;
    outputs.push_back(g);
    std::vector<Node> by_side(switched_, graph_.constant(0));
    std::vector<ExpressionGraph::Partial> partials;
    graph_.differentiate(rate, first, static_cast<int32_t>(switched_), partials);
    for (const auto& p : partials) {
      if (on_sides(p.node)) return false;
      by_side[static_cast<size_t>(p.variable)] = p.node;
    }
    outputs.push_back(rate);
    outputs.insert(outputs.end(), by_side.begin(), by_side.end());
  }
  model_.slides = program(outputs);
  return true;
}

}  // namespace truestep::ode
