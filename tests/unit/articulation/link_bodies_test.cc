// Links of a tree as bodies, through their port: where they are, the response to an impulse against the
// tree's mass matrix, momentum.
#include <cmath>

#include "engine/geometry/transform.h"
#include "engine/systems/articulation/link_bodies.h"
#include "tests/support/jointed_bodies.h"

namespace truestep {
namespace {

using namespace testing_coupled;

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

}  // namespace
}  // namespace truestep
