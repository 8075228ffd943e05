#include "engine/systems/sph/volume_map.h"

#include <algorithm>
#include <cmath>

namespace truestep::sph {

namespace {

constexpr double kMostNodes = 1e6;
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

/// Share and slope of a half space by the same sums.
struct Flat {
  static constexpr int kIntervals = 256;
  double from, per_metre;
  std::array<double, kIntervals + 1> share{}, slope{};

  Flat(const Stencil& stencil, double support, double width)
      : from(-support), per_metre(kIntervals / (2 * support)) {
    for (int k = 0; k <= kIntervals; ++k) {
      const double d = from + k / per_metre;
      for (const Stencil::Entry& e : stencil.entries) {
        const double in = inside(d + e.y * width, width);
        share[static_cast<size_t>(k)] += in * e.w, slope[static_cast<size_t>(k)] -= in * e.g.y;
      }
    }
  }
  std::array<double, 2> at(double d) const {
    const double place = std::clamp((d - from) * per_metre, 0.0, kIntervals - 1e-9);
    const auto k = static_cast<size_t>(place);
    const double f = place - static_cast<double>(k);
    return {share[k] + f * (share[k + 1] - share[k]), slope[k] + f * (slope[k + 1] - slope[k])};
  }
};

}  // namespace

// Chooses the grid; false if it would have to be too coarse.
bool VolumeMap::lay(const Solid& solid, const Setting& setting) {
  const Box box = bounds(solid, Transform{rotation(Quat{}), {}});
  const double s = setting.def.spacing;
  for (width_ = kFinest * s; width_ <= kCoarsest * s; width_ *= 1.25) {
    const double margin = setting.support + width_;
    const Vec3 size = box.high - box.low + Vec3{2 * margin, 2 * margin, 2 * margin};
    const double n[3] = {std::ceil(size.x / width_) + 1, std::ceil(size.y / width_) + 1,
                         std::ceil(size.z / width_) + 1};
    if (!(n[0] * n[1] * n[2] <= kMostNodes)) continue;
    for (size_t a = 0; a < 3; ++a) count_[a] = static_cast<int>(n[a]);
    low_ = (box.low + box.high) * 0.5 - Vec3{n[0] - 1, n[1] - 1, n[2] - 1} * (0.5 * width_);
    return true;
  }
  return false;
}

VolumeMap::VolumeMap(const Solid& solid, const Setting& setting) : sides_(mesh_sides(solid)) {
  if (!lay(solid, setting)) return;
  const double support = setting.support;
  const Stencil stencil(setting.def.kernel, support, width_);
  const Flat flat(stencil, support, width_);
  const size_t all =
      static_cast<size_t>(count_[0]) * static_cast<size_t>(count_[1]) * static_cast<size_t>(count_[2]);
  std::vector<float> distance(all), filled(all);
  const auto each = [&](const auto& body) {
    std::array<int, 3> n;
    for (n[2] = 0; n[2] < count_[2]; ++n[2])
      for (n[1] = 0; n[1] < count_[1]; ++n[1])
        for (n[0] = 0; n[0] < count_[0]; ++n[0]) body(n);
  };
  each([&](const std::array<int, 3>& n) {
    const auto d = point_distance(solid, place(n), 2 * support + 2 * width_, sides_);
    distance[index(n)] = static_cast<float>(d ? d->distance : 2 * support);
    filled[index(n)] = static_cast<float>(inside(distance[index(n)], width_));
  });
  nodes_.resize(all);
  each([&](const std::array<int, 3>& n) {
    Node& node = nodes_[index(n)];
    node = {1, 0, 0, 0};
    const double d = distance[index(n)];
    if (std::abs(d) > support + width_) return;
    double share = 0;
    Vec3 slope;
    for (const Stencil::Entry& e : stencil.entries) {
      const std::array<int, 3> at{n[0] + e.x, n[1] + e.y, n[2] + e.z};
      bool there = true;
      for (size_t a = 0; a < 3; ++a) there = there && at[a] >= 0 && at[a] < count_[a];
      if (!there) continue;
      const double in = double{filled[index(at)]};
      share += in * e.w, slope += e.g * in;
    }
    // Where hardly any of the kernel is inside, its small contribution does not matter.
    constexpr double kLittle = 1e-3;
    const auto [whole, steep] = flat.at(d);
    const double per = 1 / (steep + kLittle / support);
    node = {static_cast<float>((share + kLittle) / (whole + kLittle)), static_cast<float>(slope.x * per),
            static_cast<float>(slope.y * per), static_cast<float>(slope.z * per)};
  });
}

VolumeMap::At VolumeMap::at(const Vec3& p, const Vec3& normal) const {
  if (nodes_.empty()) return {1, -normal};
  const double at[3] = {(p.x - low_.x) / width_, (p.y - low_.y) / width_, (p.z - low_.z) / width_};
  std::array<int, 3> n{};
  double f[3];
  for (size_t a = 0; a < 3; ++a) {
    n[a] = std::clamp(static_cast<int>(at[a]), 0, count_[a] - 2);
    f[a] = std::clamp(at[a] - n[a], 0.0, 1.0);
  }
  double sum[4] = {};
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const double w = (x ? f[0] : 1 - f[0]) * (y ? f[1] : 1 - f[1]) * (z ? f[2] : 1 - f[2]);
    const Node& node = nodes_[index({n[0] + x, n[1] + y, n[2] + z})];
    for (size_t k = 0; k < 4; ++k) sum[k] += w * double{node[k]};
  }
  return {sum[0], {sum[1], sum[2], sum[3]}};
}

}  // namespace truestep::sph
