#include "engine/systems/rigid2d/solver/solver.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/rigid/islands.h"
#include "engine/systems/rigid2d/solver/solver_impact.h"

namespace truestep::rigid2d {
namespace {

/// Maximum rounds of impacts passed on between bodies in one substep; the rest does not bounce.
constexpr int kImpactRounds = 64;
/// Fraction of the thinner body's inner radius beyond which one of a pair is inside the other; a body inside
/// this many others is in a crowd. Bodies in its middle move only once those around them have been pushed
/// away: a crowd takes several sweeps. With one, thirty disks at one place are as deep as a radius after two
/// seconds.
constexpr double kInside = 0.25;
constexpr uint8_t kCrowdAround = 3;
constexpr int kCrowdSweeps = 8;
/// Mass that a body may have while it is pushed out of others, as a multiple of the lightest of its island. A
/// sweep lifts a heavy body through a light one by the ratio of their masses only, and pushes that are taken
/// back do not add up: a light body under a load of 50 times its mass went deeper and deeper into the next.
constexpr double kMostHeavier = 3;
/// Fraction of its island's heaviest weight that a deep contact must bear for that. A light body that bears
/// less is in the way of nothing, and moves out itself: lifting what rolls off it would be energy from
/// nothing.
constexpr double kPressed = 0.5;

/// Calls body(pack) for all packs, colour after colour; packs of one colour run in parallel.
template <class Packs, class Body>
void each_colour(const ThreadArena& arena, Packs& packs, const std::vector<uint32_t>& colours, Body&& body,
                 ColourOrder order = ColourOrder::forth) {
  truestep::each_colour(colours, order, arena, kPacksPerTask, [&](size_t p) { body(packs[p]); });
}

template <class Packs, class Body>
void each_colour_back(const ThreadArena& arena, Packs& packs, const std::vector<uint32_t>& colours,
                      Body&& body) {
  each_colour(arena, packs, colours, body, ColourOrder::back);
}

}  // namespace

template <class T>
void Solver<T>::place_bodies(const Model& model, const State& state, const Pairs& pairs, const Hands& hands,
                             const SolverSettings& settings) {
  const size_t n = model.count();
  const auto status = state.span<uint32_t>(columns::status);
  movers_.clear();
  slot_.assign(n + 1, kNoPoint);
  for (uint32_t i = 0; i < n; ++i) {
    if (is_moved(model.light[i], status[i]))
      slot_[i] = static_cast<uint32_t>(movers_.size()), movers_.push_back(i);
  }
  moved_ = static_cast<uint32_t>(movers_.size());
  for (uint32_t i = 0; i < n; ++i) {
    if (pairs.active[i] && slot_[i] == kNoPoint) {
      slot_[i] = static_cast<uint32_t>(movers_.size()), movers_.push_back(i);
    }
  }
  const auto still = static_cast<uint32_t>(movers_.size());
  for (uint32_t& s : slot_) s = s == kNoPoint ? still : s;

  rows_.assign(8 * (movers_.size() + 1), 0), flight_.resize(rows_.size());
  push_.assign(8 * (movers_.size() + 1), 0);
  start_.resize(rows_.size()), island_.resize(movers_.size() + 1), parts_.resize(movers_.size() + 1);
  const double* v = state.f64(columns::velocity).data();
  const auto w = state.f64(columns::angular_velocity);
  const auto g = state.f64(columns::parameters);
  const double h = settings.h;
  for (uint32_t r = 0; r < movers_.size(); ++r) {
    const uint32_t i = movers_[r];
    const Dynamics& b = model.dynamics[i];
    T* row = rows_.data() + 8 * r;
    T* push = push_.data() + 8 * r;
    row[0] = static_cast<T>(v[3 * i]), row[1] = static_cast<T>(v[3 * i + 1]), row[2] = static_cast<T>(w[i]);
    const bool takes = r < moved_;
    row[3] = takes ? static_cast<T>(b.inverse_mass) : 0,
    row[7] = takes ? static_cast<T>(b.inverse_inertia) : 0;
    push[0] = takes ? static_cast<T>(h * b.gravity_scale * g[0]) : 0;
    push[1] = takes ? static_cast<T>(h * b.gravity_scale * g[1]) : 0;
    push[2] = 0;
    push[3] = takes ? static_cast<T>(1 / (1 + h * b.linear_damping)) : 1;
    push[4] = takes ? static_cast<T>(1 / (1 + h * b.angular_damping)) : 1;
  }
  for (const Hands::Force& f : hands.forces) {
    if (slot_[f.body] >= moved_) continue;
    const Dynamics& b = model.dynamics[f.body];
    T* push = push_.data() + 8 * static_cast<size_t>(slot_[f.body]);
    push[0] += static_cast<T>(h * b.inverse_mass * f.force.x);
    push[1] += static_cast<T>(h * b.inverse_mass * f.force.y);
    push[2] += static_cast<T>(h * b.inverse_inertia * f.torque);
  }
}

template <class T>
void Solver<T>::hit_contacts(const SolverSettings& settings, const ThreadArena& arena) {
  toi_correction_.assign(rows_.size(), 0);
  const ImpactRows<T> bodies{rows_.data(), push_.data(), toi_correction_.data(), moved_};
  const T h = static_cast<T>(settings.h), threshold = static_cast<T>(settings.restitution_speed);
  std::atomic<bool> any = false;
  each_colour(arena, contacts_, contact_colours_, [&](const ContactPack<T>& p) {
    if (p.bounces && hit<Hits::bouncing>(p, bodies, h, threshold)) any = true;
  });
  // An impact is passed on through contacts that do not bounce.
  for (int round = 1; round < kImpactRounds && any; ++round) {
    any = false;
    each_colour(arena, contacts_, contact_colours_, [&](const ContactPack<T>& p) {
      if (hit<Hits::all>(p, bodies, h, threshold)) any = true;
    });
  }
  // What is no longer going to touch must not be slowed by the solver.
  for (size_t i = 0; i < movers_.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) rows_[8 * i + 4 + k] += toi_correction_[8 * i + k];
  }
}

