#include "engine/kernels/fem/bending.h"

#include <cmath>

#include "engine/math/mat3.h"

namespace truestep::fem {

namespace {

constexpr double kInside = 4, kRim = 8;  // eta
constexpr size_t kEnds[3][2] = {{0, 1}, {1, 2}, {2, 0}};

/// Gradients of the barycentric coordinates, in space and in the triangle's plane.
struct Barycentric {
  Vec3 g[3];
  double area;
};
Barycentric barycentric(std::span<const Vec3, 3> x) {
  const Vec3 n = cross(x[1] - x[0], x[2] - x[0]);
  const double twice = norm(n);
  Barycentric out{{}, 0.5 * twice};
  for (size_t i = 0; i < 3; ++i) out.g[i] = cross(n, x[(i + 2) % 3] - x[(i + 1) % 3]) / (twice * twice);
  return out;
}

// Slopes along u of the shape functions at the barycentric coordinates l.
SixNodes slopes(const Barycentric& b, const double* l, const Vec3& u) {
  SixNodes out;
  for (size_t i = 0; i < 3; ++i) out[i] = (4 * l[i] - 1) * dot(b.g[i], u);
  for (size_t e = 0; e < 3; ++e) {
    const auto [i, j] = kEnds[e];
    out[3 + e] = 4 * (l[i] * dot(b.g[j], u) + l[j] * dot(b.g[i], u));
  }
  return out;
}

SixNodes second(const Barycentric& b, const Vec3& u, const Vec3& v) {
  SixNodes out;
  for (size_t i = 0; i < 3; ++i) out[i] = 4 * dot(b.g[i], u) * dot(b.g[i], v);
  for (size_t e = 0; e < 3; ++e) {
    const auto [i, j] = kEnds[e];
    out[3 + e] = 4 * (dot(b.g[i], u) * dot(b.g[j], v) + dot(b.g[j], u) * dot(b.g[i], v));
  }
  return out;
}

// One side of an edge at a point of it, at `share` of the edge from the side's own first end.
struct Side {
  SixNodes out, moment, along;  // slope along the conormal, k_mm + nu k_tt, slope along the edge
  double height;                // m, of the triangle over the edge
};
Side side_of(std::span<const Vec3, 3> x, size_t edge, double share, const Vec3& t, double poisson) {
  const Barycentric b = barycentric(x);
  const auto [i, j] = kEnds[edge];
  double l[3] = {};
  l[i] = 1 - share, l[j] = share;
  // The third coordinate decreases towards the edge.
  const Vec3 down = b.g[3 - i - j];
  const double steep = norm(down);
  const Vec3 m = down / -steep;
  Side s{slopes(b, l, m), second(b, m, m), slopes(b, l, t), 1 / steep};
  const SixNodes across = second(b, t, t);
  for (size_t a = 0; a < 6; ++a) s.moment[a] += poisson * across[a];
  return s;
}

Mat3 skew(const Vec3& v) {
  Mat3 out;
  out(0, 1) = -v.z, out(0, 2) = v.y, out(1, 0) = v.z, out(1, 2) = -v.x, out(2, 0) = -v.y, out(2, 1) = v.x;
  return out;
}

Mat3 outer(const Vec3& a, const Vec3& b) {
  const double u[] = {a.x, a.y, a.z}, v[] = {b.x, b.y, b.z};
  Mat3 out;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) out(r, c) = u[r] * v[c];
  }
  return out;
}

void put(std::array<double, 81>& h, size_t row, size_t column, const Mat3& block) {
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 3; ++c) {
      h[9 * (3 * row + r) + 3 * column + c] = block(r, c);
      h[9 * (3 * column + c) + 3 * row + r] = block(r, c);
    }
  }
}

}  // namespace

TriangleCurvature triangle_curvature(std::span<const Vec3, 3> x) {
  const Barycentric b = barycentric(x);
  const Vec3 e = normalized(x[1] - x[0]), n = normalized(cross(x[1] - x[0], x[2] - x[0])), f = cross(n, e);
  return {{second(b, e, e), second(b, f, f), second(b, e, f)}, b.area};
}

