// Energies and the dissipation function of mass_spring_field.h.
#include "engine/kernels/springs/air.h"
#include "engine/systems/mass_spring/mass_spring_field.h"

namespace truestep::mass_spring {

using Columns = MassSpringColumns;

namespace {

// sum_i term(i), i < n, in fixed blocks; without allocation, as the line search needs it in every step.
template <class Term>
double sum(Evaluation& e, size_t n, Term term) {
  const auto partial = e.workspace.doubles("mass_spring.partial", (n + kBlockRows - 1) / kBlockRows);
  e.arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
    double s = 0;
    for (size_t i = begin; i < end; ++i) s += term(i);
    partial[begin / kBlockRows] = s;
  });
  double total = 0;
  for (const double p : partial) total += p;
  return total;
}

}  // namespace

std::optional<double> MassSpringField::potential(const Phase& at, Evaluation& e) const {
  const double* x = at.x.data();
  const double* rest = rests(e).springs;
  const auto stiffness = at.state.f64(Columns::stiffness);
  double v = sum(e, schedule_.a.size(), [&](size_t s) {
    const double l = norm(load3(x, schedule_.b[s]) - load3(x, schedule_.a[s]));
    const double k = stiffness[static_cast<size_t>(schedule_.family[s])] * schedule_.scale[s];
    return spring::energy(l, k, rest[s]);
  });
  v += sum(e, network_.bends.size(), [&](size_t k) {
    const Bend& b = network_.bends[k];
    return bending::energy(
        bending::links(load3(x, b.points[0]), load3(x, b.points[1]), load3(x, b.points[2])), b.stiffness);
  });
  const Vec3 g = load3(at.state.f64(Columns::gravity).data(), 0);
  v += sum(e, masses_.size(), [&](size_t i) { return -masses_[i] * dot(g, load3(x, i)); });
  for (size_t k = 0; k < Columns::kHands.drags(at.state); ++k) {
    const UserForces::Drag drag = Columns::kHands.drag(at.state, k);
    const Vec3 d = drag.target - load3(x, drag.who);
    v += 0.5 * drag.stiffness * norm2(d);
  }
  return v;
}

double MassSpringField::kinetic(const Phase& at, Evaluation& e) const {
  const auto w = at.state.f64(Columns::inverse_mass);
  return sum(e, masses_.size(),
             [&](size_t i) { return w[i] > 0 ? 0.5 * masses_[i] * norm2(load3(at.v.data(), i)) : 0.0; });
}

std::optional<double> MassSpringField::dissipation(const Phase& at, Evaluation& e) const {
  const double* x = at.x.data();
  const double* v = at.v.data();
  const State& state = at.state;
  const double viscous = state.f64(Columns::damping)[0], internal = state.f64(Columns::damping)[1];
  double r = 0;
  if (viscous > 0) r += sum(e, masses_.size(), [&](size_t i) { return 0.5 * viscous * norm2(load3(v, i)); });
  if (internal > 0) {
    r += sum(e, schedule_.a.size(), [&](size_t s) {
      const uint32_t a = schedule_.a[s], b = schedule_.b[s];
      return spring::dissipation(load3(x, b) - load3(x, a), load3(v, b) - load3(v, a), internal);
    });
  }
  if (state.span<uint32_t>(Columns::air)[0] != 0) {
    const Vec3 wind = wind_at(at);
    r += sum(e, network_.triangles.size(), [&](size_t k) {
      const auto& t = network_.triangles[k];
      const Vec3 normal = cross(load3(x, t[1]) - load3(x, t[0]), load3(x, t[2]) - load3(x, t[0]));
      const Vec3 u = wind - (load3(v, t[0]) + load3(v, t[1]) + load3(v, t[2])) * (1.0 / 3);
      return air::plate_dissipation(normal, u, air_factor_);
    });
    r += sum(e, section_.size(), [&](size_t i) {
      return air::cylinder_dissipation(wind - load3(v, i), air_factor_, section_[i]);
    });
  }
  for (size_t k = 0; k < Columns::kHands.pushes(state); ++k) {
    const UserForces::Push push = Columns::kHands.push(state, k);
    r -= dot(push.force, load3(v, push.who));
  }
  return r;
}

}  // namespace truestep::mass_spring
