// Names of parameters, states, velocities and definitions.
#include "engine/systems/ode/compiler/ode_compiler.h"

#include <algorithm>

namespace truestep::ode {

namespace {
constexpr size_t kMaxStates = 20'000;
}  // namespace

void OdeCompiler::add_name(const std::string& pointer, const OdeModel::Named& named, int32_t first) {
  std::vector<Node> nodes;
  for (const uint32_t place : named.places)
    nodes.push_back(graph_.variable(first + static_cast<int32_t>(place)));
  const bool added = named.form == NamedNumbers::Form::number
                         ? names_.add_value(named.name, nodes[0])
                         : names_.add_array(named.name, std::move(nodes));
  if (!added) {
    issue(pointer, "bad_name", "this name is taken, reserved or no name", named.name,
          "letters, digits, _; not t, pi, sum, len or a function");
  }
}

void OdeCompiler::declare() {
  names_.add_value("t", graph_.variable(0));
  for (const NamedNumbers& p : def_.parameters) {
    OdeModel::Named named{p.name, {}, p.form};
    for (const double v : p.values) {
      named.places.push_back(static_cast<uint32_t>(model_.parameter_values.size()));
      model_.parameter_values.push_back(v);
    }
    add_name("/parameters/" + pointer_token(p.name), named, 1);
    model_.parameters.push_back(std::move(named));
  }
  model_.parameter_values.resize(model_.parameter_values.size() + switched_, 1.0);
  first_state_ = static_cast<int32_t>(1 + model_.parameter_values.size());
  for (const NamedNumbers& s : def_.states) add_state("/states/" + pointer_token(s.name), s);
  for (const NamedText& e : def_.second) add_velocity(e.name);
  for (const NamedNumbers& v : def_.velocities) {
    const auto same = [&](const NamedText& e) { return base_name(e.name) == v.name; };
    if (std::none_of(def_.second.begin(), def_.second.end(), same)) {
      issue("/velocities/" + pointer_token(v.name), "unknown_name",
            "no equation of second order is given for it", v.name);
    }
  }
  if (!order_.empty()) {
    std::vector<double> values(model_.initial.size());
    std::vector<std::string> labels(values.size());
    for (size_t d = 0; d < values.size(); ++d) {
      values[order_[d]] = model_.initial[d];
      labels[order_[d]] = model_.labels[d];
    }
    model_.initial = std::move(values);
    model_.labels = std::move(labels);
  }
}

std::string OdeCompiler::base_name(const std::string& target) {
  return target.substr(0, target.find_first_of("[ "));
}

void OdeCompiler::add_state(const std::string& pointer, const NamedNumbers& s) {
  if (model_.initial.size() + s.values.size() > kMaxStates) {
    return issue(pointer, "too_many", "too many states", "", "at most " + std::to_string(kMaxStates));
  }
  if (s.name == "position")
    issue(pointer, "bad_name", "\"position\" is reserved for drawing; use another name for the state");
  OdeModel::Named named{s.name, {}, s.form};
  for (size_t k = 0; k < s.values.size(); ++k) {
    const auto declared = static_cast<uint32_t>(model_.initial.size());
    named.places.push_back(order_.empty() ? declared : order_[declared]);
    model_.labels.push_back(s.form == NamedNumbers::Form::number ? s.name
                                                                 : s.name + "[" + std::to_string(k) + "]");
    model_.initial.push_back(s.values[k]);
  }
  add_name(pointer, named, first_state_);
  model_.states.push_back(std::move(named));
}

void OdeCompiler::add_velocity(const std::string& target) {
  const std::string name = base_name(target);
  const auto same = [&](const auto& e) { return e.name == name; };
  const auto state = std::find_if(def_.states.begin(), def_.states.end(), same);
  const auto taken = std::find_if(model_.states.begin(), model_.states.end(),
                                  [&](const OdeModel::Named& s) { return s.name == name + "'"; });
  if (state == def_.states.end() || taken != model_.states.end()) return;  // reported with the equation
  NamedNumbers v{name + "'", std::vector<double>(state->values.size(), 0.0), state->form};
  const auto given = std::find_if(def_.velocities.begin(), def_.velocities.end(), same);
  if (given != def_.velocities.end()) {
    if (given->values.size() != v.values.size()) {
      issue("/velocities/" + pointer_token(name), "inconsistent",
            "needs as many numbers as the state has: " + std::to_string(v.values.size()));
    } else {
      v.values = given->values;
    }
  }
  add_state("/second/" + pointer_token(target), v);
}

void OdeCompiler::definitions() {
  for (const NamedText& e : def_.let) {
    const std::string pointer = "/let/" + pointer_token(e.name);
    try {
      const ExpressionTarget target = parse_expression_target(e.name);
      bool added;
      if (target.indices.empty()) {
        added = names_.add_value(target.name, read(pointer, e.text));
      } else {
        ExpressionNames::Bindings zero;
        for (const std::string& i : target.indices) {
          if (!good_expression_name(i)) throw ExpressionFault{0, "indices of a definition must be names", ""};
          zero.emplace_back(i, 0);
        }
        try {
          names_.read(graph_, e.text, zero);
        } catch (const ExpressionFault& f) {
          fault(pointer, f, e.text);
        }
        added = names_.add_definition(target.name, target.indices, e.text);
      }
      if (!added) issue(pointer, "bad_name", "this name is taken, reserved or no name", target.name);
    } catch (const ExpressionFault& f) {
      fault(pointer, f, e.name);
    }
  }
}

}  // namespace truestep::ode
