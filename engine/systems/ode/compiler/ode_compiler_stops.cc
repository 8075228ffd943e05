// Comparisons, signs and floors of expressions of time and parameters alone: an integration has to stop where
// they change, or it steps over what they switch on.
#include "engine/systems/ode/compiler/ode_compiler.h"

namespace truestep::ode {

OdeModel::Stop OdeCompiler::kind_of_stop(Node n, Node slope) const {
  const auto depends_on_time = [&](Node m) {
    const std::vector<Node> root{m};
    const auto used = graph_.variables_of(root);
    return !used.empty() && used.front() == 0;
  };
  if (depends_on_time(slope)) return OdeModel::Stop::sampled;
  OdeModel::Stop kind = OdeModel::Stop::crossing;
  std::vector<Node> open{n};
  std::vector<uint8_t> seen(graph_.size());
  while (!open.empty()) {
    const Node m = open.back();
    open.pop_back();
    if (m < 0 || seen[static_cast<size_t>(m)]) continue;
    seen[static_cast<size_t>(m)] = 1;
    const ExpressionGraph::Entry& e = graph_.at(m);
    const int operands = arity(e.op);
    if (operands > 0) open.push_back(e.a);
    if (operands > 1) open.push_back(e.b);
    if (operands > 2) open.push_back(e.c);
    const bool bends = e.op == Operator::abs || e.op == Operator::min || e.op == Operator::max ||
                       e.op == Operator::choose || e.op == Operator::both || e.op == Operator::either;
    const bool jumps = e.op == Operator::floor || e.op == Operator::sign || e.op == Operator::less ||
                       e.op == Operator::less_equal || e.op == Operator::equal || e.op == Operator::not_equal;
    if (!(bends || jumps) || !depends_on_time(m)) continue;
    if (bends) return OdeModel::Stop::sampled;
    kind = OdeModel::Stop::piecewise;
  }
  return kind;
}

void OdeCompiler::stops() {
  std::vector<Node> open = roots_, outputs;
  std::vector<uint8_t> seen(graph_.size());
  const auto add = [&](Node n, OdeModel::Stop kind) {
    const std::vector<Node> root{n};
    const auto used = graph_.variables_of(root);
    if (!used.empty() && used.back() >= first_state_) model_.switches = true;
    if (used.empty() || used.front() != 0 || used.back() >= first_state_) return;
    std::vector<ExpressionGraph::Partial> by_time;
    graph_.differentiate(n, 0, 1, by_time);
    const Node slope = by_time.empty() ? graph_.constant(0) : by_time[0].node;
    const OdeModel::Stop way = kind_of_stop(n, slope);
    // A whole number that anything but a straight line reaches is not looked for.
    if (way != OdeModel::Stop::crossing && kind == OdeModel::Stop::integer) return;
    model_.stops.push_back(kind == OdeModel::Stop::integer ? kind : way);
    outputs.push_back(n), outputs.push_back(slope);
  };
  while (!open.empty()) {
    const Node n = open.back();
    open.pop_back();
    if (n < 0 || static_cast<size_t>(n) >= seen.size() || seen[static_cast<size_t>(n)]) continue;
    seen[static_cast<size_t>(n)] = 1;
    const ExpressionGraph::Entry e = graph_.at(n);
    const int operands = arity(e.op);
    if (operands > 0) open.push_back(e.a);
    if (operands > 1) open.push_back(e.b);
    if (operands > 2) open.push_back(e.c);
    switch (e.op) {
      case Operator::less:
      case Operator::less_equal:
      case Operator::equal:
      case Operator::not_equal:
        add(graph_.binary(Operator::subtract, e.a, e.b), OdeModel::Stop::crossing);
        break;
      case Operator::sign:
        add(e.a, OdeModel::Stop::crossing);
        break;
      case Operator::floor:
        add(e.a, OdeModel::Stop::integer);
        break;
      default:
        break;
    }
  }
  model_.stop_values = program(outputs);
}

}  // namespace truestep::ode
