// Remembers for which arguments the acceleration in the scratch array "integrator.k1" was evaluated, so that
// a method whose last evaluation is the next step's first need not repeat it. Position-dependent forces are
// functions of t and of the state without its velocity: they are compared by a copy of all those bytes. As a
// cache of something the state determines, it may vanish at any time without changing a bit.
#pragma once
#include <vector>

#include "engine/integrators/motion.h"

namespace truestep {

class LastForce {
 public:
  /// Whether the scratch array holds a(x, t) of the present state.
  bool holds(const Motion& m, double t) const;
  /// To be called when it does.
  void keep(const Motion& m, double t);

 private:
  const ForceField* field_ = nullptr;
  double t_ = 0;
  std::vector<std::byte> image_;
};

}  // namespace truestep
