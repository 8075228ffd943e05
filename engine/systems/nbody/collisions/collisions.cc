#include "engine/systems/nbody/collisions/collisions.h"

#include <algorithm>

#include "engine/math/trig.h"

namespace truestep::nbody {

Vec3 change_of_velocity(const Vec3& u, const Vec3& n, Response response, double restitution) {
  if (response == Response::stop) return -u;
  return n * (-(1 + restitution) * std::min(dot(u, n), 0.0));
}

void merge(State& s, uint32_t into, uint32_t gone) {
  const auto mass = s.f64(Columns::mass), radius = s.f64(Columns::radius);
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  const double sum = mass[into] + mass[gone], share = sum > 0 ? mass[gone] / sum : 0.5;
  store3(x, into, load3(x, into) + (load3(x, gone) - load3(x, into)) * share);
  store3(v, into, load3(v, into) + (load3(v, gone) - load3(v, into)) * share);
  mass[into] = sum;
  const auto cube = [](double r) { return r * r * r; };
  radius[into] = trig::pow(cube(radius[into]) + cube(radius[gone]), 1.0 / 3);
}

uint64_t collide_apart(State& s, const CollisionsDef& def, const PathPiece& piece,
                       std::span<const Touch> touches, Workspace& workspace) {
  const size_t n = s.rows(Columns::position);
  auto& taken = workspace.object<std::vector<uint8_t>>("nbody.taken");
  auto& row = workspace.object<std::vector<uint32_t>>("nbody.merged_into");
  auto& dead = workspace.object<std::vector<uint8_t>>("nbody.dead");
  taken.assign(n, 0), dead.assign(n, 0), row.resize(n);
  for (uint32_t i = 0; i < n; ++i) row[i] = i;
  const auto now = [&](uint32_t i) {
    while (row[i] != i) i = row[i];
    return i;
  };
  const auto mass = s.f64(Columns::mass);
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  bool any_dead = false;
  uint64_t left_over = 0;
  for (const Touch& t : touches) {
    if (def.response == Response::merge) {
      const uint32_t a = now(t.a), b = now(t.b);
      if (a == b) continue;
      const bool first = mass[a] >= mass[b];
      const uint32_t into = first ? a : b, gone = first ? b : a;
      merge(s, into, gone);
      dead[gone] = 1, row[gone] = into, any_dead = true;
      ++counter(s, Counter::collisions), ++counter(s, Counter::merged);
      continue;
    }
    if (taken[t.a] || taken[t.b]) {
      ++left_over;
      continue;
    }
    const CubicPath path = piece.between(t.a, t.b);
    const Vec3 normal = normalized(path.at(t.share)), u = path.slope(t.share) / piece.h;
    if (!(dot(u, normal) < 0)) continue;
    taken[t.a] = taken[t.b] = 1;
    ++counter(s, Counter::collisions);
    const double to_a = share_of_first(mass[t.a], mass[t.b]), left = (1 - t.share) * piece.h;
    const Vec3 change = change_of_velocity(u, normal, def.response, def.restitution);
    const auto add = [&](uint32_t i, const Vec3& dv) {
      store3(v, i, load3(v, i) + dv), store3(x, i, load3(x, i) + dv * left);
    };
    add(t.a, change * -to_a), add(t.b, change * (1 - to_a));
  }
  if (any_dead) remove_rows(s, dead);
  return left_over;
}

}  // namespace truestep::nbody
