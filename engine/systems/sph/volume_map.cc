#include "engine/systems/sph/volume_map.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"

namespace truestep::sph {

namespace {

constexpr double kMostNodesOfBody = 1e6;
constexpr double kFinest = 0.5, kCoarsest = 1;  ///< spacings between nodes

/// Nodes within a kernel's radius of one, with the kernel's weights and gradients times the node's volume.
struct Stencil {
  struct Entry {
    int x, y, z;
    double w;
    Vec3 g;
  };
  std::vector<Entry> entries;
  int reach = 0;

  Stencil(Smoothing kind, double support, double width) {
    reach = static_cast<int>(support / width);
    double sum = 0;
    for (int z = -reach; z <= reach; ++z) {
      for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
          const Vec3 r = Vec3{x * width, y * width, z * width};
          const double q = norm(r) / support;
          if (q >= 1) continue;
          const auto at = smoothing_at(kind, q);
          entries.push_back({x, y, z, at.w[0], r * (-at.s[0] / (support * support))});
          sum += at.w[0];
        }
      }
    }
    for (Entry& e : entries) e.w /= sum, e.g = e.g / sum;
  }
};

/// Fraction of a node's cell that is inside, from its distance to the surface.
double inside(double distance, double width) {
  return std::clamp(0.5 - distance / width, 0.0, 1.0);
}

/// What the same sums make of a half space: share, slope, and by how much its leans along and across the
/// normal fall short of d times the slope and of 0 (d: distance from the face, which the sums blur).
struct Flat {
  static constexpr int kIntervals = 256;
  struct At {
    double share = 0, slope = 0, along = 0, across = 0;
  };
  double from, per_metre;
  std::array<At, kIntervals + 1> table{};

  Flat(const Stencil& stencil, double support, double width)
      : from(-support), per_metre(kIntervals / (2 * support)) {
    for (int k = 0; k <= kIntervals; ++k) {
      const double d = from + k / per_metre;
      At& t = table[static_cast<size_t>(k)];
      for (const Stencil::Entry& e : stencil.entries) {
        const double in = inside(d + e.y * width, width);
        t.share += in * e.w, t.slope -= in * e.g.y;
        t.along -= in * e.g.y * e.y * width, t.across -= in * e.g.x * e.x * width;
      }
      t.along += t.share + d * t.slope, t.across += t.share;
    }
  }
  At at(double d) const {
    const double place = std::clamp((d - from) * per_metre, 0.0, kIntervals - 1e-9);
    const auto k = static_cast<size_t>(place);
    const double f = place - static_cast<double>(k);
    const At &a = table[k], &b = table[k + 1];
    return {a.share + f * (b.share - a.share), a.slope + f * (b.slope - a.slope),
            a.along + f * (b.along - a.along), a.across + f * (b.across - a.across)};
  }
};

/// The grid's nodes along each axis.
std::array<double, 3> nodes_along(const Box& region, double margin, double width) {
  const Vec3 size = region.high - region.low + Vec3{2 * margin, 2 * margin, 2 * margin};
  return {std::ceil(size.x / width) + 1, std::ceil(size.y / width) + 1, std::ceil(size.z / width) + 1};
}

}  // namespace

double VolumeMap::least_nodes(const Box& region, const Kernel& kernel) {
  const double width = kCoarsest * kernel.spacing;
  const auto n = nodes_along(region, kernel.support + width, width);
  return n[0] * n[1] * n[2];
}

// Chooses the grid; false if it would have to be too coarse.
bool VolumeMap::lay(const Box& region, const Kernel& kernel, double most) {
  const double s = kernel.spacing;
  for (width_ = kFinest * s; width_ <= kCoarsest * s; width_ *= 1.25) {
    const auto n = nodes_along(region, kernel.support + width_, width_);
    if (!(n[0] * n[1] * n[2] <= most)) continue;
    for (size_t a = 0; a < 3; ++a) count_[a] = static_cast<int>(n[a]);
    low_ = region.center() - Vec3{n[0] - 1, n[1] - 1, n[2] - 1} * (0.5 * width_);
    return true;
  }
  width_ = kCoarsest * s;
  return false;
}

VolumeMap::VolumeMap(const Solid& solid, const Kernel& kernel) : sides_(mesh_sides(solid)) {
  if (!lay(bounds(solid, Transform{rotation(Quat{}), {}}), kernel, kMostNodesOfBody)) return;
  fill(solid, kernel, PointSide::outside, false);
}

VolumeMap::VolumeMap(const Solid& mesh, const Kernel& kernel, const Box& region, PointSide side)
    : sides_(MeshSides::enclosed) {
  if (!lay(region, kernel, kMostNodes)) throw Error("bad_solid", "the map of a mesh has too many nodes");
  fill(mesh, kernel, side, true);
}

