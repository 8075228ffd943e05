#include "engine/collision/points/surface_contacts.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"

namespace truestep {

namespace {

/// Maximum number of solves per step, and after how many of them points are only released: a point that still
/// enters then waits for the next step, because forcing positions on stiff springs creates energy.
constexpr int kRounds = 16, kTakingRounds = 10;
/// How often a point may be released in a step before it stays free.
constexpr double kMostReleases = 2;
/// Maximum number of times that a step without a solution is halved.
constexpr int kHalvings = 5;
/// Energy that a step may gain, as a fraction of the kinetic energy and of what gravity adds to it in a step.
constexpr double kRise = 0.01;
/// m, and fraction of a point's radius, by which a point may be off its surface (which bends under it) until
/// the next step.
constexpr double kOff = 1e-6, kOffRadius = 0.02;
/// Relative change of friction, and tensile impulse as a fraction of the weight's, that are tolerated until
/// the next step.
constexpr double kSame = 0.25, kPulled = 0.05;

}  // namespace

void SurfaceContacts::step(const ForceField& field, const Integrator& method,
                           const IntegratorOptions& options, State& s, const StepInput& in,
                           Supply supply) const {
  const RowContacts on = RowContacts::all(s);
  const size_t n = on.kind.size();
  const auto x = s.f64(columns_.position), v = s.f64(columns_.velocity);
  const auto x_begin = in.workspace.doubles("surfaces.x_begin", x.size());
  const auto v_begin = in.workspace.doubles("surfaces.v_begin", v.size());
  const auto held = in.workspace.doubles("surfaces.held", n);
  std::copy(x.begin(), x.end(), x_begin.begin()), std::copy(v.begin(), v.end(), v_begin.begin());
  for (size_t i = 0; i < n; ++i) held[i] = on.kind[i];
  const EnergyBound bound = energy_bound(field, s, in, supply);
  divided(field, method, options, s, in, {Friction::coulomb, Depth::corrected});
  if (bound.most == HUGE_VAL || energy(field, s, in.t + in.h, in) <= bound.most) return;
  const auto w = s.f64(columns_.inverse_mass);
  const auto restart = [&] {
    std::copy(x_begin.begin(), x_begin.end(), x.begin()),
        std::copy(v_begin.begin(), v_begin.end(), v.begin());
    for (size_t i = 0; i < n; ++i) {
      on.kind[i] = held[i] == double{RowContacts::kFree} ? RowContacts::kFree : RowContacts::kSlides;
      store3(on.drag.data(), i, Vec3{});
    }
  };
  // Friction that is revised from solve to solve may diverge where springs are stiff; without it points are
  // only held back.
  Evaluation e{in.workspace, in.arena};
  for (const Depth depth : {Depth::corrected, Depth::kept}) {
    restart();
    divided(field, method, options, s, in, {Friction::none, depth});
    const double end = energy(field, s, in.t + in.h, in);
    if (end <= bound.most) return;
    // The energy that moving points onto surfaces has put into the springs is removed from the velocities.
    const double kinetic = field.kinetic({in.t + in.h, x, v, s}, e);
    const double left = kinetic - (end - bound.start);
    const double lifted = depth == Depth::corrected ? lift(s, x_begin, in.t) : 0;
    if (left < -lifted) continue;
    const double share = kinetic > 0 ? std::sqrt(std::max(0.0, left) / kinetic) : 0;
    for (size_t i = 0; i < n; ++i) {
      if (w[i] > 0) store3(v.data(), i, load3(v.data(), i) * share);
    }
    return;
  }
  restart();
  for (size_t i = 0; i < n; ++i) {
    if (w[i] > 0) store3(v.data(), i, Vec3{});
  }
}

double SurfaceContacts::lift(const State& s, std::span<const double> x, double t) const {
  const double g = norm(load3(s.f64(columns_.gravity).data(), 0));
  const auto w = s.f64(columns_.inverse_mass);
  double sum = 0;
  for (size_t i = 0; i < w.size(); ++i) {
    if (w[i] == 0) continue;
    const NearSurface at = colliders_.nearest(load3(x.data(), i), t);
    if (at.collider != NearSurface::kNone) sum += g / w[i] * std::max(0.0, radius_ - at.distance);
  }
  return sum;
}

void SurfaceContacts::divided(const ForceField& field, const Integrator& method,
                              const IntegratorOptions& options, State& s, const StepInput& in,
                              Means by) const {
  const auto x = s.f64(columns_.position), v = s.f64(columns_.velocity);
  const auto x_begin = in.workspace.doubles("surfaces.x_begin", x.size());
  const auto v_begin = in.workspace.doubles("surfaces.v_begin", v.size());
  for (int halvings = 0;; ++halvings) {
    const int parts = 1 << halvings;
    try {
      for (int k = 0; k < parts; ++k) {
        StepInput part{in.t + in.h * k / parts, in.h / parts, in.step, in.workspace, in.arena, in.profile};
        whole(field, method, options, s, part, by);
      }
      return;
    } catch (const Instability&) {
      if (halvings == kHalvings) throw;
      std::copy(x_begin.begin(), x_begin.end(), x.begin()),
          std::copy(v_begin.begin(), v_begin.end(), v.begin());
    }
  }
}

double SurfaceContacts::energy(const ForceField& field, const State& s, double t, const StepInput& in) const {
  Evaluation e{in.workspace, in.arena};
  const Phase at{t, s.f64(columns_.position), s.f64(columns_.velocity), s};
  return field.kinetic(at, e) + field.potential(at, e).value_or(0);
}

// Only moving solids or an external supply can add energy.
SurfaceContacts::EnergyBound SurfaceContacts::energy_bound(const ForceField& field, const State& s,
                                                           const StepInput& in, Supply supply) const {
  const bool moved =
      std::ranges::any_of(colliders_.colliders(), [](const Collider& c) { return !c.motion.at_rest(); });
  if (moved || supply == Supply::some) return {HUGE_VAL, HUGE_VAL};
  const auto v = s.f64(columns_.velocity), w = s.f64(columns_.inverse_mass);
  const double fall = norm(load3(s.f64(columns_.gravity).data(), 0)) * in.h;
  double moving = 0;
  for (size_t i = 0; i < w.size(); ++i) {
    const double speed = norm(load3(v.data(), i)) + fall;
    if (w[i] > 0) moving += 0.5 / w[i] * speed * speed;
  }
  const double start = energy(field, s, in.t, in);
  return {start, start + kRise * moving};
}

void SurfaceContacts::whole(const ForceField& field, const Integrator& method,
                            const IntegratorOptions& options, State& s, const StepInput& in, Means by) const {
  const auto x = s.f64(columns_.position), v = s.f64(columns_.velocity);
  const RowContacts on = RowContacts::all(s);
  const size_t n = on.kind.size();
  const auto x0 = in.workspace.doubles("surfaces.x", x.size()),
             v0 = in.workspace.doubles("surfaces.v", v.size());
  const auto before = in.workspace.doubles("surfaces.before", n);
  std::copy(x.begin(), x.end(), x0.begin()), std::copy(v.begin(), v.end(), v0.begin());
  for (size_t i = 0; i < n; ++i) before[i] = on.kind[i];
  const Start start{x0, v0};
  const auto released = in.workspace.doubles("surfaces.released", n);
  std::fill(released.begin(), released.end(), 0.0);
  take_up(s, on, start, in, by);
  for (int round = 0;; ++round) {
    method.step(field, s, in, options);
    if (round + 1 == kRounds || !revise(s, on, start, in, round, by)) break;
    std::copy(x0.begin(), x0.end(), x.begin()), std::copy(v0.begin(), v0.end(), v.begin());
  }
  finish(s, on, start, in, before);
}

Vec3 SurfaceContacts::free_normal(size_t i, const Vec3& normal) const {
  if (fixed_.empty() || fixed_[i] == 0) return normal;
  constexpr double kLeast = 0.1;
  const uint8_t bits = fixed_[i];
  const Vec3 n{bits & 1 ? 0 : normal.x, bits & 2 ? 0 : normal.y, bits & 4 ? 0 : normal.z};
  const double size = norm(n);
  return size > kLeast ? n / size : Vec3{};
}

void SurfaceContacts::hold(const RowContacts& on, size_t i, const Vec3& x0, const NearSurface& surface,
                           const Vec3& place, RowContacts::Kind kind, double h, Depth depth) const {
  NearSurface at = surface;
  at.normal = free_normal(i, surface.normal);
  if (norm2(at.normal) == 0) {
    on.kind[i] = RowContacts::kFree;
    return;
  }
  // A sticking point moves with the surface, and along the normal to where the surface will be.
  Vec3 to = (place - x0) / h;
  if (depth == Depth::kept) to -= at.normal * std::max(0.0, dot(at.normal, to - at.velocity));
  on.kind[i] = kind;
  store3(on.normal.data(), i, at.normal);
  store3(on.velocity.data(), i, at.velocity + at.normal * dot(at.normal, to - at.velocity));
  if (kind == RowContacts::kSticks) store3(on.drag.data(), i, Vec3{});
}

// Points held in the last step are held again where they still touch.
void SurfaceContacts::take_up(const State& s, const RowContacts& on, const Start& start, const StepInput& in,
                              Means by) const {
  const auto w = s.f64(columns_.inverse_mass);
  for (size_t i = 0; i < on.kind.size(); ++i) {
    store3(on.impulse.data(), i, Vec3{});
    if (on.kind[i] == RowContacts::kFree) continue;
    const Vec3 x0 = load3(start.x.data(), i);
    const NearSurface at = colliders_.nearest(x0, in.t + in.h);
    const double off = at.distance - radius_ - kContactSlop;
    const bool moving = norm2(at.velocity) > 0;
    if (w[i] == 0 || at.collider == NearSurface::kNone || (!moving && off > kOff + kOffRadius * radius_)) {
      on.kind[i] = RowContacts::kFree;
      continue;
    }
    hold(on, i, x0, at, x0 - at.normal * off, static_cast<RowContacts::Kind>(on.kind[i]), in.h, by.depth);
  }
}

// Revises the contacts after a solve; true if another one is needed.
bool SurfaceContacts::revise(State& s, const RowContacts& on, const Start& start, const StepInput& in,
                             int round, Means by) const {
  const auto x = s.f64(columns_.position), v = s.f64(columns_.velocity);
  const auto w = s.f64(columns_.inverse_mass);
  const auto xr = in.workspace.doubles("surfaces.x_apart", x.size()),
             vr = in.workspace.doubles("surfaces.v_apart", v.size());
  std::copy(x.begin(), x.end(), xr.begin()), std::copy(v.begin(), v.end(), vr.begin());
  colliders_.resolve({.t = in.t,
                      .h = in.h,
                      .x_old = start.x,
                      .v_old = start.v,
                      .x = xr,
                      .v = vr,
                      .inverse_mass = w,
                      .radius = radius_,
                      .surfaces = surfaces_},
                     in.workspace, in.arena);
  const double t = in.t + in.h;
  const auto released = in.workspace.doubles("surfaces.released", on.kind.size());
  const bool takes = round < kTakingRounds;
  const double slack = kOff + kOffRadius * radius_;
  const double g = norm(load3(s.f64(columns_.gravity).data(), 0));
  bool again = false;
  if (round + 1 == kTakingRounds) {
    // The active set does not settle: without friction the held points only need to be released.
    for (size_t i = 0; i < on.kind.size(); ++i) {
      if (on.kind[i] != RowContacts::kFree) on.kind[i] = RowContacts::kSlides;
      store3(on.drag.data(), i, Vec3{});
    }
    return true;
  }
  for (size_t i = 0; i < on.kind.size(); ++i) {
    if (w[i] == 0) continue;
    const Vec3 x0 = load3(start.x.data(), i), x1 = load3(x.data(), i);
    if (on.kind[i] == RowContacts::kFree) {
      const Vec3 apart = load3(xr.data(), i);
      if (apart == x1 || !takes || released[i] >= kMostReleases) continue;
      const NearSurface at = colliders_.nearest(apart, t);
      if (at.collider == NearSurface::kNone) continue;
      const Vec3 place = apart - at.normal * (at.distance - radius_ - kContactSlop);
      // Only points that end beyond the surface need to be held.
      const double depth = dot(at.normal, place - x1);
      if (depth <= 0) continue;
      // Friction starts with the next solve, which knows the normal load.
      hold(on, i, x0, at, place, RowContacts::kSlides, in.h, by.depth);
      store3(on.drag.data(), i, Vec3{});
      again = again || depth > slack;
      continue;
    }
    const Vec3 n = load3(on.normal.data(), i), impulse = load3(on.impulse.data(), i);
    const double pressed = dot(n, impulse), weight = g * in.h / w[i];
    const NearSurface at = colliders_.nearest(x1, t);
    if (pressed < 0) {
      on.kind[i] = RowContacts::kFree, released[i] += 1;
      again = again || -pressed > kPulled * weight;
      store3(on.drag.data(), i, Vec3{});
      continue;
    }
    const double off = at.distance - radius_ - kContactSlop,
                 most = by.friction == Friction::none ? 0 : surfaces_[at.collider].friction * pressed;
    if (!takes) continue;
    // A point that is kept at its depth is off by as much.
    const double from = by.depth == Depth::kept
                            ? std::min(0.0, colliders_.nearest(x0, in.t).distance - radius_ - kContactSlop)
                            : 0;
    if (off > slack || off < from - slack) {
      hold(on, i, x0, at, x1 - at.normal * off, static_cast<RowContacts::Kind>(on.kind[i]), in.h, by.depth);
      again = true;
    }
    const Vec3 along = impulse - n * pressed;
    if (on.kind[i] == RowContacts::kSticks) {
      if (norm(along) <= most * (1 + kSame)) continue;
      on.kind[i] = RowContacts::kSlides;
      again = again || norm(along) > (1 + kSame) * most + kPulled * weight;
      store3(on.drag.data(), i, along * (most / norm(along)));
      continue;
    }
    const Vec3 drag = load3(on.drag.data(), i), slip = load3(v.data(), i) - at.velocity;
    const Vec3 slides = slip - n * dot(n, slip);
    if (most > 0 && dot(drag, slides) > 0) {
      // Friction must not drive the point: it sticks instead.
      hold(on, i, x0, at, x1 - at.normal * off, RowContacts::kSticks, in.h, by.depth);
      again = again || dot(drag, slides) > kPulled * weight * g * in.h;
      continue;
    }
    const double size = norm(drag), speed = norm(slides);
    const Vec3 against = size > 0 ? drag / size : speed > 0 ? slides * (-1 / speed) : Vec3{};
    store3(on.drag.data(), i, against * most);
    again = again || std::abs(size - most) > kSame * std::max(size, most) + kPulled * weight;
  }
  return again;
}

void SurfaceContacts::finish(State& s, const RowContacts& on, const Start& start, const StepInput& in,
                             std::span<const double> held_before) const {
  const auto x = s.f64(columns_.position), v = s.f64(columns_.velocity);
  const auto w = s.f64(columns_.inverse_mass);
  const Vec3 g = load3(s.f64(columns_.gravity).data(), 0);
  for (size_t i = 0; i < on.kind.size(); ++i) {
    if (w[i] == 0) continue;
    const Vec3 x1 = load3(x.data(), i), v1 = load3(v.data(), i), v0 = load3(start.v.data(), i);
    if (on.kind[i] == RowContacts::kFree) continue;
    const NearSurface at = colliders_.nearest(x1, in.t + in.h);
    const Vec3 n = free_normal(i, at.normal), relative = v1 - at.velocity;
    const double approach = -dot(n, v0 - at.velocity), e = surfaces_[at.collider].restitution;
    const bool rests = held_before[i] != double{RowContacts::kFree} ||
                       approach <= surfaces_[at.collider].rest_speed || e * approach <= 0.51 * norm(g) * in.h;
    store3(v.data(), i, at.velocity + relative - n * dot(n, relative) + n * (rests ? 0 : e * approach));
  }
}

}  // namespace truestep
