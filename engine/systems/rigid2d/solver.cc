#include "engine/systems/rigid2d/solver.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "engine/rigid/islands.h"
#include "engine/systems/rigid2d/solver_impact.h"

namespace truestep::rigid2d {
namespace {

constexpr size_t kBlock = 1024;    // bodies per task
constexpr size_t kPackBlock = 64;  // packs per task
/// Maximum rounds of impacts passed on between bodies in one small step; the rest does not bounce.
constexpr int kImpactRounds = 64;
/// Share of the smaller body's inner radius up to which offsets grow; those of the start may be thicker.
/// Of 24 heaps of 40 layers, that yield where grains are strained by some percent, 21 sleep within 10 s of
/// rest so, 13 with a hundredth and none without a bound.
constexpr double kThickestLearnt = 1.0 / 400;

/// Calls body(pack) for all packs, colour after colour; packs of one colour run in parallel.
template <class Packs, class Body>
void each_colour(const ThreadArena& arena, Packs& packs, const std::vector<uint32_t>& colours, Body&& body,
                 ColourOrder order = ColourOrder::forth) {
  truestep::each_colour(colours, order, arena, kPackBlock, [&](size_t p) { body(packs[p]); });
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

  rows_.assign(8 * (movers_.size() + 1), 0);
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
}

template <class T>
void Solver<T>::choose_sprung(const Pairs& pairs) {
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
  const auto held = [&](uint32_t row) { return row < moved_ && held_[row]; };
  for (JointRow<T>& j : joints_) {
    if (!alone(j) || held(j.a) || held(j.b) || !(j.spring.half > 0)) {
      j.spring.half = 0;
    } else {
      sprung_[j.a] = sprung_[j.b] = 1;
    }
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
void Solver<T>::start_parting(T push_out_speed) {
  std::copy(rows_.begin(), rows_.end(), start_.begin());
  std::fill(parts_.begin(), parts_.end(), uint8_t{0});
  if (!knows_islands_) find_islands();
  const uint32_t packs = contact_colours_.empty() ? 0 : contact_colours_.back();
  const auto island = [&](const ContactPack<T>& c, int k) {
    const uint32_t body = std::min(c.a[k], c.b[k]);
    return body < moved_ ? island_[body] : kNoPoint;
  };
  for (uint32_t p = 0; p < packs; ++p) {
    ContactPack<T>& c = contacts_[p];
    remember_impulses(c);
    Wide<T> separation[2];
    separations(c, Ends<T>(rows_.data(), c.a, c.b), separation);
    const Wide<T> left = depth_left(c, separation, push_out_speed);
    if (!any_below(left, Wide<T>::zero())) continue;
    for (int k = 0; k < Wide<T>::kLanes; ++k) {
      const uint32_t i = island(c, k);
      if (i != kNoPoint && left[k] < 0) parts_[i] = 1;
    }
  }
  for (uint32_t p = 0; p < packs; ++p) {
    ContactPack<T>& c = contacts_[p];
    for (int k = 0; k < Wide<T>::kLanes; ++k) {
      const uint32_t i = island(c, k);
      c.before.taken.set(k, i != kNoPoint && parts_[i] ? T(1) : T(0));
    }
  }
}

template <class T>
void Solver<T>::small_step(const SolverSettings& settings, const ThreadArena& arena) {
  const T h = static_cast<T>(settings.h), inverse_h = static_cast<T>(1 / settings.h);
  const T push_out_speed = static_cast<T>(settings.push_out_speed);
  const SoftConstraint<T> soft{static_cast<T>(settings.joint.bias_rate),
                               static_cast<T>(settings.joint.mass_scale),
                               static_cast<T>(settings.joint.impulse_scale)};
  T* rows = rows_.data();
  const uint32_t moved = moved_;
  arena.for_blocks(movers_.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const T* p = push_.data() + 8 * i;
      T* r = rows + 8 * i;
      r[0] = (r[0] + p[0]) * p[3], r[1] = (r[1] + p[1]) * p[3], r[2] = (r[2] + p[2]) * p[4];
    }
  });
  // Before warm starting: impacts use the actual velocities of the bodies.
  if (bounces_) hit_contacts(settings, arena);
  for (JointRow<T>& j : joints_) solve_joint(j, rows, moved, JointPass::warm, h);
  each_colour(arena, hinges_, hinge_colours_, [&](HingePack<T>& p) { warm_start(p, rows, moved); });
  each_colour(arena, contacts_, contact_colours_, [&](ContactPack<T>& p) { warm_start(p, rows, moved); });

  const bool parts = deep_.exchange(false);
  if (parts) start_parting(push_out_speed);
  const T* start = parts ? start_.data() : nullptr;
  for (JointRow<T>& j : joints_) {
    if (j.joint->has_spring) solve_joint(j, rows, moved, JointPass::pull, h);
  }
  for (JointRow<T>& j : joints_) {
    if (!j.joint->spring_only()) solve_joint(j, rows, moved, JointPass::bias, h);
  }
  each_colour(arena, hinges_, hinge_colours_,
              [&](HingePack<T>& p) { solve_hinges<Pass::bias>(p, rows, moved, soft, h); });
  // Pushes that are taken back begin anew in every small step: what must lift a heavy body through a light
  // one needs several sweeps.
  for (int i = 0; i < (parts ? settings.push_sweeps : 1); ++i) {
    each_colour_back(arena, contacts_, contact_colours_, [&](ContactPack<T>& p) {
      solve_contacts<Pass::bias>(p, rows, moved, inverse_h, push_out_speed, start);
    });
  }

  arena.for_blocks(movers_.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      T* r = rows + 8 * i;
      r[4] += h * r[0], r[5] += h * r[1], r[6] += h * r[2];
      if (bounces_) {
        for (int k = 0; k < 3; ++k) r[4 + k] += toi_correction_[8 * i + static_cast<size_t>(k)];
      }
    }
  });

