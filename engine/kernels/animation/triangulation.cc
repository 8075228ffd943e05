#include "engine/kernels/animation/triangulation.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace truestep::animation {

namespace {

/// Solves a x = b for a symmetric a (xx xy xz yy yz zz); false if a is singular relative to its size.
bool solve3(const double* a, const Vec3& b, Vec3& x) {
  const double cxx = a[3] * a[5] - a[4] * a[4], cxy = a[2] * a[4] - a[1] * a[5],
               cxz = a[1] * a[4] - a[2] * a[3];
  const double cyy = a[0] * a[5] - a[2] * a[2], cyz = a[1] * a[2] - a[0] * a[4],
               czz = a[0] * a[3] - a[1] * a[1];
  const double det = a[0] * cxx + a[1] * cxy + a[2] * cxz, size = a[0] + a[3] + a[5];
  if (!(det > 1e-12 * size * size * size)) return false;
  x = Vec3{cxx * b.x + cxy * b.y + cxz * b.z, cxy * b.x + cyy * b.y + cyz * b.z,
           cxz * b.x + cyz * b.y + czz * b.z} /
      det;
  return true;
}
void add_outer(const Vec3& v, double by, double* a) {
  a[0] += by * v.x * v.x, a[1] += by * v.x * v.y, a[2] += by * v.x * v.z;
  a[3] += by * v.y * v.y, a[4] += by * v.y * v.z, a[5] += by * v.z * v.z;
}

}  // namespace

PinholeCamera camera_looking_at(const Vec3& from, const Vec3& at, const Vec3& up, double focal,
                                double middle_u, double middle_v) {
  const Vec3 ahead = normalized(at - from, Vec3{0, 0, 1});
  Vec3 right = cross(ahead, up);
  if (!(norm2(right) > 0)) right = cross(ahead, std::abs(ahead.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0});
  right = normalized(right);
  // Rotates z to the viewing direction, then x about that to the right.
  Quat q = rotation_between({0, 0, 1}, ahead);
  const Vec3 x = rotate(q, {1, 0, 0});
  q = normalized(turn_about(ahead, trig::atan2(dot(ahead, cross(x, right)), dot(x, right))) * q);
  return {{from, q}, focal, {middle_u, middle_v}};
}

std::optional<ImagePoint> project(const PinholeCamera& camera, const Vec3& place) {
  const Vec3 p = rotate(conjugate(camera.pose.orientation), place - camera.pose.position);
  if (!(p.z > 0)) return std::nullopt;
  return ImagePoint{camera.middle[0] + camera.focal * p.x / p.z, camera.middle[1] + camera.focal * p.y / p.z};
}

std::optional<Triangulated> triangulate(std::span<const PinholeCamera> cameras,
                                        std::span<const Sighting> seen) {
  if (seen.size() < 2) return std::nullopt;
  double a[6] = {};
  Vec3 b;
  for (const Sighting& s : seen) {
    const PinholeCamera& c = cameras[s.camera];
    const Vec3 d = normalized(
        rotate(c.pose.orientation, {(s.at.u - c.middle[0]) / c.focal, (s.at.v - c.middle[1]) / c.focal, 1}));
    a[0] += 1, a[3] += 1, a[5] += 1;
    add_outer(d, -1, a);
    b += c.pose.position - d * dot(d, c.pose.position);
  }
  Triangulated out;
  if (!solve3(a, b, out.place)) return std::nullopt;
  constexpr int kMost = 10;
  for (int k = 0; k <= kMost; ++k) {
    double g[6] = {}, sum = 0;
    Vec3 h;
    for (const Sighting& s : seen) {
      const PinholeCamera& c = cameras[s.camera];
      const Quat back = conjugate(c.pose.orientation);
      const Vec3 p = rotate(back, out.place - c.pose.position);
      if (!(p.z > 0)) return std::nullopt;
      const double u = s.at.u - c.middle[0] - c.focal * p.x / p.z,
                   v = s.at.v - c.middle[1] - c.focal * p.y / p.z;
      const Vec3 du = rotate(c.pose.orientation, Vec3{1, 0, -p.x / p.z} * (c.focal / p.z));
      const Vec3 dv = rotate(c.pose.orientation, Vec3{0, 1, -p.y / p.z} * (c.focal / p.z));
      add_outer(du, 1, g), add_outer(dv, 1, g);
      h += du * u + dv * v, sum += u * u + v * v;
    }
    out.residual = std::sqrt(sum / (2.0 * static_cast<double>(seen.size())));
    Vec3 by;
    if (k == kMost || !solve3(g, h, by)) break;
    if (norm(by) < 1e-14 * (1 + norm(out.place))) break;
    out.place += by;
  }
  return out;
}

double picture_noise(std::span<const Triangulated> found, std::span<const uint32_t> sightings) {
  constexpr double kFinest = 0.05;
  std::vector<double> variances;
  for (size_t i = 0; i < found.size(); ++i) {
    const double n = 2.0 * sightings[i], freedoms = n - 3;
    if (!(freedoms > 0)) continue;
    // Median of chi^2 (Wilson, Hilferty 1931).
    const double cube = 1 - 2 / (9 * freedoms);
    variances.push_back(n * found[i].residual * found[i].residual / (freedoms * cube * cube * cube));
  }
  if (variances.empty()) return kFinest;
  const auto middle = variances.begin() + static_cast<ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return std::max(std::sqrt(*middle), kFinest);
}

namespace {
/// Distance in pixels between a sighting and the projection of `place`; infinite behind the camera.
double miss(const PinholeCamera& camera, const Sighting& s, const Vec3& place) {
  const auto at = project(camera, place);
  if (!at) return HUGE_VAL;
  const double u = at->u - s.at.u, v = at->v - s.at.v;
  return std::sqrt(u * u + v * v);
}
}  // namespace

std::optional<Agreed> triangulate_agreed(std::span<const PinholeCamera> cameras,
                                         std::span<const Sighting> seen, double noise) {
  constexpr double kSuspect = 6, kCut = 4.685;
  const auto all = triangulate(cameras, seen);
  const auto farthest = [&](const Vec3& place) {
    double most = 0;
    for (const Sighting& s : seen) most = std::max(most, miss(cameras[s.camera], s, place));
    return most;
  };
  if (all && farthest(all->place) <= kSuspect * noise)
    return Agreed{*all, static_cast<uint32_t>(seen.size())};
  std::optional<Agreed> best;
  std::vector<Sighting> agree;
  for (size_t i = 0; i < seen.size(); ++i) {
    for (size_t k = i + 1; k < seen.size(); ++k) {
      const Sighting pair[] = {seen[i], seen[k]};
      const auto place = triangulate(cameras, pair);
      if (!place) continue;
      agree.clear();
      for (const Sighting& s : seen) {
        if (miss(cameras[s.camera], s, place->place) <= kCut * noise) agree.push_back(s);
      }
      const auto refined = agree.size() >= 2 ? triangulate(cameras, agree) : std::nullopt;
      if (!refined) continue;
      const auto used = static_cast<uint32_t>(agree.size());
      if (!best || used > best->used || (used == best->used && refined->residual < best->found.residual)) {
        best = Agreed{*refined, used};
      }
    }
  }
  return best;
}

}  // namespace truestep::animation
