// Bodies that are not free in space: links of a tree and bodies of the plane, accessed through their ports.
// The response to an impulse against the tree's mass matrix, momentum, faces that nothing passes, links to
// points.
#include <cmath>

#include "engine/base/random.h"
#include "engine/collision/point_distance.h"
#include "engine/geometry/transform.h"
#include "engine/kernels/point_hull.h"
#include "engine/systems/articulation/link_bodies.h"
#include "tests/support/coupled.h"

namespace truestep {
namespace {

using namespace testing_coupled;

Vec3 random_vec(uint64_t stream, uint64_t i) {
  const auto u = uniform4(29, stream, i);
  return {2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1};
}

/// A free trunk with two limbs on a ball and a hinge, in slow motion.
constexpr const char* kBody = R"({"type": "articulation", "id": "doll", "links": [
    {"id": "trunk", "parent": "ground", "joint": "free", "q": [0.1, -0.2, 0.3, 0.9950371902099892, 0.09950371902099893, 0, 0],
     "v": [0.1, 0.2, -0.1, 0.3, -0.2, 0.5], "shapes": [{"type": "box", "half_extents": [0.3, 0.4, 0.2]}]},
    {"id": "arm", "parent": "trunk", "joint": "spherical", "offset": [0.35, 0.3, 0], "v": [0.2, 0.5, -0.4],
     "shapes": [{"type": "capsule", "radius": 0.1, "half_length": 0.3, "position": [0.4, 0, 0], "rotation": [0, 0, 1.2]}]},
    {"id": "hand", "parent": "arm", "joint": "revolute", "offset": [0.8, 0, 0], "q": [0.4], "v": [1],
     "shapes": [{"type": "box", "half_extents": [0.15, 0.1, 0.05], "position": [0.15, 0, 0]}]}]})";

std::string scene_of(const std::string& systems, const std::string& couplings, double dt = 0.004,
                     const char* gravity = "[0, 0, 0]") {
  return R"({"gravity": )" + std::string(gravity) + R"(, "time": {"dt": )" + std::to_string(dt) +
         R"(}, "systems": [)" + systems + R"(], "couplings": [)" + couplings + "]}";
}

struct Reached {
  explicit Reached(const std::string& system)
      : run(scene_of(system, "")), state(run.session.state().systems[0]) {}
  const System& system() const { return run.world->system(0); }
  const BodyPort& port() const { return port_; }
  double observe(const char* name) const {
    Observables out;
    system().observe(state, 0, out);
    return out.find(name).value();
  }
  Vec3 observe3(const std::string& name) const {
    return {observe((name + ".x").c_str()), observe((name + ".y").c_str()), observe((name + ".z").c_str())};
  }
  SceneRun run;
  State state;
  Workspace memory;
  BodyPort port_ = *run.world->system(0).ports().bodies;
};

TEST(LinkBodies, StandWhereTheFieldsSay) {
  Reached r(kBody);
  const BodyPort& port = r.port();
  const ConstBodies with(r.state, port, &r.memory), without(r.state, port);
  for (const char* name : {"position", "velocity", "orientation", "angular_velocity"}) {
    std::vector<double> scratch;
    const auto place = *r.system().find_field(name);
    const FieldView view = r.system().field(r.state, place.part, place.field, scratch);
    for (const ConstBodies* b : {&with, &without}) {
      for (size_t i = 0; i < 3; ++i) {
        const Quat q = b->orientation(i);
        const Vec3 value = name[0] == 'p'   ? b->place(i)
                           : name[0] == 'v' ? b->velocity(i)
                           : name[0] == 'a' ? b->spin(i)
                                            : Vec3{q.x, q.y, q.z};
        const double* at = static_cast<const double*>(view.data) + view.width * i + (view.width == 4 ? 1 : 0);
        EXPECT_LT(norm(value - load3(at, 0)), 1e-14) << name << " " << i;
      }
    }
  }
}

