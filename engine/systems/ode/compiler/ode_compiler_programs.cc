// Programs of all roots; pairing of equations into a second-order system; derivatives in their sparse shape.
#include "engine/systems/ode/compiler/ode_compiler.h"

#include <algorithm>
#include <numeric>

namespace truestep::ode {

ExpressionProgram OdeCompiler::program(const std::vector<Node>& roots) const {
  return {graph_, roots, model_.variables()};
}

void OdeCompiler::programs() {
  OdeModel& m = model_;
  find_signs();
  sides_ = signs_.size();
  m.switched = switched_;
  if (switched_ > 0) {
    std::vector<Node> both = roots_;
    for (const Node n : signs_) both.push_back(graph_.at(n).a);
    both = with_sides(both);
    slide_guards_.assign(both.begin() + static_cast<std::ptrdiff_t>(roots_.size()), both.end());
    both.resize(roots_.size());
    roots_ = std::move(both);
    if (!slides()) sides_ = 0;
  }
  m.rate = program(roots_);
  m.invariants = program(invariants_);
  std::vector<Node> all_guards = guards_;
  all_guards.insert(all_guards.end(), slide_guards_.begin(), slide_guards_.end());
  m.guards = program(all_guards);
  m.plot = program(plot_);
  for (size_t k = 0; k < m.events.size(); ++k) m.events[k].values = program(event_values_[k]);
  const auto used = graph_.variables_of(roots_);
  m.autonomous = used.empty() || used[0] != 0;
  if (!tracer_roots_.empty()) {
    try {
      m.tracer_velocity = ExpressionRows(graph_, tracer_roots_);
    } catch (const ExpressionFault& f) {
      throw Error("scene_invalid", f.message,
                  {"/tracers/velocity", "bad_expression", f.message, "", "", "", ""});
    }
  }
  pair_up();
  const auto n = static_cast<int32_t>(m.size());
  m.second_order = !paired_.empty() && std::is_sorted(paired_.begin(), paired_.end());
  if (m.second_order) {
    const std::vector<Node> accelerations(roots_.begin() + n / 2, roots_.end());
    m.acceleration = program(accelerations);
    const auto on = graph_.variables_of(accelerations);
    m.depends_on_velocity = !on.empty() && on.back() >= first_state_ + n / 2;
    if (switched_ > 0) m.depends_on_velocity = true;
    differentiate(accelerations, n / 2, 2, m.acceleration_jacobian);
  }
  differentiate(roots_, n, 1, m.jacobian);
  contacts();
  stops();
}

// dn/dt along the solution: dn/dt + dn/dy f.
OdeCompiler::Node OdeCompiler::rate_of(Node n) {
  std::vector<ExpressionGraph::Partial> partials;
  graph_.differentiate(n, 0, 1, partials);
  Node sum = partials.empty() ? graph_.constant(0) : partials[0].node;
  partials.clear();
  graph_.differentiate(n, first_state_, static_cast<int32_t>(model_.size()), partials);
  for (const auto& p : partials) {
    const Node term = graph_.binary(Operator::multiply, p.node, roots_[static_cast<size_t>(p.variable)]);
    sum = graph_.binary(Operator::add, sum, term);
  }
  return sum;
}

void OdeCompiler::contacts() {
  OdeModel& m = model_;
  m.contacts.resize(guards_.size());
  bool any = false;
  const auto n = static_cast<int32_t>(m.size());
  size_t guard = 0;
  for (const OdeModel::Event& e : m.events) {
    if (e.def.when.empty()) continue;
    OdeModel::Contact& c = m.contacts[guard];
    const Node g = guards_[guard++];
    std::vector<uint8_t> set(m.size());
    for (const auto& target : e.targets) {
      const bool moves = !m.second_order || target.place >= m.size() / 2;
      if (target.kind == OdeModel::Event::Target::Kind::state && moves) set[target.place] = 1;
    }
    if (std::ranges::find(set, 1) == set.end()) continue;
    try {
      const Node rate = rate_of(g);
      std::vector<Node> outputs{rate, rate_of(rate)};
      std::vector<ExpressionGraph::Partial> partials;
      graph_.differentiate(rate, first_state_, n, partials);
      for (const auto& p : partials) {
        if (!set[static_cast<size_t>(p.variable)]) continue;
        c.places.push_back(static_cast<uint32_t>(p.variable));
        outputs.push_back(p.node);
      }
      partials.clear();
      graph_.differentiate(g, first_state_, n, partials);
      for (const auto& p : partials) {
        const auto place = static_cast<uint32_t>(p.variable);
        if (std::ranges::find(c.places, place) == c.places.end()) c.watched.push_back(place);
      }
      c.program = program(outputs);
      any = any || !c.places.empty();
    } catch (const ExpressionFault&) {
      c = {};  // too large: such an event never comes to rest
    }
  }
  if (!any) m.contacts.clear();
}

void OdeCompiler::pair_up() {
  const size_t n = model_.size();
  if (n == 0 || n % 2) return;
  std::vector<int32_t> velocity_of(n, -1);
  std::vector<uint8_t> is_velocity(n);
  // In declaration order, so that the scene decides when several pairings exist.
  std::vector<uint32_t> declared(n);
  for (uint32_t d = 0; d < n; ++d) declared[d] = order_.empty() ? d : order_[d];
  size_t pairs = 0;
  for (const uint32_t p : declared) {
    const auto& e = graph_.at(roots_[p]);
    if (is_velocity[p] || e.op != Operator::variable || e.a < first_state_) continue;
    const auto v = static_cast<uint32_t>(e.a - first_state_);
    if (v == p || is_velocity[v] || velocity_of[v] >= 0) continue;
    velocity_of[p] = static_cast<int32_t>(v);
    is_velocity[v] = 1;
    ++pairs;
  }
  if (2 * pairs != n) return;
  paired_.resize(n);
  uint32_t next = 0;
  for (uint32_t d = 0; d < n; ++d) {
    const uint32_t p = declared[d];
    if (velocity_of[p] < 0) continue;
    const auto v = static_cast<uint32_t>(velocity_of[p]);
    const auto dv = static_cast<size_t>(std::find(declared.begin(), declared.end(), v) - declared.begin());
    paired_[d] = next;
    paired_[dv] = next + static_cast<uint32_t>(n / 2);
    ++next;
  }
  if (!order_.empty() && paired_ == order_) std::iota(paired_.begin(), paired_.end(), 0);
}

void OdeCompiler::differentiate(const std::vector<Node>& roots, int32_t n, int32_t blocks, OdeMatrix& out) {
  std::vector<std::vector<ExpressionGraph::Partial>> rows(roots.size());
  try {
    for (size_t i = 0; i < roots.size(); ++i) {
      graph_.differentiate(roots[i], first_state_, n * blocks, rows[i]);
    }
  } catch (const ExpressionFault&) {
    return;  // too large: methods difference a dense matrix
  }
  std::vector<std::vector<int32_t>> pattern(static_cast<size_t>(n));  // rows of every column, ascending
  int32_t lower = 0, upper = 0;
  size_t count = 0;
  for (int32_t i = 0; i < n; ++i) {
    for (const auto& p : rows[static_cast<size_t>(i)]) {
      auto& column = pattern[static_cast<size_t>(p.variable % n)];
      if (!column.empty() && column.back() == i) continue;
      column.push_back(i);
      lower = std::max(lower, i - p.variable % n), upper = std::max(upper, p.variable % n - i);
      ++count;
    }
  }
  const auto width = static_cast<size_t>(lower + upper + 1), size = static_cast<size_t>(n);
  if (size > 12 && 3 * width <= size) {
    out.kind = MatrixShape::Kind::banded;
    out.lower = static_cast<size_t>(lower), out.upper = static_cast<size_t>(upper);
  } else if (size > 12 && 6 * count <= size * size) {
    out.kind = MatrixShape::Kind::sparse;
    out.column_start.push_back(0);
    for (const auto& column : pattern) {
      out.rows.insert(out.rows.end(), column.begin(), column.end());
      out.column_start.push_back(static_cast<int32_t>(out.rows.size()));
    }
  }
  const size_t values = out.shape().values(size);
  if (values * static_cast<size_t>(blocks) > 4'000'000) return;
  std::vector<Node> nodes(values * static_cast<size_t>(blocks), graph_.constant(0));
  for (int32_t i = 0; i < n; ++i) {
    for (const auto& p : rows[static_cast<size_t>(i)]) {
      const auto j = static_cast<size_t>(p.variable % n), row = static_cast<size_t>(i);
      size_t at = j * size + row;
      if (out.kind == MatrixShape::Kind::banded) at = j * width + out.upper + row - j;
      if (out.kind == MatrixShape::Kind::sparse) {
        const auto begin = out.rows.begin() + out.column_start[j],
                   end = out.rows.begin() + out.column_start[j + 1];
        at = static_cast<size_t>(std::lower_bound(begin, end, i) - out.rows.begin());
      }
      nodes[static_cast<size_t>(p.variable / n) * values + at] = p.node;
    }
  }
  out.program = program(nodes);
}

}  // namespace truestep::ode