template <class T>
void Solver<T>::choose_sprung(const Pairs& pairs, double h) {
  const auto alone = [](const JointRow<T>& j) { return j.joint->spring_only(); };
  springs_ = std::any_of(joints_.begin(), joints_.end(), alone);
  if (!springs_) return;
  held_.assign(movers_.size() + 1, 0), sprung_.assign(movers_.size() + 1, 0);
  for (const uint32_t i : pairs.touching) {
    held_[slot_[pairs.hits[i].body_a]] = held_[slot_[pairs.hits[i].body_b]] = 1;
  }
  for (const HingePack<T>& p : hinges_) {
    for (int k = 0; k < Wide<T>::kLanes; ++k) held_[p.a[k]] = held_[p.b[k]] = 1;
  }
  for (const JointRow<T>& j : joints_) {
    if (!alone(j)) held_[j.a] = held_[j.b] = 1;
  }
  for (uint32_t r = 0; r < moved_; ++r) {
    // Damping outside of springs makes a step first order in any case.
    const T* p = push_.data() + 8 * static_cast<size_t>(r);
    if (p[3] != 1 || p[4] != 1) held_[r] = 1;
  }
  const auto loose = [&](const JointRow<T>& j) {
    return alone(j) && !(j.a < moved_ && held_[j.a]) && !(j.b < moved_ && held_[j.b]) && j.spring.k > 0;
  };
  // In the basis of springs the matrix of an oscillation has at most w_i w_j where two share a body: their
  // largest frequency is below a sum over a row (Gershgorin).
  const auto rate = [](const JointRow<T>& j) { return std::sqrt(j.joint->stiffness * double(j.spring.k)); };
  spring_rates_.assign(movers_.size() + 1, 0);
  for (const JointRow<T>& j : joints_) {
    if (!loose(j)) continue;
    if (j.a < moved_) spring_rates_[j.a] += rate(j);
    if (j.b < moved_) spring_rates_[j.b] += rate(j);
  }
  for (JointRow<T>& j : joints_) {
    if (loose(j)) {
      const double w = rate(j), both = j.a < moved_ && j.b < moved_ ? w : 0;
      const double beside = spring_rates_[j.a] + spring_rates_[j.b] - both;
      if (w * beside * h * h < kResolvedAlone2) soften_spring(j, static_cast<T>(h), kResolvedAlone2);
    } else {
      j.spring.half = 0;
    }
    if (j.spring.half > 0) sprung_[j.a] = sprung_[j.b] = 1;
  }
}