void VolumeMap::fill(const Solid& solid, const Kernel& kernel, PointSide side, bool wall) {
  const double support = kernel.support, sign = side == PointSide::outside ? 1 : -1;
  const Stencil stencil(kernel.kind, support, width_);
  const Flat flat(stencil, support, width_);
  const size_t all =
      static_cast<size_t>(count_[0]) * static_cast<size_t>(count_[1]) * static_cast<size_t>(count_[2]);
  std::vector<float> distance(all), filled(all);
  const auto each = [&](const auto& body) {
    Count n;
    for (n[2] = 0; n[2] < count_[2]; ++n[2])
      for (n[1] = 0; n[1] < count_[1]; ++n[1])
        for (n[0] = 0; n[0] < count_[0]; ++n[0]) body(n);
  };
  // The distance changes by at most the step from the previous node.
  const double farthest = 2 * support + 2 * width_;
  std::optional<double> before;
  each([&](const Count& n) {
    if (n[0] == 0) before.reset();
    const double within = before ? std::min(std::abs(*before) + 1.001 * width_, farthest) : farthest;
    const auto d = point_distance(solid, place(n), within, sides_);
    before = d ? std::optional(d->distance) : std::nullopt;
    distance[index(n)] = static_cast<float>(d ? sign * d->distance : 2 * support);
    filled[index(n)] = static_cast<float>(inside(distance[index(n)], width_));
  });
  slot_.assign(all, 0);
  nodes_.assign(1, Node{1, 0, 0, 0});
  if (wall) leans_.assign(1, {}), distances_.assign(1, 0);
  // For a container, everything beyond the grid is wall.
  const double around = side == PointSide::outside ? 0 : 1;
  each([&](const Count& n) {
    const double d = distance[index(n)];
    if (std::abs(d) > support + width_) return;
    double share = 0;
    Vec3 slope;
    Symmetric3 lean;
    for (const Stencil::Entry& e : stencil.entries) {
      const Count at{n[0] + e.x, n[1] + e.y, n[2] + e.z};
      bool there = true;
      for (size_t a = 0; a < 3; ++a) there = there && at[a] >= 0 && at[a] < count_[a];
      if (!there && around == 0) continue;
      const double in = there ? double{filled[index(at)]} : around;
      share += in * e.w, slope += e.g * in;
      if (!wall) continue;
      const Vec3 r = Vec3{e.x * width_, e.y * width_, e.z * width_} * in;
      lean += {e.g.x * r.x, e.g.y * r.y, e.g.z * r.z, e.g.x * r.y, e.g.x * r.z, e.g.y * r.z};
    }
    // Where hardly any of the kernel is inside, its small contribution does not matter.
    constexpr double kLittle = 1e-3;
    const Flat::At face = flat.at(d);
    const double per = 1 / (face.slope + kLittle / support);
    slot_[index(n)] = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back({static_cast<float>((share + kLittle) / (face.share + kLittle)),
                      static_cast<float>(slope.x * per), static_cast<float>(slope.y * per),
                      static_cast<float>(slope.z * per)});
    if (!wall) return;
    // Less the share, and what the nearest face lacks.
    const double steep = norm(slope), more = face.along - face.across, same = face.across - share;
    const Vec3 u = steep > 0 ? slope / steep : Vec3{};
    const auto over = [&](double sum) { return static_cast<float>(sum * per); };
    leans_.push_back({over(lean.xx + same + more * u.x * u.x), over(lean.yy + same + more * u.y * u.y),
                      over(lean.zz + same + more * u.z * u.z), over(lean.xy + more * u.x * u.y),
                      over(lean.xz + more * u.x * u.z), over(lean.yz + more * u.y * u.z)});
    distances_.push_back(static_cast<float>(d));
  });
}

VolumeMap::Corners VolumeMap::around(const Vec3& p) const {
  const double at[3] = {(p.x - low_.x) / width_, (p.y - low_.y) / width_, (p.z - low_.z) / width_};
  Count n{};
  double f[3];
  for (size_t a = 0; a < 3; ++a) {
    n[a] = std::clamp(static_cast<int>(at[a]), 0, count_[a] - 2);
    f[a] = std::clamp(at[a] - n[a], 0.0, 1.0);
  }
  Corners out{};
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const auto k = static_cast<size_t>(corner);
    out.weight[k] = (x ? f[0] : 1 - f[0]) * (y ? f[1] : 1 - f[1]) * (z ? f[2] : 1 - f[2]);
    out.slot[k] = slot_[index({n[0] + x, n[1] + y, n[2] + z})];
  }
  return out;
}

VolumeMap::At VolumeMap::at(const Vec3& p, const Vec3& normal) const {
  if (nodes_.empty()) return {1, -normal};
  const Corners c = around(p);
  double sum[4] = {};
  for (size_t corner = 0; corner < 8; ++corner) {
    for (size_t k = 0; k < 4; ++k) sum[k] += c.weight[corner] * double{nodes_[c.slot[corner]][k]};
  }
  return {sum[0], {sum[1], sum[2], sum[3]}};
}

Symmetric3 VolumeMap::lean_at(const Vec3& p) const {
  const Corners c = around(p);
  double sum[6] = {};
  for (size_t corner = 0; corner < 8; ++corner) {
    for (size_t k = 0; k < 6; ++k) sum[k] += c.weight[corner] * double{leans_[c.slot[corner]][k]};
  }
  return {sum[0], sum[1], sum[2], sum[3], sum[4], sum[5]};
}

std::optional<VolumeMap::Bounds> VolumeMap::distance_at(const Vec3& p) const {
  const double at[3] = {(p.x - low_.x) / width_, (p.y - low_.y) / width_, (p.z - low_.z) / width_};
  Count n{};
  for (size_t a = 0; a < 3; ++a) {
    if (!(at[a] >= 0 && at[a] <= count_[a] - 1)) return std::nullopt;
    n[a] = static_cast<int>(std::floor(at[a] + 0.5));
  }
  const uint32_t slot = slot_[index(n)];
  if (slot == 0) return std::nullopt;
  const double d = double{distances_[slot]}, off = norm(p - place(n)) + 1e-5 * width_;
  return Bounds{d - off, d + off};
}

}  // namespace truestep::sph
