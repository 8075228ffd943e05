#include "engine/collision/pairs/box_box.h"

#include <algorithm>
#include <cmath>

#include "engine/collision/pairs/distance/gjk.h"
#include "engine/collision/pairs/face_clip.h"
#include "engine/collision/pairs/general_pair.h"

namespace truestep {
namespace {

constexpr double kBias = 1e-3;  // fraction of the smallest half extent by which a face may be worse than an
                                // edge
constexpr double kSlop = 1e-4;  // fraction of a half extent: corners this far over the rim count as on it, so
                                // that

/// A corner over the reference face: in-plane place and height.
struct Corner {
  double u, v, h;
  uint32_t id;
};

/// Keeps s * (u or v) <= limit.
template <double Corner::*Axis>
int cut(const Corner* in, int n, double sign, double limit, uint32_t plane, Corner* out) {
  int m = 0;
  for (int i = 0; i < n; ++i) {
    const Corner &p = in[i], &q = in[i + 1 < n ? i + 1 : 0];
    const double dp = sign * p.*Axis - limit, dq = sign * q.*Axis - limit;
    if (dp <= 0) out[m++] = p;
    if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) {
      const double t = dp / (dp - dq);
      out[m++] = {p.u + t * (q.u - p.u), p.v + t * (q.v - p.v), p.h + t * (q.h - p.h), p.id * 8 + plane};
    }
  }
  return m;
}

struct Boxes {
  double r[3][3];  // r[i][j]: component i of the incident box's axis j in the reference frame
  double t[3];     // its centre
  double a[3], b[3];
};

/// A rectangle clipped by a rectangle has at most eight corners.
struct BoxPoints {
  int count = 0;
  ContactPoint point[10];
};

/// Contact points over the face of the reference box along `axis` on the incident box's side, in the
/// reference frame.
void face_points(const Boxes& x, int axis, double margin, uint32_t tag, Vec3& normal, BoxPoints& out) {
  const int iu = (axis + 1) % 3, iv = (axis + 2) % 3;
  const double side = x.t[axis] < 0 ? -1 : 1;
  int j = 0;
  for (int k = 1; k < 3; ++k) {
    if (std::fabs(x.r[axis][k]) > std::fabs(x.r[axis][j])) j = k;
  }
  const int k = (j + 1) % 3, l = (j + 2) % 3;
  const double facing = side * x.r[axis][j] > 0 ? -x.b[j] : x.b[j];
  const auto along = [&](int i, double sk, double sl) {
    return x.t[i] + x.r[i][j] * facing + x.r[i][k] * (sk * x.b[k]) + x.r[i][l] * (sl * x.b[l]);
  };
  Corner one[10], two[10];
  static constexpr double kSigns[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  const double hu = x.a[iu] * (1 + kSlop), hv = x.a[iv] * (1 + kSlop);
  int n = 4;
  bool inside = true;
  for (uint32_t c = 0; c < 4; ++c) {
    const double sk = kSigns[c][0], sl = kSigns[c][1];
    one[c] = {along(iu, sk, sl), along(iv, sk, sl), side * along(axis, sk, sl) - x.a[axis], c + 1};
    inside &= std::fabs(one[c].u) <= hu && std::fabs(one[c].v) <= hv;
  }
  if (!inside) {
    n = cut<&Corner::u>(one, n, 1, hu, 1, two);
    n = cut<&Corner::u>(two, n, -1, hu, 2, one);
    n = cut<&Corner::v>(one, n, 1, hv, 3, two);
    n = cut<&Corner::v>(two, n, -1, hv, 4, one);
  }
  double e[3] = {0, 0, 0};
  e[axis] = side;
  normal = {e[0], e[1], e[2]};
  out.count = 0;
  tag |= static_cast<uint32_t>((axis * 2 + (side < 0)) * 8 + j * 2 + (facing < 0)) << 16;
  for (int i = 0; i < n; ++i) {
    if (one[i].h > margin) continue;
    double p[3];
    p[iu] = one[i].u, p[iv] = one[i].v, p[axis] = side * (x.a[axis] + 0.5 * one[i].h);
    out.point[out.count++] = {{p[0], p[1], p[2]}, one[i].h, tag | (one[i].id & 0xffff)};
  }
}

/// Nearest points of the two edges that face each other along the unit normal. Empty when they are apart and
/// pass each other by more than `slack`.
void edge_point(const Boxes& x, int i, int j, const Vec3& normal, double slack, Manifold& out) {
  const double n[3] = {normal.x, normal.y, normal.z};
  double p[3], q[3] = {x.t[0], x.t[1], x.t[2]};
  uint32_t signs = 0;
  for (int k = 0; k < 3; ++k) {
    p[k] = k == i ? 0 : n[k] < 0 ? -x.a[k] : x.a[k];
    signs = signs << 1 | (k != i && n[k] < 0);
  }
  for (int k = 0; k < 3; ++k) {
    if (k == j) continue;
    const double facing = n[0] * x.r[0][k] + n[1] * x.r[1][k] + n[2] * x.r[2][k];
    const double s = facing < 0 ? x.b[k] : -x.b[k];
    signs = signs << 1 | (facing < 0);
    for (int c = 0; c < 3; ++c) q[c] += s * x.r[c][k];
  }
  // Lines p + s e_i and q + t b_j.
  const double de = x.r[i][j], rd = q[i] - p[i];
  double re = 0;
  for (int c = 0; c < 3; ++c) re += (q[c] - p[c]) * x.r[c][j];
  const double det = 1 - de * de;
  const auto within = [](double s, double h) { return s < -h ? -h : s > h ? h : s; };
  const double s = within((rd - re * de) / det, x.a[i]), t = within((rd * de - re) / det, x.b[j]);
  p[i] += s;
  for (int c = 0; c < 3; ++c) q[c] += t * x.r[c][j];
  const Vec3 pa{p[0], p[1], p[2]}, pb{q[0], q[1], q[2]};
  const double separation = dot(normal, pb - pa);
  out.normal = normal;
  out.count = 0;
  if (separation > 0 && norm(pb - pa - normal * separation) > slack) return;
  out.add((pa + pb) * 0.5, separation, 0x40000000u | static_cast<uint32_t>(i * 3 + j) << 8 | signs);
}

}  // namespace

void collide_boxes(const Vec3& ha, const Vec3& hb, const Transform& place, double margin, Manifold& out) {
  out.count = 0;
  Boxes x{{}, {place.position.x, place.position.y, place.position.z}, {ha.x, ha.y, ha.z}, {hb.x, hb.y, hb.z}};
  double q[3][3];
  for (int i = 0; i < 3; ++i) {
    const Vec3& row = place.rotation.row[i];
    x.r[i][0] = row.x, x.r[i][1] = row.y, x.r[i][2] = row.z;
    for (int j = 0; j < 3; ++j) q[i][j] = std::fabs(x.r[i][j]);
  }

  // Faces.
  double face[6];
  for (int i = 0; i < 3; ++i) {
    face[i] = std::fabs(x.t[i]) - x.a[i] - (q[i][0] * x.b[0] + q[i][1] * x.b[1] + q[i][2] * x.b[2]);
  }
  int fa = face[1] > face[0] ? 1 : 0;
  if (face[2] > face[fa]) fa = 2;
  if (face[fa] > margin) return;
  double tb[3];
  for (int j = 0; j < 3; ++j) {
    tb[j] = x.r[0][j] * x.t[0] + x.r[1][j] * x.t[1] + x.r[2][j] * x.t[2];
    face[3 + j] = std::fabs(tb[j]) - x.b[j] - (q[0][j] * x.a[0] + q[1][j] * x.a[1] + q[2][j] * x.a[2]);
  }
  int fb = face[4] > face[3] ? 1 : 0;
  if (face[5] > face[3 + fb]) fb = 2;
  if (face[3 + fb] > margin) return;

  // Edges: axis e_i x b_j, all nine before one square root each.
  double along[9], length2[9], edge[9];
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      const double d = x.t[i2] * x.r[i1][j] - x.t[i1] * x.r[i2][j];
      along[3 * i + j] = d;
      length2[3 * i + j] = x.r[i1][j] * x.r[i1][j] + x.r[i2][j] * x.r[i2][j];
      edge[3 * i + j] = std::fabs(d) - (x.a[i1] * q[i2][j] + x.a[i2] * q[i1][j]) -
                        (x.b[j1] * q[i][j2] + x.b[j2] * q[i][j1]);
    }
  }
  for (int k = 0; k < 9; ++k) {
    // Edges closer to parallel than 1e-7 rad say nothing that faces do not.
    edge[k] = length2[k] > 1e-14 ? edge[k] / std::sqrt(length2[k]) : -1e300;
  }
  int e = 0;
  for (int k = 1; k < 9; ++k) e = edge[k] > edge[e] ? k : e;
  if (edge[e] > margin) return;

  const double thin = std::min(std::min(ha.x, std::min(ha.y, ha.z)), std::min(hb.x, std::min(hb.y, hb.z)));
  const double bias = kBias * thin, best_face = std::max(face[fa], face[3 + fb]);
  if (edge[e] > best_face + bias) {
    const int i = e / 3, j = e % 3, i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    double n[3];
    const double s = (along[e] < 0 ? -1 : 1) / std::sqrt(length2[e]);
    n[i] = 0, n[i1] = -x.r[i2][j] * s, n[i2] = x.r[i1][j] * s;
    edge_point(x, i, j, {n[0], n[1], n[2]}, bias, out);
  } else {
    BoxPoints list;
    Vec3 normal;
    if (face[3 + fb] > face[fa] + bias) {
      Boxes y{{}, {-tb[0], -tb[1], -tb[2]}, {hb.x, hb.y, hb.z}, {ha.x, ha.y, ha.z}};
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) y.r[i][j] = x.r[j][i];
      }
      face_points(y, fb, margin, 0x80000000u, normal, list);
      keep_best({list.point, static_cast<size_t>(list.count)}, normal, out);
      out.normal = -place.direction(normal);
      for (int i = 0; i < out.count; ++i) out.points[i].position = place.point(out.points[i].position);
    } else {
      face_points(x, fa, margin, 0, normal, list);
      keep_best({list.point, static_cast<size_t>(list.count)}, normal, out);
      out.normal = normal;
    }
  }

  // For separated boxes the separating axes give only a lower bound; unless a point proves it tight, compute
  // the distance.
  const double separation = std::max(best_face, edge[e]);
  if (out.count > 0 && (separation <= 0 || -out.deepest() <= separation + bias)) return;
  const Convex a{SolidKind::box, ha}, b{SolidKind::box, hb};
  const CoreDistance d = core_distance(a, b, place, place.position, margin);
  out.count = 0;
  if (!(d.distance > 0)) return collide_general(a, b, place, margin, out);
  if (d.distance > margin) return;
  out.normal = d.normal;
  out.add((d.point_a + d.point_b) * 0.5, d.distance, 0xc0000000u);
}

}  // namespace truestep
