// Joints with axes, motors, limits and springs, solved one after the other. A joint consists of scalar rows,
//   J v + bias = 0,  impulse within bounds,
// and of a 2x2 block for two coinciding points. In a substep springs pull as at its start (oscillator_step
// in soft_constraint.h): undamped springs keep their energy. Impulses, in the order of the state's column: x,
// y (or across and angle), motor, lower, upper, spring.
#pragma once
#include "engine/kernels/rigid/soft_constraint.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::rigid2d {

template <class T>
struct JointRow {
  const Joint* joint = nullptr;
  uint32_t index = 0;
  uint32_t a = 0, b = 0;  // rows of the bodies
  T ax, ay, bx, by;       // anchors about the centres at the start of the step
  T ex, ey;               // from anchor to anchor at the start of the step
  T ux, uy;               // axis in the world at the start of the step
  T angle;                // of the joint at the start of the step
  T gax, gay, gbx, gby;   // pulley: from the wheels to the anchors at the start of the step
  SoftConstraint<T> soft, servo;
  T wanted, most;     // of the motor: speed or position, maximum force or torque
  T spin, most_turn;  // of a motor joint
  T wx, wy;           // velocity of a motor joint, in the world at the start of the step
  struct Spring {
    T pull = 0;   // N s/m or N m s/rad, of a substep
    T scale = 0;  // fraction of the speed removed by damping
    T error = 0;  // m or rad, at the start of the last bias pass
    T half = 0;   // half a pull without damping, where only the spring acts on its bodies
    T k = 0;      // 1/kg, of its row at the start of the step
  } spring;
  T impulse[6];
};

/// soften: spring coefficients for the current masses; unkick, kick: removes half a pull before the first
/// substep of a step, adds it after the last; pull: only springs, bias: all but springs.
enum class JointPass : uint8_t { soften, unkick, warm, pull, bias, relax, kick };

/// Coefficients of the joint's spring for substeps of h (s), with the inverse mass of its row that it
/// holds; most2: see oscillator_step.
template <class T>
void soften_spring(JointRow<T>& j, T h, double most2) {
  const T k = j.spring.k;
  const Joint& d = *j.joint;
  const OscillatorStep step = oscillator_step(d.stiffness * k, d.damping * k, h, most2);
  j.spring.pull = static_cast<T>(h * d.stiffness * (1 - step.scale));
  j.spring.scale = static_cast<T>(step.scale), j.spring.half = static_cast<T>(step.half / k);
}

/// One pass over a joint. rows: bodies' rows of eight, those from `moved` on take no impulses; h in s.
template <class T>
void solve_joint(JointRow<T>& j, T* rows, uint32_t moved, JointPass pass, T h);

}  // namespace truestep::rigid2d
