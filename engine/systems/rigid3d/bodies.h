// What never changes of bodies: shape, mass, surface, groups. One kind per entry of "bodies"; its copies and
// whatever is spawned later share it. Bodies are placed by their centre of mass and principal axes, so that
// every inertia is diagonal in the body's frame; hulls, meshes and compounds are moved there once.
#pragma once
#include <vector>

#include "engine/collision/collision.h"
#include "engine/systems/rigid3d/rigid3d_def.h"

namespace truestep::rigid3d {

struct BodyKind {
  std::string id;
  Solid solid;                   ///< in the frame of centre and principal axes
  std::vector<SolidPart> parts;  ///< of a compound, for drawing
  BodyDef::Motion motion = BodyDef::Motion::dynamic;
  double mass = 0;              ///< kg; 0: contacts do not move it
  Vec3 moments;                 ///< kg m^2
  Vec3 center;                  ///< m, centre of mass in the frame of the scene's shape
  Quat axes;                    ///< principal axes in that frame
  double reach = 0, inner = 0;  ///< m, of the balls that hold it and that it holds
  double friction = 0, restitution = 0, rolling = 0;
  std::optional<double> spinning;  ///< m, where it is given
  double patch = 0;                ///< m, radius of what a round body touches with
  double linear_damping = 0, angular_damping = 0, gravity_scale = 1;
  Vec3 force, torque;        ///< N, N m, constant, in the world or in the body's axes
  bool force_turns = false;  ///< with the body
  uint32_t category = 1, mask = ~0u;
  bool sensor = false;
  bool turned_round = false;  ///< is a cylinder or has one
  std::optional<Vec3> color;

  /// m, torque against spinning on the spot per normal force in a contact with this coefficient of friction:
  /// without a given one that of even stiffness under a round patch (Hertz), 3 pi / 16 mu a.
  double spin_arm(double mu) const { return spinning.value_or(0.589048622548086 * mu * patch); }
  bool moved_by_forces() const { return mass > 0; }
  bool forced() const { return norm2(force) + norm2(torque) > 0; }
  /// Pose of centre and principal axes when the scene's shape has this one, and back.
  Pose body_pose(const Pose& shape) const;
  Pose shape_pose(const Pose& body) const;
};

/// A body's mass in the variables in which constraints are solved (contact_rows3.h).
struct ScaledBody {
  double root;     ///< 1/sqrt(m)
  double turn[9];  ///< S = I^-1/2 R^T by rows
};
/// Of a body moved by forces, with its principal axes along the columns of R.
ScaledBody scaled_body(const BodyKind& kind, const Rotation& R);

/// Whether the two are surfaces of triangles that should meet and cannot: one that forces move would fall
/// through the other.
bool falls_through(const BodyKind& a, const BodyKind& b);

/// A body at t = 0.
struct BodyStart {
  uint32_t kind = 0;
  Pose pose;
  Vec3 velocity, angular_velocity;
};

struct BodyList {
  std::vector<BodyKind> kinds;
  std::vector<BodyStart> starts;
};

/// All bodies of the scene. Error "scene_invalid" with the pointer of a body whose shape makes no solid.
BodyList build_bodies(const Rigid3dDef& def, uint64_t seed);

}  // namespace truestep::rigid3d
