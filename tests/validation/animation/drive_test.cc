// Animation channels that set whole lists of parameters and move bodies: every kind of interpolation,
// component by component, and rotations by slerp.
#include <cmath>

#include "engine/core/ports/body_port.h"
#include "engine/kernels/animation/rotations.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

std::string swinging(const std::string& channels, const std::string& coupling) {
  return R"({"time": {"dt": 0.01}, "systems": [{"type": "keyframes", "id": "keys", )" + channels +
         R"(}, {"type": "particles", "id": "dust", "positions": [[0,5,0]]}],
         "couplings": [{"type": "drive", "id": "d", "a": "keys", )" +
         coupling + "}]}";
}

TEST(Drive, AVectorSetsNumbersAndVectorsByEveryInterpolation) {
  // Five numbers through three keys, into a number, a vector and a number; each also as a control of its own.
  const double times[] = {0, 0.4, 1};
  const double values[3][5] = {{0.1, 1, -2, 3, 0.5}, {0.9, -1, 4, 0, 0.2}, {0.3, 2, 0, -5, 0.8}};
  std::string list;
  for (const auto& key : values) {
    for (const double v : key) list += (list.empty() ? "" : ", ") + std::to_string(v);
  }
  for (const char* kind : {"step", "linear", "catmull_rom", "hermite", "bezier", "natural", "monotone"}) {
    std::string controls;
    for (int k = 0; k < 5; ++k) {
      controls += (k > 0 ? ", " : "") + (R"({"name": "c)" + std::to_string(k)) +
                  R"(", "times": [0, 0.4, 1], "values": [)" + std::to_string(values[0][k]) + ", " +
                  std::to_string(values[1][k]) + ", " + std::to_string(values[2][k]) +
                  R"(], "interpolation": ")" + kind + "\"}";
    }
    const std::string channels = R"("controls": [)" + controls +
                                 R"(], "vectors": [{"name": "tune", "times": [0, 0.4, 1], "values": [)" +
                                 list + R"(], "interpolation": ")" + kind + "\"}]";
    testing_coupled::SceneRun run(swinging(
        channels,
        R"("b": "dust", "vector": "tune", "parameters": ["linear_drag", "wind", "quadratic_drag"])"));
    for (int step = 1; step <= 100; ++step) {
      run.session.step(1);
      if (step % 17 != 0) continue;
      for (int k = 0; k < 5; ++k) {
        // The coupling has the values at the step's start; the controls are compared at that time.
        const WorldState before = run.session.state_at(static_cast<uint64_t>(step - 1));
        const State& keys = before.systems[0];
        ASSERT_NEAR(run.observe("d.value." + std::to_string(k)),
                    keys.f64(keys.at("value"))[static_cast<size_t>(k)], 1e-12)
            << kind << " at step " << step;
      }
    }
    EXPECT_NE(run.observe("d.value.0"), times[0]);
  }
}

TEST(Drive, APathSetsAVectorAndExpressionsSeeVectors) {
  testing_coupled::SceneRun run(swinging(
      R"("paths": [{"name": "g", "times": [0, 1], "points": [[0, -10, 0], [2, -4, 6]], "interpolation": "linear"}],
                  "vectors": [{"name": "v", "times": [0, 1], "values": [1, 10, 3, 20], "interpolation": "linear"}],
                  "controls": [{"name": "both", "value": "v_0 + v_1"}])",
      R"("b": "dust", "path": "g", "parameter": "gravity")"));
  run.session.step(51);
  // Set at t = 0.5.
  EXPECT_NEAR(run.observe("d.value.0"), 1, 1e-12);
  EXPECT_NEAR(run.observe("d.value.1"), -7, 1e-12);
  EXPECT_NEAR(run.observe("d.value.2"), 3, 1e-12);
  EXPECT_NEAR(run.observe("keys.control.both"), 11 + 12 * 0.51, 1e-12);
  // It falls under the prescribed gravity: v = integral of g, by sums at the steps' starts.
  double vx = 0, vy = 0;
  for (int k = 0; k < 51; ++k) vx += 0.01 * 2 * 0.01 * k, vy += 0.01 * (-10 + 6 * 0.01 * k);
  const State& dust = run.session.state().systems[1];
  EXPECT_NEAR(dust.f64(dust.at("velocity"))[0], vx, 1e-9);
  EXPECT_NEAR(dust.f64(dust.at("velocity"))[1], vy, 1e-9);
}

