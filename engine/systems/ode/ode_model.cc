#include "engine/systems/ode/ode_model.h"

#include <charconv>

#include "engine/systems/ode/compiler/ode_compiler.h"

namespace truestep::ode {

std::optional<OdeModel::Event::Target> OdeModel::find(std::string_view name) const {
  std::string base(name.substr(0, name.find('[')));
  size_t index = 0;
  const bool indexed = base.size() < name.size();
  if (indexed) {
    const char* end = name.data() + name.size() - 1;
    const auto [rest, error] = std::from_chars(name.data() + base.size() + 1, end, index);
    if (name.back() != ']' || rest != end || error != std::errc{}) return std::nullopt;
  }
  using Target = Event::Target;
  for (const auto kind : {Target::Kind::state, Target::Kind::parameter}) {
    for (const Named& n : kind == Target::Kind::state ? states : parameters) {
      if (n.name != base || index >= n.places.size() || indexed != (n.form == NamedNumbers::Form::array))
        continue;
      return Target{kind, n.places[index]};
    }
  }
  return std::nullopt;
}

OdeModel compile_ode(const OdeDef& def) {
  try {
    OdeCompiler first(def, {});
    OdeModel model = first.compile();
    // All states may pair up, but in another order than positions, velocities: compile again in that order.
    const auto order = model.second_order ? std::vector<uint32_t>{} : first.paired();
    if (first.sides() > 0) {
      OdeCompiler second(def, order, first.sides());
      OdeModel switched = second.compile();
      if (second.sides() == first.sides()) return switched;
    }
    if (order.empty()) return model;
    return OdeCompiler(def, order).compile();
  } catch (const ExpressionFault& fault) {
    throw Error("scene_invalid", fault.message,
                {"/equations", "bad_expression", fault.message, "", "", "", ""});
  }
}

}  // namespace truestep::ode
