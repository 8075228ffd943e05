#include "engine/geometry/read/polygon.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace {

constexpr double kTiny = 1e-12;   // of areas, in units of the squared extent: rounding of coordinates
constexpr double kMostOff = 0.1;  // of the root of the area: a square's halves are then folded by 32 degrees
constexpr size_t kMostClipped = 1'000;
constexpr double kMostWork = 1e9;  // a few seconds

}  // namespace

double PolygonCutter::turn(size_t a, size_t b, size_t c) const {
  const Flat &p = at_[a], &q = at_[b], &r = at_[c];
  return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
}

bool PolygonCutter::same(size_t a, size_t b) const {
  return at_[a].x == at_[b].x && at_[a].y == at_[b].y;
}

/// Corners in the plane of the face, which they run round anticlockwise. False without an area, or with
/// `why`.
bool PolygonCutter::flatten(std::span<const Vec3> vertices, std::string& why) {
  const Vec3 origin = vertices[corners_[0]];
  const auto p = [&](size_t k) { return vertices[corners_[k]] - origin; };
  const size_t n = corners_.size();
  Vec3 normal, far;
  for (size_t k = 0; k < n; ++k) {
    normal += cross(p(k), p(k + 1 < n ? k + 1 : 0));
    if (norm2(p(k)) > norm2(far)) far = p(k);
  }
  const double extent = norm(far), area = 0.5 * norm(normal);
  if (!(area > kTiny * extent * extent)) {
    double widest = 0;
    for (size_t k = 0; k < n; ++k) widest = std::max(widest, norm(cross(p(k), far)));
    if (widest > 1e-9 * extent * extent) why = "a face of " + std::to_string(n) + " corners crosses itself";
    return false;
  }
  normal = normal / (2 * area);
  Vec3 u = far - normal * dot(far, normal);
  u = u / norm(u);
  const Vec3 v = cross(normal, u);
  double low = 0, high = 0;
  at_.clear();
  for (size_t k = 0; k < n; ++k) {
    at_.push_back({dot(p(k), u) / extent, dot(p(k), v) / extent});
    low = std::min(low, dot(p(k), normal)), high = std::max(high, dot(p(k), normal));
  }
  const double off = 0.5 * (high - low) / std::sqrt(area);
  if (off <= kMostOff) return true;
  why = "the corners of a face are off any plane by " + std::to_string(std::lround(100 * off)) +
        " % of its size: cut it into triangles";
  return false;
}

/// All turns to the left, once round, and no triangle of the fan without an area.
bool PolygonCutter::convex() const {
  const size_t n = at_.size();
  size_t changes = 0;
  const auto up = [&](size_t a, size_t b) {
    return at_[b].y > at_[a].y || (at_[b].y == at_[a].y && at_[b].x > at_[a].x);
  };
  for (size_t k = 0; k < n; ++k) {
    const size_t a = k, b = (k + 1) % n, c = (k + 2) % n;
    if (turn(a, b, c) < -kTiny) return false;
    if (up(a, b) != up(b, c)) ++changes;
    if (k > 0 && k + 1 < n && !(turn(0, k, k + 1) > kTiny)) return false;
  }
  return changes <= 2;
}

std::string PolygonCutter::crossing() const {
  const size_t n = at_.size();
  const std::string face = "a face of " + std::to_string(n) + " corners ";
  const auto sides = [&](size_t a, size_t b, size_t c, size_t d) {
    const double x = turn(a, b, c), y = turn(a, b, d);
    return (x > kTiny && y < -kTiny) || (x < -kTiny && y > kTiny);
  };
  for (size_t a = 0; a < n; ++a) {
    const size_t b = (a + 1) % n;
    for (size_t c = a + 1; c < n; ++c) {
      const size_t d = (c + 1) % n;
      if (same(a, c) && same(b, d)) return face + "runs over one of its edges twice";
      if (sides(a, b, c, d) && sides(c, d, a, b)) return face + "crosses itself";
    }
  }
  return "";
}

/// Whether the triangle at this corner belongs to the face and no other corner lies in it.
bool PolygonCutter::ear(size_t b) const {
  const size_t a = before_[b], c = after_[b];
  if (!(turn(a, b, c) > kTiny)) return false;
  for (size_t p = after_[c]; p != a; p = after_[p]) {
    if (same(p, a) || same(p, b) || same(p, c)) continue;
    if (turn(a, b, p) >= -kTiny && turn(b, c, p) >= -kTiny && turn(c, a, p) >= -kTiny) return false;
  }
  return true;
}

bool PolygonCutter::clip(std::vector<std::array<uint32_t, 3>>& out) {
  const size_t n = at_.size();
  before_.resize(n), after_.resize(n);
  for (size_t k = 0; k < n; ++k) before_[k] = k > 0 ? k - 1 : n - 1, after_[k] = k + 1 < n ? k + 1 : 0;
  std::vector<uint8_t> ears(n);
  for (size_t k = 0; k < n; ++k) ears[k] = ear(k);
  size_t left = n, b = 0, passed = 0;
  bool fresh = true;
  while (left > 3) {
    if (!ears[b]) {
      b = after_[b];
      if (++passed < left) continue;
      // What stood in an ear's way may have been cut off since.
      if (fresh) return false;
      for (size_t k = b, round = 0; round < left; ++round, k = after_[k]) ears[k] = ear(k);
      fresh = true, passed = 0;
      continue;
    }
    const size_t a = before_[b], c = after_[b];
    out.push_back({corners_[a], corners_[b], corners_[c]});
    after_[a] = c, before_[c] = a;
    --left, passed = 0, fresh = false;
    ears[a] = ear(a), ears[c] = ear(c);
    // Not the neighbour: fans of slivers would come of that.
    b = after_[c];
  }
  if (turn(before_[b], b, after_[b]) < -kTiny) return false;
  out.push_back({corners_[before_[b]], corners_[b], corners_[after_[b]]});
  return true;
}

std::string PolygonCutter::cut(std::span<const Vec3> vertices, std::span<const uint32_t> corners,
                               std::vector<std::array<uint32_t, 3>>& out) {
  corners_.assign(corners.begin(), corners.end());
  if (corners_.size() > 3) {
    corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
    while (corners_.size() > 1 && corners_.back() == corners_.front()) corners_.pop_back();
    if (corners_.size() < 3) return "";
  }
  const size_t n = corners_.size();
  std::string why;
  const bool fan = n == 3 || (!flatten(vertices, why) && why.empty()) || (why.empty() && convex());
  if (!why.empty()) return why;
  if (fan) {
    for (size_t k = 1; k + 1 < n; ++k) out.push_back({corners_[0], corners_[k], corners_[k + 1]});
    return "";
  }
  const std::string face = "a concave face of " + std::to_string(n) + " corners ";
  if (n > kMostClipped)
    return face + "has more than " + std::to_string(kMostClipped) + ": cut it into triangles";
  work_ += static_cast<double>(n) * static_cast<double>(n);
  if (work_ > kMostWork) return "there are too many concave faces of many corners: cut them into triangles";
  why = crossing();
  const size_t first = out.size();
  if (why.empty() && !clip(out)) {
    out.resize(first);
    why = "a face of " + std::to_string(n) + " corners crosses or touches itself";
  }
  return why;
}

}  // namespace truestep
