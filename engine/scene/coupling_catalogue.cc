#include "engine/scene/coupling_catalogue.h"

#include "engine/couplings/attachment/attachment.h"
#include "engine/couplings/contact/contact.h"
#include "engine/couplings/drive/drive.h"
#include "engine/couplings/immersion/immersion.h"
#include "engine/couplings/ragdoll/ragdoll.h"

namespace truestep {

std::span<const CouplingRow> coupling_catalogue() {
  static const std::vector<CouplingRow> kRows = {
      {"contact",
       "points of one system against the solids or rigid bodies of the other, which recoil",
       &contact::contact_table(),
       contact::build_contact,
       contact::contact_cost,
       {"what one side gains in momentum the other loses",
        "a point that crosses a solid within one step is stopped, however thin the solid",
        "restitution and Coulomb's friction as on a wall, with the masses of both sides"},
       true},
      {"attachment",
       "joins points of two systems, or points and rigid bodies, pair by pair, with springs or rigid links",
       &attachment::attachment_table(),
       attachment::build_attachment,
       attachment::attachment_cost,
       {"what one side gains in momentum the other loses", "second order in the step",
        "a rigid link keeps its length to rounding"}},
      {"drive",
       "controls, paths and vectors of an animation set parameters of another system at every step, paths "
       "and "
       "turns move its bodies",
       &drive::drive_table(),
       drive::build_drive,
       drive::drive_cost,
       {"parameters are the channels at the substep's start",
        "a driven body has the velocities that take it where it is a substep later"}},
      {"immersion",
       "rigid bodies of a float, sink and are carried in b, a medium such as water of particles",
       &immersion::immersion_table(),
       immersion::build_immersion,
       immersion::immersion_cost,
       {"what one side gains in momentum the other loses",
        "pressure and bodies are solved for together: light bodies stay calm",
        "a body is in the water to the depth of its weight"}},
      {"ragdoll",
       "rigid bodies of b that a skeleton, a, carries until a time or an impact, and that then carry it",
       &ragdoll::ragdoll_table(),
       ragdoll::build_ragdoll,
       ragdoll::ragdoll_cost,
       {"bodies go on with the velocities of their bones", "an impact keeps its momentum",
        "bones lie in their bodies to the gap of the joints between those"}},
  };
  return kRows;
}

const CouplingRow* find_coupling_type(std::string_view type) {
  for (const CouplingRow& row : coupling_catalogue()) {
    if (row.type == type) return &row;
  }
  return nullptr;
}

}  // namespace truestep
