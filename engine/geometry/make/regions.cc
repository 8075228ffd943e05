// Regions to be filled with tetrahedra: balls, cylinders and the inside of closed surfaces.
#include <algorithm>
#include <cmath>
#include <map>

#include "engine/geometry/make/stuffing.h"
#include "engine/geometry/static_tree.h"

namespace truestep {

namespace {

constexpr double kPi = 3.14159265358979323846;

// By bisection: for regions that are convex along the path.
double halved(const Region& region, const Vec3& in, const Vec3& out) {
  double low = 0, high = 1;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (region.inside(in + middle * (out - in)) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

class Ball final : public Region {
 public:
  Ball(const Vec3& center, double radius) : center_(center), radius_(radius) {}
  Box bounds() const override { return Box{center_, center_}.grown(radius_); }
  double volume() const override { return 4.0 / 3 * kPi * radius_ * radius_ * radius_; }
  bool inside(const Vec3& p) const override { return norm2(p - center_) < radius_ * radius_; }
  double leaves(const Vec3& in, const Vec3& out) const override { return halved(*this, in, out); }

 private:
  Vec3 center_;
  double radius_;
};

class Cylinder final : public Region {
 public:
  Cylinder(const Vec3& from, const Vec3& to, double radius)
      : from_(from), along_(normalized(to - from)), length_(norm(to - from)), radius_(radius) {}
  Box bounds() const override {
    // A disc across a direction d reaches r sqrt(1 - d_c^2) along axis c.
    const auto reach = [&](double d) { return radius_ * std::sqrt(std::max(0.0, 1 - d * d)); };
    const Vec3 r{reach(along_.x), reach(along_.y), reach(along_.z)}, to = from_ + length_ * along_;
    Box out{from_ - r, from_ + r};
    out.cover(to - r), out.cover(to + r);
    return out;
  }
  double volume() const override { return kPi * radius_ * radius_ * length_; }
  bool inside(const Vec3& p) const override {
    const double t = dot(p - from_, along_);
    return t > 0 && t < length_ && norm2(p - from_ - t * along_) < radius_ * radius_;
  }
  double leaves(const Vec3& in, const Vec3& out) const override { return halved(*this, in, out); }

 private:
  Vec3 from_, along_;
  double length_, radius_;
};

class Closed final : public Region {
 public:
  Closed(std::vector<Vec3> vertices, std::vector<std::array<uint32_t, 3>> triangles)
      : x_(std::move(vertices)), triangles_(std::move(triangles)) {
    std::vector<Box> boxes;
    for (const auto& t : triangles_) {
      boxes.push_back(Box::nothing());
      for (const uint32_t p : t) boxes.back().cover(x_[p]);
    }
    tree_.build(boxes);
    for (const auto& t : triangles_) volume_ += dot(x_[t[0]], cross(x_[t[1]], x_[t[2]])) / 6;
    volume_ = std::abs(volume_);
    const Vec3 size = bounds().high - bounds().low;
    aside_ = 1e-9 * norm(size);
  }
  Box bounds() const override { return tree_.bounds(); }
  double volume() const override { return volume_; }
  // Counts how often a ray along x crosses the surface: an odd number from inside. The ray is slightly
  // offset, so that it does not meet an edge of a surface with round coordinates.
  bool inside(const Vec3& p) const override {
    const Vec3 from = p + Vec3{0, aside_ * 0.7548776662, aside_ * 0.5698402909};
    const Vec3 along{2 * (bounds().high.x - p.x) + aside_, 0, 0};
    if (!(along.x > 0)) return false;
    Box way = Box::nothing();
    way.cover(from), way.cover(from + along);
    size_t crossed = 0;
    tree_.overlapping(way, [&](uint32_t k) { crossed += meets(k, from, along).has_value(); });
    return crossed % 2;
  }
  double leaves(const Vec3& in, const Vec3& out) const override {
    const Vec3 aside{0, aside_ * 0.7548776662, aside_ * 0.5698402909};
    Box way = Box::nothing();
    way.cover(in + aside), way.cover(out + aside);
    std::optional<double> first;
    tree_.overlapping(way, [&](uint32_t k) {
      const auto at = meets(k, in + aside, out - in);
      if (at && (!first || *at < *first)) first = at;
    });
    // Rounding may hide a crossing at an end.
    return std::clamp(first.value_or(0.5), 1e-6, 1 - 1e-6);
  }

 private:
  // Fraction of the path at which it goes through a triangle (Moeller, Trumbore 1997).
  std::optional<double> meets(uint32_t k, const Vec3& from, const Vec3& along) const {
    const auto& t = triangles_[k];
    const Vec3 e1 = x_[t[1]] - x_[t[0]], e2 = x_[t[2]] - x_[t[0]], h = cross(along, e2);
    const double det = dot(e1, h);
    if (det == 0) return std::nullopt;
    const Vec3 s = from - x_[t[0]], q = cross(s, e1);
    const double u = dot(s, h) / det, v = dot(along, q) / det, share = dot(e2, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || share < 0 || share > 1) return std::nullopt;
    return share;
  }

  std::vector<Vec3> x_;
  std::vector<std::array<uint32_t, 3>> triangles_;
  StaticTree tree_;
  double volume_ = 0, aside_ = 0;
};

}  // namespace

std::unique_ptr<Region> ball_region(const Vec3& center, double radius) {
  return std::make_unique<Ball>(center, radius);
}
std::unique_ptr<Region> cylinder_region(const Vec3& from, const Vec3& to, double radius) {
  return std::make_unique<Cylinder>(from, to, radius);
}
std::unique_ptr<Region> surface_region(std::vector<Vec3> vertices,
                                       std::vector<std::array<uint32_t, 3>> triangles) {
  return std::make_unique<Closed>(std::move(vertices), std::move(triangles));
}

std::optional<SurfaceFault> surface_fault(std::span<const std::array<uint32_t, 3>> triangles) {
  // How often every directed edge occurs, and where it occurs first.
  std::map<std::array<uint32_t, 2>, std::pair<size_t, size_t>> edges;
  for (size_t k = 0; k < triangles.size(); ++k) {
    for (size_t a = 0; a < 3; ++a) {
      auto& [count, where] = edges[{triangles[k][a], triangles[k][(a + 1) % 3]}];
      if (count++ == 0) where = k;
    }
  }
  for (const auto& [e, seen] : edges) {
    const auto back = edges.find({e[1], e[0]});
    const size_t count = seen.first, other = back == edges.end() ? 0 : back->second.first;
    if (count == 1 && other == 1) continue;
    const std::string name = "edge " + std::to_string(e[0]) + "-" + std::to_string(e[1]);
    const bool turned = count + other == 2;
    return SurfaceFault{seen.second,
                        name + (count + other == 1 ? " has one triangle: the surface is open there"
                                : turned ? " has the same direction in both of its triangles: reverse one"
                                         : " has " + std::to_string(count + other) +
                                               " triangles: an edge of a surface has two")};
  }
  return std::nullopt;
}

}  // namespace truestep