TEST(LinkBodies, AnImpulseChangesMomentumByItself) {
  Reached r(kBody);
  Bodies bodies(r.state, r.port(), &r.memory);
  for (uint64_t k = 0; k < 30; ++k) {
    const size_t row = k % 3;
    const Vec3 p = r.observe3("momentum"), l = r.observe3("angular_momentum"), j = random_vec(1, k),
               arm = random_vec(2, k);
    const Vec3 at = bodies.place(row) + arm, before = bodies.velocity_at(row, arm);
    const Vec3 expected = bodies.answer(row, arm, j);
    bodies.push(row, arm, j);
    EXPECT_LT(norm(bodies.velocity_at(row, arm) - before - expected), 1e-12);
    EXPECT_LT(norm(r.observe3("momentum") - p - j), 1e-12);
    EXPECT_LT(norm(r.observe3("angular_momentum") - l - cross(at, j)), 1e-11);
  }
}

// Position corrections conserve momentum, and change the angular momentum as told; the centre of mass of a
// free tree moves by P / m to first order.
TEST(LinkBodies, CorrectionsKeepMomentum) {
  Reached r(kBody);
  const BodyPort& port = r.port();
  double mass = 0;
  for (const BodyForm& f : port.forms) mass += f.mass;
  const auto center = [&](const Bodies& bodies) {
    Vec3 sum;
    for (size_t i = 0; i < 3; ++i) sum += bodies.place(i) * bodies.form(i).mass;
    return sum / mass;
  };
  for (uint64_t k = 0; k < 30; ++k) {
    const size_t row = k % 3;
    // Displacements are measured from where the memory began.
    Bodies bodies(r.state, port, &r.memory);
    const Vec3 p = r.observe3("momentum"), l = r.observe3("angular_momentum"), by = random_vec(3, k) * 0.01,
               gained = random_vec(4, k) * 0.01;
    const Vec3 v = bodies.velocity(row), c = center(bodies);
    bodies.shift(row, random_vec(5, k) * 0.3, by, gained);
    EXPECT_LT(norm(r.observe3("momentum") - p), 1e-11);
    EXPECT_LT(norm(r.observe3("angular_momentum") - l - cross(by, v) + gained), 1e-11);
    EXPECT_LT(norm(center(bodies) - c - by / mass), 0.05 * norm(by / mass));
  }
}

// v' = J M^-1 J^T (J, T) with M by the composite rigid body algorithm: a different method from the solver's.
// One hinge and one slider on the ground.
TEST(LinkBodies, AnswerByTheInverseOfTheMassMatrix) {
  Reached r(R"({"type": "articulation", "id": "arm", "links": [
      {"parent": "ground", "axis": [0, 0, 1], "q": [0.3], "mass": 2, "center": [0, -1, 0], "inertia": [0.1, 0.2, 0.3]},
      {"joint": "prismatic", "axis": [1, 0, 0], "offset": [0, -2, 0], "q": [0.5], "mass": 1, "center": [0.2, 0, 0], "inertia": [0.1, 0.1, 0.1]}]})");
  Bodies bodies(r.state, r.port(), &r.memory);
  // Lagrange: with s = 0.7 the slider's centre along the turned x, T = 1/2 (I1 + m1 + I2 + m2 (4 + s^2)) w^2
  // + 1/2 m2 u^2 + 2 m2 w u.
  const double s = 0.7, a = 0.3 + 2 + 0.1 + 1 * (4 + s * s), b = 2, c = 1, det = a * c - b * b;
  const Vec3 x{std::cos(0.3), std::sin(0.3), 0}, y{-std::sin(0.3), std::cos(0.3), 0};
  const Vec3 j = x * 0.7 + y * -0.4;
  // Generalised impulse at the slider's centre: w turns it by (2, s) along (x, y), u moves it along x.
  const double gw = 0.7 * 2 - 0.4 * s, gu = 0.7, w = (c * gw - b * gu) / det, u = (a * gu - b * gw) / det;
  const Vec3 expected = x * (2 * w + u) + y * (s * w);
  EXPECT_LT(norm(bodies.answer(1, {}, j) - expected), 1e-13);
  // The control: a free body would have responded by its mass.
  EXPECT_GT(norm(expected - j), 0.1);
}

