// Animation at its extremes: chains of a thousand joints, targets a thousand million metres away, times of
// years, limits that leave no solution, curves whose keys are next to each other. Everything stays finite and
// consistent, whether the target is reached or not.
#include "tests/unit/animation/animation_rig.h"

namespace truestep::animation {
namespace {

using testing_rig::AnimationRun;
using testing_rig::Chain;

constexpr IkMethod kIterative[] = {IkMethod::gradient, IkMethod::gauss_newton, IkMethod::damped_least_squares,
                                   IkMethod::ccd, IkMethod::fabrik};

void expect_bones(const Chain& chain, double length) {
  for (size_t j = 1; j < chain.joints.size(); ++j) {
    const double l = norm(chain.work.poses[j].position - chain.work.poses[j - 1].position);
    // Rounding of positions of order 1, accumulated along the chain.
    ASSERT_NEAR(l, length, 1e-12);
  }
}

TEST(AnimationExtremes, AThousandJoints) {
  for (const IkMethod method : kIterative) {
    Chain chain(1000, 1e-3);
    chain.solve(chain.goal({0.3, 0.4, 0.1}), {.method = method, .tolerance = 1e-3, .most = 30});
    expect_bones(chain, 1e-3);
  }
}

TEST(AnimationExtremes, TargetsOutOfThisWorld) {
  for (const IkMethod method : kIterative) {
    for (const double far : {1e3, 1e9, 1e15}) {
      Chain chain(5, 0.2);
      const IkResult r = chain.solve(chain.goal({0, far, 0}), {.method = method, .most = 200});
      EXPECT_NE(r.end, IkResult::End::reached);
      expect_bones(chain, 0.2);
    }
  }
}

TEST(AnimationExtremes, LimitsThatLeaveNoWay) {
  for (const IkMethod method : kIterative) {
    for (const JointKind kind : {JointKind::ball, JointKind::revolute, JointKind::prismatic}) {
      Chain chain(5, 0.2, kind);
      for (Joint& j : chain.joints) j.min = j.max = j.cone = 0;
      chain.solve(chain.goal({0, 0.5, 0}), {.method = method, .most = 200});
      EXPECT_LT(norm(chain.place() - Vec3{1, 0, 0}), 1e-9) << static_cast<int>(method);
    }
  }
}

TEST(AnimationExtremes, KeysNextToEachOtherAndTimesOfYears) {
  for (const Interpolation kind :
       {Interpolation::catmull_rom, Interpolation::natural, Interpolation::monotone, Interpolation::bezier}) {
    const std::vector<double> t{0, 1e-12, 1, 1 + 1e-12}, v{0, 1e6, -1e6, 1};
    Keys keys{.width = 1, .times = t, .values = v};
    keys.interpolation = kind, keys.extend = Extend::ping_pong;
    const KeyCurve curve(keys);
    for (const double at : {-1e9, -1.0, 0.0, 5e-13, 0.5, 1.0, 1e6, 1e12}) {
      double value, rate;
      curve.sample(at, &value, &rate);
      EXPECT_TRUE(std::isfinite(value) && std::isfinite(rate)) << static_cast<int>(kind) << ' ' << at;
    }
  }
}

TEST(AnimationExtremes, StepsOfAnyLength) {
  keyframes::KeyframesDef d;
  d.shapes.resize(1);
  d.shapes[0].id = "a", d.shapes[0].position = {"sin(t)"}, d.shapes[0].rotation = {"0", "t"};
  for (const double h : {1e-9, 1e-3, 1.0, 1e6}) {
    AnimationRun<keyframes::Keyframes> run(d, h);
    run.step(100);
    // The position depends on the time alone.
    EXPECT_NEAR(run.observe("shape.a.x"), std::sin(100 * h), 1e-12) << h;
  }
}

}  // namespace
}  // namespace truestep::animation
