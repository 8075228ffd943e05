#include "engine/systems/nbody/hermite.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "engine/base/cache_line.h"
#include "engine/base/errors.h"
#include "engine/kernels/gravity/softening.h"
#include "engine/systems/nbody/collisions/block_watch.h"
#include "engine/systems/nbody/nbody_state.h"

namespace truestep::nbody {

namespace {

constexpr int kDepth = 30;  // the shortest step is the session's over 2^30
constexpr uint64_t kTicks = uint64_t{1} << kDepth;
constexpr size_t kUnit = 8, kRowBlock = 8;
constexpr double kTiny = 1e-180, kStart = 0.1;  // a first step, which has no history, is shorter

using Column = std::vector<double, CacheLineAllocator<double>>;

/// Scratch memory of a step. Times are ticks since the step's start.
struct Blocks {
  std::array<Column, 7> predicted;  // x, y, z, vx, vy, vz, mu in whole units
  std::vector<Vec3> x, v, a, j;     // at each body's own time
  std::vector<uint64_t> time, step;
  std::vector<uint32_t> active;
  std::vector<gravity::JerkSums> sums;

  void resize(size_t n) {
    for (Column& c : predicted) c.resize((n + kUnit - 1) / kUnit * kUnit);
    x.resize(n), v.resize(n), a.resize(n), j.resize(n), time.resize(n), step.resize(n), sums.resize(n);
    active.reserve(n);
  }
};

Vec3 vec(const double* p) {
  return {p[0], p[1], p[2]};
}

/// The largest power of two in ticks that is at most h (s) of a step of `dt`.
uint64_t ticks_of(double h, double dt) {
  uint64_t ticks = kTicks;
  double length = dt;
  while (length > h && ticks > 1) length *= 0.5, ticks /= 2;
  return ticks;
}

class Run {
 public:
  Run(State& s, const StepInput& in, double eta)
      : in_(in),
        eta_(eta),
        b_(in.workspace.object<Blocks>("nbody.blocks")),
        n_(s.rows(Columns::position)),
        x_(s.f64(Columns::position)),
        v_(s.f64(Columns::velocity)),
        radius_(s.f64(Columns::radius)),
        watch_(in.workspace.object<BlockWatch>(kBlockWatch)) {
    law_ = {parameter(s, Parameter::softening), kTiny};
    const auto& all = gravity::pair_loops();
    jerk_ = (law_.eps > 0 ? all.plummer : all.newton).direct.jerk;
    b_.resize(n_);
    const double g = parameter(s, Parameter::gravitational_constant);
    for (Column& c : b_.predicted) std::fill(c.begin(), c.end(), 0.0);
    for (size_t i = 0; i < n_; ++i) {
      b_.x[i] = load3(x_.data(), i), b_.v[i] = load3(v_.data(), i);
      b_.predicted[6][i] = g * s.f64(Columns::mass)[i];
    }
  }

  void go() {
    start();
    constexpr uint64_t kMostBlocks = 50'000'000;
    uint64_t blocks = 0;
    for (uint64_t now = 0; now < kTicks;) {
      now = next_time();
      advance(now);
      if (watch_.on && !watch_.touches.empty()) return;
      if (++blocks > kMostBlocks) {
        throw Error("instability",
                    "hermite: more than 50 million blocks in one step: a pair is so close that it needs "
                    "softening, collisions or a larger tolerance");
      }
    }
    for (size_t i = 0; i < n_; ++i) store3(x_.data(), i, b_.x[i]), store3(v_.data(), i, b_.v[i]);
  }

 private:
  double seconds(uint64_t ticks) const {
    return in_.h * (static_cast<double>(ticks) / static_cast<double>(kTicks));
  }

  void start() {
    b_.active.clear();
    for (size_t i = 0; i < n_; ++i) b_.time[i] = 0, b_.active.push_back(static_cast<uint32_t>(i));
    predict(0);
    sum();
    for (size_t i = 0; i < n_; ++i) {
      b_.a[i] = vec(b_.sums[i].a), b_.j[i] = vec(b_.sums[i].j);
      const double a = norm(b_.a[i]), j = norm(b_.j[i]);
      b_.step[i] = ticks_of(j > 0 ? kStart * std::sqrt(eta_) * a / j : in_.h, in_.h);
    }
  }

  uint64_t next_time() const {
    uint64_t next = kTicks;
    for (size_t i = 0; i < n_; ++i) next = std::min(next, b_.time[i] + b_.step[i]);
    return next;
  }

  /// Predicts all bodies to the same time, into columns.
  void predict(uint64_t now) {
    for (size_t i = 0; i < n_; ++i) {
      const double h = seconds(now - b_.time[i]);
      const Vec3 x = b_.x[i] + (b_.v[i] + (b_.a[i] + b_.j[i] * (h / 3)) * (h / 2)) * h,
                 v = b_.v[i] + (b_.a[i] + b_.j[i] * (h / 2)) * h;
      auto& p = b_.predicted;
      p[0][i] = x.x, p[1][i] = x.y, p[2][i] = x.z, p[3][i] = v.x, p[4][i] = v.y, p[5][i] = v.z;
    }
  }

