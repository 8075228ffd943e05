// The pressure that is read (transmitted.h), with what surface tension transmits.
#pragma once
#include "engine/systems/sph/setting.h"
#include "engine/systems/sph/solvers/tension.h"
#include "engine/systems/sph/solvers/transmitted.h"

namespace truestep::sph {

/// Pa, of all rows of a state; f has its places sorted and listed without walls.
template <int D, class T>
void read_pressures(const Setting& set, Fluid<D, T>& f, const State& s, const ThreadArena& arena,
                    double* out) {
  const SphDef& d = set.def;
  const bool draws = d.surface_tension > 0 && d.surface_tension_model == Tension::cohesion;
  const bool shrinks = d.surface_tension > 0 && d.surface_tension_model == Tension::interface;
  const T strength = static_cast<T>(set.cohesion), support = static_cast<T>(set.support);
  if (shrinks) find_interface(f, *set.interface, support, arena);
  transmitted_pressures(f, s.span<T>(columns::pressure).data(), s.span<T>(columns::density).data(), arena,
                        out, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
                          const T rest = static_cast<T>(d.density);
                          if (draws) return rest * work_of_drawing<D, T>(c, begin, end, strength, support);
                          if (!shrinks) return T{0};
                          return rest *
                                 work_of_shrinking(f, i, c, begin, end, strength, *set.interface, support);
                        });
}

}  // namespace truestep::sph
