// Bullet's constraints for the joints of a rigid3d scene.
#pragma once
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <span>
#include <vector>

#include "engine/base/errors.h"
#include "engine/systems/rigid3d/joints/joints.h"

namespace truestep::reference {

/// Appends an issue for everything in the bodies and joints of the scene that Bullet has no equivalent of.
void check_bullet_scene(const rigid3d::Rigid3dDef& def, std::vector<Issue>& issues);

/// The constraint of one joint between a and b.
std::unique_ptr<btTypedConstraint> bullet_joint(const rigid3d::AnyJointDef& def, const rigid3d::Joint& joint,
                                                btRigidBody& a, btRigidBody& b);

/// The definition of every built joint, in order.
std::vector<rigid3d::AnyJointDef> joint_defs(const rigid3d::Rigid3dDef& def);

}  // namespace truestep::reference
