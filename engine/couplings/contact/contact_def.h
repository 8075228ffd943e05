// Parameters of the coupling type "contact".
#pragma once
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"

namespace truestep::contact {

struct ContactDef {
  double restitution = 0.5;  ///< Newton's e
  double friction = 0.3;     ///< Coulomb's mu
  double rest_speed = 0.01;  ///< m/s
};

const DefTable& contact_table();
/// `a` and `b` are the costs of the two systems alone.
Cost contact_cost(const void* def, const Cost& a, const Cost& b);

}  // namespace truestep::contact
