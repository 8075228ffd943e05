#include "engine/systems/rigid2d/solver.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "engine/systems/rigid2d/solver_impact.h"

namespace truestep::rigid2d {
namespace {

using flat::cross;
using flat::dot;

constexpr size_t kBlock = 1024;    // bodies a task
constexpr size_t kPackBlock = 64;  // packs a task
/// Impacts may run to and fro between bodies that often in a small step; what is left does not bounce.
constexpr int kImpactRounds = 64;

/// body(pack) for all packs, colour after colour; those of a colour side by side.
template <class Packs, class Body>
void each_colour(const ThreadArena& arena, Packs& packs, const std::vector<uint32_t>& ends, Body&& body) {
  uint32_t begin = 0;
  for (const uint32_t end : ends) {
    arena.for_blocks(end - begin, kPackBlock, [&](size_t from, size_t to) {
      for (size_t i = begin + from; i < begin + to; ++i) body(packs[i]);
    });
    begin = end;
  }
}

/// The same from the last colour to the first: contacts with what does not move tend to have the first
/// colours, and shall have the last word.
template <class Packs, class Body>
void each_colour_back(const ThreadArena& arena, Packs& packs, const std::vector<uint32_t>& ends,
                      Body&& body) {
  for (size_t c = ends.size(); c-- > 0;) {
    const uint32_t begin = c > 0 ? ends[c - 1] : 0;
    arena.for_blocks(ends[c] - begin, kPackBlock, [&](size_t from, size_t to) {
      for (size_t i = begin + from; i < begin + to; ++i) body(packs[i]);
    });
  }
}

/// Where each colour's packs of `lanes` end; what was left over makes packs of one.
void pack_ends(std::span<const uint32_t, kColours + 1> count, uint32_t lanes, std::vector<uint32_t>& ends) {
  ends.clear();
  uint32_t packs = 0;
  for (uint32_t c = 0; c < kColours && count[c] > 0; ++c) {
    packs += (count[c] + lanes - 1) / lanes;
    ends.push_back(packs);
  }
  for (uint32_t k = 0; k < count[kColours]; ++k) ends.push_back(++packs);
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
void Solver<T>::fill(ContactPack<T>& c, const uint32_t* hits, int count, const Model& model,
                     const State& state, const Pairs& pairs, const SolverSettings& settings) const {
  using W = Wide<T>;
  std::memset(&c, 0, sizeof c);
  const auto still = static_cast<uint32_t>(movers_.size());
  for (int k = 0; k < W::kLanes; ++k) c.a[k] = c.b[k] = still;
  const auto ids = state.span<uint32_t>(columns::contact_id);
  const auto impulses = state.span<float>(columns::contact_impulse),
             pads = state.span<float>(columns::contact_pad);
  const auto t = [](double x) { return static_cast<T>(x); };
  const SoftConstraint<T> between{t(settings.contact.bias_rate), t(settings.contact.mass_scale),
                                  t(settings.contact.impulse_scale)};
  const SoftConstraint<T> fixed{t(settings.contact_fixed.bias_rate), t(settings.contact_fixed.mass_scale),
                                t(settings.contact_fixed.impulse_scale)};
  W there[2] = {W::zero(), W::zero()};  // 1 where a lane has that point
  for (int k = 0; k < count; ++k) {
    const uint32_t index = pairs.touching[hits[k]];
    const Hit& hit = pairs.hits[index];
    const flat::Contact& contact = pairs.contacts[index];
    const Surface &a = model.surfaces[hit.body_a], &b = model.surfaces[hit.body_b];
    c.a[k] = slot_[hit.body_a], c.b[k] = slot_[hit.body_b];
    const Vec2 n = contact.normal, apart = pairs.pose[hit.body_b].p - pairs.pose[hit.body_a].p;
    c.nx.set(k, t(n.x)), c.ny.set(k, t(n.y));
    c.friction.set(k, t(a.friction == b.friction ? a.friction : std::sqrt(a.friction * b.friction)));
    c.surface_speed.set(k, t(-(a.speed + b.speed)));
    const double bounces = std::max(a.restitution, b.restitution);
    c.restitution.set(k, t(bounces));
    if (bounces > 0) c.bounces = 1;
    const SoftConstraint<T>& soft = c.a[k] < moved_ && c.b[k] < moved_ ? between : fixed;
    c.bias_rate.set(k, soft.bias_rate), c.mass_scale.set(k, soft.mass_scale);
    c.impulse_scale.set(k, soft.impulse_scale);
    const double pad = hit.old == kNoPoint ? 0 : pads[hit.old];
    const double rolling = std::max(a.rolling_resistance, b.rolling_resistance);
    const uint32_t* id = hit.old == kNoPoint ? nullptr : ids.data() + 2 * hit.old;
    const float* old = hit.old == kNoPoint ? nullptr : impulses.data() + 5 * static_cast<size_t>(hit.old);
    if (rolling > 0) {
      c.rolls = 1;
      c.rolling.set(k, t(rolling));
      if (old) c.rolling_impulse.set(k, old[4]);
    }
    for (uint32_t i = 0; i < contact.points; ++i) {
      const flat::ContactPoint& at = contact.point[i];
      auto& p = c.point[i];
      const Vec2 rb = at.at - apart;
      p.ax.set(k, t(at.at.x)), p.ay.set(k, t(at.at.y)), p.bx.set(k, t(rb.x)), p.by.set(k, t(rb.y));
      p.separation.set(k, t(at.separation - pad));
      there[i].set(k, 1);
      for (uint32_t m = 0; m < 2 && id; ++m) {
        if (id[m] == at.id) p.normal.set(k, old[m]), p.tangent.set(k, old[2 + m]);
      }
    }
  }
  // The rest side by side: masses and approach speeds from the bodies' rows.
  const Ends<T> e(rows_.data(), c.a, c.b);
  const W zero = W::zero(), one = W::all(1), m = e.a[3] + e.b[3];
  W arm_a[2], arm_b[2], k[2];
  for (int i = 0; i < 2; ++i) {
    auto& p = c.point[i];
    arm_a[i] = nmadd(p.ay, c.nx, p.ax * c.ny), arm_b[i] = nmadd(p.by, c.nx, p.bx * c.ny);
    const W ta = madd(p.ax, c.nx, p.ay * c.ny), tb = madd(p.bx, c.nx, p.by * c.ny);
    k[i] = madd(e.a[7] * arm_a[i], arm_a[i], madd(e.b[7] * arm_b[i], arm_b[i], m));
    const W kt = madd(e.a[7] * ta, ta, madd(e.b[7] * tb, tb, m));
    p.normal_mass = select(there[i] > zero, one / k[i], zero);
    p.tangent_mass = select(there[i] > zero, one / kt, zero);
  }
  c.stiffness0 = k[0] * there[0], c.stiffness1 = k[1] * there[1];
  c.coupling = there[1] * madd(e.a[7] * arm_a[0], arm_a[1], madd(e.b[7] * arm_b[0], arm_b[1], m));
  // Points that feel each other fully (bodies that do not turn) leave K without an inverse: taken as a little
  // apart, they share the load.
  const W all = c.stiffness0 * c.stiffness1;
  c.held = select(c.coupling * c.coupling > W::all(T(0.99)) * all, W::all(T(0.995)) * sqrt(all), c.coupling);
  if (c.rolls) {
    const W turning = e.a[7] + e.b[7];
    c.rolling_mass = select(turning > zero, one / turning, zero);
  }
}

template <class T>
void Solver<T>::pack_contacts(const Model& model, const State& state, const Pairs& pairs,
                              const SolverSettings& settings, const ThreadArena& arena) {
  constexpr uint32_t kLanes = Wide<T>::kLanes;
  const size_t n = pairs.touching.size();
  ends_.resize(n), colour_.resize(n), order_.resize(n), place_.resize(n);
  used_.resize(movers_.size() + 1);
  const auto end = [&](uint32_t body) { return slot_[body] < moved_ ? slot_[body] : kNoBody; };
  for (size_t i = 0; i < n; ++i) {
    const Hit& h = pairs.hits[pairs.touching[i]];
    ends_[i] = {end(h.body_a), end(h.body_b)};
  }
  std::array<uint32_t, kColours + 1> count;
  colour_constraints(ends_, used_, colour_, count);
  sort_by_colour(colour_, count, order_);
  pack_ends(count, kLanes, contact_end_);
  const uint32_t packs = contact_end_.empty() ? 0 : contact_end_.back();
  if (contacts_.size() < packs) contacts_.resize(packs);
  // Every colour starts a new pack: where a pack's hits begin in the order.
  std::vector<uint32_t>& first = hinge_list_;
  first.clear();
  uint32_t at = 0;
  for (uint32_t c = 0; c <= kColours; ++c) {
    const uint32_t lanes = c < kColours ? kLanes : 1;
    for (uint32_t k = 0; k < count[c]; k += lanes) first.push_back(at + k);
    at += count[c];
  }
  first.push_back(at);
  arena.for_blocks(packs, kPackBlock, [&](size_t begin, size_t finish) {
    for (size_t p = begin; p < finish; ++p) {
      const auto lanes = static_cast<int>(first[p + 1] - first[p]);
      for (int k = 0; k < lanes; ++k) {
        place_[order_[first[p] + static_cast<uint32_t>(k)]] =
            static_cast<uint32_t>(p) * kLanes + static_cast<uint32_t>(k);
      }
      fill(contacts_[p], order_.data() + first[p], lanes, model, state, pairs, settings);
    }
  });
}

template <class T>
JointRow<T> Solver<T>::row_of(const Joint& d, const Pairs& pairs, const SolverSettings& settings,
                              const State& state) const {
  JointRow<T> j;
  j.joint = &d;
  j.a = slot_[d.a], j.b = slot_[d.b];
  const Pose &a = pairs.pose[d.a], &b = pairs.pose[d.b];
  const Vec2 ra = a.q * d.local_a, rb = b.q * d.local_b, u = a.q * d.axis;
  Vec2 e = (b.p - a.p) + rb - ra;
  if (d.kind == JointKind::mouse) e = b.p + rb - d.ground_a;
  const auto t = [](double x) { return static_cast<T>(x); };
  j.ax = t(ra.x), j.ay = t(ra.y), j.bx = t(rb.x), j.by = t(rb.y), j.ex = t(e.x), j.ey = t(e.y);
  j.ux = t(u.x), j.uy = t(u.y);
  const Vec2 ga = a.p + ra - d.ground_a, gb = b.p + rb - d.ground_b;
  j.gax = t(ga.x), j.gay = t(ga.y), j.gbx = t(gb.x), j.gby = t(gb.y);
  const auto angles = state.f64(columns::angle);
  const auto angle = [&](uint32_t i) { return i < angles.size() ? angles[i] : 0.0; };
  j.angle = t(d.kind == JointKind::gear ? angle(d.a) + d.ratio * angle(d.b) - d.angle
                                        : angle(d.b) - angle(d.a) - d.angle);
  const SoftConstraint<double>& soft = settings.joint;
  const SoftConstraint<double> spring = d.kind == JointKind::motor
                                            ? rigid_constraint(d.correction, settings.h * settings.steps)
                                            : soft_constraint(d.hertz, d.damping_ratio, settings.h);
  j.soft = {t(soft.bias_rate), t(soft.mass_scale), t(soft.impulse_scale)};
  j.spring = {t(spring.bias_rate), t(spring.mass_scale), t(spring.impulse_scale)};
  return j;
}

template <class T>
void Solver<T>::pack_joints(const Model& model, const State& state, const Pairs& pairs, const Hands& hands,
                            const SolverSettings& settings) {
  constexpr uint32_t kLanes = Wide<T>::kLanes;
  const auto broken = state.span<uint32_t>(columns::joint_broken);
  const auto impulses = state.f64(columns::joint_impulse);
  joints_.clear(), hinge_list_.clear(), ends_.clear();
  const auto end = [&](uint32_t body) { return slot_[body] < moved_ ? slot_[body] : kNoBody; };
  for (uint32_t i = 0; i < model.hinges.size(); ++i) {
    const Hinge& d = model.hinges[i];
    const uint32_t a = end(d.a), b = end(d.b);
    if ((a == kNoBody && b == kNoBody) || broken[d.joint]) continue;
    hinge_list_.push_back(i), ends_.push_back({a, b});
  }
  for (const uint32_t i : model.others) {
    const Joint& d = model.joints[i];
    if (broken[i] || (slot_[d.a] >= moved_ && slot_[d.b] >= moved_)) continue;
    JointRow<T>& j = joints_.emplace_back(row_of(d, pairs, settings, state));
    j.index = i;
    for (int k = 0; k < 6; ++k) j.impulse[k] = static_cast<T>(impulses[6 * i + static_cast<size_t>(k)]);
  }
  for (const Hands::Drag& d : hands.drags) {
    JointRow<T>& j = joints_.emplace_back(row_of(d.joint, pairs, settings, state));
    j.index = kNoPoint;
    std::fill(j.impulse, j.impulse + 6, T(0));
    j.impulse[0] = static_cast<T>(d.impulse.x), j.impulse[1] = static_cast<T>(d.impulse.y);
  }
  drags_ = hands.drags.size();

  const size_t n = hinge_list_.size();
  colour_.resize(n), order_.resize(n), used_.resize(movers_.size() + 1);
  std::array<uint32_t, kColours + 1> count;
  colour_constraints(ends_, used_, colour_, count);
  sort_by_colour(colour_, count, order_);
  pack_ends(count, kLanes, hinge_end_);
  hinges_.resize(hinge_end_.empty() ? 0 : hinge_end_.back());
  const auto still = static_cast<uint32_t>(movers_.size());
  const auto t = [](double x) { return static_cast<T>(x); };
  size_t at = 0, pack = 0;
  for (uint32_t c = 0; c <= kColours; ++c) {
    const uint32_t lanes = c < kColours ? kLanes : 1;
    for (uint32_t k = 0; k < count[c]; k += lanes) {
      HingePack<T>& p = hinges_[pack++];
      std::memset(&p, 0, sizeof p);
      for (uint32_t i = 0; i < kLanes; ++i) p.a[i] = p.b[i] = still, p.joint[i] = kNoPoint;
      for (uint32_t i = 0; i < lanes && k + i < count[c]; ++i) {
        const Hinge& d = model.hinges[hinge_list_[order_[at++]]];
        const size_t index = d.joint;
        const Pose &a = pairs.pose[d.a], &b = pairs.pose[d.b];
        const Vec2 ra = a.q * d.local_a, rb = b.q * d.local_b, e = (b.p - a.p) + rb - ra;
        const auto lane = static_cast<int>(i);
        p.joint[i] = d.joint, p.a[i] = slot_[d.a], p.b[i] = slot_[d.b];
        p.ax.set(lane, t(ra.x)), p.ay.set(lane, t(ra.y)), p.bx.set(lane, t(rb.x)), p.by.set(lane, t(rb.y));
        p.ex.set(lane, t(e.x)), p.ey.set(lane, t(e.y));
        p.ix.set(lane, t(impulses[6 * index])), p.iy.set(lane, t(impulses[6 * index + 1]));
      }
    }
  }
}

template <class T>
void Solver<T>::hit_contacts(const SolverSettings& settings, const ThreadArena& arena) {
  late_.assign(rows_.size(), 0);
  const ImpactRows<T> bodies{rows_.data(), push_.data(), late_.data(), moved_};
  const T h = static_cast<T>(settings.h), threshold = static_cast<T>(settings.restitution_speed);
  std::atomic<bool> any = true;
  for (int round = 0; round < kImpactRounds && any; ++round) {
    any = false;
    each_colour(arena, contacts_, contact_end_, [&](const ContactPack<T>& p) {
      if (p.bounces && hit(p, bodies, h, threshold)) any = true;
    });
  }
}

template <class T>
void Solver<T>::small_step(const SolverSettings& settings, const ThreadArena& arena) {
  const T h = static_cast<T>(settings.h), inverse_h = static_cast<T>(1 / settings.h);
  const T push_speed = static_cast<T>(settings.push_speed);
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
  for (JointRow<T>& j : joints_) solve_joint(j, rows, moved, JointPass::warm, h);
  each_colour(arena, hinges_, hinge_end_, [&](HingePack<T>& p) { warm_start(p, rows, moved); });
  each_colour(arena, contacts_, contact_end_, [&](ContactPack<T>& p) { warm_start(p, rows, moved); });

  if (bounces_) hit_contacts(settings, arena);
  for (JointRow<T>& j : joints_) solve_joint(j, rows, moved, JointPass::bias, h);
  each_colour(arena, hinges_, hinge_end_,
              [&](HingePack<T>& p) { solve_hinges<Pass::bias>(p, rows, moved, soft); });
  each_colour_back(arena, contacts_, contact_end_, [&](ContactPack<T>& p) {
    solve_contacts<Pass::bias>(p, rows, moved, inverse_h, push_speed);
  });

  arena.for_blocks(movers_.size(), kBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      T* r = rows + 8 * i;
      r[4] += h * r[0], r[5] += h * r[1], r[6] += h * r[2];
      if (bounces_) {
        for (int k = 0; k < 3; ++k) r[4 + k] += late_[8 * i + static_cast<size_t>(k)];
      }
    }
  });

