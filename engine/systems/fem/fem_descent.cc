// An elastic body for vertex block descent (core/equations/point_forces.h): the force on a node and its
// derivative as that node alone moves, from the elements around it; colours in which no two nodes share an
// element (Chen, Liu, Yang, Yuksel 2024, "Vertex Block Descent", section 3.1).
#include <algorithm>

#include "engine/systems/fem/fem_field.h"

namespace truestep::fem {

using Columns = FemColumns;

// Greedily in the order of the nodes. Left empty, and the method refused, if forces do not come from single
// elements in space with pointwise volume.
void FemField::colour_points() {
  if (body_.plane || body_.mesh.sheet || body_.mean_volume || body_.modes > 0 || !body_.pressures.empty())
    return;
  const size_t n = body_.mesh.x.size(), size = body_.size();
  corners_begin_.assign(n + 1, 0);
  for (const uint32_t p : body_.mesh.nodes) ++corners_begin_[p + 1];
  for (size_t i = 0; i < n; ++i) corners_begin_[i + 1] += corners_begin_[i];
  corners_.resize(body_.mesh.nodes.size());
  std::vector<uint32_t> next(corners_begin_.begin(), corners_begin_.end() - 1);
  for (uint32_t k = 0; k < body_.mesh.nodes.size(); ++k) {
    corners_[next[body_.mesh.nodes[k]]++] = {static_cast<uint32_t>(k / size),
                                             static_cast<uint32_t>(k % size)};
  }
  std::vector<uint32_t> colour(n, UINT32_MAX), taken;
  std::vector<std::vector<uint32_t>> of;
  for (uint32_t i = 0; i < n; ++i) {
    taken.resize(of.size() + 1, UINT32_MAX);
    for (uint32_t k = corners_begin_[i]; k < corners_begin_[i + 1]; ++k) {
      for (const uint32_t j : body_.mesh.cell(corners_[k].cell)) {
        if (colour[j] != UINT32_MAX) taken[colour[j]] = i;
      }
    }
    uint32_t free = 0;
    while (taken[free] == i) ++free;
    colour[i] = free;
    if (free == of.size()) of.emplace_back();
    of[free].push_back(i);
  }
  colours_.begin = {0};
  for (const auto& points : of) {
    colours_.points.insert(colours_.points.end(), points.begin(), points.end());
    colours_.begin.push_back(static_cast<uint32_t>(colours_.points.size()));
  }
}

Vec3 FemField::free_acceleration(const State& s) const {
  return load3(s.f64(Columns::gravity).data(), 0);
}

Vec3 FemField::allowed(size_t node, const Vec3& a) const {
  const uint8_t held = body_.axes[node];
  return {held & 1 ? 0 : a.x, held & 2 ? 0 : a.y, held & 4 ? 0 : a.z};
}

void FemField::point_slopes(const Phase& at, std::span<const double>, double h,
                            std::span<const uint32_t> points, std::span<PointSlope> out) const {
  const State& s = at.state;
  const Material m = material(s);
  const Vec3 g = gravity(at);
  const double share = load_share(at.t), damping = s.f64(Columns::parameters)[1];
  std::array<Vec3, kMostNodes> x;
  for (size_t k = 0; k < points.size(); ++k) {
    const uint32_t i = points[k];
    const double mass = body_.masses[i];
    Vec3 force = mass * (g - damping * load3(at.v.data(), i)) + share * load3(body_.loads.data(), i);
    double K[9] = {};
    for (uint32_t c = corners_begin_[i]; c < corners_begin_[i + 1]; ++c) {
      gather(at.x.data(), corners_[c].cell, x.data());
      cell_node(m, rule(corners_[c].cell), x.data(), corners_[c].node, force, K);
    }
    for (size_t c = 0; c < 3; ++c) K[4 * c] += damping * mass / h;
    for (size_t d = 0; d < Columns::kHands.drags(s); ++d) {
      const UserForces::Drag drag = Columns::kHands.drag(s, d);
      if (drag.who != i) continue;
      force += drag.stiffness * (drag.target - load3(at.x.data(), i));
      for (size_t c = 0; c < 3; ++c) K[4 * c] += drag.stiffness;
    }
    for (size_t p = 0; p < Columns::kHands.pushes(s); ++p) {
      const UserForces::Push push = Columns::kHands.push(s, p);
      if (push.who == i) force += push.force;
    }
    // Prescribed components neither move nor are moved by the others.
    double f[3] = {force.x, force.y, force.z};
    for (size_t c = 0; c < 3; ++c) {
      if (!(body_.axes[i] >> c & 1)) continue;
      f[c] = 0;
      for (size_t r = 0; r < 3; ++r) K[3 * c + r] = K[3 * r + c] = 0;
    }
    out[k] = {{f[0], f[1], f[2]}, {K[0], K[3], K[6], K[4], K[7], K[8]}};
  }
}

}  // namespace truestep::fem
