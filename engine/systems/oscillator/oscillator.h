// The damped, driven harmonic oscillator, the first test of every method:
//   m x'' = -k x - c x' + F sin(2 pi f t).
// Its one point moves along the first axis of space; positions have three components so that it streams and
// draws like every other point. Without a driving force the exact solution is known and the distance from it
// is observed as error.exact (until a command changes the motion).
#pragma once
#include <memory>

#include "engine/core/commands/user_forces.h"
#include "engine/core/def/build.h"
#include "engine/core/def/def.h"
#include "engine/core/equations/force_system.h"
#include "engine/core/equations/integrator_def.h"
#include "engine/core/outputs.h"

namespace truestep::oscillator {

/// Parameters, SI.
struct OscillatorDef : IntegratorParams {
  double mass = 1;             ///< kg
  double stiffness = 1;        ///< N/m
  double damping = 0;          ///< N s/m
  double position = 1;         ///< m, at t = 0, from the rest position
  double velocity = 0;         ///< m/s, at t = 0
  double drive_force = 0;      ///< N, amplitude
  double drive_frequency = 1;  ///< Hz
};

const DefTable& oscillator_table();
/// The outputs of the system.
const Outputs& oscillator_outputs();
std::unique_ptr<const System> make_oscillator(const void* def, const BuildContext& context);
Cost cost_oscillator(const void* def);

/// Columns of an oscillator's state in order: everything that a command may change has one.
struct OscillatorColumns {
  enum Index : State::Column {
    kPosition,
    kVelocity,
    kInverseMass,
    kStiffness,
    kDamping,
    kDriveForce,
    kDriveFrequency,
    kPushRow,    ///< 0; one row per push
    kPushForce,  ///< N, its first component acts
    kPushRemaining,
    kDisturbed  ///< 1 once a command has left the exact solution
  };
  static constexpr UserForces kHands{UserForces::PushColumns{kPushRow, kPushForce, kPushRemaining}};
};

/// The right-hand side alone, for studies and tests.
std::unique_ptr<const ForceField> make_oscillator_field(const OscillatorDef& def);

/// x and v of the undriven oscillator at time t.
struct OscillatorMotion {
  double x, v;
};
OscillatorMotion oscillator_exact(const OscillatorDef& def, double t);

}  // namespace truestep::oscillator
