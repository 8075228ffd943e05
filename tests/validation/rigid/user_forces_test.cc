// Pushes, impulses and drags that act at a point of a body, in the plane and in space: closed forms. Points
// have no extent: a command with a place is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/base/errors.h"
#include "engine/math/quaternion.h"
#include "engine/scene/json/json.h"
#include "engine/session/world/world.h"

namespace truestep {
namespace {

constexpr double kPushedMass = 2, kMoment = 2.0 / 6;  // of a square and of a cube of 1 m about z

struct Hand {
  explicit Hand(const std::string& system)
      : world(parse_scene(R"({"gravity": [0, 0, 0], "time": {"dt": 0.01}, "systems": [)" + system + "]}")),
        state(world.initial_state()) {}
  void apply(CommandKind kind, const Vec3& vector, std::optional<Vec3> at, double duration = 0) {
    Command c;
    c.kind = kind, c.index = 0, c.vector = vector, c.at = at, c.duration = duration;
    world.system(0).apply(state.systems[0], c);
  }
  void steps(int n) {
    for (int k = 0; k < n; ++k) world.step(state, workspace, arena, {});
  }
  double value(const std::string& column, size_t k) const {
    const State& s = state.systems[0];
    const auto values = s.f64(s.at(column));
    return values[std::min(k, values.size() - 1)];
  }
  double spin() const { return value("angular_velocity", 2); }
  // The corner at (0.5, 0.5, 0) of the body's frame.
  Vec3 corner() const {
    const State& s = state.systems[0];
    Vec3 arm;
    if (s.find("angle")) {
      const double a = value("angle", 0);
      arm = {0.5 * (std::cos(a) - std::sin(a)), 0.5 * (std::sin(a) + std::cos(a)), 0};
    } else {
      const auto q = s.f64(s.at("orientation"));
      arm = rotation(Quat{q[0], q[1], q[2], q[3]}).apply({0.5, 0.5, 0});
    }
    return Vec3{value("position", 0), value("position", 1), value("position", 2)} + arm;
  }

  World world;
  WorldState state;
  Workspace workspace;
  ThreadArena arena{1};
};

const std::string kCube = R"({"type": "rigid3d", "id": "r", "precision": "f64", "bodies": [
    {"type": "box", "half_extents": [0.5, 0.5, 0.5], "mass": 2, "angular_damping": 2}]})";
const std::string kSquare = R"({"type": "rigid2d", "id": "r", "precision": "f64", "bodies": [
    {"shapes": [{"type": "box", "half_extents": [0.5, 0.5, 0]}], "mass": 2, "angular_damping": 2}]})";
const std::string kBodies[] = {kCube, kSquare};

TEST(UserForces, AnImpulseAtACornerTurns) {
  for (const std::string& body : kBodies) {
    Hand hand(body), centre(body);
    hand.apply(CommandKind::impulse, {1, 0, 0}, Vec3{0.5, 0.5, 0});
    EXPECT_NEAR(hand.value("velocity", 0), 1 / kPushedMass, 1e-15);
    EXPECT_NEAR(hand.spin(), -0.5 / kMoment, 1e-6) << body;  // moments of hulls in the plane are sums
    centre.apply(CommandKind::impulse, {1, 0, 0}, std::nullopt);
    EXPECT_EQ(centre.spin(), 0);
  }
}

