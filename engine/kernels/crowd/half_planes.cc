#include "engine/kernels/crowd/half_planes.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace truestep::crowd {
namespace {

// Lines whose normals differ by less than this count as parallel; violations below it (m/s) count as
// rounding.
constexpr double kParallel = 1e-9, kRounding = 1e-10;

/// The objective: the point closest to `aim` or, if `far`, the one farthest along the unit vector `aim`.
struct Aim {
  Vec3 aim;
  enum class Kind : uint8_t { closest, farthest } kind = Kind::closest;
};

/// The best point on the line of planes[i] within the disc and planes[0 .. i); false if there is none.
bool on_line(std::span<const HalfPlane> planes, size_t i, double speed, const Aim& aim, Vec3& v) {
  const HalfPlane& line = planes[i];
  const double room = speed * speed - line.offset * line.offset;
  if (room < 0) return false;
  const Vec3 foot = line.normal * line.offset, along{-line.normal.y, line.normal.x, 0};
  double high = std::sqrt(room), low = -high;
  for (size_t j = 0; j < i; ++j) {
    const double slope = dot(planes[j].normal, along), lack = planes[j].lack(foot);
    if (std::abs(slope) < kParallel) {
      if (lack > kRounding) return false;
    } else if (slope > 0) {
      low = std::max(low, lack / slope);
    } else {
      high = std::min(high, lack / slope);
    }
    if (low > high) return false;
  }
  const double s = dot(aim.aim, along);
  v = foot + along * (aim.kind == Aim::Kind::closest ? std::clamp(s, low, high) : s > 0 ? high : low);
  return true;
}

/// Moves v, which starts at the disc's best point, into one half-plane after the other; returns how many
/// could be satisfied.
size_t in_order(std::span<const HalfPlane> planes, double speed, const Aim& aim, Vec3& v) {
  const double far = norm(aim.aim);
  v = aim.kind == Aim::Kind::farthest || far > speed ? aim.aim * (speed / far) : aim.aim;
  for (size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].lack(v) <= kRounding) continue;
    const Vec3 before = v;
    if (!on_line(planes, i, speed, aim, v)) {
      v = before;
      return i;
    }
  }
  return planes.size();
}

/// From plane `failed` on: minimises the largest violation. At the optimum the most violated plane ties with
/// others, so each is tried in that role against those before it.
void relax(std::span<const HalfPlane> planes, size_t hard, size_t failed, double speed, Vec3& v) {
  std::array<HalfPlane, kMostHalfPlanes> level;
  double worst = 0;
  for (size_t i = std::max(failed, hard); i < planes.size(); ++i) {
    if (planes[i].lack(v) <= worst + kRounding) continue;
    std::copy_n(planes.begin(), hard, level.begin());
    size_t n = hard;
    for (size_t j = hard; j < i; ++j) {
      // lack_j <= lack_i
      const Vec3 across = planes[j].normal - planes[i].normal;
      const double size = norm(across);
      if (size > kParallel) level[n++] = {across / size, (planes[j].offset - planes[i].offset) / size};
    }
    Vec3 better;
    const bool found =
        in_order({level.data(), n}, speed, {planes[i].normal, Aim::Kind::farthest}, better) == n;
    // Only rounding can leave none: then v itself is optimal to its accuracy.
    if (found) v = better;
    worst = std::max(worst, planes[i].lack(v));
  }
}

}  // namespace

Chosen choose_velocity(std::span<const HalfPlane> planes, size_t hard, double speed, const Vec3& wish) {
  planes = planes.first(std::min(planes.size(), kMostHalfPlanes));
  hard = std::min(hard, planes.size());
  Chosen c;
  const size_t kept = in_order(planes, speed, {wish}, c.velocity);
  if (kept == planes.size()) return c;
  c.fit = Fit::relaxed;
  // Walls that contradict each other are treated like people.
  relax(planes, kept < hard ? 0 : hard, kept, speed, c.velocity);
  return c;
}

}  // namespace truestep::crowd
