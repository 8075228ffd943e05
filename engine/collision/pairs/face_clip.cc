#include "engine/collision/pairs/face_clip.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace {

/// Id of the corner that `plane` cuts off the edge starting at `corner`: 16 bits, different from those of
/// corners and of other cuts except by chance.
constexpr uint32_t name_of_cut(uint32_t corner, uint32_t plane) {
  return (corner * 40503u + (plane + 1) * 25717u) & 0xffff;
}

/// Points without those that lie above another one, at less than 45 degrees from the normal: unless the
/// bodies turn by as much, they touch after it. Where a margin exceeds a body's height, its upper corners are
/// such points, and a body that counted them would have fewer than it stands on.
void leave_out_covered(std::span<const ContactPoint> all, const Vec3& normal, PointList& out) {
  for (const ContactPoint& p : all) {
    const bool covered = std::any_of(all.begin(), all.end(), [&](const ContactPoint& q) {
      const double above = p.separation - q.separation;
      if (!(above > 0)) return false;
      const Vec3 d = p.position - q.position;
      const double along = dot(d, normal);
      return norm2(d) - along * along < above * above;
    });
    if (!covered) out.point[out.count++] = p;
  }
}

/// Keeps what is inside the prism over `reference` whose edges run along `along`.
void cut_to_prism(const FacePolygon& reference, const Vec3& along, FacePolygon& incident) {
  for (int i = 0; i < reference.count && incident.count > 0; ++i) {
    const Vec3 &p = reference.corner[i], &q = reference.corner[i + 1 < reference.count ? i + 1 : 0];
    const Vec3 side = cross(q - p, along);
    incident.cut(side, dot(side, p), static_cast<uint32_t>(i));
  }
}

}  // namespace

void FacePolygon::cut(const Vec3& outward, double offset, uint32_t plane) {
  FacePolygon kept;
  for (int i = 0; i < count; ++i) {
    const int j = i + 1 < count ? i + 1 : 0;
    if (count == 2 && i == 1) {  // an edge has one side only
      if (dot(outward, corner[1]) - offset <= 0) kept.add(corner[1], id[1]);
      break;
    }
    const double si = dot(outward, corner[i]) - offset, sj = dot(outward, corner[j]) - offset;
    if (si <= 0) kept.add(corner[i], id[i]);
    if ((si < 0 && sj > 0) || (si > 0 && sj < 0)) {
      kept.add(corner[i] + (corner[j] - corner[i]) * (si / (si - sj)), name_of_cut(id[i], plane));
    }
  }
  count = kept.count;
  for (int i = 0; i < count; ++i) corner[i] = kept.corner[i], id[i] = kept.id[i];
}

void clip_faces(const FacePolygon& reference, const Vec3& normal, FacePolygon incident, double margin,
                FaceOwner owner, uint32_t tag, Manifold& out) {
  cut_to_prism(reference, normal, incident);
  const double level = dot(normal, reference.corner[0]);
  PointList all;
  for (int i = 0; i < incident.count; ++i) {
    const double s = dot(normal, incident.corner[i]) - level;
    if (s > margin) continue;
    all.point[all.count++] = {incident.corner[i] - normal * (0.5 * s), s, tag << 16 | incident.id[i]};
  }
  out.normal = owner == FaceOwner::first ? normal : -normal;
  keep_best(all.all(), normal, out);
}

void clip_slanted(const FacePolygon& reference, const Vec3& normal, const Vec3& along, FacePolygon incident,
                  double margin, uint32_t tag, Manifold& out) {
  cut_to_prism(reference, along, incident);
  const double level = dot(normal, reference.corner[0]), facing = dot(normal, along);
  out.normal = along, out.count = 0;
  for (int i = 0; i < incident.count; ++i) {
    const double s = (dot(normal, incident.corner[i]) - level) / facing;
    if (s > margin) continue;
    out.add(incident.corner[i] - along * (0.5 * s), s, tag << 16 | incident.id[i]);
  }
}

void keep_best(std::span<const ContactPoint> list, const Vec3& normal, Manifold& out) {
  out.count = 0;
  const auto keep_all = [&] {
    std::copy(list.begin(), list.end(), out.points), out.count = static_cast<int>(list.size());
  };
  if (list.size() <= Manifold::kMost) return keep_all();
  double width = 0, low = list[0].separation, high = low;
  for (const ContactPoint& p : list) {
    width = std::max(width, norm(p.position - list[0].position));
    low = std::min(low, p.separation), high = std::max(high, p.separation);
  }
  // Faces that touch all over have none.
  constexpr double kFlat = 1e-3;
  PointList uncovered;
  if (high - low > kFlat * width) {
    leave_out_covered(list, normal, uncovered), list = uncovered.all();
    if (list.size() <= Manifold::kMost) return keep_all();
  }
  const ContactPoint* all = list.data();
  const auto count = static_cast<int>(list.size());
  // The deepest first: it alone decides whether the bodies separate. Differences below a thousandth of the
  // manifold's width are noise that must not flip the choice, so a fixed direction breaks the tie; where that
  // leaves a tie (points on an edge across the direction, opposite points of a rim), the first counts.
  constexpr double kTie = 1e-6;
  const Vec3 u =
      normalized(std::fabs(normal.x) < 0.6 ? Vec3{0, -normal.z, normal.y} : Vec3{normal.z, 0, -normal.x});
  const auto pick = [&](double tie, auto&& score) {
    int best = 0;
    double most = score(all[0]);
    for (int i = 1; i < count; ++i) {
      const double s = score(all[i]);
      if (s > most + tie) most = s, best = i;
    }
    return std::pair(best, most);
  };
  const auto depth = [&](const ContactPoint& p) { return dot(u, p.position) * 1e-3 - p.separation; };
  const int a = pick(kTie * width, depth).first;
  const Vec3 pa = all[a].position;
  const double tie = kTie * width * width;
  const int b = pick(tie, [&](const ContactPoint& p) { return norm2(p.position - pa); }).first;
  const Vec3 side = cross(normal, all[b].position - pa);
  const auto [c, left] = pick(tie, [&](const ContactPoint& p) { return dot(side, p.position - pa); });
  const auto [d, right] = pick(tie, [&](const ContactPoint& p) { return -dot(side, p.position - pa); });
  const double thin = 1e-9 * norm2(side);
  out.points[out.count++] = all[a];
  if (b != a) out.points[out.count++] = all[b];
  if (left > thin && c != a && c != b) out.points[out.count++] = all[c];
  if (right > thin && d != a && d != b) out.points[out.count++] = all[d];
}

}  // namespace truestep