  for (JointRow<T>& j : joints_) solve_joint(j, rows, moved, JointPass::relax, h);
  each_colour(arena, hinges_, hinge_end_,
              [&](HingePack<T>& p) { solve_hinges<Pass::relax>(p, rows, moved, soft); });
  each_colour_back(arena, contacts_, contact_end_, [&](ContactPack<T>& p) {
    solve_contacts<Pass::relax>(p, rows, moved, inverse_h, push_speed);
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
        // What nothing can push goes exactly as it is told.
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
    // A distance joint carries along one direction only; others hold two points.
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
  place_bodies(model, state, pairs, hands, settings);
  pack_joints(model, state, pairs, hands, settings);
  pack_contacts(model, state, pairs, settings, arena);
  const uint32_t packs = contact_end_.empty() ? 0 : contact_end_.back();
  bounces_ =
      std::any_of(contacts_.begin(), contacts_.begin() + packs, [](const auto& p) { return p.bounces != 0; });
  for (int i = 0; i < settings.steps; ++i) small_step(settings, arena);
  store_bodies(state, settings.h * settings.steps, arena);
  store_joints(model, state, hands, settings);
}

template <class T>
void Solver<T>::store_contacts(const Pairs& pairs, const ContactPadding& padding, State& state) {
  const auto ids = state.span<uint32_t>(columns::contact_id);
  const auto impulses = state.span<float>(columns::contact_impulse);
  old_id_.assign(ids.begin(), ids.end());
  old_impulse_.assign(impulses.begin(), impulses.end());
  const auto pads = state.span<float>(columns::contact_pad);
  old_pad_.assign(pads.begin(), pads.end());
  size_t count = 0;
  for (const Hit& h : pairs.hits) count += h.what >= Hit::What::touching;
  for (const auto c :
       {columns::contact_key, columns::contact_id, columns::contact_impulse, columns::contact_pad}) {
    state.resize(c, count);
  }
  uint64_t* key = state.span<uint64_t>(columns::contact_key).data();
  uint32_t* id = state.span<uint32_t>(columns::contact_id).data();
  float* impulse = state.span<float>(columns::contact_impulse).data();
  float* pad = state.span<float>(columns::contact_pad).data();
  size_t next = 0;
  for (const Hit& h : pairs.hits) {
    if (h.what < Hit::What::touching) continue;
    *key++ = h.key();
    if (h.what == Hit::What::carried) {
      std::copy_n(old_id_.data() + 2 * h.old, 2, id);
      std::copy_n(old_impulse_.data() + 5 * static_cast<size_t>(h.old), 5, impulse);
      *pad = old_pad_[h.old];
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
      const double before = h.old == kNoPoint ? 0 : old_pad_[h.old];
      *pad = load > 0 ? static_cast<float>(next_pad(before, depth / load, load * mobility, padding)) : 0;
    }
    id += 2, impulse += 5, ++pad;
  }
}

template class Solver<float>;
template class Solver<double>;

}  // namespace truestep::rigid2d
