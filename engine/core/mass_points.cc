#include "engine/core/mass_points.h"

namespace truestep {

void add_vector(Observables& out, const std::string& name, const Vec3& a, const char* unit) {
  out.add(name + ".x", a.x, unit), out.add(name + ".y", a.y, unit), out.add(name + ".z", a.z, unit);
}

void MassPoints::observe_energy(Observables& out) const {
  out.add("energy.kinetic", kinetic, "J");
  out.add("energy.gravity", height, "J");
  out.add("energy.total", kinetic + height, "J");
}

void MassPoints::observe_centre(Observables& out) const {
  add_vector(out, "centre", centre(), "m");
}

void MassPoints::observe_extent(Observables& out) const {
  const bool none = !(low.x <= high.x);
  add_vector(out, "low", none ? centre() : low, "m");
  add_vector(out, "high", none ? centre() : high, "m");
}

}  // namespace truestep
