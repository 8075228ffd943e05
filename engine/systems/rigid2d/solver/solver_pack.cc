// Packs the constraints of a step into SIMD lanes: contacts, hinges and other joints.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/collision/flat/foreseen_contact.h"
#include "engine/math/trig.h"
#include "engine/systems/rigid2d/solver/solver_contact.h"

namespace truestep::rigid2d {
namespace {

constexpr size_t kPacksAhead = 2;
/// rad, or typical sizes: smaller motion within half a step is ignored: it is what single precision leaves of
/// rest.
constexpr double kSeenMotion = 1e-6;
/// rad, or typical sizes: larger motion tells little of where a load will act.
constexpr double kMostMotion = 0.05;

/// First pack of `lanes` of each colour, and the end; remainders become packs of one.
void pack_colours(std::span<const uint32_t, kColours + 1> count, uint32_t lanes,
                  std::vector<uint32_t>& colours) {
  colours.assign(1, 0);
  uint32_t packs = 0;
  for (uint32_t c = 0; c < kColours && count[c] > 0; ++c) {
    packs += (count[c] + lanes - 1) / lanes;
    colours.push_back(packs);
  }
  for (uint32_t k = 0; k < count[kColours]; ++k) colours.push_back(++packs);
}

}  // namespace

template <class T>
void Solver<T>::fill(ContactPack<T>& c, const uint32_t* hits, int count, const Model& model,
                     const State& state, const Pairs& pairs, const SolverSettings& settings) {
  using W = Wide<T>;
  std::memset(&c, 0, sizeof c);
  const auto still = static_cast<uint32_t>(movers_.size());
  for (int k = 0; k < W::kLanes; ++k) c.a[k] = c.b[k] = still;
  const auto ids = state.span<uint32_t>(columns::contact_id);
  const auto impulses = state.span<float>(columns::contact_impulse),
             offsets = state.span<float>(columns::contact_offset);
  const auto t = [](double x) { return static_cast<T>(x); };
  W there[2] = {W::zero(), W::zero()};  // 1 where a lane has this point
  flat::Contact foreseen;
  Place place[W::kLanes];
  const double ahead = 0.5 * (settings.steps - 1) * settings.h;
  const double* w = state.f64(columns::angular_velocity).data();
  const double least_spin = kSeenMotion / ahead, least_speed = least_spin * model.size;
  for (int k = 0; k < count; ++k) {
    const uint32_t index = pairs.touching[hits[k]];
    const Hit& hit = pairs.hits[index];
    const flat::Contact* at_start = &pairs.contacts[index];
    const Surface &a = model.surfaces[hit.body_a], &b = model.surfaces[hit.body_b];
    c.a[k] = slot_[hit.body_a], c.b[k] = slot_[hit.body_b];
    double foreseen_by = 0;  // s
    const Vec2 apart_at_start = pairs.pose[hit.body_b].p - pairs.pose[hit.body_a].p;
    Vec2 apart = apart_at_start;
    const float* old = hit.old == kNoPoint ? nullptr : impulses.data() + 5 * static_cast<size_t>(hit.old);
    const Met* met = pairs.met.empty() ? nullptr : meeting(pairs, hit.key());
    if (met) apart = met->apart;
    // A loaded contact stays loaded: its load acts where it will be, averaged over the substeps.
    if (!met && old && old[0] + old[1] > 0) {
      const auto motion = [&](uint32_t row) {
        const T* r = rows_.data() + 8 * static_cast<size_t>(row);
        return flat::PlaneMotion{{r[0], r[1]}, r[2]};
      };
      const flat::PlaneMotion of_a = motion(c.a[k]), of_b = motion(c.b[k]);
      // Seen from what turns and carries the other, where that goes round with it.
      double frame = carried_.empty() ? 0 : carries(c.a[k], c.b[k], w[hit.body_a], w[hit.body_b]);
      Vec2 passing = of_b.velocity - of_a.velocity;
      const Vec2 there = passing - frame * flat::left_of(apart);
      if (flat::dot(there, there) < flat::dot(passing, passing)) {
        passing = there;
      } else {
        frame = 0;
      }
      const double spin = std::max(std::abs(of_a.spin), std::abs(of_b.spin));
      if (spin > least_spin || flat::dot(passing, passing) > least_speed * least_speed) {
        const double way = std::max({std::abs(of_a.spin - frame), std::abs(of_b.spin - frame),
                                     flat::norm(passing) / model.size, 1e-30});
        foreseen = *at_start, at_start = &foreseen;
        const double by = std::min(ahead, kMostMotion / way), ra = model.radius[hit.a],
                     rb = model.radius[hit.b];
        foreseen_by = frame == 0 ? flat::foresee(foreseen, apart, of_a, of_b, ra, rb, by)
                                 : flat::foresee_turning(foreseen, apart, of_a, of_b, ra, rb, by, frame);
      }
    }
    const flat::Contact& contact = *at_start;
    const Vec2 n = contact.normal;
    c.nx.set(k, t(n.x)), c.ny.set(k, t(n.y));
    c.round_a.set(k, t(model.radius[hit.a]));
    c.round_b.set(k, t(model.radius[hit.b]));
    c.friction.set(k, t(a.friction == b.friction ? a.friction : std::sqrt(a.friction * b.friction)));
    c.surface_speed.set(k, t(-(a.speed + b.speed)));
    const double bounces = std::max(a.restitution, b.restitution);
    c.restitution.set(k, t(bounces));
    if (bounces > 0) c.bounces = 1;
    const size_t crowd = std::min<size_t>(kCrowd, std::max(crowd_[c.a[k]], crowd_[c.b[k]]));
    const SoftConstraint<double>& soft =
        (c.a[k] < moved_ && c.b[k] < moved_ ? settings.contact : settings.contact_fixed)[crowd];
    c.bias_rate.set(k, t(soft.bias_rate)), c.mass_scale.set(k, t(soft.mass_scale));
    c.impulse_scale.set(k, t(soft.impulse_scale));
    const double rolling = std::max(a.rolling_resistance, b.rolling_resistance);
    const uint32_t* id = hit.old == kNoPoint ? nullptr : ids.data() + 2 * hit.old;
    const float* old_offsets =
        hit.old == kNoPoint ? nullptr : offsets.data() + 2 * static_cast<size_t>(hit.old);
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
      there[i].set(k, 1);
      double offset = old_offsets ? 0.5 * (double(old_offsets[0]) + double(old_offsets[1])) : 0;
      for (uint32_t m = 0; m < 2 && id; ++m) {
        if (id[m] != at.id) continue;
        p.normal.set(k, old[m]), p.tangent.set(k, old[2 + m]);
        offset = old_offsets[m];
      }
      p.separation.set(k, t(at.separation - offset));
    }
    if (!carried_.empty()) place[k] = {hit.body_a, hit.body_b, apart_at_start, apart, foreseen_by};
  }
  weigh(c, Ends<T>(rows_.data(), c.a, c.b), there);
  if (carried_.empty()) return;
  CarriedPack<T>& carried = carried_[static_cast<size_t>(&c - contacts_.data())];
  std::memset(&carried, 0, sizeof carried);
  for (int k = 0; k < count; ++k) {
    const Hit& hit = pairs.hits[pairs.touching[hits[k]]];
    if (carries(c.a[k], c.b[k], w[hit.body_a], w[hit.body_b]) == 0) continue;
    c.turns = 1, carry(c, k, model, state, place[k], settings.h * settings.steps, carried);
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
  crowd_.assign(movers_.size() + 1, 0);
  for (size_t i = 0; i < n; ++i) {
    const Hit& h = pairs.hits[pairs.touching[i]];
    ends_[i] = {end(h.body_a), end(h.body_b)};
    for (const uint32_t row : ends_[i]) {
      if (row != kNoBody) ++crowd_[row];
    }
  }
  std::array<uint32_t, kColours + 1> count;
  colour_constraints(ends_, used_, colour_, count);
  sort_by_colour(colour_, count, order_);
  pack_colours(count, kLanes, contact_colours_);
  const uint32_t packs = contact_colours_.empty() ? 0 : contact_colours_.back();
  if (contacts_.size() < packs) contacts_.resize(packs);
  carried_.resize(find_driven(model, state) ? packs : 0);
  // Every colour starts a new pack: position in the order at which the hits of each pack begin.
  std::vector<uint32_t>& first = hinge_list_;
  first.clear();
  uint32_t at = 0;
  for (uint32_t c = 0; c <= kColours; ++c) {
    const uint32_t lanes = c < kColours ? kLanes : 1;
    for (uint32_t k = 0; k < count[c]; k += lanes) first.push_back(at + k);
    at += count[c];
  }
  first.push_back(at);
  arena.for_blocks(packs, kPacksPerTask, [&](size_t begin, size_t finish) {
    for (size_t p = begin; p < finish; ++p) {
      const auto lanes = static_cast<int>(first[p + 1] - first[p]);
      for (int k = 0; k < lanes; ++k) {
        place_[order_[first[p] + static_cast<uint32_t>(k)]] =
            static_cast<uint32_t>(p) * kLanes + static_cast<uint32_t>(k);
      }
      // Contacts of a colour are far apart in memory: those of the pack after the next are prefetched.
      if (p + kPacksAhead + 1 < first.size()) {
        for (uint32_t k = first[p + kPacksAhead]; k < first[p + kPacksAhead + 1]; ++k) {
          const uint32_t index = pairs.touching[order_[k]];
          __builtin_prefetch(&pairs.hits[index]);
          __builtin_prefetch(&pairs.contacts[index]);
          __builtin_prefetch(reinterpret_cast<const char*>(&pairs.contacts[index]) + 64);
        }
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
  const auto t = [](double x) { return static_cast<T>(x); };
  Motor motor;
  if (d.motor_row != kNoMotor) motor = motor_of(state, d);
  Vec2 local_a = d.local_a, velocity;
  if (d.kind == JointKind::motor) {
    if (d.at_velocity) {
      velocity = a.q * motor.wanted;
    } else {
      local_a = local_a + (motor.wanted - d.move);
    }
  }
  j.wanted = t(motor.wanted.x), j.most = t(motor.most), j.spin = t(motor.turn);
  j.most_turn = t(motor.most_turn), j.wx = t(velocity.x), j.wy = t(velocity.y);
  const Vec2 ra = a.q * local_a, rb = b.q * d.local_b, u = a.q * d.axis;
  Vec2 e = (b.p - a.p) + rb - ra;
  // A drag has no row of its own.
  if (d.kind == JointKind::mouse) e = b.p + rb - (d.motor_row == kNoMotor ? d.ground_a : motor.wanted);
  j.ax = t(ra.x), j.ay = t(ra.y), j.bx = t(rb.x), j.by = t(rb.y), j.ex = t(e.x), j.ey = t(e.y);
  j.ux = t(u.x), j.uy = t(u.y);
  const Vec2 ga = a.p + ra - d.ground_a, gb = b.p + rb - d.ground_b;
  j.gax = t(ga.x), j.gay = t(ga.y), j.gbx = t(gb.x), j.gby = t(gb.y);
  const auto angles = state.f64(columns::angle);
  const auto angle = [&](uint32_t i) { return i < angles.size() ? angles[i] : 0.0; };
  j.angle = t(d.kind == JointKind::gear ? angle(d.a) + d.ratio * angle(d.b) - d.angle
                                        : angle(d.b) - angle(d.a) - d.angle);
  if (d.kind == JointKind::motor && !d.at_spin) j.angle -= t(motor.turn - d.turn);
  const SoftConstraint<double>& soft = settings.joint;
  const bool servos = d.has_target || d.kind == JointKind::motor;
  const SoftConstraint<double> servo =
      servos ? rigid_constraint(1 - trig::exp(-d.motor_rate * settings.h), settings.h)
             : soft_constraint(d.hertz, d.damping_ratio, settings.h);
  j.soft = {t(soft.bias_rate), t(soft.mass_scale), t(soft.impulse_scale)};
  j.servo = {t(servo.bias_rate), t(servo.mass_scale), t(servo.impulse_scale)};
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
  pack_colours(count, kLanes, hinge_colours_);
  hinges_.resize(hinge_colours_.empty() ? 0 : hinge_colours_.back());
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

template void Solver<float>::pack_contacts(const Model&, const State&, const Pairs&, const SolverSettings&,
                                           const ThreadArena&);
template void Solver<double>::pack_contacts(const Model&, const State&, const Pairs&, const SolverSettings&,
                                            const ThreadArena&);
template void Solver<float>::pack_joints(const Model&, const State&, const Pairs&, const Hands&,
                                         const SolverSettings&);
template void Solver<double>::pack_joints(const Model&, const State&, const Pairs&, const Hands&,
                                          const SolverSettings&);

}  // namespace truestep::rigid2d
