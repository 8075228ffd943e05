#include "engine/systems/crowd/walls.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace truestep::crowd {
namespace {

/// The intervals of [0, 1] along a piece that remain after cutting one door after the other.
void cut(std::vector<std::array<double, 2>>& kept, double from, double to) {
  std::vector<std::array<double, 2>> out;
  for (const auto& [a, b] : kept) {
    if (from > a) out.push_back({a, std::min(b, from)});
    if (to < b) out.push_back({std::max(a, to), b});
  }
  std::erase_if(out, [](const auto& k) { return k[1] - k[0] <= 1e-12; });
  kept = std::move(out);
}

}  // namespace

void Walls::add(const Vec3& a, const Vec3& b, std::span<const DoorDef> doors) {
  const Vec3 d = b - a;
  const double length = norm(d);
  if (!(length > 0)) return;
  std::vector<std::array<double, 2>> kept{{0, 1}};
  for (const DoorDef& door : doors) {
    // A door must lie along a wall to within a millimetre.
    const Vec3 p = door.from - a, q = door.to - a;
    if (std::abs(cross2(d, p)) > 1e-3 * length || std::abs(cross2(d, q)) > 1e-3 * length) continue;
    const double s = dot(p, d) / (length * length), t = dot(q, d) / (length * length);
    cut(kept, std::min(s, t), std::max(s, t));
  }
  for (const auto& [s, t] : kept) pieces_.push_back({a + d * s, a + d * t});
}

Walls::Walls(const CrowdDef& def, double reach) : reach_(reach) {
  std::vector<DoorDef> doors = def.doors;
  for (DoorDef& d : doors) d.from.z = d.to.z = 0;
  for (const WallDef& w : def.walls) {
    const size_t n = w.points.size();
    for (size_t i = 0; i + 1 < n + (w.closed && n > 2 ? 1 : 0); ++i) {
      Vec3 a = w.points[i], b = w.points[(i + 1) % n];
      a.z = b.z = 0;
      add(a, b, doors);
    }
  }
  if (def.period > 0) {
    // Those near one end see obstacles at the other.
    const size_t n = pieces_.size();
    for (const double shift : {-def.period, def.period}) {
      for (size_t i = 0; i < n; ++i)
        pieces_.push_back({pieces_[i].a + Vec3{shift, 0, 0}, pieces_[i].b + Vec3{shift, 0, 0}});
    }
    std::erase_if(pieces_, [&](const Segment& s) {
      const double edge = 0.5 * def.period + reach;
      return std::min(s.a.x, s.b.x) > edge || std::max(s.a.x, s.b.x) < -edge;
    });
  }
  join();
  if (pieces_.empty()) return;

  Vec3 high = low_ = pieces_[0].a;
  for (const Segment& s : pieces_) {
    low_ = {std::min({low_.x, s.a.x, s.b.x}), std::min({low_.y, s.a.y, s.b.y}), 0};
    high = {std::max({high.x, s.a.x, s.b.x}), std::max({high.y, s.a.y, s.b.y}), 0};
  }
  low_ -= Vec3{reach, reach, 0}, high += Vec3{reach, reach, 0};
  constexpr double kMostCells = 1e5;
  size_ = std::max(0.5 * reach, std::sqrt((high.x - low_.x) * (high.y - low_.y) / kMostCells));
  nx_ = static_cast<long>((high.x - low_.x) / size_) + 1,
  ny_ = static_cast<long>((high.y - low_.y) / size_) + 1;
  // Two passes over the cells that a piece may be near: first to count, then to fill.
  const double far = reach + 0.7072 * size_;
  const auto each = [&](auto&& visit) {
    for (uint32_t k = 0; k < pieces_.size(); ++k) {
      const Segment& s = pieces_[k];
      const auto cell = [&](double at, double low, long n) {
        return std::clamp(static_cast<long>((at - low) / size_), 0L, n - 1);
      };
      const long x0 = cell(std::min(s.a.x, s.b.x) - reach, low_.x, nx_),
                 x1 = cell(std::max(s.a.x, s.b.x) + reach, low_.x, nx_);
      const long y0 = cell(std::min(s.a.y, s.b.y) - reach, low_.y, ny_),
                 y1 = cell(std::max(s.a.y, s.b.y) + reach, low_.y, ny_);
      for (long y = y0; y <= y1; ++y) {
        for (long x = x0; x <= x1; ++x) {
          const Vec3 middle =
              low_ + Vec3{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5, 0} * size_;
          if (norm(middle - nearest_point(s, middle)) <= far) visit(static_cast<size_t>(y * nx_ + x), k);
        }
      }
    }
  };
  start_.assign(static_cast<size_t>(nx_ * ny_) + 2, 0);
  each([&](size_t cell, uint32_t) { ++start_[cell + 2]; });
  for (size_t c = 2; c < start_.size(); ++c) start_[c] += start_[c - 1];
  list_.resize(start_.back());
  each([&](size_t cell, uint32_t k) { list_[start_[cell + 1]++] = k; });
}

