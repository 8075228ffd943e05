// Manifolds of pairs of solids, poses near touching as in a pile, beside libccd: its depth by GJK and EPA
// (one point, no manifold). Seconds per pair.
#include <ccd/ccd.h>

#include <cmath>

#include "engine/base/random.h"
#include "engine/collision/pairs/collide.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;

struct Pair {
  Transform a, b;
};
struct Object {
  Convex shape;
  Transform at;
};

void support(const void* object, const ccd_vec3_t* d, ccd_vec3_t* out) {
  const auto& o = *static_cast<const Object*>(object);
  const Vec3 dir{d->v[0], d->v[1], d->v[2]};
  const Vec3 p =
      o.at.point(o.shape.support(o.at.inverse_direction(dir))) + normalized(dir) * o.shape.radius();
  ccdVec3Set(out, p.x, p.y, p.z);
}
void center(const void* object, ccd_vec3_t* out) {
  const Vec3& p = static_cast<const Object*>(object)->at.position;
  ccdVec3Set(out, p.x, p.y, p.z);
}

Quat turn(uint64_t i) {
  const auto u = uniform4(1, 3, i);
  return normalized(Quat{u[0] - 0.5, u[1] - 0.5, u[2] - 0.5, u[3] - 0.5});
}

/// Random positions and orientations; `stacked` has almost no rotation, the usual case of a pile at rest.
enum class Kind { tumbling, stacked };
std::vector<Pair> poses(Kind kind, double reach) {
  std::vector<Pair> out;
  for (uint64_t i = 0; i < 4096; ++i) {
    const auto u = uniform4(2, 3, i);
    if (kind == Kind::stacked) {
      const Quat q = normalized(Quat{1, 1e-4 * u[0], 0.3 * u[1], 1e-4 * u[2]});
      out.push_back(
          {transform_of({{0, 0, 0}, q}), transform_of({{0.3 * u[0], 2 * reach - 1e-3, 0.3 * u[2]}, q})});
      continue;
    }
    const Vec3 d = normalized(Vec3{u[0] - 0.5, u[1] - 0.5, u[2] - 0.5});
    out.push_back({transform_of({{1, 2, 3}, turn(i)}),
                   transform_of({Vec3{1, 2, 3} + d * (reach * (1.2 + u[3])), turn(i + 9999)})});
  }
  return out;
}

void compare(const char* name, const Solid& a, const Solid& b, Kind kind, double reach) {
  const std::vector<Pair> pairs = poses(kind, reach);
  double sink = 0;
  int met = 0, overlapping = 0;
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = support;
  ccd.center1 = ccd.center2 = center;
  ccd.max_iterations = 100;
  ccd.epa_tolerance = 1e-6;
  const auto ours = [&] {
    Manifold m;
    met = 0;
    for (const Pair& p : pairs) {
      if (collide(a, p.a, b, p.b, 0.01, m)) sink += m.points[0].separation, ++met;
    }
  };
  const auto theirs = [&] {
    overlapping = 0;
    for (const Pair& p : pairs) {
      const Object x{view(a), p.a}, y{view(b), p.b};
      ccd_real_t depth = 0;
      ccd_vec3_t dir, at;
      overlapping += ccdGJKPenetration(&x, &y, &ccd, &depth, &dir, &at) == 0;
      sink += depth;
    }
  };
  const auto times = bench::paired(9, ours, theirs, bench::thread_seconds).times;
  const auto n = static_cast<double>(pairs.size());
  bench::report({.bench = "narrow_phase",
                 .metric = std::string("seconds per pair, ") + name + (sink == 0.5 ? "!" : "") + ", " +
                           std::to_string(100 * met / static_cast<int>(n)) + " % touch",
                 .ours = times.ours / n,
                 .peer = times.peer / n,
                 .peer_name = "libccd GJK + EPA"});
}

}  // namespace

int main() {
  std::vector<Vec3> points;
  for (uint64_t i = 0; i < 32; ++i) {
    const auto u = uniform4(5, 3, i);
    points.push_back(normalized(Vec3{u[0] - 0.5, u[1] - 0.5, u[2] - 0.5}) * 0.5);
  }
  const Solid box = box_solid({0.5, 0.4, 0.3}), cube = box_solid({0.5, 0.5, 0.5}), ball = sphere_solid(0.45),
              capsule = capsule_solid(0.3, 0.4), cylinder = cylinder_solid(0.4, 0.5),
              hull = hull_solid(points);
  compare("box box stacked", cube, cube, Kind::stacked, 0.5);
  compare("box box tumbling", box, box, Kind::tumbling, 0.5);
  compare("cylinder box stacked", cylinder, cube, Kind::stacked, 0.5);
  const struct {
    const char* name;
    const Solid &a, &b;
  } all[] = {{"sphere sphere", ball, ball},     {"sphere capsule", ball, capsule},
             {"sphere box", ball, box},         {"sphere cylinder", ball, cylinder},
             {"sphere hull", ball, hull},       {"capsule capsule", capsule, capsule},
             {"capsule box", capsule, box},     {"capsule cylinder", capsule, cylinder},
             {"capsule hull", capsule, hull},   {"box cylinder", box, cylinder},
             {"box hull", box, hull},           {"cylinder cylinder", cylinder, cylinder},
             {"cylinder hull", cylinder, hull}, {"hull hull", hull, hull}};
  for (const auto& p : all) compare(p.name, p.a, p.b, Kind::tumbling, 0.45);
}
