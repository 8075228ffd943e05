#include "engine/geometry/mass_properties.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/geometry/compound.h"
#include "engine/geometry/triangle_mesh.h"

namespace truestep {
namespace {

constexpr double kPi = 3.141592653589793;

MassProperties diagonal(double mass, double x, double y, double z) {
  return {mass, {}, {x, y, z, 0, 0, 0}};
}

/// m (|d|^2 1 - d d^T): added by moving mass m by d.
Symmetric3 steiner(double m, const Vec3& d) {
  return Symmetric3{d.y * d.y + d.z * d.z,
                    d.x * d.x + d.z * d.z,
                    d.x * d.x + d.y * d.y,
                    -d.x * d.y,
                    -d.x * d.z,
                    -d.y * d.z} *
         m;
}

/// Sums tetrahedra with the corner `origin`.
class Polyhedron {
 public:
  explicit Polyhedron(const Vec3& origin) : origin_(origin) {}
  void add(const Vec3& p, const Vec3& q, const Vec3& r) {
    const Vec3 a = p - origin_, b = q - origin_, c = r - origin_, s = a + b + c;
    const double v = dot(a, cross(b, c)) / 6;
    volume_ += v;
    first_ += s * (v / 4);
    for (const Vec3& k : {a, b, c, s}) second_ += outer(k) * (v / 20);
  }
  MassProperties result(double density) const {
    if (!(volume_ > 0)) throw Error("no_mass", "a mesh with inward-facing triangles has no mass");
    const Vec3 c = first_ / volume_;
    const Symmetric3 m = second_;
    MassProperties out{
        volume_ * density, origin_ + c, {m.yy + m.zz, m.xx + m.zz, m.xx + m.yy, -m.xy, -m.xz, -m.yz}};
    out.inertia += steiner(-volume_, c);
    out.inertia = out.inertia * density;
    return out;
  }