template <class T>
void Solver<T>::kick(JointPass pass, T h) {
  const T times = T(pass == JointPass::kick ? 0.5 : -0.5);
  for (uint32_t r = 0; r < moved_; ++r) {
    if (!sprung_[r]) continue;
    for (size_t k = 0; k < 3; ++k) rows_[8 * r + k] += times * push_[8 * r + k];
  }
  for (JointRow<T>& j : joints_) {
    if (j.spring.half > 0) solve_joint(j, rows_.data(), moved_, pass, h);
  }
}

template <class T>
void Solver<T>::find_islands() {
  start_islands(island_);
  const uint32_t packs = contact_colours_.empty() ? 0 : contact_colours_.back();
  for (uint32_t p = 0; p < packs; ++p) {
    const ContactPack<T>& c = contacts_[p];
    for (int k = 0; k < Wide<T>::kLanes; ++k) {
      if (c.a[k] < moved_ && c.b[k] < moved_) link_islands(island_, c.a[k], c.b[k]);
    }
  }
  for (uint32_t i = 0; i < moved_; ++i) island_[i] = island_of(island_, i);
  knows_islands_ = true;
}

template <class T>
void Solver<T>::start_parting(const Model& model, T push_out_speed) {
  std::copy(rows_.begin(), rows_.end(), start_.begin());
  std::fill(parts_.begin(), parts_.end(), uint8_t{0});
  pressed_.assign(parts_.size(), 0);
  if (!knows_islands_) find_islands();
  const uint32_t packs = contact_colours_.empty() ? 0 : contact_colours_.back();
  const auto island = [&](const ContactPack<T>& c, int k) {
    const uint32_t body = std::min(c.a[k], c.b[k]);
    return body < moved_ ? island_[body] : kNoPoint;
  };
  const auto thickness = [&](uint32_t row) {
    return row < movers_.size() ? model.light[movers_[row]].inner : HUGE_VAL;
  };
  inside_.assign(movers_.size() + 1, 0);
  for (uint32_t p = 0; p < packs; ++p) {
    ContactPack<T>& c = contacts_[p];
    remember_impulses(c);
    Wide<T> separation[2];
    separations(c, Ends<T>(rows_.data(), c.a, c.b), separation);
    const Wide<T> left = depth_left(c, separation, push_out_speed);
    if (!any_below(left, Wide<T>::zero())) continue;
    for (int k = 0; k < Wide<T>::kLanes; ++k) {
      const uint32_t i = island(c, k);
      if (i == kNoPoint || !(left[k] < 0)) continue;
      parts_[i] = 1;
      pressed_[i] = std::max<double>(pressed_[i], c.point[0].normal[k] + c.point[1].normal[k]);
      const double depth = -static_cast<double>(std::min(separation[0][k], separation[1][k]));
      if (!(depth > kInside * std::min(thickness(c.a[k]), thickness(c.b[k])))) continue;
      for (const uint32_t row : {c.a[k], c.b[k]}) {
        if (row < moved_ && inside_[row] < kCrowdAround) ++inside_[row];
      }
    }
  }
  for (uint32_t p = 0; p < packs; ++p) {
    ContactPack<T>& c = contacts_[p];
    c.crowded = 0;
    for (int k = 0; k < Wide<T>::kLanes; ++k) {
      if (std::max(inside_[c.a[k]], inside_[c.b[k]]) == kCrowdAround) c.crowded = 1, crowded_ = true;
      const uint32_t i = island(c, k);
      c.before.taken.set(k, i != kNoPoint && parts_[i] ? T(1) : T(0));
    }
  }
}

