// Quickhull (Barber, Dobkin, Huhdanpaa 1996) with exact decisions: points are rounded to 40-bit integers, on
// which the orientation of four points is a 126-bit determinant. So the topology needs no tolerances and has
// no degenerate triangles; coplanar ones are merged afterwards (hull_faces.cc).
#include "engine/geometry/hull.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/geometry/hull_build.h"

namespace truestep {
namespace {

constexpr uint32_t kNoFace = 0xffffffff;

struct Lattice {
  int64_t x, y, z;
};

class Quickhull {
 public:
  explicit Quickhull(std::span<const Vec3> points);
  std::vector<HullTriangle> run();

 private:
  struct Face {
    std::array<uint32_t, 3> v, beyond;  // beyond[k]: face across the edge v[k] -> v[k + 1]
    std::vector<uint32_t> outside;      // points that see this face
    enum class Life : uint8_t { alive, dead } life = Life::alive;
  };

  /// Six times the volume of (face, p): positive when p sees the face. Exact.
  __int128 height(const Face& f, uint32_t p) const;
  void start();
  uint32_t add_face(uint32_t a, uint32_t b, uint32_t c);
  uint32_t furthest(const Face& f) const;
  void grow(uint32_t face, uint32_t apex);

  std::vector<Lattice> at_;
  std::vector<Face> faces_;
  std::vector<uint32_t> seen_, orphans_;
  struct Rim {
    uint32_t from, to, face, edge;
  };
  std::vector<Rim> rim_;
};

Quickhull::Quickhull(std::span<const Vec3> points) {
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 e = high - low, middle = (low + high) * 0.5;
  const double extent = std::max({e.x, e.y, e.z});
  if (!(extent > 0)) throw Error("bad_hull", "a hull needs points that do not all coincide");
  const double scale = 0x1p39 / extent;
  const auto whole = [&](double a) { return static_cast<int64_t>(std::nearbyint(a * scale)); };
  for (const Vec3& p : points) {
    const Vec3 q = p - middle;
    at_.push_back({whole(q.x), whole(q.y), whole(q.z)});
  }
}

__int128 Quickhull::height(const Face& f, uint32_t p) const {
  const Lattice &a = at_[f.v[0]], &b = at_[f.v[1]], &c = at_[f.v[2]], &d = at_[p];
  const __int128 ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
  const __int128 vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  return (uy * vz - uz * vy) * (d.x - a.x) + (uz * vx - ux * vz) * (d.y - a.y) +
         (ux * vy - uy * vx) * (d.z - a.z);
}

uint32_t Quickhull::add_face(uint32_t a, uint32_t b, uint32_t c) {
  faces_.push_back({{a, b, c}, {kNoFace, kNoFace, kNoFace}, {}});
  return static_cast<uint32_t>(faces_.size() - 1);
}

/// A tetrahedron of four points: extremes first, so that few points are left outside.
void Quickhull::start() {
  const auto n = static_cast<uint32_t>(at_.size());
  const auto best = [n](auto&& measure) {
    uint32_t k = 0;
    auto most = measure(0);
    for (uint32_t i = 1; i < n; ++i) {
      if (const auto m = measure(i); m > most) most = m, k = i;
    }
    return std::pair(k, most);
  };
  const auto real = [&](uint32_t i, uint32_t o) {
    return Vec3{static_cast<double>(at_[i].x - at_[o].x), static_cast<double>(at_[i].y - at_[o].y),
                static_cast<double>(at_[i].z - at_[o].z)};
  };
  const uint32_t a = best([&](uint32_t i) { return -at_[i].x; }).first;
  const uint32_t b = best([&](uint32_t i) { return norm2(real(i, a)); }).first;
  const uint32_t c = best([&](uint32_t i) { return norm2(cross(real(i, a), real(b, a))); }).first;
  Face base{{a, b, c}, {}, {}};
  const auto [d, volume] = best([&](uint32_t i) {
    const __int128 h = height(base, i);
    return h < 0 ? -h : h;
  });
  if (volume == 0) throw Error("bad_hull", "a hull needs four points that are not in one plane");
  const bool flip = height(base, d) > 0;
  const uint32_t p = flip ? c : b, q = flip ? b : c;
  add_face(a, p, q);
  add_face(a, d, p);
  add_face(p, d, q);
  add_face(q, d, a);
  faces_[0].beyond = {1, 2, 3};
  faces_[1].beyond = {3, 2, 0};
  faces_[2].beyond = {1, 3, 0};
  faces_[3].beyond = {2, 1, 0};
  for (uint32_t i = 0; i < n; ++i) {
    for (Face& f : faces_) {
      if (height(f, i) > 0) {
        f.outside.push_back(i);
        break;
      }
    }
  }
}

uint32_t Quickhull::furthest(const Face& f) const {
  uint32_t k = f.outside[0];
  __int128 most = 0;
  for (const uint32_t i : f.outside) {
    if (const __int128 h = height(f, i); h > most) most = h, k = i;
  }
  return k;
}

/// Replaces all faces that `apex` sees by a fan from it to their rim.
void Quickhull::grow(uint32_t face, uint32_t apex) {
  seen_.assign(1, face);
  faces_[face].life = Face::Life::dead;
  rim_.clear();
  orphans_.clear();
  for (size_t s = 0; s < seen_.size(); ++s) {
    for (uint32_t k = 0; k < 3; ++k) {
      const Face& f = faces_[seen_[s]];
      const uint32_t g = f.beyond[k];
      if (faces_[g].life == Face::Life::dead) continue;
      if (height(faces_[g], apex) > 0) {
        faces_[g].life = Face::Life::dead;
        seen_.push_back(g);
      }
    }
  }
  for (const uint32_t s : seen_) {
    Face& f = faces_[s];
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t g = f.beyond[k];
      if (faces_[g].life == Face::Life::dead) continue;
      const uint32_t from = f.v[k], to = f.v[(k + 1) % 3];
      uint32_t e = 0;
      while (faces_[g].v[e] != to) ++e;
      rim_.push_back({from, to, g, e});
    }
    orphans_.insert(orphans_.end(), f.outside.begin(), f.outside.end());
    f.outside = {};
  }
  const auto first = static_cast<uint32_t>(faces_.size()), count = static_cast<uint32_t>(rim_.size());
  for (const Rim& r : rim_) {
    const uint32_t f = add_face(r.from, r.to, apex);
    faces_[f].beyond[0] = r.face;
    faces_[r.face].beyond[r.edge] = f;
  }
  // Side edges of the fan meet where one rim edge ends and the next begins.
  for (uint32_t i = 0; i < count; ++i) {
    uint32_t j = 0;
    while (rim_[j].from != rim_[i].to) ++j;
    faces_[first + i].beyond[1] = first + j;
    faces_[first + j].beyond[2] = first + i;
  }
  for (const uint32_t p : orphans_) {
    if (p == apex) continue;
    for (uint32_t i = first; i < first + count; ++i) {
      if (height(faces_[i], p) > 0) {
        faces_[i].outside.push_back(p);
        break;
      }
    }
  }
}

std::vector<HullTriangle> Quickhull::run() {
  start();
  for (uint32_t i = 0; i < faces_.size(); ++i) {
    if (faces_[i].life == Face::Life::alive && !faces_[i].outside.empty()) grow(i, furthest(faces_[i]));
  }
  std::vector<uint32_t> place(faces_.size(), kNoFace);
  std::vector<HullTriangle> out;
  for (uint32_t i = 0; i < faces_.size(); ++i) {
    if (faces_[i].life == Face::Life::dead) continue;
    place[i] = static_cast<uint32_t>(out.size());
    out.push_back({faces_[i].v, faces_[i].beyond});
  }
  for (HullTriangle& t : out) {
    for (uint32_t& b : t.beyond) b = place[b];
  }
  return out;
}

}  // namespace

Hull convex_hull(std::span<const Vec3> points) {
  if (points.size() < 4) throw Error("bad_hull", "a hull needs at least four points");
  for (const Vec3& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      throw Error("bad_hull", "the points of a hull must be finite");
    }
  }
  Hull hull = merge_triangles(points, Quickhull(points).run());
  // Merging leaves nothing of a sliver.
  if (hull.faces.size() < 4) throw Error("bad_hull", "a hull needs four points that are not in one plane");
  return hull;
}

}  // namespace truestep
