#include "engine/math/svd3.h"

#include <algorithm>

namespace truestep {

namespace {

struct Turn {
  double c, s;
};
// The rotation by at most 45 degrees that makes (p, o; o, q) diagonal, o not 0: half the angle of (q - p, 2
// o).
Turn turn(double p, double o, double q) {
  const double d = q - p, h = std::sqrt(d * d + 4 * o * o);
  const double c = std::sqrt(0.5 + 0.5 * std::abs(d) / h);
  return {c, std::copysign(1.0, d) * o / (h * c)};
}

void rotate_columns(Mat3& a, size_t p, size_t q, const Turn& r) {
  for (size_t i = 0; i < 3; ++i) {
    const double x = a(i, p), y = a(i, q);
    a(i, p) = r.c * x - r.s * y;
    a(i, q) = r.s * x + r.c * y;
  }
}

constexpr int kSweeps = 12;
constexpr double kOrthogonal = 1e-16;

void set_column(Mat3& a, size_t c, const Vec3& v) {
  a(0, c) = v.x, a(1, c) = v.y, a(2, c) = v.z;
}

// Any unit vector perpendicular to the unit vector a.
Vec3 any_normal(const Vec3& a) {
  const Vec3 other = std::abs(a.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  return normalized(cross(a, other));
}

}  // namespace

Svd3 svd3(const Mat3& a) {
  Mat3 b = a;
  Svd3 out{.u = Mat3::identity(), .v = Mat3::identity(), .s = {}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool turned = false;
    for (const auto& [p, q] : {std::pair<size_t, size_t>{0, 1}, {0, 2}, {1, 2}}) {
      const Vec3 x = b.column(p), y = b.column(q);
      const double xx = norm2(x), yy = norm2(y), xy = dot(x, y);
      if (!(xy * xy > kOrthogonal * kOrthogonal * (xx * yy))) continue;
      const Turn r = turn(xx, xy, yy);
      rotate_columns(b, p, q, r);
      rotate_columns(out.v, p, q, r);
      turned = true;
    }
    if (!turned) break;
  }
  // Largest first; swapping two columns and negating one keeps it a rotation.
  for (const auto& [p, q] : {std::pair<size_t, size_t>{0, 1}, {0, 2}, {1, 2}}) {
    if (norm2(b.column(p)) >= norm2(b.column(q))) continue;
    for (Mat3* m : {&b, &out.v}) {
      const Vec3 x = m->column(p);
      set_column(*m, p, m->column(q));
      set_column(*m, q, -x);
    }
  }
  const Vec3 u0 = normalized(b.column(0));
  Vec3 second = b.column(1) - dot(b.column(1), u0) * u0;
  const Vec3 u1 = norm(second) > 1e-300 ? second / norm(second) : any_normal(u0);
  const Vec3 u2 = cross(u0, u1);
  set_column(out.u, 0, u0), set_column(out.u, 1, u1), set_column(out.u, 2, u2);
  out.s = {dot(u0, b.column(0)), dot(u1, b.column(1)), dot(u2, b.column(2))};
  return out;
}

Eigen3 eigen3(const Mat3& symmetric) {
  Mat3 a = symmetric;
  Eigen3 out{.values = {}, .vectors = Mat3::identity()};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    bool turned = false;
    for (const auto& [p, q] : {std::pair<size_t, size_t>{0, 1}, {0, 2}, {1, 2}}) {
      if (!(std::abs(a(p, q)) > kOrthogonal * (std::abs(a(p, p)) + std::abs(a(q, q))))) continue;
      const Turn r = turn(a(p, p), a(p, q), a(q, q));
      rotate_columns(a, p, q, r);
      a = transposed(a);
      rotate_columns(a, p, q, r);
      a = transposed(a);
      rotate_columns(out.vectors, p, q, r);
      turned = true;
    }
    if (!turned) break;
  }
  out.values = {a(0, 0), a(1, 1), a(2, 2)};
  return out;
}

}  // namespace truestep
