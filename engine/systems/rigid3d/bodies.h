// The constant properties of bodies: shape, mass, surface, groups. There is one kind per entry of "bodies",
// shared by its copies and by bodies spawned later. Bodies are placed by their centre of mass and principal
// axes, which makes every inertia diagonal in the body's frame; hulls, meshes and compounds are transformed
// there once.
#pragma once
#include <cmath>
#include <vector>

#include "engine/collision/collision.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep::rigid3d {

struct BodyKind {
  std::string id;
  Solid solid;                   ///< in the frame of the centre of mass and principal axes
  std::vector<SolidPart> parts;  ///< of a compound, for drawing
  BodyDef::Motion motion = BodyDef::Motion::dynamic;
  double mass = 0;              ///< kg; 0: not moved by contacts
  Vec3 moments;                 ///< kg m^2
  Vec3 center;                  ///< m, centre of mass in the frame of the scene's shape
  Quat axes;                    ///< principal axes in that frame
  double reach = 0, inner = 0;  ///< m, radii of the bounding ball and of the inscribed ball
  double friction = 0, restitution = 0, rolling = 0;
  std::optional<double> spinning;  ///< m, if given
  Vec3 surface_velocity;           ///< m/s, in the body's axes, relative to its material
  Vec3 one_way_direction;          ///< unit, in the body's axes
  double patch = 0;                ///< m, radius of the contact patch of a round body
  double linear_damping = 0, angular_damping = 0, gravity_scale = 1;
  Vec3 force, torque;        ///< N, N m, constant, in the world or in the body's axes
  bool force_turns = false;  ///< turns with the body
  bool fixed_rotation = false, one_way = false;
  int32_t group = 0;
  uint32_t category = 1, mask = ~0u;
  bool sensor = false, asleep = false, can_sleep = true;
  bool turned_round = false;  ///< a cylinder, or contains one
  std::optional<Vec3> color;

  /// Torque against spinning on the spot per normal force, m, for a contact with this coefficient of
  /// friction; by default that of uniform stiffness under a round patch (Hertz), 3 pi / 16 mu a.
  double spin_arm(double mu) const { return spinning.value_or(0.589048622548086 * mu * patch); }
  bool moved_by_forces() const { return mass > 0; }
  /// kg m^2: what torques act against; infinite for a body that never rotates.
  Vec3 resistance() const { return fixed_rotation ? Vec3{HUGE_VAL, HUGE_VAL, HUGE_VAL} : moments; }
  bool conveys() const { return surface_velocity != Vec3{}; }
  bool forced() const { return norm2(force) + norm2(torque) > 0; }
  /// Pose of the centre of mass and principal axes for this pose of the scene's shape, and the inverse.
  Pose body_pose(const Pose& shape) const;
  Pose shape_pose(const Pose& body) const;
};

/// Mass of a body in the variables in which constraints are solved (contact_rows3.h).
struct ScaledBody {
  double root;     ///< 1/sqrt(m)
  double turn[9];  ///< S = I^-1/2 R^T by rows; 0 for a body that never rotates
  bool rotates() const { return turn[0] != 0 || turn[1] != 0 || turn[2] != 0; }
};
/// For a dynamic body with its principal axes along the columns of R.
ScaledBody scaled_body(const BodyKind& kind, const Rotation& R);

/// Whether group, category and mask let them touch.
bool filter_allows(const BodyKind& a, const BodyKind& b);

/// True if both are triangle surfaces that should collide and cannot: a dynamic one would fall through the
/// other.
bool falls_through(const BodyKind& a, const BodyKind& b);

/// A body at t = 0.
struct BodyStart {
  uint32_t kind = 0;
  Pose pose;
  Vec3 velocity, angular_velocity;
  bool asleep = false;
};

struct BodyList {
  std::vector<BodyKind> kinds;
  std::vector<BodyStart> starts;
  bool seams = false;          ///< fixed bodies may be one surface (contacts_seams.cc)
  double thinnest = HUGE_VAL;  ///< m, least inner radius of what forces move and is touched
};

/// Whether fixed bodies, or parts of one, may be one surface.
bool has_seams(const BodyList& bodies);

/// All bodies of the scene. Throws Error "scene_invalid" with the pointer of a body whose shape has no valid
/// solid.
BodyList build_bodies(const Rigid3dDef& def, uint64_t seed);

}  // namespace truestep::rigid3d
