#include "engine/systems/flocking/gather.h"

#include <array>
#include <bit>
#include <cmath>

namespace truestep::flocking {

void Sorted::build(const double* x, const double* velocities, size_t n, double reach,
                   const ThreadArena& arena) {
  grid.build({x, 3 * n}, reach, arena);
  v.resize(3 * grid.size());
  arena.for_blocks(grid.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) store3(v.data(), k, load3(velocities, grid.point(k)));
  });
}

void Sorted::build_wide(const double* x, const double* velocities, size_t n, double reach,
                        const ThreadArena& arena) {
  grid.build({x, 3 * n}, reach, arena);
  xs.resize(n + kAtOnce), ys.resize(n + kAtOnce), zs.resize(n + kAtOnce), x4.resize(4 * n), v4.resize(4 * n);
  arena.for_blocks(grid.size(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const Vec3 p = grid.position(k), u = load3(velocities, grid.point(k));
      xs[k] = p.x, ys[k] = p.y, zs[k] = p.z;
      x4[4 * k] = p.x, x4[4 * k + 1] = p.y, x4[4 * k + 2] = p.z, x4[4 * k + 3] = 0;
      v4[4 * k] = u.x, v4[4 * k + 1] = u.y, v4[4 * k + 2] = u.z, v4[4 * k + 3] = 0;
    }
  });
}

namespace {

/// Positions of the set bits, in order; arbitrary values behind them.
constexpr auto kPacked = [] {
  std::array<std::array<uint32_t, 4>, 16> out{};
  for (unsigned bits = 0; bits < 16; ++bits) {
    size_t n = 0;
    for (uint32_t k = 0; k < 4; ++k) {
      if (bits >> k & 1) out[bits][n++] = k;
    }
  }
  return out;
}();

}  // namespace

void Gather::begin(size_t slot, const Vec3& heading) {
  heading_ = heading, u_ = Lanes4::load(&sorted_.v4[4 * slot]), at_ = Lanes4::load(&sorted_.x4[4 * slot]);
  away_ = v_ = x_ = Lanes4::zero(), with = near = 0, count_ = 0;
}

void Gather::look_from(const Vec3& p) {
  // The list's offsets refer to the previous position.
  sum();
  const double at[4] = {p.x, p.y, p.z, 0};
  at_ = Lanes4::load(at);
}

void Gather::add(const Vec3& p, size_t from, size_t to) {
  const Lanes4 px = Lanes4::all(p.x), py = Lanes4::all(p.y), pz = Lanes4::all(p.z);
  const double *xs = sorted_.xs.data(), *ys = sorted_.ys.data(), *zs = sorted_.zs.data();
  const Lanes4 reach2 = Lanes4::all(sight_.reach2);
  size_t n = count_;
  for (size_t q = from; q < to; q += kAtOnce) {
    if (n > kList - kAtOnce) {
      count_ = n;
      sum();
      n = 0;
    }
    const Lanes4 dx = Lanes4::load(xs + q) - px, dy = Lanes4::load(ys + q) - py,
                 dz = Lanes4::load(zs + q) - pz;
    const unsigned there = q + kAtOnce <= to ? 15u : (1u << (to - q)) - 1;
    const unsigned bits = below(dx * dx + dy * dy + dz * dz, reach2) & there;
    for (size_t k = 0; k < kAtOnce; ++k) list_[n + k] = static_cast<uint32_t>(q) + kPacked[bits][k];
    n += static_cast<size_t>(std::popcount(bits));
  }
  count_ = n;
}

void Gather::sum() {
  Lanes4 away = away_, v = v_, x = x_;
  const Lanes4 at = at_, u = u_;
  const bool cone = sight_.field == Sight::Field::cone;
  // Slightly more than the square: the root decides.
  const double near2 = sight_.apart * sight_.apart * (1 + 1e-12);
  for (size_t k = 0; k < count_; ++k) {
    const size_t q = list_[k];
    const Lanes4 d = Lanes4::load(&sorted_.x4[4 * q]) - at;
    double c[4];
    d.store(c);
    const double r2 = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
    if (cone || r2 < near2) {
      const double r = std::sqrt(r2);
      if (cone && heading_.x * c[0] + heading_.y * c[1] + heading_.z * c[2] < sight_.cos_view * r) continue;
      // 1 where they meet, falling to 0 at the radius, along the unit vector towards here.
      if (r > 0 && r < sight_.apart) away = away - d * Lanes4::all((1 - r / sight_.apart) / r);
    }
    if (r2 < sight_.align2) v = v + (Lanes4::load(&sorted_.v4[4 * q]) - u), with += 1;
    if (r2 < sight_.join2) x = x + d, near += 1;
  }
  away_ = away, v_ = v, x_ = x, count_ = 0;
}

void Gather::finish() {
  sum();
  // The member itself has contributed only to the counts.
  with -= 1, near -= 1;
  double c[4];
  away_.store(c), away = {c[0], c[1], c[2]};
  v_.store(c), mean_v = {c[0], c[1], c[2]};
  x_.store(c), mean_x = {c[0], c[1], c[2]};
}

}  // namespace truestep::flocking
