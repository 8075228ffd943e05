// Invariants, tolerances, events and the field that carries tracers.
#include "engine/systems/ode/compiler/ode_compiler.h"

#include <algorithm>

#include "engine/base/text/nearest_name.h"

namespace truestep::ode {

using Target = OdeModel::Event::Target;

namespace {
constexpr size_t kMaxTracerVariables = 250;
}  // namespace

void OdeCompiler::rest() {
  for (const NamedText& e : def_.invariants) {
    if (!good_expression_name(e.name))
      issue("/invariants/" + pointer_token(e.name), "bad_name", "this is no name", e.name);
    model_.invariant_names.push_back(e.name);
    invariants_.push_back(read("/invariants/" + pointer_token(e.name), e.text));
  }
  for (size_t k = 0; k < def_.events.size(); ++k) event(k);
  plot();
  for (const NamedNumbers& a : def_.absolute_tolerances) {
    const std::string pointer = "/absolute_tolerances/" + pointer_token(a.name);
    const OdeModel::Named* n = named(model_.states, a.name);
    if (!n) {
      issue(pointer, "unknown_name", "no state has this name", a.name);
    } else if (a.values.size() != 1 && a.values.size() != n->places.size()) {
      issue(pointer, "inconsistent", "needs one number, or one per element of the state");
    } else {
      const double otherwise = def_.absolute_tolerance.value_or(def_.tolerance.value_or(kOdeTolerance));
      model_.absolute_tolerances.resize(model_.size(), otherwise);
      for (size_t i = 0; i < n->places.size(); ++i) {
        model_.absolute_tolerances[n->places[i]] = a.values[a.values.size() == 1 ? 0 : i];
      }
    }
  }
}

void OdeCompiler::event(size_t k) {
  const OdeEventDef& d = def_.events[k];
  const std::string pointer = "/events/" + std::to_string(k);
  OdeModel::Event e{d.name.empty() ? std::to_string(k) : d.name, d, {}, {}};
  if (!d.name.empty() && !good_expression_name(d.name)) {
    issue(pointer + "/name", "bad_name", "letters, digits and _, a letter first", d.name);
  }
  if (!d.when.empty()) guards_.push_back(read(pointer + "/when", d.when));
  std::vector<Node> values;
  for (const NamedText& s : d.set) {
    const std::string at = pointer + "/set/" + pointer_token(s.name);
    try {
      const ExpressionTarget target = parse_expression_target(s.name);
      const OdeModel::Named *state = named(model_.states, target.name),
                            *parameter = named(model_.parameters, target.name);
      if (!state && !parameter) {
        std::vector<std::string> known;
        for (const auto* list : {&model_.states, &model_.parameters}) {
          for (const OdeModel::Named& n : *list) known.push_back(n.name);
        }
        issue(at, "unknown_name", "no state and no parameter has this name", target.name, "",
              nearest_name(target.name, known));
        continue;
      }
      each_element(at, s.name, state ? *state : *parameter, target,
                   [&](uint32_t place, const ExpressionNames::Bindings& bindings) {
                     e.targets.push_back({state ? Target::Kind::state : Target::Kind::parameter, place});
                     values.push_back(read(at, s.text, bindings));
                   });
    } catch (const ExpressionFault& f) {
      fault(at, f, s.name);
    }
  }
  event_values_.push_back(std::move(values));
  model_.events.push_back(std::move(e));
}

void OdeCompiler::tracers() {
  if (!def_.tracers) return;
  if (model_.variables() > kMaxTracerVariables) {
    issue("/tracers", "too_many",
          "a field for tracers may depend on at most " + std::to_string(kMaxTracerVariables) +
              " parameters and states");
    return;
  }
  auto next = static_cast<int32_t>(model_.variables());
  for (const char* axis : {"x", "y", "z"}) {
    if (!names_.add_value(axis, graph_.variable(next++))) {
      issue("/tracers", "bad_name",
            "x, y and z are the tracers' coordinates here; use other names for states and parameters", axis);
    }
  }
  for (const char* axis : {"x", "y", "z"}) {
    const auto given = std::find_if(def_.tracers->velocity.begin(), def_.tracers->velocity.end(),
                                    [&](const NamedText& v) { return v.name == axis; });
    tracer_roots_.push_back(given == def_.tracers->velocity.end()
                                ? graph_.constant(0)
                                : read(std::string("/tracers/velocity/") + axis, given->text));
  }
}

}  // namespace truestep::ode
