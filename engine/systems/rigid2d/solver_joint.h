// Joints with axes, motors, limits and springs, one after the other. A joint is rows of one number each,
//   J v + bias = 0,  impulse within bounds,
// and for two coinciding points a block of two. Springs pull in a small step as they do at its start
// (oscillator_step in soft_constraint.h): undamped ones keep their energy. Impulses, in the order of the
// state's column: x, y (or across and angle), motor, lower, upper, spring.
#pragma once
#include "engine/kernels/soft_constraint.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::rigid2d {

template <class T>
struct JointRow {
  const Joint* joint = nullptr;
  uint32_t index = 0;
  uint32_t a = 0, b = 0;  // rows of the bodies
  T ax, ay, bx, by;       // anchors about the centres at the step's start
  T ex, ey;               // from anchor to anchor at the step's start
  T ux, uy;               // axis in the world at the step's start
  T angle;                // of the joint at the step's start
  T gax, gay, gbx, gby;   // pulley: from the wheels to the anchors at the step's start
  SoftConstraint<T> soft, servo;
  struct Spring {
    T pull = 0;   // N s/m or N m s/rad, of a small step
    T scale = 0;  // share of the speed that damping takes
    T error = 0;  // m or rad, when the last bias pass began
    T half = 0;   // half a pull without damping, where the spring acts alone on its bodies
  } spring;
  T impulse[6];
};

/// soften: coefficients of the spring for the masses as they are; unkick, kick: takes half a pull of it back
/// before a step's first small step, adds it after the last; pull: springs alone, bias: all but them.
enum class JointPass : uint8_t { soften, unkick, warm, pull, bias, relax, kick };

/// One pass over a joint. rows: bodies' rows of eight, those from `moved` on take no impulses; h in s.
template <class T>
void solve_joint(JointRow<T>& j, T* rows, uint32_t moved, JointPass pass, T h);

}  // namespace truestep::rigid2d
