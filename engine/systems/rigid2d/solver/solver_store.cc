// What a step leaves in the state: poses, velocities and impulses, and the penetration offsets of contacts
// (engine/kernels/rigid/penetration_offset.h).
#include <algorithm>
#include <array>
#include <cmath>

#include "engine/rigid/free_flight.h"
#include "engine/systems/rigid2d/joint_loads.h"
#include "engine/systems/rigid2d/solver/solver.h"

namespace truestep::rigid2d {
namespace {

/// Fraction of the smaller body's inner radius up to which offsets grow; initial ones may be thicker. Of 24
/// heaps of 40 layers, which yield once grains are strained by some percent, 21 sleep within 10 s of coming
/// to rest with this bound, 13 with a hundredth and none without a bound.
constexpr double kThickestLearnt = 1.0 / 400;

}  // namespace

// The flight of a whole step (free_flight.h). Bodies with joints stay where these have put them: a pull that
// has not reached one of them yet must not separate it from its neighbour.
template <class T>
void Solver<T>::end_free_flights(const Model& model, const State& state, const SolverSettings& settings,
                                 const ThreadArena& arena) {
  const double* v = state.f64(columns::velocity).data();
  const auto w = state.f64(columns::angular_velocity);
  const T late = static_cast<T>(0.5 * settings.h);
  arena.for_blocks(moved_, kBodiesPerTask, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t body = movers_[i];
      if (model.light[body].jointed) continue;
      const T before[3] = {static_cast<T>(v[3 * body]), static_cast<T>(v[3 * body + 1]),
                           static_cast<T>(w[body])};
      T free[3] = {before[0], before[1], before[2]};
      for (int k = 0; k < settings.steps; ++k) act(push_.data() + 8 * i, free);
      T* r = rows_.data() + 8 * i;
      end_on_parabola<3>(r, free, before, late, r + 4);
    }
  });
}

template <class T>
void Solver<T>::store_bodies(State& state, double dt, const ThreadArena& arena) const {
  double* x = state.f64(columns::position).data();
  double* v = state.f64(columns::velocity).data();
  const auto w = state.f64(columns::angular_velocity), angle = state.f64(columns::angle);
  arena.for_blocks(movers_.size(), kBodiesPerTask, [&](size_t begin, size_t end) {
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
    for (size_t k = 0; k < 6; ++k) impulses[6 * i + k] = p[k];
    if (!model.may_break) return;
    const Joint& d = model.joints[i];
    const JointImpulse most = joint_impulse(d, p);
    if ((d.break_force > 0 && most.force > d.break_force * settings.h) ||
        (d.break_torque > 0 && most.torque > d.break_torque * settings.h)) {
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

template void Solver<float>::end_free_flights(const Model&, const State&, const SolverSettings&,
                                              const ThreadArena&);
template void Solver<double>::end_free_flights(const Model&, const State&, const SolverSettings&,
                                               const ThreadArena&);
template void Solver<float>::store_bodies(State&, double, const ThreadArena&) const;
template void Solver<double>::store_bodies(State&, double, const ThreadArena&) const;
template void Solver<float>::store_joints(const Model&, State&, Hands&, const SolverSettings&) const;
template void Solver<double>::store_joints(const Model&, State&, Hands&, const SolverSettings&) const;
template void Solver<float>::store_contacts(const Model&, const Pairs&, const PenetrationOffsetRule&, State&);
template void Solver<double>::store_contacts(const Model&, const Pairs&, const PenetrationOffsetRule&,
                                             State&);

}  // namespace truestep::rigid2d
