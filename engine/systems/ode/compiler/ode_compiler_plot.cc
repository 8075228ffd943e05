// What is drawn, also when the scene does not say.
#include "engine/systems/ode/compiler/ode_compiler.h"

#include <algorithm>

namespace truestep::ode {

void OdeCompiler::plot() {
  std::vector<std::string> axes = def_.plot;
  if (axes.empty()) axes = default_axes();
  model_.bodies = axes.empty() ? 0 : 1;
  for (size_t k = 0; k < axes.size(); ++k) {
    const size_t n = elements(axes[k]);
    if (n == 0) continue;
    if (model_.bodies != 1 && model_.bodies != n) {
      issue("/plot/" + std::to_string(k), "inconsistent",
            "arrays that are drawn together must be equally long", axes[k]);
    }
    model_.bodies = std::max(model_.bodies, n);
  }
  for (size_t body = 0; body < model_.bodies; ++body) {
    for (size_t k = 0; k < 3; ++k) {
      Node node = graph_.constant(0);
      const OdeModel::Named* n = k < axes.size() ? named(model_.states, axes[k]) : nullptr;
      if (n && n->form == NamedNumbers::Form::array) {
        if (body < n->places.size()) {
          node = graph_.variable(first_state_ + static_cast<int32_t>(n->places[body]));
        }
      } else if (k < axes.size()) {
        const size_t before = issues_.size();
        node = read("/plot/" + std::to_string(k), axes[k], {{"i", static_cast<int64_t>(body)}});
        if (issues_.size() > before) axes[k] = "0";  // one fault for all points
      }
      plot_.push_back(node);
    }
  }
  if (def_.axes.size() > axes.size())
    issue("/axes", "inconsistent", "there are more names than axes: " + std::to_string(axes.size()), "");
  if (!def_.curves.empty() && def_.curves.size() != model_.bodies)
    issue("/curves", "inconsistent", "one name for each point is needed: " + std::to_string(model_.bodies),
          "");
  if (axes.size() < 2 || !issues_.empty()) return;
  for (size_t k = 0; k < axes.size(); ++k) {
    model_.axes.push_back(axis(k, axes[k]));
    // Words say their own unit.
    if (k < def_.axes.size() && !def_.axes[k].empty())
      model_.axes.back().name = def_.axes[k], model_.axes.back().unit.clear();
  }
  model_.curves = def_.curves.empty() ? curves() : def_.curves;
}

size_t OdeCompiler::elements(const std::string& axis) const {
  if (const OdeModel::Named* n = named(model_.states, axis)) {
    return n->form == NamedNumbers::Form::array ? n->places.size() : 0;
  }
  size_t longest = 0;
  for (const OdeModel::Named& n : model_.states) {
    if (n.form == NamedNumbers::Form::array) longest = std::max(longest, n.places.size());
  }
  return axis.find("[i]") != std::string::npos ? longest : 0;
}

std::vector<std::string> OdeCompiler::default_axes() const {
  std::vector<std::string> axes;
  if (model_.states.empty()) return axes;
  const auto form = model_.states[0].form;
  const size_t length = model_.states[0].places.size();
  const bool second = !def_.second.empty();
  const size_t positions = second ? def_.states.size() : model_.states.size();
  for (size_t k = 0; k < positions && axes.size() < 3; ++k) {
    const OdeModel::Named& s = model_.states[k];
    if (s.form == form && s.places.size() == length) axes.push_back(s.name);
  }
  // x, y, vx, vy and the like: the third is a velocity.
  if (!second && axes.size() == 3 && is_velocity(axes[2])) axes.pop_back();
  if (axes.size() == 1 && form == NamedNumbers::Form::number && model_.states.size() > 1) {
    axes.push_back(model_.states[1].name == axes[0] ? model_.states[0].name : model_.states.back().name);
  }
  return axes;
}

bool OdeCompiler::is_velocity(const std::string& name) const {
  const OdeModel::Named* n = named(model_.states, name);
  const Node v = graph_of_variable(n->places[0]);
  return std::find(roots_.begin(), roots_.end(), v) != roots_.end();
}

OdeCompiler::Node OdeCompiler::graph_of_variable(uint32_t place) const {
  for (size_t n = 0; n < graph_.size(); ++n) {
    const auto& e = graph_.at(static_cast<Node>(n));
    if (e.op == Operator::variable && e.a == first_state_ + static_cast<int32_t>(place))
      return static_cast<Node>(n);
  }
  return ExpressionGraph::kNone;
}

}  // namespace truestep::ode
