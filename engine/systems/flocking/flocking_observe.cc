// Observables of a flock as a whole.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/systems/flocking/flocking.h"

namespace truestep::flocking {
namespace {

/// Root of a member's group; paths are halved on the way.
uint32_t root_of(std::vector<uint32_t>& parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

void Flocking::observe(const State& s, double, Observables& out) const {
  const double *x = s.f64(Columns::position).data(), *v = s.f64(Columns::velocity).data();
  const double n = static_cast<double>(boids_);
  Vec3 headings, mean;
  double speed = 0, spread = 0;
  for (size_t i = 0; i < boids_; ++i) {
    const Vec3 u = load3(v, i);
    headings += normalized(u, Vec3{}), mean += u / n, speed += norm(u) / n;
  }
  for (size_t i = 0; i < boids_; ++i) spread += norm2(load3(v, i) - mean) / n;

  out.add("polarisation", norm(headings) / n, "1");
  out.add("speed.mean", speed, "m/s");
  out.add("velocity.mean.x", mean.x, "m/s");
  out.add("velocity.mean.y", mean.y, "m/s");
  out.add("velocity.mean.z", mean.z, "m/s");
  out.add("velocity.spread", std::sqrt(spread), "m/s");
  if (out.wants("distance.nearest") || out.wants("groups")) observe_groups(x, out);
}

void Flocking::observe_groups(const double* x, Observables& out) const {
  PointGrid grid;
  grid.build({x, 3 * boids_}, reach_);
  std::vector<uint32_t> parent(boids_);
  std::iota(parent.begin(), parent.end(), 0u);
  double nearest = HUGE_VAL, groups = static_cast<double>(boids_);
  for (size_t slot = 0; slot < grid.size(); ++slot) {
    box_.images(grid.position(slot), reach_, [&](const Vec3& shift) {
      const Vec3 p = grid.position(slot) + shift;
      grid.near(p, [&](size_t begin, size_t end) {
        for (size_t q = begin; q < end; ++q) {
          const double r2 = norm2(grid.position(q) - p);
          if (q == slot || r2 > reach_ * reach_) continue;
          nearest = std::min(nearest, r2);
          const uint32_t a = root_of(parent, grid.point(slot)), b = root_of(parent, grid.point(q));
          if (a != b) parent[std::max(a, b)] = std::min(a, b), groups -= 1;
        }
      });
    });
  }
  // Nobody is looked for farther away.
  out.add("distance.nearest", nearest < HUGE_VAL ? std::sqrt(nearest) : reach_, "m");
  out.add("groups", groups, "1");
}

FieldView Flocking::field(const State& s, size_t part, size_t which, std::vector<double>& scratch) const {
  // Predators are the last rows of the same columns.
  const size_t first = part == 0 ? 0 : boids_, rows = part == 0 ? boids_ : rows_ - boids_;
  const double* v = s.f64(Columns::velocity).data() + 3 * first;
  if (which == 0) return {s.f64(Columns::position).data() + 3 * first, Scalar::f64, rows, 3};
  if (which == 1) return {v, Scalar::f64, rows, 3};
  scratch.resize(rows);
  for (size_t i = 0; i < rows; ++i) scratch[i] = norm(load3(v, i));
  return {scratch.data(), Scalar::f64, rows, 1};
}

}  // namespace truestep::flocking
