#include "tests/unit/collision/collision_rig.h"

#include <algorithm>
#include <cmath>

#include "engine/geometry/shape_distance.h"

namespace truestep::collision_rig {
namespace {

constexpr double kTwoPi = 6.283185307179586;

VecL local(const Transform& t, const VecL& n) {
  const auto row = [](const Vec3& r) { return VecL{r.x, r.y, r.z}; };
  return row(t.rotation.row[0]) * n.x + row(t.rotation.row[1]) * n.y + row(t.rotation.row[2]) * n.z;
}

const std::vector<VecL>& directions() {
  static const std::vector<VecL> all = [] {
    std::vector<VecL> v;
    constexpr int kCount = 1500;
    for (int i = 0; i < kCount; ++i) {
      const double y = 1 - 2 * (i + 0.5) / kCount, r = std::sqrt(1 - y * y), phi = 2.399963229728653 * i;
      v.push_back({r * std::cos(phi), y, r * std::sin(phi)});
    }
    return v;
  }();
  return all;
}

constexpr Real kCircle[8][2] = {{1, 0},  {0.7071L, 0.7071L},   {0, 1},  {-0.7071L, 0.7071L},
                                {-1, 0}, {-0.7071L, -0.7071L}, {0, -1}, {0.7071L, -0.7071L}};

VecL unit(const VecL& v) {
  return v / std::sqrt(dot(v, v));
}

}  // namespace

Quat random_quat(uint64_t stream, uint64_t i) {
  const auto u = uniform4(101, stream, i);
  const double a = std::sqrt(u[0]), b = std::sqrt(1 - u[0]);
  return normalized(Quat{a * std::cos(kTwoPi * u[1]), b * std::sin(kTwoPi * u[2]),
                         b * std::cos(kTwoPi * u[2]), a * std::sin(kTwoPi * u[1])});
}
Vec3 random_unit(uint64_t stream, uint64_t i) {
  const auto u = uniform4(102, stream, i);
  const double y = 2 * u[0] - 1, r = std::sqrt(1 - y * y);
  return {r * std::cos(kTwoPi * u[1]), y, r * std::sin(kTwoPi * u[1])};
}
Transform random_transform(uint64_t stream, uint64_t i, double far) {
  const auto u = uniform4(103, stream, i);
  return transform_of({Vec3{2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1} * far, random_quat(stream, i)});
}

Quat quarter_turns(uint64_t i) {
  const double h = std::sqrt(0.5);
  Quat q;
  for (uint64_t k = 0; k < i % 4; ++k) q = Quat{h, h, 0, 0} * q;
  for (uint64_t k = 0; k < i / 4 % 4; ++k) q = Quat{h, 0, h, 0} * q;
  for (uint64_t k = 0; k < i / 16 % 4; ++k) q = Quat{h, 0, 0, h} * q;
  return normalized(q);
}

Solid sample_solid(int k, uint64_t seed, double size) {
  const auto u = uniform4(104, static_cast<uint64_t>(k), seed);
  const Vec3 e = Vec3{0.2 + u[0], 0.2 + u[1], 0.2 + u[2]} * (0.5 * size);
  switch (k) {
    case 0:
      return sphere_solid(e.x);
    case 1:
      return capsule_solid(e.x, e.y);
    case 2:
      return box_solid(e);
    case 3:
      return cylinder_solid(e.x, e.y);
    case 4:
    case 7: {
      std::vector<Vec3> points;
      for (uint64_t i = 0; i < (k == 4 ? 14u : 48u); ++i) {
        const Vec3 d = random_unit(105 + seed, i);
        points.push_back({d.x * e.x, d.y * e.y, d.z * e.z});
      }
      return hull_solid(points);
    }
    case 5:
      return box_solid({0.002 * size, size, 0.003 * size});
    default:
      return box_solid({0.7 * size, 0.6 * size, 0.004 * size});
  }
}

Real reach(const Placed& p, const VecL& n) {
  const VecL d = local(p.at, n);
  const Vec3& e = p.solid.size;
  Real r = 0;
  switch (p.solid.kind) {
    case SolidKind::sphere:
      r = e.x;
      break;
    case SolidKind::capsule:
      r = e.x + e.y * std::fabs(d.y);
      break;
    case SolidKind::cylinder:
      r = e.x * std::sqrt(d.x * d.x + d.z * d.z) + e.y * std::fabs(d.y);
      break;
    case SolidKind::hull:
      r = -1e300L;
      for (const Vec3& v : p.solid.hull->vertices) r = std::max(r, d.x * v.x + d.y * v.y + d.z * v.z);
      break;
    default:
      r = e.x * std::fabs(d.x) + e.y * std::fabs(d.y) + e.z * std::fabs(d.z);
  }
  const Vec3& c = p.at.position;
  return r + n.x * c.x + n.y * c.y + n.z * c.z;
}

Real separation_along(const Placed& a, const Placed& b, const VecL& n) {
  return -reach(b, -n) - reach(a, n);
}

Real separation(const Placed& a, const Placed& b) {
  struct Start {
    Real s;
    VecL n;
  };
  std::vector<Start> starts;
  const auto add = [&](const VecL& n) {
    if (dot(n, n) > 1e-20L) starts.push_back({separation_along(a, b, unit(n)), unit(n)});
  };
  for (const VecL& n : directions()) add(n);
  for (const Placed* p : {&a, &b}) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 e = axis(p->at.rotation, k);
      add({e.x, e.y, e.z}), add({-e.x, -e.y, -e.z});
    }
    if (p->solid.kind == SolidKind::hull) {
      for (const HullFace& f : p->solid.hull->faces) {
        const Vec3 e = p->at.direction(f.normal);
        add({e.x, e.y, e.z}), add({-e.x, -e.y, -e.z});
      }
    }
  }
  std::sort(starts.begin(), starts.end(), [](const Start& x, const Start& y) { return x.s > y.s; });
  Real best = starts[0].s;
  for (size_t k = 0; k < 6; ++k) {
    Start at = starts[k];
    Real step = 0.05L;
    for (int round = 0; round < 120 && step > 1e-10L; ++round) {
      const VecL u = unit(cross(at.n, std::fabs(at.n.x) < 0.6L ? VecL{1, 0, 0} : VecL{0, 1, 0})),
                 v = cross(at.n, u);
      Start next = at;
      for (const auto& c : kCircle) {
        const VecL n = unit(at.n + u * (step * c[0]) + v * (step * c[1]));
        if (const Real s = separation_along(a, b, n); s > next.s) next = {s, n};
      }
      // Steps that improve shrink slowly, others fast.
      step *= next.s > at.s ? 0.9L : 0.4L;
      at = next;
    }
    best = std::max(best, at.s);
  }
  return best;
}

double outside(const Placed& p, const Vec3& x) {
  const Vec3 l = p.at.inverse_point(x), &e = p.solid.size;
  switch (p.solid.kind) {
    case SolidKind::sphere:
      return sphere_distance(l, e.x).d;
    case SolidKind::capsule:
      return capsule_distance(l, e.x, e.y).d;
    case SolidKind::cylinder:
      return std::max(std::sqrt(l.x * l.x + l.z * l.z) - e.x, std::fabs(l.y) - e.y);
    case SolidKind::hull: {
      double most = -1e300;
      for (const HullFace& f : p.solid.hull->faces) most = std::max(most, dot(f.normal, l) - f.offset);
      return most;
    }
    default:
      return box_distance(l, e).d;
  }
}

}  // namespace truestep::collision_rig