// The arm turns by 2 mrad meanwhile, which takes 2e-6 of the torque; damping takes 2 d / 2 of the spin.
TEST(UserForces, APushAtAnEdgeTurns) {
  constexpr double kForce = 0.3, kDuration = 0.1, kDamping = 2;
  for (const std::string& body : kBodies) {
    Hand hand(body), centre(body);
    hand.apply(CommandKind::push, {kForce, 0, 0}, Vec3{0, 0.5, 0}, kDuration);
    hand.steps(10);
    const double torque = -0.5 * kForce / kMoment;
    const double spin = torque * (1 - std::exp(-kDamping * kDuration)) / kDamping;
    EXPECT_NEAR(hand.value("velocity", 0), kForce * kDuration / kPushedMass, 1e-12);
    // Damping in substeps of 2.5 ms is of first order: 0.25 %.
    EXPECT_NEAR(hand.spin(), spin, 0.003 * std::abs(spin)) << body;
    const double reached = hand.value("velocity", 0);
    hand.steps(10);
    EXPECT_EQ(hand.value("velocity", 0), reached);  // it is over
    centre.apply(CommandKind::push, {kForce, 0, 0}, std::nullopt, kDuration);
    centre.steps(10);
    EXPECT_EQ(centre.spin(), 0);
  }
}

// The corner that was grabbed comes to the target, and follows where the target moves without being named
// again.
TEST(UserForces, ADraggedCornerFollowsTheHand) {
  for (const std::string& body : kBodies) {
    Hand hand(body);
    hand.apply(CommandKind::drag, {2, 0, 0}, Vec3{0.5, 0.5, 0});
    hand.steps(500);
    EXPECT_LT(norm(hand.corner() - Vec3{2, 0, 0}), 0.01) << body;
    hand.apply(CommandKind::drag, {2, 3, 0}, std::nullopt);
    hand.steps(500);
    EXPECT_LT(norm(hand.corner() - Vec3{2, 3, 0}), 0.01) << body;

    Hand centre(body);
    centre.apply(CommandKind::drag, {2, 0, 0}, std::nullopt);
    centre.steps(500);
    EXPECT_GT(norm(centre.corner() - Vec3{2, 0, 0}), 0.5);
  }
}

// A rod of 1 m on a pin at its end: an impulse J at the distance r from the pin gives J r / I about it.
TEST(UserForces, AnImpulseOnALinkTurnsByItsArm) {
  const std::string rod =
      R"({"type": "articulation", "id": "a", "links": [{"joint": "hinge", "axis": [0, 0, 1],
      "mass": 3, "center": [0.5, 0, 0], "inertia": [0.01, 0.25, 0.25]}]})";
  const double moment = 0.25 + 3 * 0.25;
  const auto rate = [](const Hand& h) {
    const State& s = h.state.systems[0];
    return s.f64(s.at("velocity"))[0];
  };
  for (const double arm : {0.25, 0.5, 1.0}) {
    Hand hand(rod);
    hand.apply(CommandKind::impulse, {0, 2, 0}, Vec3{arm, 0, 0});
    EXPECT_NEAR(rate(hand), 2 * arm / moment, 1e-12);
    // A push for one step: half of its angle, 0.05 mrad, is what the arm turns meanwhile.
    Hand push(rod);
    push.apply(CommandKind::push, {0, 2, 0}, Vec3{arm, 0, 0}, 0.01);
    push.steps(1);
    EXPECT_NEAR(rate(push), 0.02 * arm / moment, 1e-7);
  }
  Hand centre(rod);
  centre.apply(CommandKind::impulse, {0, 2, 0}, std::nullopt);
  EXPECT_NEAR(rate(centre), 2 * 0.5 / moment, 1e-12);
}

TEST(UserForces, PointsRefuseAPlace) {
  for (const char* system :
       {R"({"type": "particles", "id": "p", "positions": [[0, 0, 0]]})",
        R"({"type": "mass_spring", "id": "m", "rope": {"from": [0, 0, 0], "to": [1, 0, 0], "links": 3}})"}) {
    Hand hand(system);
    hand.apply(CommandKind::impulse, {1, 0, 0}, std::nullopt);
    try {
      hand.apply(CommandKind::impulse, {1, 0, 0}, Vec3{0, 0, 0});
      ADD_FAILURE() << system;
    } catch (const Error& e) {
      EXPECT_EQ(e.issues().at(0).pointer, "/at");
    }
  }
}

}  // namespace
}  // namespace truestep
