#include "engine/systems/crowd/navigation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace truestep::crowd {
namespace {
constexpr float kNever = std::numeric_limits<float>::infinity();
/// People next to a wall walk this much slower, so that paths keep off it where there is room.
constexpr double kSlowest = 0.2;
}  // namespace

WayGrid::WayGrid(const CrowdDef& def, const Walls& walls) : h(way_spacing(def)) {
  const Bounds b = bounds_of(def);
  low = b.low;
  nx = static_cast<long>(std::ceil((b.high.x - b.low.x) / h)) + 1;
  ny = static_cast<long>(std::ceil((b.high.y - b.low.y) / h)) + 1;
  room.resize(static_cast<size_t>(nx * ny));
  for (size_t k = 0; k < room.size(); ++k) room[k] = static_cast<float>(walls.distance(place(k)));
}

Navigation::Navigation(const Goal& goal, const WayGrid* grid, const Walls& walls, double clearance)
    : goal_(goal), grid_(grid), walls_(walls) {
  if (!grid_) return;
  look(clearance);
  march(clearance);
  descend();
}

void Navigation::look(double clearance) {
  const size_t n = grid_->room.size();
  time_.assign(n, kNever), sees_.assign(n, 0);
  for (size_t k = 0; k < n; ++k) {
    const Vec3 at = grid_->place(k), to = goal_.nearest(at);
    if (grid_->solid(k) || walls_.blocked(at, to, clearance)) continue;
    sees_[k] = 1, time_[k] = static_cast<float>(norm(to - at));
  }
}

/// Arrival time from one upwind neighbour per axis: T solves sum max(T - T_axis, 0)^2 = (h slowness)^2.
double Navigation::arrival(size_t node, double slowness) const {
  const long nx = grid_->nx, x = static_cast<long>(node) % nx, y = static_cast<long>(node) / nx;
  const auto at = [&](long i, long j) {
    if (i < 0 || j < 0 || i >= nx || j >= grid_->ny) return kNever;
    const size_t k = static_cast<size_t>(j * nx + i);
    return grid_->solid(k) ? kNever : time_[k];
  };
  const double a = std::min(at(x - 1, y), at(x + 1, y)), b = std::min(at(x, y - 1), at(x, y + 1));
  const double step = grid_->h * slowness;
  if (std::abs(a - b) < step) return 0.5 * (a + b + std::sqrt(2 * step * step - (a - b) * (a - b)));
  return std::min(a, b) + step;
}

void Navigation::march(double clearance) {
  using Entry = std::pair<float, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  const long nx = grid_->nx, ny = grid_->ny;
  const auto reach_out = [&](size_t node) {
    const long x = static_cast<long>(node) % nx, y = static_cast<long>(node) / nx;
    const long near[4][2] = {{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}};
    for (const auto& [i, j] : near) {
      if (i < 0 || j < 0 || i >= nx || j >= ny) continue;
      const size_t k = static_cast<size_t>(j * nx + i);
      if (grid_->solid(k) || sees_[k]) continue;
      const double pace = clearance > 0 ? std::clamp(grid_->room[k] / clearance, kSlowest, 1.0) : 1;
      const auto t = static_cast<float>(arrival(k, 1 / pace));
      if (t < time_[k]) time_[k] = t, front.push({t, static_cast<uint32_t>(k)});
    }
  };
  for (size_t k = 0; k < sees_.size(); ++k) {
    if (sees_[k]) front.push({time_[k], static_cast<uint32_t>(k)});
  }
  while (!front.empty()) {
    const auto [t, node] = front.top();
    front.pop();
    if (t <= time_[node]) reach_out(node);
  }
}

void Navigation::descend() {
  const long nx = grid_->nx, ny = grid_->ny;
  way_.assign(2 * time_.size(), 0);
  for (size_t k = 0; k < time_.size(); ++k) {
    if (!(time_[k] < kNever)) continue;
    const Vec3 at = grid_->place(k);
    Vec3 d = goal_.nearest(at) - at;
    if (!sees_[k]) {
      const long x = static_cast<long>(k) % nx, y = static_cast<long>(k) / nx;
      const auto fall = [&](long i, long j) {
        if (i < 0 || j < 0 || i >= nx || j >= ny) return 0.0;
        const float t = time_[static_cast<size_t>(j * nx + i)];
        return t < time_[k] ? static_cast<double>(time_[k]) - t : 0.0;
      };
      const double west = fall(x - 1, y), east = fall(x + 1, y), south = fall(x, y - 1),
                   north = fall(x, y + 1);
      d = {east > west ? east : -west, north > south ? north : -south, 0};
    }
    d = normalized(d, Vec3{});
    way_[2 * k] = static_cast<float>(d.x), way_[2 * k + 1] = static_cast<float>(d.y);
  }
}

double Navigation::time(const Vec3& x) const {
  if (!grid_) return norm(goal_.nearest(x) - x);
  const auto index = [](double at, long n) { return std::clamp(std::lround(at), 0L, n - 1); };
  const long i = index((x.x - grid_->low.x) / grid_->h, grid_->nx),
             j = index((x.y - grid_->low.y) / grid_->h, grid_->ny);
  double least = kNever;
  // A place next to a wall is reached from the surrounding nodes that it sees.
  for (long b = std::max(0L, j - 1); b <= std::min(grid_->ny - 1, j + 1); ++b) {
    for (long a = std::max(0L, i - 1); a <= std::min(grid_->nx - 1, i + 1); ++a) {
      const size_t k = static_cast<size_t>(b * grid_->nx + a);
      if (!walls_.blocked(x, grid_->place(k), 0)) least = std::min(least, static_cast<double>(time_[k]));
    }
  }
  return least;
}

Vec3 Navigation::direction(const Vec3& x) const {
  const Vec3 straight = normalized(goal_.nearest(x) - x, Vec3{});
  if (!grid_) return straight;
  const double gx = (x.x - grid_->low.x) / grid_->h, gy = (x.y - grid_->low.y) / grid_->h;
  if (!(gx >= 0 && gy >= 0 && gx < static_cast<double>(grid_->nx - 1) &&
        gy < static_cast<double>(grid_->ny - 1))) {
    return straight;
  }
  const long i = static_cast<long>(gx), j = static_cast<long>(gy);
  const double fx = gx - static_cast<double>(i), fy = gy - static_cast<double>(j);
  const size_t corner = static_cast<size_t>(j * grid_->nx + i), row = static_cast<size_t>(grid_->nx);
  const size_t nodes[4] = {corner, corner + 1, corner + row, corner + row + 1};
  const double weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  bool all_see = true, at_wall = false;
  for (const size_t k : nodes) all_see &= sees_[k] != 0, at_wall |= grid_->room[k] < 2 * grid_->h;
  if (all_see) return straight;
  Vec3 d;
  double best = HUGE_VAL;
  Vec3 escape = straight;
  for (int c = 0; c < 4; ++c) {
    const size_t k = nodes[c];
    if (!(time_[k] < kNever)) continue;
    // On the other side of a wall the path is different.
    const Vec3 to = grid_->place(k);
    if (at_wall && walls_.blocked(x, to, 0)) continue;
    d += Vec3{way_[2 * k], way_[2 * k + 1], 0} * weights[c];
    if (time_[k] < best) best = time_[k], escape = normalized(to - x, straight);
  }
  return normalized(d, escape);
}

}  // namespace truestep::crowd
