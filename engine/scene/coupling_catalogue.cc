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
        "a driven body has the velocity that takes it to its position a substep later"}},
      {"immersion",
       "rigid bodies of a float, sink and are carried in b, a medium such as water of particles",
       &immersion::immersion_table(),
       immersion::build_immersion,
       immersion::immersion_cost,
       {"what one side gains in momentum the other loses",
        "pressure and bodies are solved for together: light bodies stay stable",
        "a floating body displaces its weight"}},
      {"ragdoll",
       "rigid bodies of b that follow a skeleton, a, until a time or an impact, and that then lead it",
       &ragdoll::ragdoll_table(),
       ragdoll::build_ragdoll,
       ragdoll::ragdoll_cost,
       {"bodies continue with the velocities of their bones", "an impact conserves momentum",
        "bones match their bodies up to the gaps of the bodies' joints"}},
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