 private:
  static Symmetric3 outer(const Vec3& k) {
    return {k.x * k.x, k.y * k.y, k.z * k.z, k.x * k.y, k.x * k.z, k.y * k.z};
  }
  Vec3 origin_, first_;
  double volume_ = 0;
  Symmetric3 second_;
};

MassProperties of_hull(const Hull& h, double density) {
  Polyhedron sum(h.center);
  for (const HullFace& f : h.faces) {
    const auto corner = [&](uint32_t k) { return h.vertices[h.loops[f.first + k]]; };
    for (uint32_t k = 1; k + 1 < f.count; ++k) sum.add(corner(0), corner(k), corner(k + 1));
  }
  return sum.result(density);
}

MassProperties of_mesh(const TriangleMesh& m, double density) {
  if (!m.closed()) throw Error("no_mass", "a mesh that is not closed has no mass");
  Polyhedron sum(m.tree().bounds().center());
  for (uint32_t i = 0; i < m.size(); ++i) {
    const auto& c = m.triangle(i).corner;
    sum.add(c[0], c[1], c[2]);
  }
  return sum.result(density);
}

MassProperties of_capsule(double r, double h, double density) {
  const double tube = density * kPi * r * r * 2 * h, ball = density * (4.0 / 3) * kPi * r * r * r;
  // Half balls: centre of mass 3 r / 8 beyond the flat side.
  const double along = tube * r * r / 2 + ball * 2 * r * r / 5;
  const double across = tube * (r * r / 4 + h * h / 3) + ball * (2 * r * r / 5 + h * h + 3 * h * r / 4);
  return diagonal(tube + ball, across, along, across);
}

}  // namespace

MassProperties mass_properties(const Solid& s, double density) {
  const Vec3& e = s.size;
  switch (s.kind) {
    case SolidKind::sphere: {
      const double m = density * (4.0 / 3) * kPi * e.x * e.x * e.x, i = 0.4 * m * e.x * e.x;
      return diagonal(m, i, i, i);
    }
    case SolidKind::capsule:
      return of_capsule(e.x, e.y, density);
    case SolidKind::box: {
      const double m = density * 8 * e.x * e.y * e.z, x = e.x * e.x, y = e.y * e.y, z = e.z * e.z;
      return diagonal(m, m * (y + z) / 3, m * (x + z) / 3, m * (x + y) / 3);
    }
    case SolidKind::cylinder: {
      const double m = density * kPi * e.x * e.x * 2 * e.y, across = m * (e.x * e.x / 4 + e.y * e.y / 3);
      return diagonal(m, across, m * e.x * e.x / 2, across);
    }
    case SolidKind::hull:
      return of_hull(*s.hull, density);
    case SolidKind::mesh:
      return of_mesh(*s.mesh, density);
    case SolidKind::compound: {
      MassProperties sum;
      for (const auto& p : s.compound->parts())
        sum = sum + placed(mass_properties(p.solid, density), p.place);
      return sum;
    }
    case SolidKind::triangle:
    case SolidKind::plane:
    case SolidKind::height_field:
      break;
  }
  throw Error("no_mass", "planes and height fields have no mass");
}

MassProperties placed(const MassProperties& b, const Transform& at) {
  // R I R^T: columns of I R^T are I times the rows of R.
  const Vec3* r = at.rotation.row;
  const Vec3 c0 = b.inertia * r[0], c1 = b.inertia * r[1], c2 = b.inertia * r[2];
  return {b.mass,
          at.point(b.center),
          {dot(r[0], c0), dot(r[1], c1), dot(r[2], c2), dot(r[0], c1), dot(r[0], c2), dot(r[1], c2)}};
}

MassProperties operator+(const MassProperties& a, const MassProperties& b) {
  MassProperties out;
  out.mass = a.mass + b.mass;
  if (!(out.mass > 0)) return a;
  out.center = (a.center * a.mass + b.center * b.mass) / out.mass;
  out.inertia = inertia_about(a, out.center);
  out.inertia += inertia_about(b, out.center);
  return out;
}

Symmetric3 inertia_about(const MassProperties& body, const Vec3& point) {
  Symmetric3 i = body.inertia;
  i += steiner(body.mass, body.center - point);
  return i;
}

PrincipalAxes principal_axes(const Symmetric3& inertia) {
  double a[3][3] = {{inertia.xx, inertia.xy, inertia.xz},
                    {inertia.xy, inertia.yy, inertia.yz},
                    {inertia.xz, inertia.yz, inertia.zz}};
  Quat axes;
  for (int sweep = 0; sweep < 16; ++sweep) {
    const double scale = std::fabs(a[0][0]) + std::fabs(a[1][1]) + std::fabs(a[2][2]);
    if (std::fabs(a[0][1]) + std::fabs(a[0][2]) + std::fabs(a[1][2]) <= 1e-16 * scale) break;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        // Golub, Van Loan, section 8.5: the smaller angle that makes a[p][q] vanish.
        const double tau = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (tau < 0 ? -1 : 1) / (std::fabs(tau) + std::sqrt(1 + tau * tau));
        const double c = 1 / std::sqrt(1 + t * t), s = t * c;
        for (auto& row : a) {
          const double u = row[p], v = row[q];
          row[p] = c * u - s * v, row[q] = s * u + c * v;
        }
        for (int k = 0; k < 3; ++k) {
          const double u = a[p][k], v = a[q][k];
          a[p][k] = c * u - s * v, a[q][k] = s * u + c * v;
        }
        // The columns' rotation J has J_pp = c, J_pq = s: a turn by -atan t in the (p, q) plane.
        const double half_c = std::sqrt(0.5 * (1 + c)), half_s = s / (2 * half_c);
        Quat turn{half_c, 0, 0, 0};
        (p == 0 && q == 1 ? turn.z : p == 0 ? turn.y : turn.x) = p == 0 && q == 2 ? half_s : -half_s;
        axes = axes * turn;
      }
    }
  }
  return {{a[0][0], a[1][1], a[2][2]}, normalized(axes)};
}

std::optional<std::string> inertia_fault(const Symmetric3& inertia) {
  const Vec3 m = principal_axes(inertia).moments;
  const double least = std::min({m.x, m.y, m.z}), most = std::max({m.x, m.y, m.z}), sum = m.x + m.y + m.z;
  // A thin rod lies on the boundary, and its moments are rounded.
  const double slack = 1e-9 * most;
  const auto text = [](const Vec3& v) {
    return short_number(v.x) + ", " + short_number(v.y) + ", " + short_number(v.z) + " kg m^2";
  };
  if (!(least >= -slack)) return "no body has a principal moment below 0; these are " + text(m);
  if (!(most <= sum - most + slack)) {
    return "no body has a principal moment above the sum of the other two; these are " + text(m);
  }
  return std::nullopt;
}

}  // namespace truestep
