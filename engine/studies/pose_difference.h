// How far apart the bodies of two runs of a rigid scene are: distances of their centres (m) and rotation
// angles between their orientations (rad), as root mean square and maximum over the bodies that move.
#pragma once
#include <boost/json.hpp>
#include <vector>

#include "engine/core/state/state.h"

namespace truestep {

/// How a state's configuration holds poses: none, x y z and angle (plane), or x y z and quaternion (space).
enum class RigidKind : uint8_t { none, plane, space };
RigidKind rigid_kind(const State& state);

struct PoseDifference {
  double position_rms = 0, position_largest = 0;  ///< m
  double angle_rms = 0, angle_largest = 0;        ///< rad

  void take_larger(const PoseDifference& other);
};

/// Between sample i of both runs (configurations; sample 0 is the start); bodies that never moved in either
/// run do not count.
PoseDifference pose_difference(RigidKind kind, const std::vector<std::vector<double>>& a,
                               const std::vector<std::vector<double>>& b, size_t i);

/// {"position_rms", "position_largest", "angle_rms", "angle_largest"}
boost::json::object describe(const PoseDifference& d);

}  // namespace truestep
