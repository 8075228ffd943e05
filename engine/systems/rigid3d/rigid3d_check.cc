// Checks of a state from outside: valid kinds of bodies, contacts and joints between existing bodies.
#include "engine/systems/rigid3d/rigid3d.h"
#include "engine/systems/rigid3d/rigid3d_state.h"

namespace truestep::rigid3d {

void Rigid3d::check(StateCheck& check, double) const {
  const State& s = check.state();
  check.together(columns::position, columns::per_body_end, most_bodies_)
      .together(columns::contact_bodies, columns::contacts_end)
      .together({columns::push_id, columns::push_force, columns::push_at, columns::push_remaining})
      .together({columns::drag_id, columns::drag_target, columns::drag_at, columns::drag_stiffness});
  const size_t bodies = s.rows(columns::position), kinds = bodies_.kinds.size();
  for (const uint32_t kind : s.span<uint32_t>(columns::kind)) check.require(kind < kinds, "kind");
  const auto pairs = s.span<uint32_t>(columns::contact_bodies);
  for (size_t k = 0; k < pairs.size(); k += 2) {
    check.require(pairs[k] < bodies && pairs[k + 1] < bodies && pairs[k] != pairs[k + 1], "contact.bodies");
    constexpr uint32_t kMostPoints = 4;
    check.require(s.span<uint32_t>(columns::contact_ids)[k / 2 * 5] <= kMostPoints, "contact.ids");
  }
  check.below(columns::joint_bodies, bodies);
  const auto ids = s.span<uint64_t>(columns::id);
  for (size_t i = 1; i < ids.size(); ++i) check.require(ids[i - 1] < ids[i], "id");
}

}  // namespace truestep::rigid3d