  if (parts) {
    each_colour(arena, contacts_, contact_colours_,
                [&](ContactPack<T>& p) { take_push_back(p, rows, moved); });
  }
  for (JointRow<T>& j : joints_) solve_joint(j, rows, moved, JointPass::relax, h);
  each_colour(arena, hinges_, hinge_colours_,
              [&](HingePack<T>& p) { solve_hinges<Pass::relax>(p, rows, moved, soft, h); });
  each_colour_back(arena, contacts_, contact_colours_, [&](ContactPack<T>& p) {
    if (solve_contacts<Pass::relax>(p, rows, moved, inverse_h, push_out_speed, start)) deep_ = true;
  });
}

template <class T>
void Solver<T>::store_bodies(State& state, double dt, const ThreadArena& arena) const {
  double* x = state.f64(columns::position).data();
  double* v = state.f64(columns::velocity).data();
  const auto w = state.f64(columns::angular_velocity), angle = state.f64(columns::angle);
  arena.for_blocks(movers_.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t body = movers_[i];
      const T* r = rows_.data() + 8 * i;
      if (i < moved_) {
        v[3 * body] = r[0], v[3 * body + 1] = r[1], w[body] = r[2];
        x[3 * body] += static_cast<double>(r[4]), x[3 * body + 1] += static_cast<double>(r[5]);
        angle[body] += static_cast<double>(r[6]);
      } else {
        // A kinematic body moves exactly at its velocity.
        x[3 * body] += dt * v[3 * body], x[3 * body + 1] += dt * v[3 * body + 1], angle[body] += dt * w[body];
      }
    }
  });
}

template <class T>
void Solver<T>::store_joints(const Model& model, State& state, Hands& hands,
                             const SolverSettings& settings) const {
  const auto impulses = state.f64(columns::joint_impulse);
  const auto broken = state.span<uint32_t>(columns::joint_broken);
  const auto store = [&](uint32_t i, std::span<const double, 6> p) {
    double most = 0;
    for (size_t k = 0; k < 6; ++k) impulses[6 * i + k] = p[k];
    most = std::sqrt(p[0] * p[0] + p[1] * p[1]);
    if (!model.may_break) return;
    const Joint& d = model.joints[i];
    // A distance joint carries a force along one direction only; others hold two points.
    if (d.kind == JointKind::distance) most = std::abs(p[0] + p[5] + p[3] - p[4]);
    if (d.break_force > 0 && most > d.break_force * settings.h) {
      broken[i] = 1;
      for (size_t k = 0; k < 6; ++k) impulses[6 * i + k] = 0;
    }
  };
  for (const HingePack<T>& p : hinges_) {
    for (int k = 0; k < Wide<T>::kLanes; ++k) {
      if (p.joint[k] == kNoPoint) continue;
      store(p.joint[k], std::array<double, 6>{p.ix[k], p.iy[k], 0, 0, 0, 0});
    }
  }
  const size_t own = joints_.size() - drags_;
  for (size_t i = 0; i < own; ++i) {
    std::array<double, 6> p;
    std::copy(joints_[i].impulse, joints_[i].impulse + 6, p.begin());
    store(joints_[i].index, p);
  }
  for (size_t i = 0; i < drags_; ++i) {
    hands.drags[i].impulse = {joints_[own + i].impulse[0], joints_[own + i].impulse[1]};
  }
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
    start_contacts(pairs, settings.h);
  }
  for (JointRow<T>& j : joints_) {
    solve_joint(j, rows_.data(), moved_, JointPass::soften, h);
  }
  knows_islands_ = false;
  choose_sprung(pairs);
  if (springs_) kick(JointPass::unkick, h);
  deep_ = false;
  for (uint32_t p = 0; p < packs; ++p) {
    const Wide<T> separation[2] = {contacts_[p].point[0].separation, contacts_[p].point[1].separation};
    const Wide<T> left = depth_left(contacts_[p], separation, static_cast<T>(settings.push_out_speed));
    if (any_below(left, Wide<T>::zero())) deep_ = true;
  }
  for (int i = 0; i < settings.steps; ++i) small_step(settings, arena);
  if (springs_) kick(JointPass::kick, h);
  store_bodies(state, settings.h * settings.steps, arena);
  store_joints(model, state, hands, settings);
}