TEST(LinkBodies, AnswersOfAllAreSymmetricAndSumUp) {
  Reached r(kBody);
  const BodyPort& port = r.port();
  const ConstBodies bodies(r.state, port, &r.memory);
  const std::vector<BodyImpulse> first{{random_vec(6, 0), random_vec(6, 1)}, {}, {random_vec(6, 2), {}}},
      second{{}, {random_vec(6, 3), random_vec(6, 4)}, {{}, random_vec(6, 5)}};
  std::vector<BodyTwist> a(3), b(3);
  bodies.answers(first, a), bodies.answers(second, b);
  double ab = 0, ba = 0;
  for (size_t i = 0; i < 3; ++i) {
    ab += dot(a[i].velocity, second[i].impulse) + dot(a[i].spin, second[i].twist);
    ba += dot(b[i].velocity, first[i].impulse) + dot(b[i].spin, first[i].twist);
  }
  EXPECT_NEAR(ab, ba, 1e-13);
  EXPECT_GT(std::abs(ab), 1e-4);
}

/// 120 balls that rain on a place from one side.
std::string dust(const Vec3& from, const Vec3& speed, const Vec3& spread, double radius = 0.02) {
  std::string x, v;
  for (uint64_t i = 0; i < 120; ++i) {
    const Vec3 r = random_vec(7, i), u = random_vec(8, i) * 0.5;
    const double flat = spread.z > 0 ? 1 : 0;
    char text[160];
    std::snprintf(text, sizeof text, "%s[%.5f, %.5f, %.5f]", i ? ", " : "", from.x + r.x * spread.x,
                  from.y + r.y * spread.y, flat * (from.z + r.z * spread.z));
    x += text;
    std::snprintf(text, sizeof text, "%s[%.5f, %.5f, %.5f]", i ? ", " : "", speed.x + u.x, speed.y + u.y,
                  flat * (speed.z + u.z));
    v += text;
  }
  return R"({"type": "particles", "id": "dust", "mass": 1, "radius": )" + std::to_string(radius) +
         R"(, "positions": [)" + x + R"(], "velocities": [)" + v + "]}";
}

/// Momenta of the balls; about z alone where `flat`.
struct Momenta {
  Vec3 linear, angular;
  double scale = 0;
};
Momenta of_points(const SceneRun& run) {
  Momenta out;
  const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
  for (size_t k = 0; k < p.count; ++k) {
    const Vec3 m = p.velocity(k) / p.inverse_mass(k);
    out.linear += m, out.angular += cross(p.place(k), m);
    out.scale += norm(m);
  }
  return out;
}

TEST(LinkBodies, BallsAndAFreeTreeKeepMomentum) {
  for (const char* law : {R"("restitution": 1, "friction": 0)", R"("restitution": 0.3, "friction": 0.6)"}) {
    SceneRun run(
        scene_of(dust({0.4, 2, 0.3}, {0, -4, 0}, {0.8, 0.8, 0.4}) + "," + kBody,
                 R"({"type": "contact", "id": "c", "a": "dust", "b": "doll", )" + std::string(law) + "}"));
    const auto sums = [&] {
      Momenta m = of_points(run);
      m.linear += run.observe3("doll.momentum"), m.angular += run.observe3("doll.angular_momentum");
      return m;
    };
    const Momenta before = sums();
    const Vec3 own = run.observe3("doll.momentum");
    run.session.step(300);
    const Momenta after = sums();
    // The tree's own motion is integrated to 1e-6 of its steps (the method's tolerance): a coupling adds only
    // rounding to that. The control: the same tree alone drifts as far.
    SceneRun alone(scene_of(kBody, ""));
    alone.session.step(300);
    const double drift = norm(alone.observe3("doll.momentum") - own);
    EXPECT_LT(norm(after.linear - before.linear), 1e-11 * before.scale + 100 * drift) << law << " " << drift;
    EXPECT_LT(norm(after.angular - before.angular), 1e-6 * before.scale) << law;
    EXPECT_GT(run.observe("c.impulse.sum"), 10) << law;
    EXPECT_GT(norm(run.observe3("doll.momentum") - own), 10) << law;
    EXPECT_LT(run.observe("c.penetration"), 1e-6) << law;
  }
}

