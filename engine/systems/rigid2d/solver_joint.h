// Joints with axes, motors, limits and springs, one after the other. A joint is rows of one number each,
//   J v + bias = 0,  impulse within bounds,
// and for two coinciding points a block of two. Impulses, in the order of the state's column: x, y (or across
// and angle), motor, lower, upper, spring.
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
  SoftConstraint<T> soft, spring;
  T impulse[6];
};

enum class JointPass : uint8_t { warm, bias, relax };

/// One pass over a joint. rows: bodies' rows of eight, those from `moved` on take no impulses; h in s.
template <class T>
void solve_joint(JointRow<T>& j, T* rows, uint32_t moved, JointPass pass, T h);

}  // namespace truestep::rigid2d
