#include "engine/systems/nbody/collisions.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/neighbours/point_grid.h"

namespace truestep::nbody {

namespace {

constexpr size_t kEveryPair = 256;  // bodies that need no search

struct Touch {
  double share;  // of the step
  uint32_t a, b;
};

/// Fraction of the step at which two balls touch: 0 if they overlap at its start and approach; 2 for never.
double first_touch(const Vec3& d0, const Vec3& d1, double reach) {
  const Vec3 u = d1 - d0;
  const double b = dot(d0, u), c = norm2(d0) - reach * reach, a = norm2(u);
  if (b >= 0) return 2;
  if (c <= 0) return 0;
  const double root = b * b - a * c;
  if (root < 0) return 2;
  const double share = c / (-b + std::sqrt(root));
  return share <= 1 ? share : 2;
}

void find_touches(const State& s, std::span<const double> before, Workspace& workspace,
                  std::vector<Touch>& out) {
  const auto x = s.f64(Columns::position), radius = s.f64(Columns::radius);
  const size_t n = radius.size();
  out.clear();
  const auto look = [&](uint32_t a, uint32_t b) {
    const double reach = radius[a] + radius[b];
    if (!(reach > 0)) return;
    const Vec3 d0 = load3(before.data(), b) - load3(before.data(), a),
               d1 = load3(x.data(), b) - load3(x.data(), a);
    const double share = first_touch(d0, d1, reach);
    if (share <= 1) out.push_back({share, a, b});
  };
  if (n <= kEveryPair) {
    for (uint32_t a = 0; a < n; ++a) {
      for (uint32_t b = a + 1; b < n; ++b) look(a, b);
    }
  } else {
    double reach = 0, way = 0;
    for (size_t i = 0; i < n; ++i) {
      reach = std::max(reach, radius[i]);
      way = std::max(way, norm2(load3(x.data(), i) - load3(before.data(), i)));
    }
    if (!(reach > 0)) return;
    auto& grid = workspace.object<PointGrid>("nbody.grid");
    grid.build(x, 2 * reach + 2 * std::sqrt(way));
    for (size_t slot = 0; slot < grid.size(); ++slot) {
      grid.near(grid.position(slot), [&](uint32_t begin, uint32_t end) {
        for (uint32_t other = begin; other < end; ++other) {
          const uint32_t a = grid.point(slot), b = grid.point(other);
          if (a < b) look(a, b);
        }
      });
    }
  }
  std::sort(out.begin(), out.end(), [](const Touch& p, const Touch& q) {
    return p.share != q.share ? p.share < q.share : p.a != q.a ? p.a < q.a : p.b < q.b;
  });
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

}  // namespace

void collide(State& s, const CollisionsDef& def, std::span<const double> before, double h,
             Workspace& workspace) {
  auto& touches = workspace.object<std::vector<Touch>>("nbody.touches");
  find_touches(s, before, workspace, touches);
  if (touches.empty()) return;
  auto& taken = workspace.object<std::vector<uint8_t>>("nbody.taken");
  auto& dead = workspace.object<std::vector<uint8_t>>("nbody.dead");
  const size_t n = s.rows(Columns::position);
  taken.assign(n, 0), dead.assign(n, 0);
  const auto mass = s.f64(Columns::mass);
  double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  bool any_dead = false;
  for (const Touch& t : touches) {
    if (taken[t.a] || taken[t.b]) continue;
    taken[t.a] = taken[t.b] = 1;
    ++counter(s, Counter::collisions);
    if (def.response == Response::merge) {
      const bool first = mass[t.a] >= mass[t.b];
      merge(s, first ? t.a : t.b, first ? t.b : t.a);
      dead[first ? t.b : t.a] = 1, any_dead = true;
      ++counter(s, Counter::merged);
      continue;
    }
    const Vec3 d0 = load3(before.data(), t.b) - load3(before.data(), t.a);
    const Vec3 d = d0 + (load3(x, t.b) - load3(x, t.a) - d0) * t.share;
    const Vec3 normal = normalized(d), u = load3(v, t.b) - load3(v, t.a);
    const double along = dot(u, normal), sum = mass[t.a] + mass[t.b];
    // For two massless bodies, each takes half.
    const double to_a = sum > 0 ? mass[t.b] / sum : 0.5;
    const Vec3 change =
        def.response == Response::stop ? -u : normal * (-(1 + def.restitution) * std::min(along, 0.0));
    const double left = (1 - t.share) * h;
    store3(v, t.a, load3(v, t.a) - change * to_a), store3(v, t.b, load3(v, t.b) + change * (1 - to_a));
    store3(x, t.a, load3(x, t.a) - change * (to_a * left)),
        store3(x, t.b, load3(x, t.b) + change * ((1 - to_a) * left));
  }
  if (any_dead) remove_rows(s, dead);
}

}  // namespace truestep::nbody
