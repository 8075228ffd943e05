// Springs and motors of a step's joints: their coefficients, and springs that are the only action on their
// bodies, which begin and end a step with half an impulse (oscillator_step in soft_constraint.h).
#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"
#include "engine/systems/rigid3d/solver/solver_joint.h"

namespace truestep::rigid3d {

/// Coefficients of springs and motors for substeps of h, from the current effective masses.
template <class T>
void JointSolver<T>::soften(size_t group, const JointList& joints, double h) {
  JointGroup<T>& g = groups_[group];
  if (g.flags & JointGroup<T>::kBounded) {
    for (W& b : g.bound) b *= W(h);
  }
  if (g.drives == 0) return;
  for (int lane = 0; lane < W::kLanes; ++lane) {
    const uint32_t k = lanes_.member[group * W::kLanes + static_cast<size_t>(lane)];
    if (k == kNoBody) continue;
    const Joint& joint = joints.joints[k];
    for (uint32_t i = joint.first_drive; i < joint.first_drive + joint.drives; ++i) {
      const Drive& drive = joints.drives[i];
      JointDrive<T>& d = drive_of(g, drive.row);
      if (drive.laws & Drive::kSpring) {
        const double inverse_mass = d.k[lane];
        const OscillatorStep step =
            oscillator_step(drive.stiffness * inverse_mass, drive.damping * inverse_mass, h);
        d.spring.pull.set(lane, T(h * drive.stiffness * (1 - step.scale)));
        d.spring.scale.set(lane, T(step.scale));
      }
      if (drive.laws & Drive::kMotor) {
        // A servo moves at the speed that approaches its target at its rate, whatever its load.
        if (drive.wants == Drive::Wants::place) {
          d.motor.scale.set(lane, T(1));
          d.motor.push.set(lane, T((1 - trig::exp(-drive.servo_rate * h)) / h));
        }
        d.motor.most.set(lane, T(std::min(double(d.motor.most[lane]) * h, kAnyImpulse)));
      }
    }
  }
}

template <class T>
bool JointSolver<T>::has_springs(const JointList& joints) const {
  return std::any_of(listed_.begin(), listed_.end(),
                     [&](uint32_t k) { return joints.joints[k].springs_only; });
}

template <class T>
void JointSolver<T>::mark_held(const State& s, const JointList& joints, std::span<const uint32_t> slot,
                               std::span<uint8_t> held) const {
  const auto bodies = s.span<uint32_t>(columns::joint_bodies);
  for (const uint32_t k : listed_) {
    if (joints.joints[k].springs_only) continue;
    for (const uint32_t i : {bodies[2 * k], bodies[2 * k + 1]}) {
      if (i != kNoBody && slot[i] != kNoBody) held[slot[i]] = 1;
    }
  }
}

template <class T>
template <class Body>
void JointSolver<T>::each_loose(const JointList& joints, std::span<const uint8_t> held, Body&& body) {
  const auto loose = [&](uint32_t place) { return place == end_ || !held[place]; };
  for (size_t group = 0; group < lanes_.count; ++group) {
    const JointGroup<T>& g = groups_[group];
    for (int lane = 0; lane < W::kLanes && g.drives > 0; ++lane) {
      const uint32_t k = lanes_.member[group * W::kLanes + static_cast<size_t>(lane)];
      if (k == kNoBody || !joints.joints[k].springs_only || !loose(g.a[lane]) || !loose(g.b[lane])) continue;
      const Joint& joint = joints.joints[k];
      for (uint32_t i = joint.first_drive; i < joint.first_drive + joint.drives; ++i) {
        body(g, lane, joints.drives[i], drive_of(g, joints.drives[i].row));
      }
    }
  }
}

template <class T>
void JointSolver<T>::loosen(const JointList& joints, std::span<const uint8_t> held, std::span<uint8_t> sprung,
                            double h) {
  // In the basis of springs the matrix of an oscillation has at most w_i w_j where two share a body: their
  // largest frequency is below a sum over a row (Gershgorin).
  rates_.assign(end_ + 1, 0);
  const auto rate = [](const Drive& drive, const JointDrive<T>& d, int lane) {
    return std::sqrt(drive.stiffness * double(d.k[lane]));
  };
  each_loose(joints, held, [&](const JointGroup<T>& g, int lane, const Drive& drive, JointDrive<T>& d) {
    rates_[g.a[lane]] += rate(drive, d, lane), rates_[g.b[lane]] += rate(drive, d, lane);
  });
  rates_[end_] = 0;
  each_loose(joints, held, [&](const JointGroup<T>& g, int lane, const Drive& drive, JointDrive<T>& d) {
    const double k_now = d.k[lane], w = rate(drive, d, lane);
    const bool both = g.a[lane] != end_ && g.b[lane] != end_;
    const double beside = rates_[g.a[lane]] + rates_[g.b[lane]] - (both ? w : 0);
    const double most2 = w * beside * h * h < kResolvedAlone2 ? kResolvedAlone2 : kResolved2;
    const OscillatorStep step = oscillator_step(drive.stiffness * k_now, drive.damping * k_now, h, most2);
    if (!(step.half > 0)) return;
    d.spring.pull.set(lane, T(h * drive.stiffness * (1 - step.scale)));
    d.spring.scale.set(lane, T(step.scale));
    d.half.set(lane, T(step.half / k_now));
    for (const uint32_t place : {g.a[lane], g.b[lane]}) {
      if (place != end_) sprung[place] = 1;
    }
  });
}

template <class T>
void JointSolver<T>::kick(Record8<T>* v, T times, const ThreadTeam& team) {
  each_colour(lanes_, groups_, team, [&](JointGroup<T>& g) {
    if (g.drives > 0) kick_springs(g, drives_.data() + g.first_drive, v, end_, times);
  });
}

template void JointSolver<float>::soften(size_t, const JointList&, double);
template bool JointSolver<float>::has_springs(const JointList&) const;
template void JointSolver<float>::mark_held(const State&, const JointList&, std::span<const uint32_t>,
                                            std::span<uint8_t>) const;
template void JointSolver<float>::loosen(const JointList&, std::span<const uint8_t>, std::span<uint8_t>,
                                         double);
template void JointSolver<float>::kick(Record8<float>*, float, const ThreadTeam&);
template void JointSolver<double>::soften(size_t, const JointList&, double);
template bool JointSolver<double>::has_springs(const JointList&) const;
template void JointSolver<double>::mark_held(const State&, const JointList&, std::span<const uint32_t>,
                                             std::span<uint8_t>) const;
template void JointSolver<double>::loosen(const JointList&, std::span<const uint8_t>, std::span<uint8_t>,
                                          double);
template void JointSolver<double>::kick(Record8<double>*, double, const ThreadTeam&);

}  // namespace truestep::rigid3d
