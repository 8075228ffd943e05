// Box2D's joints for those of a rigid2d scene, and the parts of a scene that have no equivalent there.
#pragma once
#include <box2d/box2d.h>

#include <array>
#include <span>
#include <vector>

#include "engine/base/errors.h"
#include "engine/systems/rigid2d/model.h"

namespace truestep::reference {

/// As Box2D's float; cut off where its products would overflow.
inline float real(double x) {
  constexpr double kMost = 1e15;
  return static_cast<float>(x < -kMost ? -kMost : x > kMost ? kMost : x);
}
inline b2Vec2 vec(const flat::Vec2& v) {
  return {real(v.x), real(v.y)};
}

/// Appends an issue for every body and joint that Box2D has no equivalent of.
void check_box2d_scene(const rigid2d::Rigid2dDef& def, const rigid2d::Model& model,
                       std::vector<Issue>& issues);

/// Adds joint `j` of the model, for steps of dt (s). `joints` are those added before, which a gear may
/// connect.
b2Joint* add_box2d_joint(b2World& world, const rigid2d::Model& model, const rigid2d::Joint& j,
                         std::span<b2Body* const> bodies, std::span<b2Joint* const> joints, double dt);

/// Impulses of a joint in h (s), as rigid2d keeps them (columns::joint_impulse), from the forces that Box2D
/// reports for its last step of dt (s).
std::array<double, 6> box2d_impulses(b2Joint& joint, const rigid2d::Joint& j, double dt, double h);

}  // namespace truestep::reference
