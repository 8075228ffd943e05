// Checks of a state from outside: contacts between existing shapes, user forces on existing bodies.
#include "engine/systems/rigid2d/columns.h"
#include "engine/systems/rigid2d/rigid2d.h"
#include "engine/systems/rigid2d/solver/substeps.h"

namespace truestep::rigid2d {

void Rigid2d::check(StateCheck& check, double) const {
  const State& s = check.state();
  check
      .together(
          {columns::contact_key, columns::contact_id, columns::contact_impulse, columns::contact_offset})
      .together({columns::push_body, columns::push_force, columns::push_local, columns::push_remaining})
      .together({columns::drag_body, columns::drag_local, columns::drag_target, columns::drag_stiffness,
                 columns::drag_impulse});
  const size_t shapes = model_.shapes.size();
  uint64_t last = 0;
  for (const uint64_t key : s.span<uint64_t>(columns::contact_key)) {
    check.require(key >= last && key > 0 && key >> 32 < shapes && static_cast<uint32_t>(key) < shapes,
                  "contact.key");
    last = key;
  }
  for (const auto column : {columns::push_body, columns::drag_body}) {
    for (const uint32_t body : s.span<uint32_t>(column))
      check.require(body < model_.count(), "the body of a push or drag");
  }
  const auto most = static_cast<uint32_t>(Substeps::kMostTimes * settings_.substeps);
  check.require(s.span<uint32_t>(columns::substeps)[0] <= most, "substeps");
  for (const uint32_t status : s.span<uint32_t>(columns::status))
    check.require(status <= (kAwake | kPinned | kRemoved), "status");
}

}  // namespace truestep::rigid2d
