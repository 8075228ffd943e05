// Trees of joints and systems of animation for tests.
#pragma once
#include <gtest/gtest.h>

#include <random>

#include "engine/kernels/animation/inverse_kinematics.h"
#include "engine/systems/blend_shapes/blend_shapes.h"
#include "engine/systems/keyframes/keyframes.h"
#include "engine/systems/skeleton/skeleton.h"
#include "tests/support/runs/system_run.h"

namespace truestep::testing_rig {

/// A chain of n joints along x, `length` apart, its end as far from the last joint.
struct Chain {
  std::vector<animation::Joint> joints;
  std::vector<animation::JointMotion> motion;
  Vec3 end;
  animation::IkWork work;

  Chain(size_t n, double length, animation::JointKind kind = animation::JointKind::ball)
      : motion(n), end{length, 0, 0} {
    for (size_t j = 0; j < n; ++j) {
      animation::Joint joint;
      joint.parent = static_cast<int32_t>(j) - 1, joint.kind = kind;
      if (j > 0) joint.rest.position = {length, 0, 0};
      joints.push_back(joint);
    }
  }
  animation::IkGoal goal(const Vec3& target) const {
    animation::IkGoal g;
    g.joint = static_cast<uint32_t>(joints.size() - 1), g.point = end, g.target = target;
    return g;
  }
  animation::IkResult solve(const animation::IkGoal& g, const animation::IkOptions& options) {
    return animation::solve_ik(joints, {}, std::span(&g, 1), options, motion, work);
  }
  /// Any pose: turns of up to `most` rad.
  void shake(std::mt19937& engine, double most) {
    std::uniform_real_distribution<double> u(-most, most);
    for (size_t j = 0; j < joints.size(); ++j) {
      motion[j].value = u(engine);
      motion[j].turn = free_rotation::turn({u(engine), u(engine), u(engine)});
      animation::apply_limits(joints[j], motion[j]);
    }
  }
  Vec3 place() {
    work.poses.resize(joints.size());
    animation::forward_kinematics(joints, motion, {}, work.poses);
    return work.poses.back().position + animation::rotate(work.poses.back().orientation, end);
  }
};

/// A system with a state, to be stepped.
template <class S>
struct AnimationRun : SystemRun<std::unique_ptr<const S>> {
  template <class Def>
  explicit AnimationRun(const Def& def, double dt = 1.0 / 60, int threads = 1)
      : SystemRun<std::unique_ptr<const S>>(
            [&] { return std::make_unique<S>(def, BuildContext{.id = "s", .dt = dt}); }, dt, threads) {}
};

}  // namespace truestep::testing_rig
