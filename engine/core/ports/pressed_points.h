// What a system may offer whose points are put where its constraints hold instead of moving by the sum of the
// forces on each: the step in which they carry what presses on them or hangs on them.
#pragma once

namespace truestep {

class PressedPoints {
 public:
  virtual ~PressedPoints() = default;
  /// s, the longest substep in which its points answer to a body of `mass` (kg) with all their stiffness. In
  /// a longer one they give way first, and what they are tied to stores more energy than the body has lost.
  virtual double pressed_h(double mass) const = 0;
};

}  // namespace truestep