std::string guided(const std::string& body, const std::string& coupling) {
  return R"({"gravity": [0, -9.81, 0], "time": {"dt": 0.005}, "systems": [
    {"type": "keyframes", "id": "keys",
     "paths": [{"name": "way", "times": [0, 1], "points": [[0, 1, 0], [2, 3, 0]], "interpolation": "linear"}],
     "turns": [{"name": "roll", "times": [0, 1], "quaternions": [1, 0, 0, 0,  0.7071067811865476, 0, 0, 0.7071067811865476]}]},
    {"type": "rigid3d", "id": "world", "precision": "f64", "bodies": [)" +
         body + R"(]}], "couplings": [{"type": "drive", "id": "d", "a": "keys", "b": "world", )" + coupling +
         "}]}";
}

TEST(Drive, APathAndATurnMoveABody) {
  for (const char* motion : {"dynamic", "kinematic"}) {
    testing_coupled::SceneRun run(
        guided(R"({"type": "box", "half_extents": [0.3, 0.2, 0.1], "position": [0, 1.5, 0], "motion": ")" +
                   std::string(motion) + R"("})",
               R"("body": 0, "path": "way", "turn": "roll")"));
    const auto body = [&] {
      const Ports ports = run.world->system(1).ports();
      const ConstBodies b(run.session.state().systems[1], *ports.bodies);
      return BodyMotion{b.place(0), b.orientation(0), b.velocity(0), b.spin(0)};
    };
    const BodyMotion start = body();
    for (int k = 1; k <= 100; ++k) {
      run.session.step(1);
      const double t = 0.005 * k, angle = 1.5707963267948966 * t;
      const BodyMotion now = body();
      // Half a metre above the frame's origin, rotating with it: closed form of a linear path and a slerp.
      const Vec3 want = Vec3{2 * t, 1 + 2 * t, 0} + Vec3{-0.5 * std::sin(angle), 0.5 * std::cos(angle), 0};
      ASSERT_LT(norm(now.place - want), 1e-12) << motion << k;
      const Quat turned = normalized(now.orientation * animation::conjugate(start.orientation));
      ASSERT_NEAR(2 * std::atan2(turned.z, turned.w), angle, 1e-12);
      ASSERT_LT(norm(now.spin - Vec3{0, 0, 1.5707963267948966}), 1e-9);
    }
  }
}

TEST(Drive, SaysWhatDoesNotFit) {
  const auto pointer = [](const std::string& scene) {
    try {
      testing_coupled::SceneRun run(scene);
    } catch (const Error& e) {
      return e.issues().empty() ? std::string("?") : e.issues()[0].pointer + " " + e.issues()[0].allowed;
    }
    return std::string("fits");
  };
  const std::string keys =
      R"("paths": [{"name": "p", "times": [0, 1], "points": [[0,0,0],[1,1,1]]}], "controls": [{"name": "c", "value": "1"}],
         "vectors": [{"name": "v", "times": [0, 1], "values": [1, 2, 3, 4]}])";
  const auto drive = [&](const std::string& coupling) { return pointer(swinging(keys, coupling)); };
  const std::string at = "/couplings/0";
  EXPECT_EQ(drive(R"("b": "dust", "vector": "v", "parameters": ["linear_drag", "quadratic_drag"])"), "fits");
  EXPECT_EQ(drive(R"("b": "dust", "vector": "w", "parameters": ["linear_drag"])"), at + "/vector v");
  EXPECT_EQ(drive(R"("b": "dust", "vector": "v", "parameters": ["linear_drag"])"),
            at + "/parameters 2 numbers");
  EXPECT_EQ(drive(R"("b": "dust", "vector": "v", "parameters": ["linear_drag", "wind"])"),
            at + "/parameters 2 numbers");
  EXPECT_EQ(drive(R"("b": "dust", "control": "c", "parameter": "wind")"),
            at + "/parameter a path or a vector");
  EXPECT_EQ(drive(R"("b": "dust", "path": "p", "parameter": "linear_drag")"), at + "/parameter 3 numbers");
  EXPECT_EQ(drive(R"("b": "dust", "control": "c", "path": "p", "parameter": "wind")"), at + " ");
  EXPECT_EQ(drive(R"("b": "dust", "control": "c", "parameters": ["linear_drag"])"), at + "/parameters ");
  EXPECT_EQ(drive(R"("b": "dust", "path": "p", "body": 0)").substr(0, at.size() + 2), at + "/b");
  EXPECT_EQ(drive(R"("b": "dust", "control": "c", "parameter": "colour")").substr(0, at.size() + 10),
            at + "/parameter");
  EXPECT_EQ(pointer(guided(R"({"type": "sphere", "radius": 0.1, "motion": "fixed"})",
                           R"("body": 0, "path": "way")")),
            at + "/body a dynamic or kinematic body");
  EXPECT_EQ(pointer(guided(R"({"type": "sphere", "radius": 0.1})", R"("body": 7, "path": "way")")),
            at + "/body 0 to 0");
  EXPECT_EQ(pointer(guided(R"({"type": "sphere", "radius": 0.1})", R"("body": 0, "path": "weg")")),
            at + "/path way");
  const std::string short_list =
      R"("vectors": [{"name": "v", "times": [0, 1], "values": [1, 2, 3]}], "controls": [{"name": "c", "value": "1"}])";
  EXPECT_EQ(pointer(swinging(short_list, R"("b": "dust", "control": "c", "parameter": "linear_drag")"))
                .substr(0, 28),
            "/systems/0/vectors/0/values ");
}

TEST(Drive, RestoresToTheBit) {
  const std::string scene = guided(
      R"({"type": "box", "half_extents": [0.3, 0.2, 0.1], "position": [0, 1.5, 0]}, {"type": "sphere", "radius": 0.1, "position": [0, 1.9, 0]})",
      R"("body": 0, "path": "way", "turn": "roll")");
  testing_coupled::SceneRun run(scene), other(scene);
  run.session.step(20);
  other.session.restore(run.session.state());
  run.session.step(30), other.session.step(30);
  EXPECT_EQ(run.session.hash(), other.session.hash());
}

}  // namespace
}  // namespace truestep