// No ball is closer to any link than its radius, however fast it arrives.
TEST(LinkBodies, NoBallPassesALink) {
  for (const double speed : {5.0, 200.0}) {
    SceneRun run(scene_of(dust({0.4, 2, 0.3}, {0, -speed, 0}, {0.8, 0.8, 0.4}) + "," + kBody,
                          R"({"type": "contact", "id": "c", "a": "dust", "b": "doll", "restitution": 0})"));
    const BodyPort port = *run.world->system(1).ports().bodies;
    for (int k = 0; k < 150; ++k) {
      run.session.step(1);
      const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
      const ConstBodies b(run.session.state().systems[1], port);
      for (size_t row = 0; row < 3; ++row) {
        const Transform at{rotation(b.orientation(row)), b.place(row)};
        for (size_t i = 0; i < p.count; ++i) {
          const auto d = point_distance(*b.form(row).solid, at.inverse_point(p.place(i)), 0.1);
          if (d) {
            ASSERT_GT(d->distance, 0.02 - 1e-4) << speed << " ball " << i << " link " << row << " step " << k;
          }
        }
      }
    }
    EXPECT_GT(run.observe("c.impulse.sum"), 10);
  }
}

// A ball hits a hinged rod at a = 0.8 m from the hinge: there the rod has the effective mass M = I / a^2, and
// for e = 1 v' = (m - M) / (m + M) v (Landau, Lifshitz, Mechanics, section 17 with one coordinate each).
TEST(LinkBodies, ABallBouncesOffAHingedRod) {
  for (const double e : {1.0, 0.5}) {
    char law[160];
    std::snprintf(
        law, sizeof law,
        R"({"type": "contact", "id": "c", "a": "ball", "b": "rod", "restitution": %g, "friction": 0, "rest_speed": 0})",
        e);
    SceneRun run(R"({"gravity": [0, 0, 0], "time": {"dt": 0.001}, "systems": [
        {"type": "particles", "id": "ball", "mass": 0.7, "radius": 0.05, "positions": [[-0.3, -0.8, 0]], "velocities": [[2, 0, 0]]},
        {"type": "articulation", "id": "rod", "links": [{"parent": "ground", "mass": 3,
          "shapes": [{"type": "box", "half_extents": [0.02, 0.5, 0.02], "position": [0, -0.5, 0]}]}]}],
      "couplings": [)" +
                 std::string(law) +
                 R"(], "probes": [{"id": "ball", "system": "ball", "fields": ["velocity"]}]})");
    const double inertia = 3 * ((0.04 * 0.04 + 1) / 12 + 0.25), M = inertia / 0.64, m = 0.7;
    while (run.observe("c.impulse.sum") == 0 && run.session.step_index() < 1000) run.session.step(1);
    EXPECT_NEAR(run.observe("ball.velocity.x"), (m - e * M) / (m + M) * 2, 1e-12) << e;
    EXPECT_NEAR(run.observe("rod.angular_momentum.z"), 0.8 * m * (1 + e) * M / (m + M) * 2, 1e-9) << e;
    EXPECT_NEAR(run.observe("c.energy.lost"), 0.5 * m * M / (m + M) * 4 * (1 - e * e), 1e-12) << e;
  }
}

// A rope that hangs on a hand: the two places coincide to rounding, and momentum is as without the hook.
TEST(LinkBodies, ARopeHooksOn) {
  SceneRun run(scene_of(
      R"({"type": "mass_spring", "id": "rope", "rope": {"from": [2, 0.3, 0.3], "to": [3, 0.3, 0.3], "links": 6},
      "mass": 0.05, "stiffness": 2000, "velocity": [0, 1, 0], "integrator": "velocity_verlet"},)" +
          std::string(kBody),
      R"({"type": "attachment", "id": "hook", "a": "rope", "b": "doll", "link": "rigid", "a_points": [0], "b_points": [2], "places": [[2, 0.3, 0.3]]})",
      0.002));
  run.session.step(1);
  const auto sums = [&] {
    Momenta m = of_points(run);
    m.linear += run.observe3("doll.momentum"), m.angular += run.observe3("doll.angular_momentum");
    return m;
  };
  const Momenta before = sums();
  double worst = 0;
  for (int k = 0; k < 500; ++k) {
    run.session.step(1);
    worst = std::max(worst, run.observe("hook.length.error"));
  }
  const Momenta after = sums();
  EXPECT_LT(worst, 1e-12);
  EXPECT_LT(norm(after.linear - before.linear), 1e-9);
  EXPECT_LT(norm(after.angular - before.angular), 1e-6);
  EXPECT_GT(run.observe("hook.impulse.sum"), 0.1);
}

