#include "engine/systems/nbody/nbody_state.h"

#include <algorithm>

namespace truestep::nbody {

State nbody_state(std::span<const Body> bodies, double gravitational_constant, double softening) {
  using S = Scalar;
  State s;
  const size_t n = bodies.size();
  s.add({"position", "m", S::f64, 3, Role::position}, n);
  s.add({"velocity", "m/s", S::f64, 3, Role::velocity}, n);
  s.add({"mass", "kg", S::f64, 1}, n);
  s.add({"radius", "m", S::f64, 1}, n);
  s.add({"id", "1", S::u64, 1}, n);
  s.add({"parameters", "SI", S::f64, 1}, static_cast<size_t>(Parameter::count));
  s.add({"counters", "1", S::u64, 1}, static_cast<size_t>(Counter::count));
  s.add({"push.id", "1", S::u64, 1}, 0);
  s.add({"push.force", "N", S::f64, 3}, 0);
  s.add({"push.remaining", "s", S::f64, 1}, 0);
  s.add({"drag.id", "1", S::u64, 1}, 0);
  s.add({"drag.target", "m", S::f64, 3}, 0);
  s.add({"drag.stiffness", "N/m", S::f64, 1}, 0);
  for (size_t i = 0; i < n; ++i) {
    store3(s.f64(Columns::position).data(), i, bodies[i].x);
    store3(s.f64(Columns::velocity).data(), i, bodies[i].v);
    s.f64(Columns::mass)[i] = bodies[i].mass, s.f64(Columns::radius)[i] = bodies[i].radius;
    s.span<uint64_t>(Columns::id)[i] = i;
  }
  const auto numbers = s.f64(Columns::parameters);
  numbers[static_cast<size_t>(Parameter::gravitational_constant)] = gravitational_constant;
  numbers[static_cast<size_t>(Parameter::softening)] = softening;
  return s;
}

std::optional<size_t> row_of(const State& s, uint64_t id) {
  const auto ids = s.span<uint64_t>(Columns::id);
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  if (at == ids.end() || *at != id) return std::nullopt;
  return static_cast<size_t>(at - ids.begin());
}

void remove_rows(State& s, std::span<const uint8_t> dead) {
  const size_t n = s.rows(Columns::position);
  for (State::Column c = 0; c < s.columns(); ++c) {
    // The method's per-row columns are as wide as positions; its other columns do not depend on the number of
    // bodies.
    const ColumnInfo& info = s.info(c);
    const bool carried = info.name.starts_with("integrator.") && s.rows(c) == n && info.width == 3;
    if (c >= Columns::per_body_end && !carried) continue;
    size_t kept = 0;
    for (size_t i = 0; i < n; ++i) {
      if (dead[i]) continue;
      if (kept != i) s.copy_row(c, i, kept);
      ++kept;
    }
    s.resize(c, kept);
  }
}

}  // namespace truestep::nbody
