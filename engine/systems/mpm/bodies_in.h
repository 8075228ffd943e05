// Rigid bodies in the material (core/ports/medium.h): nodes inside a body and the body push each other
// (kernels/mpm/touch.h), with equal and opposite impulses. Nodes do not see a body thinner than a cell or
// two.
#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "engine/base/function_ref.h"
#include "engine/core/ports/medium.h"
#include "engine/geometry/box.h"
#include "engine/kernels/mpm/touch.h"
#include "engine/systems/mpm/solver.h"

namespace truestep::mpm {

class BodiesIn {
 public:
  void begin(std::span<const ImmersedBody> given, double cell);
  void end(std::span<ImmersedBody> given) const { std::copy(bodies_.begin(), bodies_.end(), given.begin()); }
  bool any() const { return !bodies_.empty(); }

  /// m/s, of the fastest point of any body.
  double fastest() const;

  /// Exchanges impulses between nodes and bodies for a substep that may still be rejected. visit(box, f)
  /// calls f(place, mass, velocity, handle) for every node with mass in the box; settle(handle, velocity)
  /// writes a node's velocity and returns the change. Returns the speed of the fastest node that was touched.
  using See = FunctionRef<void(const Vec3& place, double mass, const Vec3& velocity, size_t handle)>;
  using Visit = FunctionRef<void(const Box& box, See see)>;
  using Settle = FunctionRef<Vec3(size_t handle, const Vec3& velocity)>;
  double push(const MpmDef& def, const Vec3& gravity, double h, Visit visit, Settle settle);
  /// Accepts the substep of `push`.
  void accept(double h);

 private:
  /// In squares of gravity.
  static constexpr double kSteady = 2;
  static constexpr double kMostRoom = 1e5;
  std::vector<ImmersedBody> bodies_, trial_;
  std::vector<TouchedNode> nodes_;
  std::vector<size_t> handles_;
};

}  // namespace truestep::mpm
