// What contacts between points and bodies cost: the search looks at every point, triangle and edge, and what
// it finds is solved in sweeps, as often as answers lead to more.
#include <algorithm>
#include <cmath>

#include "engine/couplings/contact/body_contact.h"

namespace truestep::contact {

namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
// Measured, s: boxes and copies per point, looks per point, triangle or edge, and per body.
constexpr double kPointSeconds = 1.5e-8, kLookSeconds = 1e-8, kBodySeconds = 1.5e-7;
/// s per touch: found, and solved in some tens of sweeps.
constexpr double kTouchSeconds = 2.2e-6;
/// Searches and solutions while anything touches: answers bend paths.
constexpr double kRounds = 3;
/// Share of a scene's steps in which a body touches.
constexpr double kTouching = 0.5;
/// Share of the points that a floor or a landscape carries.
constexpr double kCarried = 0.1;

double area(const ConstPoints& points, const std::array<uint32_t, 3>& t) {
  const Vec3 a = points.place(t[0]);
  return 0.5 * norm(cross(points.place(t[1]) - a, points.place(t[2]) - a));
}

}  // namespace

// A cloth hugs half of what lies in it: as many triangles as cover that, and half as many points.
std::optional<double> BodyContact::step_seconds(const ConstCoupledStates& s, double) const {
  const ConstPoints points(bodies_first_ ? s.b : s.a, point_columns_);
  const ConstBodies bodies(bodies_first_ ? s.a : s.b, body_columns_);
  const auto n = static_cast<double>(points.count);
  const auto triangles = static_cast<double>(hulls_.start.triangles.size()),
             hulls = triangles + static_cast<double>(hulls_.start.segments.size());
  const double edges = meets_edges_ ? 1.5 * triangles + (hulls - triangles) : 0;
  double covered = 0;
  for (const auto& t : hulls_.start.triangles) covered += area(points, t);
  double touches = 0;
  for (size_t i = 0; i < bodies.count(); ++i) {
    const Solid* solid = bodies.form(i).solid;
    if (!solid) continue;
    const bool wide = solid->kind == SolidKind::plane || solid->kind == SolidKind::height_field ||
                      solid->kind == SolidKind::mesh;
    const double radius = forms_[bodies.form_index(i)].reach;
    const double hugged = covered > 0 ? std::min(2 * kHalfTurn * radius * radius / covered, 1.0) : 0;
    touches += wide || covered == 0 ? kCarried * n : 1 + 0.5 * hugged * 1.5 * triangles;
  }
  touches = std::min(touches, n + hulls);
  return kPointSeconds * n + kLookSeconds * (n + hulls + edges) +
         kBodySeconds * static_cast<double>(bodies.count()) + kTouching * kRounds * touches * kTouchSeconds;
}

}  // namespace truestep::contact
