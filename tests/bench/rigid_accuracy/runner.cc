// rigid_accuracy_runner: our side of rigid_accuracy.py, one JSON object on stdout. A free asymmetric top (box
// 3 x 2 x 1, w = (1, 2, 3) rad/s, 10 s) by rigid3d and articulation, and a chain of ten links of 1 m (0.1 m
// thick) on ball joints, released from level, by rigid3d and by methods of articulation: CPU microseconds per
// step on one thread against the angular error of the top at the end, or the chain's energy at the end
// relative to the range of its potential. The top's true orientation is integrated here in steps of 1e-5 s.
#include <boost/json.hpp>
#include <cmath>
#include <iostream>

#include "engine/kernels/rigid/free_rotation.h"
#include "engine/systems/articulation/articulation.h"
#include "engine/systems/rigid3d/rigid3d.h"
#include "tests/bench/report.h"

namespace truestep::bench {
using namespace articulation;
using namespace rigid3d;
namespace {

namespace json = boost::json;

constexpr double kSeconds = 10, kG = 9.81;
constexpr int kLinks = 10, kTurns = 5;
const Vec3 kHalf{1.5, 1, 0.5}, kSpin{1, 2, 3};

struct Outcome {
  double microseconds = 0;
  State end;
};

/// The fastest of some runs: disturbances only make a run longer.
Outcome run(const System& system, double h, int turns) {
  Outcome out{HUGE_VAL, {}};
  const auto steps = static_cast<uint64_t>(std::llround(kSeconds / h));
  ThreadArena arena(1);
  for (int turn = 0; turn < turns; ++turn) {
    out.end = system.initial_state();
    Workspace workspace;
    const double start = thread_seconds();
    for (uint64_t k = 0; k < steps; ++k)
      system.step(out.end, {static_cast<double>(k) * h, h, k, workspace, arena});
    out.microseconds =
        std::min(out.microseconds, 1e6 * (thread_seconds() - start) / static_cast<double>(steps));
  }
  return out;
}

BuildContext context(double h) {
  BuildContext c;
  c.dt = h;
  return c;
}

/// Orientation after ten seconds, by RK4 on q and the body-frame w.
Quat true_top() {
  const Vec3 moments{kHalf.y * kHalf.y + kHalf.z * kHalf.z, kHalf.x * kHalf.x + kHalf.z * kHalf.z,
                     kHalf.x * kHalf.x + kHalf.y * kHalf.y};
  struct Top {
    Quat q;
    Vec3 w;
  };
  const auto rate = [&](const Top& s) {
    const Quat d = s.q * Quat{0, 0.5 * s.w.x, 0.5 * s.w.y, 0.5 * s.w.z};
    const Vec3 L = free_rotation::times(moments, s.w);
    return Top{d, free_rotation::divide(cross(L, s.w), moments)};
  };
  const auto ahead = [](const Top& s, const Top& d, double h) {
    return Top{{s.q.w + h * d.q.w, s.q.x + h * d.q.x, s.q.y + h * d.q.y, s.q.z + h * d.q.z}, s.w + d.w * h};
  };
  Top s{{}, kSpin};
  constexpr int kSteps = 1'000'000;
  constexpr double h = kSeconds / kSteps;
  for (int k = 0; k < kSteps; ++k) {
    const Top a = rate(s), b = rate(ahead(s, a, h / 2)), c = rate(ahead(s, b, h / 2)),
              d = rate(ahead(s, c, h));
    s = ahead(ahead(ahead(ahead(s, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
    s.q = normalized(s.q);
  }
  return s.q;
}

double angle_between(const Quat& a, const Quat& b) {
  const Quat d = b * Quat{a.w, -a.x, -a.y, -a.z};
  return 2 * std::atan2(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z), std::abs(d.w));
}

json::object point(const char* problem, const std::string& method, int hertz, const Outcome& o,
                   double error) {
  return {{"problem", problem},
          {"method", method},
          {"hertz", hertz},
          {"microseconds", o.microseconds},
          {"error", error}};
}

json::object top(int hertz, const Quat& truth) {
  Rigid3dDef d;
  BoxBodyDef box;
  box.half_extents = kHalf, box.angular_velocity = kSpin;
  d.bodies = {box}, d.gravity = Vec3{}, d.sleeping = false;
  const BuildContext c = context(1.0 / hertz);
  const auto system = build_rigid3d(&d, c);
  const Outcome o = run(*system, c.dt, kTurns);
  // Bodies are oriented along their principal axes, which need not be those of the box.
  const auto start = system->initial_state();
  const auto orientation = [](const State& s) {
    const double* q = s.f64(s.at("orientation")).data();
    return Quat{q[0], q[1], q[2], q[3]};
  };
  const Quat q0 = orientation(start);
  const Quat turned = orientation(o.end) * Quat{q0.w, -q0.x, -q0.y, -q0.z};
  return point("top", "rigid3d", hertz, o, angle_between(turned, truth));
}

/// Energy at the end relative to the range of the potential; the start is its maximum.
double chain_error(const System& system, const Outcome& o, double mass) {
  const auto energy = [&](const State& s) {
    Observables seen;
    system.observe(s, 0, seen);
    return seen.find("energy.total").value();
  };
  double range = 0;
  for (int i = 0; i < kLinks; ++i) range += mass * kG * (i + 0.5);
  return (energy(o.end) - energy(system.initial_state())) / range;
}

json::object free_chain(int hertz) {
  Rigid3dDef d;
  BoxBodyDef box;
  box.half_extents = {0.5, 0.05, 0.05}, box.mass = 1, box.mask = 0;
  for (int i = 0; i < kLinks; ++i) {
    box.position = {i + 0.5, 0, 0};
    d.bodies.push_back(box);
    BallJointDef j;
    j.a = i - 1, j.b = i, j.anchor = Vec3{static_cast<double>(i), 0, 0};
    d.joints.push_back(j);
  }
  d.sleeping = false;
  const BuildContext c = context(1.0 / hertz);
  const auto system = build_rigid3d(&d, c);
  const Outcome o = run(*system, c.dt, 2);
  return point("chain", "rigid3d", hertz, o, chain_error(*system, o, 1));
}

json::object tree_chain(int hertz, const std::string& method, double tolerance) {
  ArticulationDef d;
  for (int i = 0; i < kLinks; ++i) {
    LinkDef l;
    l.joint = JointType::spherical, l.mass = 1;
    BoxLinkDef box;
    box.half_extents = {0.5, 0.05, 0.05}, box.position = {0.5, 0, 0};
    l.shapes = {box};
    if (i > 0) l.offset = {1, 0, 0};
    d.links.push_back(l);
  }
  d.integrator = method;
  if (tolerance > 0) d.absolute_tolerance = tolerance, d.relative_tolerance = 0;
  const BuildContext c = context(1.0 / hertz);
  const auto system = build_articulation(&d, c);
  const Outcome o = run(*system, c.dt, 2);
  std::string name = "articulation " + method;
  if (tolerance > 0) name += " to " + json::serialize(json::value(tolerance));
  return point("chain", name, hertz, o, chain_error(*system, o, 1));
}

}  // namespace
}  // namespace truestep::bench

int main() {
  using namespace truestep::bench;
  json::array points;
  const truestep::Quat truth = true_top();
  for (const int hertz : {60, 240, 960}) {
    points.push_back(top(hertz, truth));
    points.push_back(free_chain(hertz));
    points.push_back(tree_chain(hertz, "rk4", 0));
  }
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-12})
    points.push_back(tree_chain(60, "dop853", tolerance));
  std::cout << json::object{{"truth", {truth.w, truth.x, truth.y, truth.z}}, {"points", points}} << std::endl;
}