// A hand on a spring to a pinned point: m g = k stretch at rest.
TEST(LinkBodies, ASpringCarriesALink) {
  SceneRun run(scene_of(
      R"({"type": "mass_spring", "id": "pin", "free": {"points": [[0, 2, 0]]}, "pins": [0]},
      {"type": "articulation", "id": "slide", "links": [{"parent": "ground", "joint": "prismatic", "axis": [0, 1, 0], "q": [1],
        "mass": 2, "inertia": [0.1, 0.1, 0.1]}]})",
      R"({"type": "attachment", "id": "s", "a": "slide", "b": "pin", "stiffness": 200, "damping": 10})",
      0.004, "[0, -9.81, 0]"));
  run.session.step(2500);
  Observables out;
  const ConstBodies b(run.session.state().systems[1], *run.world->system(1).ports().bodies);
  EXPECT_NEAR(b.place(0).y, 1 - 2 * 9.81 / 200, 1e-5);
}

constexpr const char* kFlat = R"({"type": "rigid2d", "id": "flat", "precision": "f64", "bodies": [
    {"position": [0, 0, 0], "angle": 0.3, "angular_velocity": 0.7, "shapes": [{"type": "box", "half_extents": [0.6, 0.2, 0], "radius": 0.05}], "density": 100},
    {"position": [1.4, -0.3, 0], "velocity": [-0.2, 0.1, 0], "shapes": [{"type": "circle", "radius": 0.3}, {"type": "circle", "radius": 0.2, "center": [0.4, 0, 0]}], "density": 100},
    {"position": [-1.4, 0.1, 0], "shapes": [{"type": "polygon", "points": [[-0.3, -0.3, 0], [0.4, -0.2, 0], [0, 0.5, 0]]}], "density": 100}]})";

TEST(FlatBodies, BallsInThePlaneKeepMomentum) {
  for (const char* law : {R"("restitution": 1, "friction": 0)", R"("restitution": 0.3, "friction": 0.6)"}) {
    SceneRun run(
        scene_of(dust({0, 2.5, 0}, {0, -4, 0}, {2, 1.2, 0}) + "," + kFlat,
                 R"({"type": "contact", "id": "c", "a": "dust", "b": "flat", )" + std::string(law) + "}"));
    const auto sums = [&] {
      Momenta m = of_points(run);
      m.linear += Vec3{run.observe("flat.momentum.x"), run.observe("flat.momentum.y"), 0};
      m.angular += Vec3{0, 0, run.observe("flat.momentum.angular")};
      return m;
    };
    const Momenta before = sums();
    double worst = 0;
    for (int k = 0; k < 300; ++k) {
      const Momenta then = sums();
      run.session.step(1);
      const Momenta now = sums();
      // Before the balls drive the bodies together, whose own contacts are swept a limited number of times.
      if (k < 100)
        worst = std::max({worst, norm(now.linear - then.linear), std::abs(now.angular.z - then.angular.z)});
    }
    EXPECT_LT(worst, 1e-11 * before.scale) << law;
    EXPECT_GT(run.observe("c.impulse.sum"), 10) << law;
    // What is in the plane stays in it.
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    for (size_t i = 0; i < p.count; ++i) ASSERT_EQ(p.place(i).z, 0);
  }
}

/// m, of a point from the outline of the first body of kFlat, a rounded box.
double gap_to_box(const ConstBodies& b, const Vec3& p) {
  const Vec3 q = rotation(b.orientation(0)).apply_inverse(p - b.place(0));
  const double x = std::abs(q.x) - 0.6, y = std::abs(q.y) - 0.2;
  return std::hypot(std::max(x, 0.0), std::max(y, 0.0)) + std::min(std::max(x, y), 0.0) - 0.05;
}

TEST(FlatBodies, NoBallPassesAnOutline) {
  for (const double speed : {4.0, 300.0}) {
    SceneRun run(scene_of(dust({0, 2.5, 0}, {0, -speed, 0}, {2, 1.2, 0}) + "," + kFlat,
                          R"({"type": "contact", "id": "c", "a": "dust", "b": "flat", "restitution": 0})"));
    const BodyPort port = *run.world->system(1).ports().bodies;
    for (int k = 0; k < 150; ++k) {
      run.session.step(1);
      const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
      const ConstBodies b(run.session.state().systems[1], port);
      for (size_t i = 0; i < p.count; ++i)
        ASSERT_GT(gap_to_box(b, p.place(i)), 0.02 - 1e-4) << speed << " " << i << " step " << k;
    }
    EXPECT_GT(run.observe("c.impulse.sum"), 10);
  }
}