  void sum() {
    const auto& p = b_.predicted;
    const gravity::MotionColumns columns{p[0].data(), p[1].data(), p[2].data(), p[3].data(),
                                         p[4].data(), p[5].data(), p[6].data(), p[0].size()};
    in_.arena.for_blocks(b_.active.size(), kRowBlock, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) b_.sums[b_.active[k]] = jerk_(columns, law_, b_.active[k]);
    });
  }

  void advance(uint64_t now) {
    b_.active.clear();
    for (size_t i = 0; i < n_; ++i) {
      if (b_.time[i] + b_.step[i] == now) b_.active.push_back(static_cast<uint32_t>(i));
    }
    predict(now);
    sum();
    for (const uint32_t i : b_.active) correct(i, now);
  }

  void correct(uint32_t i, uint64_t now) {
    const double h = seconds(b_.step[i]);
    const Vec3 a0 = b_.a[i], j0 = b_.j[i], v0 = b_.v[i], x0 = b_.x[i], a1 = vec(b_.sums[i].a),
               j1 = vec(b_.sums[i].j);
    b_.v[i] = v0 + (a0 + a1) * (h / 2) + (j0 - j1) * (h * h / 12);
    b_.x[i] = b_.x[i] + (v0 + b_.v[i]) * (h / 2) + (a0 - a1) * (h * h / 12);
    b_.a[i] = a1, b_.j[i] = j1, b_.time[i] = now;
    if (watch_.on) look_for_touches(i, x0, v0, now - b_.step[i], now);
    // The cubic through both ends: its second and third derivatives at the end.
    const Vec3 crackle = ((a0 - a1) * 2 + (j0 + j1) * h) * (6 / (h * h * h));
    const Vec3 snap = ((a1 - a0) * 6 - (j0 * 4 + j1 * 2) * h) * (1 / (h * h)) + crackle * h;
    const double a = norm(a1), j = norm(j1), s = norm(snap), c = norm(crackle);
    const double below = j * c + s * s,
                 wanted = below > 0 ? std::sqrt(eta_ * (a * s + j * j) / below) : in_.h;
    uint64_t next = ticks_of(wanted, in_.h);
    // Blocks: a step may double only where one of twice the length may begin.
    if (next > b_.step[i]) next = now % (2 * b_.step[i]) == 0 ? 2 * b_.step[i] : b_.step[i];
    b_.step[i] = std::max<uint64_t>(std::min(next, kTicks), 1);
  }

  /// Of body i on its way from x0, v0, with all others, each along its own Taylor series.
  void look_for_touches(uint32_t i, const Vec3& x0, const Vec3& v0, uint64_t before, uint64_t now) {
    const double h = seconds(now - before);
    const auto at = [&](size_t j, uint64_t when, Vec3& x, Vec3& v) {
      const double t = in_.h * ((static_cast<double>(when) - static_cast<double>(b_.time[j])) /
                                static_cast<double>(kTicks));
      x = b_.x[j] + (b_.v[j] + (b_.a[j] + b_.j[j] * (t / 3)) * (t / 2)) * t;
      v = b_.v[j] + (b_.a[j] + b_.j[j] * (t / 2)) * t;
    };
    for (uint32_t j = 0; j < n_; ++j) {
      const double reach = radius_[i] + radius_[j];
      if (j == i || !(reach > 0)) continue;
      Vec3 from, from_v, to, to_v;
      at(j, before, from, from_v), at(j, now, to, to_v);
      const CubicPath path =
          CubicPath::through(from - x0, (from_v - v0) * h, to - b_.x[i], (to_v - b_.v[i]) * h);
      const uint32_t a = std::min(i, j), b = std::max(i, j);
      if (!path.may_reach(reach) || watch_.skip(a, b)) continue;
      const double share = first_contact_on_cubic(path, reach);
      if (share > 1) continue;
      const double ticks = static_cast<double>(before) + share * static_cast<double>(now - before);
      watch_.touches.push_back({ticks / static_cast<double>(kTicks), a, b});
    }
  }

  const StepInput& in_;
  double eta_;
  Blocks& b_;
  size_t n_;
  std::span<double> x_, v_, radius_;
  BlockWatch& watch_;
  gravity::LawNumbers law_;
  gravity::JerkSums (*jerk_)(const gravity::MotionColumns&, const gravity::LawNumbers&, size_t) = nullptr;
};

void step(const ForceField&, State& s, const StepInput& in, const IntegratorOptions& options) {
  Run(s, in, options.tolerance).go();
}

}  // namespace

const Integrator& hermite() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  static const Integrator kRow{.name = kHermiteName,
                               .title = "Hermite's scheme of order 4 with block time steps",
                               .order = 4,
                               .imaginary_limit = kNone,
                               .real_limit = kNone,
                               .stepping = Integrator::Stepping::adaptive,
                               .equations = Integrator::Equations::second_order,
                               .source = "Makino, Aarseth 1992, Publ. Astron. Soc. Japan 44:141",
                               .step = step};
  return kRow;
}

}  // namespace truestep::nbody