template <class T>
void Solver<T>::store_contacts(const Model& model, const Pairs& pairs, const PenetrationOffsetRule& rule,
                               State& state) {
  const auto ids = state.span<uint32_t>(columns::contact_id);
  const auto impulses = state.span<float>(columns::contact_impulse);
  old_id_.assign(ids.begin(), ids.end());
  old_impulse_.assign(impulses.begin(), impulses.end());
  const auto offsets = state.span<float>(columns::contact_offset);
  old_offset_.assign(offsets.begin(), offsets.end());
  size_t count = 0;
  for (const Hit& h : pairs.hits) count += h.what >= Hit::What::touching;
  for (const auto c :
       {columns::contact_key, columns::contact_id, columns::contact_impulse, columns::contact_offset}) {
    state.resize(c, count);
  }
  uint64_t* key = state.span<uint64_t>(columns::contact_key).data();
  uint32_t* id = state.span<uint32_t>(columns::contact_id).data();
  float* impulse = state.span<float>(columns::contact_impulse).data();
  float* offset = state.span<float>(columns::contact_offset).data();
  size_t next = 0;
  for (const Hit& h : pairs.hits) {
    if (h.what < Hit::What::touching) continue;
    *key++ = h.key();
    if (h.what == Hit::What::carried) {
      std::copy_n(old_id_.data() + 2 * h.old, 2, id);
      std::copy_n(old_impulse_.data() + 5 * static_cast<size_t>(h.old), 5, impulse);
      std::copy_n(old_offset_.data() + 2 * static_cast<size_t>(h.old), 2, offset);
    } else {
      const uint32_t place = place_[next++];
      const ContactPack<T>& c = contacts_[place / Wide<T>::kLanes];
      const auto k = static_cast<int>(place % Wide<T>::kLanes);
      const flat::Contact& contact = pairs.contacts[static_cast<size_t>(&h - pairs.hits.data())];
      double load = 0, depth = 0;
      for (uint32_t i = 0; i < 2; ++i) {
        id[i] = i < contact.points ? contact.point[i].id : kNoPoint;
        impulse[i] = static_cast<float>(c.point[i].normal[k]);
        impulse[2 + i] = static_cast<float>(c.point[i].tangent[k]);
        if (i < contact.points) {
          load += c.point[i].normal[k], depth -= c.point[i].normal[k] * contact.point[i].separation;
        }
      }
      impulse[4] = static_cast<float>(c.rolling_impulse[k]);
      const double mobility =
          rows_[8 * static_cast<size_t>(c.a[k]) + 3] + rows_[8 * static_cast<size_t>(c.b[k]) + 3];
      double before[2] = {}, largest = 0;
      for (uint32_t i = 0; i < 2; ++i) {
        const uint32_t at = std::min(i, contact.points - 1);
        before[i] = contact.point[at].separation - static_cast<double>(c.point[at].separation[k]);
        largest = std::max({largest, std::abs(contact.point[at].separation), before[i]});
      }
      // Offsets that differ by no more than the rounding of separations are treated as one.
      if (std::abs(before[1] - before[0]) <= 0x1p-22 * largest) before[1] = before[0];
      const double yields = (1 - c.mass_scale[k]) / (c.mass_scale[k] * c.bias_rate[k]);  // m per m/s of load
      const auto inner = [&](uint32_t row) {
        return row < moved_ ? model.light[movers_[row]].inner : HUGE_VAL;
      };
      const PenetrationOffsetRule own{rule.learnt, kMostOffset * yields, rule.slack,
                                      kThickestLearnt * std::min(inner(c.a[k]), inner(c.b[k]))};
      offset[0] = offset[1] = 0;
      if (load > 0) {
        const double first = impulse[0] / load;
        const double mean = before[0] == before[1] ? before[0] : first * before[0] + (1 - first) * before[1];
        const double next = next_penetration_offset(mean, depth / load, load * mobility, own);
        for (int i = 0; i < 2; ++i) {
          offset[i] = static_cast<float>(before[i] == mean ? next : std::max(before[i] + next - mean, 0.0));
        }
      }
    }
    id += 2, impulse += 5, offset += 2;
  }
}

template class Solver<float>;
template class Solver<double>;

}  // namespace truestep::rigid2d