// A rope falls across a triangle whose corner points up between two of its points: lines in the plane have
// sides, and the corner stays on its own.
TEST(FlatBodies, ACornerDoesNotPassARope) {
  SceneRun run(R"({"time": {"dt": 0.002}, "systems": [
      {"type": "mass_spring", "id": "rope", "rope": {"from": [-1.05, 0.8, 0], "to": [1.05, 0.8, 0], "links": 7}, "mass": 0.1,
       "stiffness": 3000, "internal_damping": 0.5, "thickness": 0.04, "integrator": "velocity_verlet"},
      {"type": "rigid2d", "id": "peak", "bodies": [{"motion": "fixed", "shapes": [{"type": "polygon", "points": [[-0.5, -0.5, 0], [0.5, -0.5, 0], [0, 0.5, 0]]}]}]}],
    "couplings": [{"type": "contact", "id": "c", "a": "rope", "b": "peak", "friction": 0.9}]})");
  for (int k = 0; k < 500; ++k) {
    run.session.step(1);
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    double least = 1;
    for (size_t i = 0; i + 1 < p.count; ++i) {
      const std::array<Vec3, 3> ends{p.place(i), p.place(i + 1), {}};
      const Vec3 corner{0, 0.5, 0};
      least = std::min(least, norm(corner - blend(ends, nearest_on_hull(corner, ends, 2), 2)));
    }
    ASSERT_GT(least, 0.02 - 1e-3) << k;
  }
  EXPECT_GT(run.observe("c.impulse.sum"), 0.5);
}

// A chain is a wall on its left side; a sleeping body wakes where a ball hits it.
TEST(FlatBodies, ChainsHoldAndSleepersWake) {
  SceneRun run(R"({"time": {"dt": 0.004}, "systems": [
      {"type": "particles", "id": "ball", "mass": 50, "radius": 0.1, "positions": [[0.1, 6, 0], [3, 1, 0]]},
      {"type": "rigid2d", "id": "flat", "bodies": [{"motion": "fixed", "shapes": [{"type": "chain", "points": [[-5, 0, 0], [0, 0, 0], [5, 0, 0]]}]},
        {"position": [0, 0.5, 0], "shapes": [{"type": "box"}], "density": 100}]}],
    "couplings": [{"type": "contact", "id": "c", "a": "ball", "b": "flat", "restitution": 0}]})");
  bool slept = false;
  for (int k = 0; k < 500; ++k) {
    run.session.step(1);
    const auto asleep = run.observe("flat.awake") == 0;
    slept |= asleep;
    const ConstPoints p(run.session.state().systems[0], *run.world->system(0).ports().points);
    for (size_t i = 0; i < p.count; ++i) ASSERT_GT(p.place(i).y, 0.09) << k;
  }
  EXPECT_TRUE(slept);
  EXPECT_GT(run.observe("c.impulse.sum"), 50);
}

TEST(JointedBodies, ThreadsAndRestoresChangeNoBit) {
  const std::string scene = scene_of(
      dust({0.4, 2, 0.3}, {0, -4, 0}, {0.8, 0.8, 0.4}) + "," + kBody + "," + kFlat,
      R"({"type": "contact", "id": "c", "a": "dust", "b": "doll", "friction": 0.5}, {"type": "contact", "a": "flat", "b": "dust"})");
  SceneRun one(scene, 1), four(scene, 4), dropped(scene, 2), restored(scene, 1);
  for (int k = 0; k < 150; ++k) {
    for (SceneRun* run : {&one, &four, &dropped}) run->session.step(1);
    dropped.session.drop_workspace();
    if (k == 100) restored.session.restore(WorldState::deserialize(one.session.state().serialize()));
    if (k > 100) restored.session.step(1);
    ASSERT_EQ(one.session.hash(), four.session.hash()) << k;
    ASSERT_EQ(one.session.hash(), dropped.session.hash()) << k;
    if (k >= 100) {
      ASSERT_EQ(one.session.hash(), restored.session.hash()) << k;
    }
  }
}

}  // namespace
}  // namespace truestep
