#include "engine/collision/pairs/distance/epa.h"

#include <algorithm>
#include <cmath>

namespace truestep {
namespace {

constexpr double kClose = 1e-7;  // fraction of the size
constexpr int kPoints = 96, kFaces = 2 * kPoints + 8, kRim = 96;

class Expansion {
 public:
  Expansion(const Convex& a, const Convex& b, const Transform& b_in_a) : a_(a), b_(b), place_(b_in_a) {}

  CoreDepth run(const Simplex& start, std::span<const Vec3> guesses);

 private:
  struct Point {
    Vec3 w;
  };
  struct Face {
    int v[3];
    Vec3 normal;
    double height;  // of its plane above the origin
  };

  Point furthest(const Vec3& d) const {
    const Vec3 pa = a_.support(d), pb = place_.point(b_.support(place_.inverse_direction(-d)));
    return {pa - pb};
  }
  /// Remembers the direction with the least extent of the set.
  void consider(const Vec3& unit, const Point& p) {
    const double reach = dot(unit, p.w);
    if (reach < best_.depth) best_.depth = reach, best_.normal = unit, best_.source = source_;
  }
  bool tetrahedron(const Simplex& start);
  bool add_face(int i, int j, int k);
  bool expand(const Point& p);

  const Convex &a_, &b_;
  const Transform& place_;
  Point points_[kPoints];
  Face faces_[kFaces];
  int point_count_ = 0, face_count_ = 0;
  double size_ = 0;
  CoreDepth best_;
  CoreDepth::Source source_ = CoreDepth::Source::guess;
};

bool Expansion::add_face(int i, int j, int k) {
  if (face_count_ == kFaces) return false;
  const Vec3 &p = points_[i].w, u = points_[j].w - p, v = points_[k].w - p, n = cross(u, v);
  const double l = norm(n);
  if (!(l > 1e-14 * size_ * size_)) return false;
  faces_[face_count_++] = {{i, j, k}, n / l, dot(n, p) / l};
  return true;
}

/// A tetrahedron containing the origin, from the remaining simplex of the distance search.
bool Expansion::tetrahedron(const Simplex& start) {
  for (int i = 0; i < start.count; ++i) points_[i] = {start.w[i]};
  int n = start.count;
  static constexpr Vec3 kAxes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const double flat = 1e-10;
  if (n == 1) {
    double most = 0;
    for (const Vec3& e : kAxes) {
      for (const double s : {1.0, -1.0}) {
        const Point p = furthest(e * s);
        if (const double l = norm2(p.w - points_[0].w); l > most) most = l, points_[1] = p, n = 2;
      }
    }
  }
  if (n == 2) {
    const Vec3 line = points_[1].w - points_[0].w;
    double most = flat * flat * norm2(line) * norm2(line);
    for (const Vec3& e : kAxes) {
      const Vec3 d = cross(line, e);
      for (const double s : {1.0, -1.0}) {
        const Point p = furthest(d * s);
        if (const double l = norm2(cross(p.w - points_[0].w, line)); l > most)
          most = l, points_[2] = p, n = 3;
      }
    }
  }
  if (n == 3) {
    const Vec3 up = cross(points_[1].w - points_[0].w, points_[2].w - points_[0].w);
    double most = flat * norm2(up);
    for (const double s : {1.0, -1.0}) {
      const Point p = furthest(up * s);
      if (const double l = std::fabs(dot(p.w - points_[0].w, up)); l > most) most = l, points_[3] = p, n = 4;
    }
  }
  if (n < 4) return false;
  point_count_ = 4;
  size_ = 0;
  for (int i = 0; i < 4; ++i) size_ = std::max(size_, norm(points_[i].w - points_[(i + 1) % 4].w));
  const Vec3& o = points_[0].w;
  if (dot(cross(points_[1].w - o, points_[2].w - o), points_[3].w - o) > 0) std::swap(points_[1], points_[2]);
  return add_face(0, 1, 2) && add_face(0, 3, 1) && add_face(1, 3, 2) && add_face(2, 3, 0);
}

/// Adds a point outside: faces that it sees are replaced by a fan.
bool Expansion::expand(const Point& p) {
  if (point_count_ == kPoints) return false;
  const int apex = point_count_++;
  points_[apex] = p;
  struct Edge {
    int from, to;
  } rim[kRim];
  int rims = 0;
  bool fits = true;
  for (int f = 0; f < face_count_;) {
    if (!(dot(faces_[f].normal, p.w) > faces_[f].height)) {
      ++f;
      continue;
    }
    for (int k = 0; k < 3; ++k) {
      const int from = faces_[f].v[k], to = faces_[f].v[(k + 1) % 3];
      int e = 0;
      while (e < rims && !(rim[e].from == to && rim[e].to == from)) ++e;
      if (e < rims) {
        rim[e] = rim[--rims];
      } else if (rims < kRim) {
        rim[rims++] = {from, to};
      } else {
        fits = false;
      }
    }
    faces_[f] = faces_[--face_count_];
  }
  for (int e = 0; e < rims && fits; ++e) fits = add_face(rim[e].from, rim[e].to, apex);
  return fits && rims > 2;
}

CoreDepth Expansion::run(const Simplex& start, std::span<const Vec3> guesses) {
  best_.depth = std::numeric_limits<double>::infinity();
  for (const Vec3& g : guesses) consider(g, furthest(g));
  source_ = CoreDepth::Source::search;
  if (!tetrahedron(start)) {
    for (const Vec3& d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      consider(d, furthest(d));
      consider(-d, furthest(-d));
    }
    return best_;
  }
  for (;;) {
    int lowest = 0;
    for (int f = 1; f < face_count_; ++f) {
      if (faces_[f].height < faces_[lowest].height) lowest = f;
    }
    const Face face = faces_[lowest];
    const double close = kClose * size_;
    if (best_.depth - face.height <= close) break;
    const Point p = furthest(face.normal);
    consider(face.normal, p);
    if (dot(face.normal, p.w) - face.height <= close || !expand(p) || face_count_ == 0) break;
  }
  return best_;
}

}  // namespace

CoreDepth core_depth(const Convex& a, const Convex& b, const Transform& b_in_a, const Simplex& start,
                     std::span<const Vec3> guesses) {
  CoreDepth d = Expansion(a, b, b_in_a).run(start, guesses);
  if (d.depth < 0) d.depth = 0;
  return d;
}

void refine(const Convex& a, const Convex& b, const Transform& b_in_a, double size, CoreDepth& depth) {
  const double gap = 1e-3 * size;
  for (int round = 0; round < 3; ++round) {
    const Vec3 shift = depth.normal * (depth.depth + gap);
    const Transform moved{b_in_a.rotation, b_in_a.position + shift};
    const CoreDistance d = core_distance(a, b, moved, depth.normal);
    if (!(d.distance > 0)) return;
    depth.point_a = d.point_a, depth.point_b = d.point_b - shift;
    const double better = dot(shift, d.normal) - d.distance, gain = depth.depth - better;
    if (!(gain > 0)) return;
    depth.depth = better > 0 ? better : 0, depth.normal = d.normal;
    if (gain < 1e-6 * size) return;
  }
}

}  // namespace truestep