// Pushes that are taken back move bodies without giving them velocities: no momentum depends on their masses.
template <class T>
bool Solver<T>::lighten(const Model& model) {
  lightest_.assign(movers_.size() + 1, HUGE_VAL), heaviest_.assign(movers_.size() + 1, 0);
  const auto mass = [&](uint32_t row) { return model.light[movers_[row]].mass; };
  for (uint32_t r = 0; r < moved_; ++r) {
    const uint32_t i = island_[r];
    if (!parts_[i]) continue;
    lightest_[i] = std::min(lightest_[i], mass(r));
    const T* push = push_.data() + 8 * static_cast<size_t>(r);
    heaviest_[i] = std::max(heaviest_[i], mass(r) * flat::norm(Vec2{push[0], push[1]}));
  }
  for (uint32_t i = 0; i < moved_; ++i) {
    if (!(pressed_[i] > kPressed * heaviest_[i])) lightest_[i] = HUGE_VAL;
  }
  const auto times = [&](uint32_t r) { return mass(r) / (kMostHeavier * lightest_[island_[r]]); };
  bool any = false;
  for (uint32_t r = 0; r < moved_ && !any; ++r) any = times(r) > 1;
  if (!any) return false;
  masses_.resize(movers_.size() + 1);
  for (uint32_t r = 0; r < masses_.size(); ++r) {
    T* row = rows_.data() + 8 * static_cast<size_t>(r);
    masses_[r] = {row[3], row[7]};
    if (r < moved_ && times(r) > 1) row[3] *= T(times(r)), row[7] *= T(times(r));
  }
  weigh_contacts();
  return true;
}

template <class T>
void Solver<T>::restore_masses() {
  for (uint32_t r = 0; r < masses_.size(); ++r) {
    T* row = rows_.data() + 8 * static_cast<size_t>(r);
    row[3] = masses_[r][0], row[7] = masses_[r][1];
  }
  weigh_contacts();
}

template <class T>
void Solver<T>::weigh_contacts() {
  using W = Wide<T>;
  const uint32_t packs = contact_colours_.back();
  for (uint32_t p = 0; p < packs; ++p) {
    ContactPack<T>& c = contacts_[p];
    if (!any_below(W::zero(), c.before.taken)) continue;
    W there[2];
    for (int i = 0; i < 2; ++i) there[i] = select(c.point[i].normal_mass > W::zero(), W::all(1), W::zero());
    weigh(c, Ends<T>(rows_.data(), c.a, c.b), there);
  }
}

template <class T>
void Solver<T>::substep(const Model& model, const SolverSettings& settings, T elapsed,
                        const ThreadArena& arena) {
  const T h = static_cast<T>(settings.h), inverse_h = static_cast<T>(1 / settings.h);
  const T push_out_speed = static_cast<T>(settings.push_out_speed);
  const SoftConstraint<T> soft{static_cast<T>(settings.joint.bias_rate),
                               static_cast<T>(settings.joint.mass_scale),
                               static_cast<T>(settings.joint.impulse_scale)};
  T* rows = rows_.data();
  const uint32_t moved = moved_;
  const auto carried_of = [&](const ContactPack<T>& p) -> const CarriedPack<T>& {
    return carried_[static_cast<size_t>(&p - contacts_.data())];
  };
  arena.for_blocks(movers_.size(), kBodiesPerTask, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      T* r = rows + 8 * i;
      if (bounces_) std::copy_n(r, 3, flight_.data() + 8 * i + 4);
      act(push_.data() + 8 * i, r);
      if (bounces_) std::copy_n(r, 3, flight_.data() + 8 * i);
    }
  });
  // Before warm starting: impacts use the actual velocities of the bodies.
  if (bounces_) hit_contacts(settings, arena);
  for (JointRow<T>& j : joints_) solve_joint(j, rows, moved, JointPass::warm, h);
  each_colour(arena, hinges_, hinge_colours_, [&](HingePack<T>& p) { warm_start(p, rows, moved); });
  each_colour(arena, contacts_, contact_colours_, [&](ContactPack<T>& p) { warm_start(p, rows, moved); });

  const bool parts = deep_.exchange(false);
  crowded_ = false;
  if (parts) start_parting(model, push_out_speed);
  const T* start = parts ? start_.data() : nullptr;
  for (JointRow<T>& j : joints_) {
    if (j.joint->has_spring) solve_joint(j, rows, moved, JointPass::pull, h);
  }
  for (JointRow<T>& j : joints_) {
    if (!j.joint->spring_only()) solve_joint(j, rows, moved, JointPass::bias, h);
  }
  each_colour(arena, hinges_, hinge_colours_,
              [&](HingePack<T>& p) { solve_hinges<Pass::bias>(p, rows, moved, soft, h); });
  // Pushes that are taken back begin anew in every substep: what must lift a heavy body through a light
  // one, or make room in a crowd, needs several sweeps.
  const bool lighter = parts && lighten(model);
  const int all = parts ? settings.push_sweeps : 1, sweeps = crowded_ ? std::max(all, kCrowdSweeps) : all;
  for (int i = 0; i < sweeps; ++i) {
    each_colour_back(arena, contacts_, contact_colours_, [&](ContactPack<T>& p) {
      if (i + all < sweeps && !p.crowded) return;
      if (p.turns) {
        const TurningSurfaces<T> turning{carried_of(p), elapsed, elapsed + T(0.5) * h};
        solve_contacts<Pass::bias>(p, rows, moved, inverse_h, push_out_speed, start, turning);
      } else {
        solve_contacts<Pass::bias>(p, rows, moved, inverse_h, push_out_speed, start);
      }
    });
  }

  arena.for_blocks(movers_.size(), kBodiesPerTask, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      T* r = rows + 8 * i;
      r[4] += h * r[0], r[5] += h * r[1], r[6] += h * r[2];
      if (!bounces_) continue;
      const T* f = flight_.data() + 8 * i;
      // Up to a bounce and after it a body flies freely, also where only that one step has contacts.
      const bool free = i < moved && !model.light[movers_[i]].jointed && std::equal(f, f + 3, r);
      const T half_step = free ? T(0.5) * h : T(0);
      for (int k = 0; k < 3; ++k) r[4 + k] -= half_step * (r[k] - f[4 + k]);
    }
  });

  if (parts) {
    each_colour(arena, contacts_, contact_colours_,
                [&](ContactPack<T>& p) { take_push_back(p, rows, moved); });
  }
  if (lighter) restore_masses();
  for (JointRow<T>& j : joints_) solve_joint(j, rows, moved, JointPass::relax, h);
  each_colour(arena, hinges_, hinge_colours_,
              [&](HingePack<T>& p) { solve_hinges<Pass::relax>(p, rows, moved, soft, h); });
  each_colour_back(arena, contacts_, contact_colours_, [&](ContactPack<T>& p) {
    bool deep;
    if (p.turns) {
      const TurningSurfaces<T> turning{carried_of(p), elapsed + h, elapsed + h};
      deep = solve_contacts<Pass::relax>(p, rows, moved, inverse_h, push_out_speed, start, turning);
    } else {
      deep = solve_contacts<Pass::relax>(p, rows, moved, inverse_h, push_out_speed, start);
    }
    if (deep) deep_ = true;
  });
}

