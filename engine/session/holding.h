// What falls in a scene, and what could hold it: bodies that stay where they are, colliders, held points,
// walls. From this follow what can be said before a run (nothing in the scene holds a system) and during one
// (rows have fallen far below everything that there was at the start).
#pragma once
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/geometry/box.h"
#include "engine/session/world/world.h"

namespace truestep {

/// One system of a scene at its start.
struct Footing {
  /// m/s^2; zero: it does not fall, it is driven or it is a medium within walls.
  Vec3 gravity;
  bool own =
      false;  ///< whether something of its own could hold it: fixed bodies, colliders, joints, held points
  bool stays = false;  ///< whether something of it stays where it is
  Box box;             ///< of its rows; planes and height fields are wide
};
std::vector<Footing> footings(const World& world, const WorldState& start);

/// Faults that a scene does not have but that its author would want to know: systems that fall past others,
/// or out of a medium whose walls hold only itself. With pointers into the scene.
std::vector<Issue> scene_doubts(const World& world, const WorldState& start);

/// Watches for rows that have left everything that could hold them.
class FallWatch {
 public:
  FallWatch(const World& world, const WorldState& start);
  /// Adds a warning for each system of which rows lie far below the whole scene at its start.
  void warn(const World& world, const WorldState& state, std::vector<World::SystemWarning>& out) const;

 private:
  struct Watched {
    size_t system, part;  ///< the part among those of the world
    Vec3 down;            ///< unit
    double lost;          ///< m along `down`: the depth from which on a row is lost
    std::string why;
  };
  std::vector<Watched> watched_;
  mutable std::vector<double> scratch_;
};

}  // namespace truestep
