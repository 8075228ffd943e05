// Processing of a recorded motion against closed forms: resampling, smoothing, foot locking.
#include <cmath>

#include "tests/support/coupled.h"

namespace truestep {
namespace {

constexpr double kDegrees = 57.29577951308232;

/// One joint, and another 1 m along x on it, with the rotation about z (degrees) of every frame.
std::string turning(double frame_time, size_t frames, auto&& angle, const std::string& more, double dt) {
  std::string lines;
  for (size_t f = 0; f < frames; ++f) {
    char text[80];
    std::snprintf(text, sizeof text, ", \"0 0 0 %.17g 0 0 0\"", angle(static_cast<double>(f) * frame_time));
    lines += text;
  }
  return R"({"time": {"dt": )" + std::to_string(dt) +
         R"(}, "systems": [{"type": "motion_capture", "id": "s", "motion": {"bvh": ["HIERARCHY", "ROOT a", "{", "OFFSET 0 0 0",
     "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation", "JOINT b", "{", "OFFSET 1 0 0", "CHANNELS 1 Zrotation",
     "End Site", "{", "OFFSET 1 0 0", "}", "}", "}", "MOTION", "Frames: )" +
         std::to_string(frames) + R"(", "Frame Time: )" + std::to_string(frame_time) + "\"" + lines + "]" +
         more + "}}]}";
}
double angle_of(const testing_coupled::SceneRun& run) {
  return kDegrees * std::atan2(run.observe("s.joint.b.y"), run.observe("s.joint.b.x"));
}

TEST(RecordedMotion, IsSampledAtAnyRate) {
  // 90 degrees a second at 40 frames a second, stepped at 24, 60 and 90: between frames it rotates evenly.
  for (const double rate : {25.0, 62.5, 80.0}) {
    testing_coupled::SceneRun run(turning(
        0.025, 41, [](double t) { return 90 * t; }, "", 1 / rate));
    for (int k = 1; k <= static_cast<int>(rate); ++k) {
      run.session.step(1);
      ASSERT_NEAR(angle_of(run), 90 * k / rate, 1e-9) << rate << " " << k;
    }
  }
}

TEST(RecordedMotion, SmoothingTakesFromASineWhatAGaussianDoes) {
  // exp(-(w s)^2 / 2) of a sine remains; w = 2 pi / 0.5 s, s = 0.08 s. Rotations about one axis smooth like
  // numbers.
  const double w = 4 * M_PI, s = 0.08, left = std::exp(-0.5 * w * w * s * s);
  const auto sine = [&](double t) { return 20 * std::sin(w * t); };
  testing_coupled::SceneRun run(turning(0.0125, 241, sine, R"(, "smoothing": 0.08)", 0.0125)),
      plain(turning(0.0125, 241, sine, "", 0.0125));
  double most = 0, off = 0;
  for (int k = 1; k <= 200; ++k) {
    run.session.step(1), plain.session.step(1);
    if (k < 40) continue;  // within half a second of an end the kernel is cut off
    most = std::max(most, std::abs(angle_of(plain)));
    off = std::max(off, std::abs(angle_of(run) - left * angle_of(plain)));
  }
  EXPECT_NEAR(most, 20, 0.1);
  // Kernels end at about three widths: 0.3 % of the amplitude.
  EXPECT_LT(off, 0.003 * 20);
  EXPECT_GT((1 - left) * 20, 5) << "the control: it does take something";
}

TEST(RecordedMotion, FeetThatStandAreHeld) {
  // A crouched leg whose hips drift by 0.1 m/s: its foot is low and slow, and therefore locked.
  const auto leg = [](const std::string& lock) {
    std::string lines;
    for (int f = 0; f < 61; ++f) lines += ", \"" + std::to_string(0.1 * f / 60) + " 0.8 0 20 -40\"";
    return R"({"time": {"dt": 0.016666666666666666}, "systems": [{"type": "motion_capture", "id": "s", "motion": {"bvh": ["HIERARCHY", "ROOT hips", "{",
      "OFFSET 0 0 0", "CHANNELS 3 Xposition Yposition Zposition", "JOINT thigh", "{", "OFFSET 0 0 0", "CHANNELS 1 Xrotation", "JOINT shin", "{",
      "OFFSET 0 -0.42 0", "CHANNELS 1 Xrotation", "JOINT foot", "{", "OFFSET 0 -0.42 0", "CHANNELS 0", "End Site", "{", "OFFSET 0 0 0.1", "}", "}", "}", "}", "}",
      "MOTION", "Frames: 61", "Frame Time: 0.016666666666666666")" +
           lines + "]" + lock + "}}]}";
  };
  const std::string lock =
      R"(, "foot_lock": {"joints": ["foot"], "height": 0.05, "speed": 0.3, "blend": 0.1})";
  testing_coupled::SceneRun held(leg(lock)), free(leg(""));
  const Vec3 drifts = free.observe3("s.joint.foot");
  EXPECT_NEAR(drifts.y, 0.8 - 2 * 0.42 * std::cos(20 / kDegrees), 1e-9) << "it stands on the ground";
  Vec3 stood;
  for (int k = 1; k <= 50; ++k) {
    held.session.step(1), free.session.step(1);
    if (k == 10) stood = held.observe3("s.joint.foot");
    // Two bones reach it in closed form.
    if (k > 10) {
      ASSERT_LT(norm(held.observe3("s.joint.foot") - stood), 1e-9) << k;
    }
  }
  EXPECT_NEAR(free.observe3("s.joint.foot").x - drifts.x, 0.1 * 50 / 60, 1e-6) << "the control: it slides";
  EXPECT_NEAR(held.observe("s.joint.hips.x"), 0.1 * 50 / 60, 1e-6) << "the hips go on";
  EXPECT_GT(held.observe("s.foot_lock.slide"), 0.03);
  EXPECT_LT(held.observe("s.foot_lock.error"), 1e-9);
}

TEST(RecordedMotion, AGoalSaysHowFarItIsInLengthsOfItsChain) {
  const auto arm = [](const std::string& target) {
    return R"({"systems": [{"type": "ik", "id": "s", "solver": "two_link", "joints": [{"id": "a", "type": "revolute"},
      {"id": "b", "parent": "a", "type": "revolute", "offset": [1, 0, 0], "end": [0.8, 0, 0]}],
      "goals": [{"id": "g", "joint": "b", "base": "a", "point": [0.8, 0, 0], "target": [)" +
           target + "]}]}]}";
  };
  struct Case {
    const char* target;
    double stretch, error;
  };
  for (const Case& c : {Case{R"("1.2", "0.5")", 1.3 / 1.8, 0}, Case{R"("1.8", "0")", 1, 0},
                        Case{R"("3", "4")", 5 / 1.8, 3.2}, Case{R"("0.1", "0")", 0.1 / 1.8, 0.1}}) {
    testing_coupled::SceneRun run(arm(c.target));
    EXPECT_NEAR(run.observe("s.goal.g.stretch"), c.stretch, 1e-12);
    EXPECT_NEAR(run.observe("s.goal.g.error"), c.error, 1e-7);
    EXPECT_EQ(run.observe("s.ik.reached"), c.error == 0 ? 1 : 0);
  }
}

}  // namespace
}  // namespace truestep