template <class T>
void Solver<T>::solve(const Model& model, State& state, const Pairs& pairs, Hands& hands,
                      const SolverSettings& settings, const ThreadArena& arena) {
  const T h = static_cast<T>(settings.h);
  place_bodies(model, state, pairs, hands, settings);
  pack_joints(model, state, pairs, hands, settings);
  pack_contacts(model, state, pairs, settings, arena);
  const uint32_t packs = contact_colours_.empty() ? 0 : contact_colours_.back();
  bounces_ =
      std::any_of(contacts_.begin(), contacts_.begin() + packs, [](const auto& p) { return p.bounces != 0; });
  // The loads in joints are not known here.
  if (packs > 0 && state.rows(columns::contact_key) == 0 && model.joints.empty()) {
    start_contacts(model, pairs, settings, arena);
  }
  for (JointRow<T>& j : joints_) {
    solve_joint(j, rows_.data(), moved_, JointPass::soften, h);
  }
  knows_islands_ = false;
  choose_sprung(pairs, settings.h);
  if (springs_) kick(JointPass::unkick, h);
  deep_ = false;
  for (uint32_t p = 0; p < packs; ++p) {
    const Wide<T> separation[2] = {contacts_[p].point[0].separation, contacts_[p].point[1].separation};
    const Wide<T> left = depth_left(contacts_[p], separation, static_cast<T>(settings.push_out_speed));
    if (any_below(left, Wide<T>::zero())) deep_ = true;
  }
  for (int i = 0; i < settings.steps; ++i) substep(model, settings, static_cast<T>(i * settings.h), arena);
  if (springs_) kick(JointPass::kick, h);
  if (!bounces_) end_free_flights(model, state, settings, arena);
  store_bodies(state, settings.h * settings.steps, arena);
  store_joints(model, state, hands, settings);
}

template class Solver<float>;
template class Solver<double>;

}  // namespace truestep::rigid2d
