#include "engine/systems/fem/barrier/barrier_step.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"

namespace truestep::fem {

using Columns = FemColumns;
using Column = State::Column;

namespace {

constexpr int kMostRounds = 200, kMostParts = 64;
/// In body sizes a second: slower slips stick.
constexpr double kStill = 1e-3;
/// Strain whose elastic force the barrier matches.
constexpr double kStrain = 0.1;

}  // namespace

BarrierStep::BarrierStep(const FemField& field, BarrierSurface surface, double reach)
    : field_(field), surface_(std::move(surface)) {
  law_.reach = reach;
  size_ = field_.body().mesh.diagonal();
  for (const double m : field_.body().masses) mean_ += m / static_cast<double>(field_.body().masses.size());
}

// The barrier is stiff enough to balance, at half the reach, the elements' response to a strain of a tenth,
// and to stop a node that would penetrate by `overshoot` (m) in the step: resting gaps stay near the reach,
// where the barrier curves least.
BarrierLaw BarrierStep::law_in(const State& state, double h, double overshoot) const {
  BarrierLaw law = law_;
  const double elements =
      field_.contact_stiffness(state) * std::max(1.0, kStrain * field_.cell_size() / law.reach);
  law.stiffness = std::max(elements, mean_ / (h * h) * std::max(1.0, overshoot / law.reach));
  law.still = kStill * size_ * h;
  return law;
}

// Moves held nodes and obstacles as far as nothing touches; returns the share of the remaining path that was
// covered.
double BarrierStep::move_prescribed(BarrierWork& k) const {
  const BarrierNewton newton(field_, surface_);
  std::fill(k.d.begin(), k.d.end(), 0.0);
  double most = 0;
  const auto prescribe = [&](size_t i) {
    k.d[i] = k.target[i] - k.x[i];
    most = std::max(most, std::abs(k.d[i]));
  };
  for (size_t i = 0; i < k.n; ++i) {
    if (!(k.w[i / 3] > 0)) prescribe(i);
  }
  for (size_t i = k.n; i < k.all; ++i) prescribe(i);
  double share = 1;
  if (most > 0) {
    newton.find_pairs(k, k.d);
    share = newton.safe_share(k, k.d);
  }
  // Walls move only as far as every node keeps some of its gap.
  const double end = k.in.t + k.in.h;
  const auto moves = [&] {
    for (const Wall& wall : surface_.walls()) {
      for (const uint32_t p : surface_.surface_nodes()) {
        const Vec3 x = load3(k.x.data(), p), there = x + share * load3(k.d.data(), p);
        const double now = surface_.wall_gap(wall, k.tau, x).gap;
        if (surface_.wall_gap(wall, k.tau + share * (end - k.tau), there).gap < kLeftOfGap * now)
          return false;
      }
    }
    return true;
  };
  while (share > 1e-9 && !moves()) share *= 0.5;
  k.tau = share < 1 ? k.tau + share * (end - k.tau) : end;
  for (size_t i = 0; i < k.all; ++i) k.x[i] += share * k.d[i];
  return share;
}

void BarrierStep::advance(State& state, const StepInput& in, double overshoot) const {
  const auto places = state.f64(Columns::position), velocities = state.f64(Columns::velocity);
  const size_t n = places.size(), all = 3 * surface_.rows();
  const auto scratch = [&](std::string_view key, size_t size) { return in.workspace.doubles(key, size); };
  BarrierWork k{state,
                in,
                {in.workspace, in.arena},
                law_in(state, in.h, overshoot),
                in.t,
                n,
                all,
                scratch("barrier.x", all),
                scratch("barrier.x0", all),
                scratch("barrier.push", n),
                scratch("barrier.to", n),
                scratch("barrier.a", n),
                scratch("barrier.v", n),
                scratch("barrier.gradient", n),
                scratch("barrier.d", all),
                scratch("barrier.trial", all),
                scratch("barrier.target", all),
                state.f64(Columns::inverse_mass),
                in.workspace.object<std::vector<FeaturePair>>("barrier.pairs"),
                scratch("barrier.ways", 2 * all),
                false,
                in.workspace.object<std::vector<BarrierHessian>>("barrier.forms"),
                in.workspace.object<std::vector<BarrierTouch>>("barrier.touches"),
                in.workspace.object<std::vector<FrictionTerm>>("barrier.friction"),
                in.workspace.object<BarrierWork::System>("barrier.system")};
  if (k.system.dfdx.empty()) field_.jacobian_pattern(state, k.system.dfdx, k.system.dfdv);
  std::copy(places.begin(), places.end(), k.x.begin());
  surface_.place_obstacles(in.t, k.x);
  std::copy(k.x.begin(), k.x.end(), k.x0.begin());
  for (size_t i = 0; i < n; ++i) k.to[i] = places[i] + in.h * velocities[i];
  std::copy(k.to.begin(), k.to.end(), k.target.begin());
  surface_.place_obstacles(in.t + in.h, k.target);

  const BarrierNewton newton(field_, surface_);
  const auto look = [&] {
    newton.find_pairs(k, {});
    look_at_friction(surface_, k.law, {k.x, k.tau}, in.t, k.pairs, k.friction);
  };
  look();
  for (int round = 0;; ++round) {
    const double share = move_prescribed(k);
    newton.minimise(k);
    if (share >= 1) break;
    if (round >= kMostRounds || share < 1e-6) {
      throw Instability("", "position", -1,
                        "fixed and prescribed nodes leave no room for the body between them; a smaller dt or "
                        "another motion would help");
    }
  }
  // Friction with the normal forces at the minimum just found.
  const size_t before = k.friction.size();
  look();
  if (before + k.friction.size() > 0) newton.minimise(k);
  for (size_t i = 0; i < n; ++i) {
    velocities[i] = (k.x[i] - k.x0[i]) / in.h;
    places[i] = k.x[i];
  }
}

// m, by which features that are about to meet would pass through each other.
double BarrierStep::overshoot(const State& state, const StepInput& in) const {
  const auto places = state.f64(Columns::position), velocities = state.f64(Columns::velocity);
  const size_t n = places.size(), all = 3 * surface_.rows();
  const auto x = in.workspace.doubles("barrier.x", all), d = in.workspace.doubles("barrier.d", all);
  std::copy(places.begin(), places.end(), x.begin());
  surface_.place_obstacles(in.t + in.h, d);
  surface_.place_obstacles(in.t, x);
  for (size_t i = 0; i < all; ++i) d[i] = i < n ? in.h * velocities[i] : d[i] - x[i];
  auto& pairs = in.workspace.object<std::vector<FeaturePair>>("barrier.pairs");
  surface_.find_pairs(x, d, law_.reach, pairs);
  double most = 0;
  for (const FeaturePair& p : pairs) {
    const double way = relative_way(p, d);
    const double gap = p.closest(p.at(x)).distance - static_cast<double>(p.radius);
    if (gap < way) most = std::max(most, way - gap);
  }
  for (const Wall& wall : surface_.walls()) {
    for (const uint32_t p : surface_.surface_nodes()) {
      const Vec3 at = load3(x.data(), p), there = at + load3(d.data(), p);
      most = std::max(most, -surface_.wall_gap(wall, in.t + in.h, there).gap);
    }
  }
  return most;
}

// Newton's method converges in one step only if features would not pass far through each other; a part that
// still finds no minimum is halved.
void BarrierStep::step(State& state, const StepInput& in) const {
  const double through = overshoot(state, in);
  const double count = std::clamp(std::ceil(through / surface_.shortest_edge()), 1.0, double(kMostParts));
  const auto kept = [&](Column c, std::string_view key) {
    const auto now = state.f64(c), copy = in.workspace.doubles(key, now.size());
    std::copy(now.begin(), now.end(), copy.begin());
    return copy;
  };
  double done = 0, length = 1.0 / count;
  while (done < 1) {
    length = std::min(length, 1 - done);
    const StepInput part{in.t + done * in.h, length * in.h, in.step, in.workspace, in.arena, nullptr};
    const auto x = kept(Columns::position, "barrier.x_kept"), v = kept(Columns::velocity, "barrier.v_kept");
    try {
      advance(state, part, length * through);
    } catch (const Instability&) {
      length *= 0.5;
      if (length < 1.0 / kMostParts) throw;
      std::copy(x.begin(), x.end(), state.f64(Columns::position).begin());
      std::copy(v.begin(), v.end(), state.f64(Columns::velocity).begin());
      continue;
    }
    done += length;
    // A remainder due to rounding is not a part.
    if (1 - done < 1e-9) done = 1;
  }
}

BarrierStep::Report BarrierStep::report(const State& state, double t) const {
  const auto places = state.f64(Columns::position);
  std::vector<double> x(places.begin(), places.end());
  x.resize(3 * surface_.rows());
  surface_.place_obstacles(t, x);
  std::vector<FeaturePair> pairs;
  surface_.find_pairs(x, {}, law_.reach, pairs);
  BarrierLaw law = law_;
  law.stiffness = law_in(state, HUGE_VAL, 0).stiffness;
  BarrierOutput out;
  out.least_gap = law_.reach;
  const double energy = barrier_energy(surface_, law, {x, t}, pairs, out);
  return {out.least_gap, out.touching, energy};
}

}  // namespace truestep::fem
