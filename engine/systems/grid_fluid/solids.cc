#include "engine/systems/grid_fluid/solids.h"

#include <algorithm>
#include <cmath>

namespace truestep::grid_fluid {

double distance_to(std::span<const ObstacleDef> obstacles, const Vec3& at, size_t dimensions,
                   uint32_t* which) {
  double nearest = 1e300;
  for (size_t n = 0; n < obstacles.size(); ++n) {
    const ObstacleDef& o = obstacles[n];
    double d[3] = {at.x - o.center.x, at.y - o.center.y, dimensions == 3 ? at.z - o.center.z : 0};
    if (o.shape == ObstacleDef::Shape::box && o.turned != Quat{}) {
      const Vec3 own = rotation(o.turned).apply_inverse({d[0], d[1], d[2]});
      d[0] = own.x, d[1] = own.y, d[2] = own.z;
    }
    double here = 0;
    if (o.shape == ObstacleDef::Shape::sphere) {
      here = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) - o.radius;
    } else {
      const double half[3] = {o.half.x, o.half.y, o.half.z};
      double outside = 0, inside = -1e300;
      for (size_t a = 0; a < dimensions; ++a) {
        const double beyond = std::abs(d[a]) - half[a];
        outside += std::max(beyond, 0.0) * std::max(beyond, 0.0);
        inside = std::max(inside, beyond);
      }
      here = std::sqrt(outside) + std::min(inside, 0.0);
    }
    if (here < nearest && which) *which = static_cast<uint32_t>(n);
    nearest = std::min(nearest, here);
  }
  return nearest;
}

Solids::Solids(const std::vector<ObstacleDef>& obstacles, const mac::MacGrid& g) {
  if (!obstacles.empty()) place(obstacles, g);
}

void Solids::set_aside() {
  constexpr size_t kSpare = 256;
  size_t most = 0;
  for (size_t c = 0; c < 3; ++c) {
    const size_t n = 2 * shut[c].size() + kSpare;
    shut[c].reserve(n), inside[c].reserve(n), walls[c].reserve(2 * walls[c].size() + kSpare);
    most = std::max(most, n);
  }
  depth_.reserve(most);
}

CellRange cells_near(const ObstacleDef& o, const mac::MacGrid& g, double beyond) {
  const double center[] = {o.center.x, o.center.y, o.center.z};
  double half[] = {o.half.x, o.half.y, o.half.z};
  if (o.turned != Quat{}) {
    const Rotation r = rotation(o.turned);
    for (size_t a = 0; a < 3; ++a)
      half[a] =
          std::abs(r.row[a].x) * o.half.x + std::abs(r.row[a].y) * o.half.y + std::abs(r.row[a].z) * o.half.z;
  }
  CellRange out;
  for (size_t a = 0; a < g.dimensions; ++a) {
    const double reach = (o.shape == ObstacleDef::Shape::sphere ? o.radius : half[a]) / g.spacing[a] + beyond;
    const double middle = (center[a] - g.origin[a]) / g.spacing[a];
    const auto most = static_cast<double>(g.cells[a] + 1);
    out.first[a] = static_cast<size_t>(std::clamp(std::floor(middle - reach), 0.0, most));
    out.last[a] = static_cast<size_t>(std::clamp(std::ceil(middle + reach), 0.0, most));
  }
  return out;
}

void Solids::place(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g) {
  // Faces more than two cells from every obstacle are open.
  near_.assign(g.size(), 0);
  for (const ObstacleDef& o : obstacles) {
    const auto [first, last] = cells_near(o, g, 2);
    for (size_t k = first[2]; k < last[2]; ++k) {
      for (size_t j = first[1]; j < last[1]; ++j) {
        for (size_t i = first[0]; i < last[0]; ++i) near_[g.at(i, j, k)] = 1;
      }
    }
  }
  for (size_t c = 0; c < g.dimensions; ++c) measure_faces(obstacles, g, c), find_walls(obstacles, g, c);
}

