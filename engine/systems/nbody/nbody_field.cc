#include "engine/systems/nbody/nbody_field.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/systems/nbody/collisions/impacts.h"

namespace truestep::nbody {

namespace {

std::vector<NbodyField::Orbit> orbits_of(const State& s) {
  const auto x = s.f64(Columns::position), v = s.f64(Columns::velocity), mass = s.f64(Columns::mass);
  const double mu = parameter(s, Parameter::gravitational_constant) * mass[0];
  std::vector<NbodyField::Orbit> out(mass.size());
  for (size_t i = 1; i < mass.size() && mu > 0; ++i) {
    const double r = norm(load3(x.data(), i) - load3(x.data(), 0)),
                 v2 = norm2(load3(v.data(), i) - load3(v.data(), 0)), beta = 2 * mu / r - v2;
    if (!(r > 0)) continue;
    const double a = beta > 0 ? mu / beta : r;
    out[i] = {a * trig::pow(mass[i] / (3 * mass[0]), 1.0 / 3), std::sqrt(mu / a)};
  }
  return out;
}

}  // namespace

NbodyField::NbodyField(const NbodyDef& def, uint64_t seed)
    : def_(def),
      attraction_(def),
      start_(nbody_state(bodies_at_start(def, seed), def.gravitational_constant, def.softening)),
      orbits_(orbits_of(start_)) {
  if (def.collisions) {
    start_.add({std::string(kImpacts), "1", Scalar::f64, 1}, static_cast<size_t>(Impact::count));
  }
  // Only the parameters are needed from here on.
  for (auto* list : {&def_.positions, &def_.velocities}) list->clear(), list->shrink_to_fit();
}

Dependence NbodyField::dependence() const {
  // A drag is damped, but it is user input: no method is refused because of it.
  return Dependence::position;
}

void NbodyField::acceleration(const Phase& at, std::span<double> a, Evaluation& e) const {
  const State& s = at.state;
  attraction_.accelerations(s, at.x, a, e.workspace, e.arena);
  const auto mass = s.f64(Columns::mass);
  const auto add = [&](size_t i, const Vec3& force) {
    store3(a.data(), i, load3(a.data(), i) + force / mass[i]);
  };
  for (size_t k = 0; k < Columns::kHands.pushes(s); ++k) {
    const UserForces::Push p = Columns::kHands.push(s, k);
    if (const auto i = row_of(s, p.who)) add(*i, p.force);
  }
  for (size_t k = 0; k < Columns::kHands.drags(s); ++k) {
    const UserForces::Drag d = Columns::kHands.drag(s, k);
    const auto i = row_of(s, d.who);
    if (!i) continue;
    // Critically damped, so that the body follows the drag without oscillating.
    add(*i, (d.target - load3(at.x.data(), *i)) * d.stiffness -
                (at.v.empty() ? Vec3{} : load3(at.v.data(), *i)) * (2 * std::sqrt(d.stiffness * mass[*i])));
  }
}

std::optional<double> NbodyField::potential(const Phase& at, Evaluation& e) const {
  return attraction_.potential(at.state, at.x, e.workspace, e.arena);
}

double NbodyField::kinetic(const Phase& at, Evaluation& e) const {
  const double* mass = at.state.f64(Columns::mass).data();
  return e.arena.sum_blocks(at.v.size() / 3, kBlockRows, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += 0.5 * mass[i] * norm2(load3(at.v.data(), i));
    return sum;
  });
}

std::optional<ForceField::Stiffness> NbodyField::stiffness(const State& s) const {
  const auto x = s.f64(Columns::position);
  const size_t n = x.size() / 3;
  if (n <= kFewBodies) return std::nullopt;
  static const ThreadArena kSerial(1);
  Workspace workspace;
  std::vector<double> a(3 * n), r(n);
  attraction_.accelerations(s, x, a, workspace, kSerial);
  double most = 0;
  Vec3 middle;
  for (size_t i = 0; i < n; ++i) {
    most = std::max(most, norm(load3(a.data(), i))), middle += load3(x.data(), i) / static_cast<double>(n);
  }
  for (size_t i = 0; i < n; ++i) r[i] = norm(load3(x.data(), i) - middle);
  std::nth_element(r.begin(), r.begin() + static_cast<ptrdiff_t>(n / 2), r.end());
  const double softening = parameter(s, Parameter::softening), length = softening > 0 ? softening : r[n / 2];
  return Stiffness{length > 0 ? std::sqrt(most / length) : 0, 0};
}

}  // namespace truestep::nbody
