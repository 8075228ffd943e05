// Bullet's constraints for the joints of a rigid3d scene.
#pragma once
#include <btBulletDynamicsCommon.h>

#include <memory>
#include <span>
#include <vector>

#include "engine/base/errors.h"
#include "engine/systems/rigid3d/joints.h"

namespace truestep::reference {

/// Appends an issue for every joint of the scene that Bullet has no equivalent of.
void check_bullet_joints(const Rigid3dDef& def, std::vector<Issue>& issues);

/// The constraint of one joint between a and b.
std::unique_ptr<btTypedConstraint> bullet_joint(const AnyJointDef& def, const Joint& joint, btRigidBody& a,
                                                btRigidBody& b);

/// What every built joint was made from, in their order.
std::vector<AnyJointDef> joint_defs(const Rigid3dDef& def);

}  // namespace truestep::reference