void Solids::measure_faces(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g, size_t c) {
  constexpr int kStrips = 8;
  constexpr double kLeastOpen = 1e-3;
  open[c].assign(g.size(), 1), fluid[c].assign(g.size(), 1);
  depth_.clear();
  solid_[c].assign(g.size(), 0);
  shut[c].clear(), inside[c].clear();
  const size_t u = c == 0 ? 1 : 0, w = c == 2 ? 1 : 2;
  const bool space = g.dimensions == 3;
  const double smallest =
      *std::min_element(g.spacing.begin(), g.spacing.begin() + static_cast<ptrdiff_t>(g.dimensions));
  for (size_t k = 0; k < g.count(c, 2); ++k) {
    for (size_t j = 0; j < g.count(c, 1); ++j) {
      for (size_t i = 0; i < g.count(c, 0); ++i) {
        const size_t at = g.at(i, j, k);
        if (!near_[at]) continue;
        const size_t index[] = {i, j, k};
        double middle[3];
        for (size_t a = 0; a < 3; ++a) middle[a] = g.coordinate(c, a, static_cast<double>(index[a]));
        const auto distance = [&](double along_u, double along_w) {
          double p[3] = {middle[0], middle[1], middle[2]};
          p[u] += along_u * g.spacing[u];
          if (space) p[w] += along_w * g.spacing[w];
          return distance_to(obstacles, {p[0], p[1], p[2]}, g.dimensions);
        };
        Face face{static_cast<uint32_t>(at), 0};
        const double here =
            distance_to(obstacles, {middle[0], middle[1], middle[2]}, g.dimensions, &face.obstacle);
        fluid[c][at] = std::clamp(0.5 + here / smallest, 0.0, 1.0);
        // Fraction of each strip across the face where the distance, linear between its ends, is positive.
        double sum = 0, depth = 0;
        const int strips = space ? kStrips : 1;
        for (int s = 0; s < strips; ++s) {
          const double across = (s + 0.5) / strips - 0.5;
          const double low = distance(-0.5, across), high = distance(0.5, across);
          const double length = std::abs(low) + std::abs(high);
          const double share = low > 0 && high > 0     ? 1
                               : low <= 0 && high <= 0 ? 0
                                                       : std::max(low, high) / length;
          sum += share, depth += 0.5 * share * (std::max(low, 0.0) + std::max(high, 0.0));
        }
        open[c][at] = sum / strips < kLeastOpen ? 0 : sum / strips;
        if (open[c][at] < 1 || fluid[c][at] < 1) shut[c].push_back(face);
        if (here <= 0 || open[c][at] == 0) {
          inside[c].push_back(face), depth_.push_back(sum > 0 ? depth / sum : 0);
          solid_[c][at] = 1;
        }
      }
    }
  }
  if (!g.periodic[c]) return;
  // Face n of a periodic axis is face 0.
  for (size_t k = 0; k < (c == 2 ? 1 : g.cells[2]); ++k) {
    for (size_t j = 0; j < (c == 1 ? 1 : g.cells[1]); ++j) {
      for (size_t i = 0; i < (c == 0 ? 1 : g.cells[0]); ++i) {
        const size_t at = g.at(i, j, k), twin = at + g.cells[c] * g.stride(c);
        open[c][twin] = open[c][at], fluid[c][twin] = fluid[c][at], solid_[c][twin] = solid_[c][at];
      }
    }
  }
}

// If an image point of a wall needs a face inside a solid (in gaps narrower than a few cells), only the
// nearer image point is used, or the obstacle's velocity.
void Solids::find_walls(std::span<const ObstacleDef> obstacles, const mac::MacGrid& g, size_t c) {
  walls[c].clear();
  double longest = 0;
  for (size_t a = 0; a < g.dimensions; ++a) longest = std::max(longest, g.spacing[a]);
  const double reach = 1.001 * std::sqrt(static_cast<double>(g.dimensions)) * longest;
  const size_t corners = size_t{1} << g.dimensions;
  for (size_t n = 0; n < inside[c].size(); ++n) {
    const Face& face = inside[c][n];
    bool beside = false;
    for (size_t a = 0; a < g.dimensions && !beside; ++a)
      beside = !solid_[c][face.at + g.stride(a)] || !solid_[c][face.at - g.stride(a)];
    // The cross terms of convection reach diagonal neighbours.
    for (size_t a = 0; a < g.dimensions && !beside; ++a) {
      for (size_t b = a + 1; b < g.dimensions && !beside; ++b) {
        const size_t s = g.stride(a), q = g.stride(b);
        beside = !solid_[c][face.at + s + q] || !solid_[c][face.at + s - q] || !solid_[c][face.at - s + q] ||
                 !solid_[c][face.at - s - q];
      }
    }
    if (!beside) continue;
    const Vec3 middle = g.position(c, face.at);
    const double x[3] = {middle.x, middle.y, middle.z};
    const auto distance = [&](const double* p) {
      return distance_to(obstacles, {p[0], p[1], p[2]}, g.dimensions);
    };
    const double depth = distance(x);
    double normal[3] = {}, length = 0;
    for (size_t a = 0; a < g.dimensions; ++a) {
      const double step = 1e-3 * longest;
      double low[] = {x[0], x[1], x[2]}, high[] = {x[0], x[1], x[2]};
      low[a] -= step, high[a] += step;
      normal[a] = distance(high) - distance(low), length += normal[a] * normal[a];
    }
    if (length == 0) continue;
    length = std::sqrt(length);
    const double down = depth / length;
    Wall wall{.face = face,
              .foot = middle - down * Vec3{normal[0], normal[1], normal[2]},
              .image = {},
              .share = {},
              .ghost = {},
              .flux = {}};
    std::array<bool, 2> sound{true, true};
    for (size_t m = 0; m < 2; ++m) {
      size_t at = g.base();
      for (size_t a = 0; a < g.dimensions; ++a) {
        const double p = x[a] + (static_cast<double>(m + 1) * reach - depth) * normal[a] / length;
        // Offset by one so that the truncated value is never negative; one value beyond a side is set.
        const double place = (p - g.origin[a]) / g.spacing[a] + (a == c ? 1.0 : 0.5);
        const double kept = std::clamp(place, 0.0, static_cast<double>(g.cells[a] + 1) - 1e-9);
        const auto low = static_cast<size_t>(kept);
        wall.share[m][a] = kept - static_cast<double>(low);
        at += g.stride(a) * low - g.stride(a);
      }
      wall.image[m] = static_cast<uint32_t>(at);
      for (size_t corner = 0; corner < corners; ++corner) {
        size_t value = at;
        for (size_t a = 0; a < g.dimensions; ++a) value += (corner >> a) & 1 ? g.stride(a) : 0;
        sound[m] = sound[m] && !solid_[c][value];
      }
    }
    const auto weights = [&](double phi) -> std::array<double, 2> {
      const double s = phi / reach;
      if (!sound[0]) return {0, 0};
      if (!sound[1]) return {s, 0};
      return {s * (2 - s), 0.5 * s * (s - 1)};
    };
    wall.ghost = weights(std::max(depth, -reach)), wall.flux = weights(depth_[n]);
    walls[c].push_back(wall);
  }
}

}  // namespace truestep::grid_fluid
