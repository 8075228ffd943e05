// Right-hand sides: one root per state.
#include "engine/systems/ode/compiler/ode_compiler.h"

#include "engine/base/text/nearest_name.h"

namespace truestep::ode {

void OdeCompiler::equations() {
  roots_.assign(model_.size(), ExpressionGraph::kNone);
  for (const NamedText& e : def_.equations) equation("/equations/", e, "");
  for (const NamedText& e : def_.second) equation("/second/", e, "'");
  // x' = v for the equations of second order.
  for (const NamedText& e : def_.second) {
    const auto *x = named(model_.states, base_name(e.name)),
               *v = named(model_.states, base_name(e.name) + "'");
    if (!x || !v) continue;
    for (size_t k = 0; k < x->places.size(); ++k) {
      Node& root = roots_[x->places[k]];
      const Node node = graph_.variable(first_state_ + static_cast<int32_t>(v->places[k]));
      if (root != ExpressionGraph::kNone && root != node) {
        issue("/second/" + pointer_token(e.name), "duplicate",
              "this state also has an equation of first order", e.name);
      }
      root = node;
    }
  }
  std::string missing;
  for (size_t k = 0; k < roots_.size(); ++k) {
    if (roots_[k] != ExpressionGraph::kNone) continue;
    if (missing.size() < 200) missing += (missing.empty() ? "" : ", ") + model_.labels[k];
    roots_[k] = graph_.constant(0);
  }
  if (!missing.empty()) issue("/equations", "missing", "no equation for: " + missing);
}

void OdeCompiler::equation(const std::string& list, const NamedText& e, const std::string& suffix) {
  const std::string pointer = list + pointer_token(e.name);
  try {
    const ExpressionTarget target = parse_expression_target(e.name);
    const OdeModel::Named* n = named(model_.states, target.name + suffix);
    if (!n) {
      std::vector<std::string> known;
      std::string all;
      for (const NamedNumbers& s : def_.states) {
        known.push_back(s.name);
        if (all.size() < 200) all += (all.empty() ? "" : ", ") + s.name;
      }
      return issue(pointer, "unknown_name", "no state has this name", target.name, all,
                   nearest_name(target.name, known));
    }
    bool good = true;
    each_element(pointer, e.name, *n, target, [&](uint32_t place, const ExpressionNames::Bindings& bindings) {
      if (!good) return;
      const size_t before = issues_.size();
      const Node node = read(pointer, e.text, bindings);
      if (roots_[place] != ExpressionGraph::kNone) {
        issue(pointer, "duplicate", model_.labels[place] + " has another equation", e.name);
      }
      roots_[place] = node;
      good = issues_.size() == before;  // one fault for a whole family
    });
  } catch (const ExpressionFault& f) {
    fault(pointer, f, e.name);
  }
}

}  // namespace truestep::ode
