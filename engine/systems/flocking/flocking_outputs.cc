// What a flock gives out: its members, its predators, and observables of the flock as a whole.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/core/outputs/outputs_of.h"
#include "engine/systems/flocking/flocking.h"

namespace truestep::flocking {
namespace {

/// Root of a member's group; paths are halved on the way.
uint32_t root_of(std::vector<uint32_t>& parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

}  // namespace

struct Flocking::Motion {
  double polarisation, speed, spread;
  Vec3 mean;
};
struct Flocking::Groups {
  double nearest, groups;
};

const OutputTable& Flocking::outputs() {
  using F = Flocking;
  static const OutputTable kTable =
      OutputsOf<F>("a member; in part predators, a predator")
          .part("", [](const F& f) { return points_part(f.boids_); })
          .field({"position", "m", Scalar::f64, 3, Meaning::position}, column(Columns::position), "")
          .field({"velocity", "m/s", Scalar::f64, 3, Meaning::velocity}, column(Columns::velocity), "")
          .field({"speed", "m/s"}, length_of(Columns::velocity), "magnitude of the velocity")
          // Predators are the last rows of the same columns.
          .part("predators",
                [](const F& f) {
                  const size_t predators = f.rows_ - f.boids_;
                  return predators > 0 ? std::optional(points_part(predators)) : std::nullopt;
                })
          .rows([](const F& f, const State&, size_t) {
            return ShownRows{f.boids_, f.rows_ - f.boids_};
          })
          .like_main("of part predators, where there are any; velocity and speed too")
          .measured(&F::motion,
                    {{"polarisation", "1", &Motion::polarisation,
                      "|mean of the unit headings|: 1 all aligned, 0 none"},
                     {"speed.mean", "m/s", &Motion::speed, "without predators, like all of these"},
                     {"velocity.mean", "m/s", &Motion::mean},
                     {"velocity.spread", "m/s", &Motion::spread,
                      "root mean square of the differences to the mean velocity"}})
          .measured(&F::groups, {{"distance.nearest", "m", &Groups::nearest,
                                  "between the nearest two, or the largest radius if nobody is within it"},
                                 {"groups", "1", &Groups::groups,
                                  "groups connected by distances of at most the largest radius"}})
          .when_wanted()
          .build();
  return kTable;
}

const Outputs& flocking_outputs() {
  static const Outputs kDescribed = Flocking::outputs().described();
  return kDescribed;
}

Flocking::Motion Flocking::motion(const State& s, double) const {
  const double* v = s.f64(Columns::velocity).data();
  const double n = static_cast<double>(boids_);
  Vec3 headings, mean;
  double speed = 0, spread = 0;
  for (size_t i = 0; i < boids_; ++i) {
    const Vec3 u = load3(v, i);
    headings += normalized(u, Vec3{}), mean += u / n, speed += norm(u) / n;
  }
  for (size_t i = 0; i < boids_; ++i) spread += norm2(load3(v, i) - mean) / n;
  return {norm(headings) / n, speed, std::sqrt(spread), mean};
}

Flocking::Groups Flocking::groups(const State& s, double) const {
  PointGrid grid;
  grid.build(s.f64(Columns::position).first(3 * boids_), reach_);
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
  return {nearest < HUGE_VAL ? std::sqrt(nearest) : reach_, groups};
}

}  // namespace truestep::flocking