std::array<double, 36> triangle_bending(const TriangleCurvature& t, double nu) {
  std::array<double, 36> out;
  const auto& [k11, k22, k12] = t.k;
  for (size_t a = 0; a < 6; ++a) {
    for (size_t b = 0; b < 6; ++b) {
      out[6 * a + b] = t.area * (k11[a] * k11[b] + k22[a] * k22[b] +
                                 nu * (k11[a] * k22[b] + k22[a] * k11[b]) + 2 * (1 - nu) * k12[a] * k12[b]);
    }
  }
  return out;
}

std::array<EdgePoint, 2> edge_points(std::span<const Vec3, 3> first, size_t first_edge,
                                     const Vec3* second_side, size_t second_edge, double poisson) {
  const Vec3 from = first[kEnds[first_edge][0]], way = first[kEnds[first_edge][1]] - from;
  const double length = norm(way);
  const Vec3 t = way / length;
  std::array<EdgePoint, 2> out{};
  for (size_t q = 0; q < 2; ++q) {
    constexpr double kAt = 0.28867513459481287;  // half of 1 / sqrt(3)
    const double share = 0.5 + (q == 0 ? -kAt : kAt);
    EdgePoint& p = out[q];
    p.weight = 0.5 * length;
    const Side one = side_of(first, first_edge, share, t, poisson);
    const double part = second_side ? 0.5 : 1;
    for (size_t a = 0; a < 6; ++a) {
      p.jump[a] = one.out[a], p.between[a] = one.out[a];
      p.moment[a] = part * one.moment[a], p.along[a] = one.along[a];
    }
    p.penalty = (second_side ? 0.5 * kInside : kRim) / one.height;
    if (!second_side) continue;
    const std::span<const Vec3, 3> x(second_side, 3);
    const bool same = norm2(x[kEnds[second_edge][0]] - from) < 0.25 * length * length;
    const Side two = side_of(x, second_edge, same ? share : 1 - share, t, poisson);
    for (size_t a = 0; a < 6; ++a) {
      p.jump[6 + a] = two.out[a], p.between[6 + a] = -two.out[a];
      p.moment[6 + a] = part * two.moment[a];
    }
    p.penalty += 0.5 * kInside / two.height;
  }
  return out;
}

Bent bent(const Vec3& l, const Vec3& t, const Vec3& c) {
  const Vec3 whole = cross(t, c);
  const double size = norm(whole);
  if (!(size > 0)) return {};
  const Vec3 n = whole / size;
  const double value = dot(l, n);
  const Vec3 g = (l - value * n) / size;
  return {value, {n, cross(c, g), cross(g, t)}};
}

std::array<double, 81> bent_slope(const Vec3& l, const Vec3& t, const Vec3& c, BentSlope kind, double f) {
  std::array<double, 81> out{};
  const Vec3 whole = cross(t, c);
  const double size = norm(whole);
  if (!(size > 0)) return out;
  const Vec3 n = whole / size;
  const double value = dot(l, n);
  const Vec3 g = (l - value * n) / size;
  const Mat3 flat = Mat3::identity() - outer(n, n), by_t = -1.0 * skew(c), by_c = skew(t);
  put(out, 0, 1, (1 / size) * (flat * by_t));
  put(out, 0, 2, (1 / size) * (flat * by_c));
  const Mat3 curved = kind == BentSlope::definite
                          ? (f / (size * size)) * flat
                          : (1 / (size * size)) * (3 * value * outer(n, n) - outer(l, n) - outer(n, l) -
                                                   value * Mat3::identity());
  const Mat3 cross_term = kind == BentSlope::definite ? Mat3{} : -1.0 * skew(g);
  put(out, 1, 1, transposed(by_t) * curved * by_t);
  put(out, 1, 2, transposed(by_t) * curved * by_c + cross_term);
  put(out, 2, 2, transposed(by_c) * curved * by_c);
  return out;
}

}  // namespace truestep::fem