void Walls::join() {
  const size_t n = pieces_.size();
  before_.assign(n, kNone), after_.assign(n, kNone), left_.resize(n);
  const auto same = [](const Vec3& a, const Vec3& b) { return norm2(a - b) < 1e-18; };
  for (uint32_t i = 0; i < n; ++i) {
    const Vec3 d = pieces_[i].b - pieces_[i].a;
    left_[i] = normalized(Vec3{-d.y, d.x, 0});
    for (uint32_t j = 0; j < n; ++j) {
      if (j == i) continue;
      if (before_[i] == kNone && (same(pieces_[i].a, pieces_[j].b) || same(pieces_[i].a, pieces_[j].a)))
        before_[i] = j;
      if (after_[i] == kNone && (same(pieces_[i].b, pieces_[j].a) || same(pieces_[i].b, pieces_[j].b)))
        after_[i] = j;
    }
  }
}

bool Walls::hidden(uint32_t other, const Vec3& corner, const Vec3& x, uint32_t k) const {
  if (other == kNone) return false;
  const Segment& s = pieces_[other];
  const Vec3 away = norm2(s.a - corner) < norm2(s.b - corner) ? s.b - s.a : s.a - s.b;
  return dot(x - corner, away) > 0 || other < k;
}

std::span<const uint32_t> Walls::near(const Vec3& x) const {
  const double cx = (x.x - low_.x) / size_, cy = (x.y - low_.y) / size_;
  if (!(cx >= 0 && cy >= 0 && cx < static_cast<double>(nx_) && cy < static_cast<double>(ny_))) return {};
  const size_t cell = static_cast<size_t>(static_cast<long>(cy) * nx_ + static_cast<long>(cx));
  return std::span(list_).subspan(start_[cell], start_[cell + 1] - start_[cell]);
}

double Walls::distance(const Vec3& x) const {
  double least = reach_;
  for (const uint32_t k : near(x)) least = std::min(least, norm(x - nearest_point(pieces_[k], x)));
  return least;
}

bool Walls::blocked(const Vec3& a, const Vec3& b, double clearance) const {
  // People standing next to a wall may walk away from it or along it, and so at the goal.
  const double room = std::min({clearance, distance(a), distance(b)}) - 1e-9;
  const Segment way{a, b};
  return along(a, b, clearance,
               [&](const Segment& s) { return segment_distance(way, s) < room || crossing(way, s) != 0; });
}

const Segment* Walls::crossed(const Vec3& a, const Vec3& b) const {
  const Segment way{a, b};
  const Segment* hit = nullptr;
  along(a, b, 0, [&](const Segment& s) { return runs_into(way, s) && (hit = &s) != nullptr; });
  return hit;
}

}  // namespace truestep::crowd
