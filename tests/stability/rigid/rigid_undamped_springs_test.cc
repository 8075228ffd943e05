// Undamped springs conserve their energy: what they take from the bodies they give back, in an oscillating
// pair (against its closed form, second order in dt) and in a closed heap of springs for a minute. Springs
// too stiff for the step gain none either.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/kernels/rigid/free_rotation.h"
#include "tests/support/rigid2d_run.h"
#include "tests/support/rigid3d_run.h"

namespace truestep::testing {
using namespace rigid3d;
namespace {

constexpr double kTurn = 6.283185307179586;

/// Two bodies of 1 and 3 kg on a spring of 1 m along x, stretched by 0.5 m, parting at 2 m/s.
struct Pair {
  double hertz = 2, stretched = 0.5, parting = 2;
  double exact(double t) const {
    const double w = kTurn * hertz;
    return stretched * std::cos(w * t) + parting / w * std::sin(w * t);
  }
  double amplitude() const { return std::hypot(stretched, parting / (kTurn * hertz)); }
};

/// Worst error of the length in ten periods, relative to the amplitude; in space, by hertz or N/m, and in the
/// plane.
double space_error(double dt, bool by_hertz, double dampen = 0) {
  const Pair p;
  Rigid3dDef d;
  d.sleeping = false;
  for (const double x : {0.0, 1 + p.stretched}) {
    SphereBodyDef b = ball(0.1, {x, 0, 0});
    b.mass = x == 0 ? 1 : 3, b.velocity = {x == 0 ? -0.75 * p.parting : 0.25 * p.parting, 0, 0};
    d.bodies.push_back(b);
  }
  SpringJointDef s;
  s.a = 0, s.b = 1, s.length = 1, s.damping_ratio = dampen;
  if (by_hertz) {
    s.hertz = p.hertz;
  } else {
    s.stiffness = 0.75 * kTurn * kTurn * p.hertz * p.hertz;
  }
  d.joints.push_back(s);
  RigidRun run(d, dt, 1, {});
  double worst = 0;
  while (run.t() < 10 / p.hertz - 0.5 * dt) {
    run.run(1);
    worst = std::max(worst, std::abs(run.x(1).x - run.x(0).x - 1 - p.exact(run.t())));
  }
  return worst / p.amplitude();
}
double plane_error(double dt) {
  const Pair p;
  FlatTrial t(R"("sleeping": false, "precision": "f64", "gravity": [0, 0, 0], "bodies": [
    {"mass": 1, "velocity": [-1.5, 0, 0], "shapes": [{"type": "circle", "radius": 0.1}]},
    {"mass": 3, "position": [1.5, 0, 0], "velocity": [0.5, 0, 0], "shapes": [{"type": "circle", "radius": 0.1}]}],
    "joints": [{"type": "distance", "a": 0, "b": 1, "anchor": [0, 0, 0], "anchor_b": [1.5, 0, 0], "length": 1,
                "hertz": 2, "damping_ratio": 0}])",
              dt);
  double worst = 0;
  const int steps = static_cast<int>(10 / p.hertz / dt + 0.5);
  for (int k = 0; k < steps; ++k) {
    t.steps(1);
    worst = std::max(worst, std::abs(t.position(1).x - t.position(0).x - 1 - p.exact((k + 1) * dt)));
  }
  return worst / p.amplitude();
}

TEST(UndampedSprings, APairSwingsAsItShouldToSecondOrder) {
  const auto check = [](const char* what, auto&& error) {
    const double coarse = error(1.0 / 60), fine = error(1.0 / 240);
    std::printf("%s: %.2e of the amplitude at 60 Hz, %.2e at 240 Hz\n", what, coarse, fine);
    // Verlet's phase: 10 turns of w^2 h^2 / 24 each, h a fifth of a step (a quarter in the plane).
    EXPECT_LT(coarse, 8e-3) << what;
    EXPECT_GT(std::log2(coarse / fine) / 2, 1.7) << what;
  };
  check("space, hertz", [](double dt) { return space_error(dt, true); });
  check("space, N/m", [](double dt) { return space_error(dt, false); });
  check("plane, hertz", plane_error);
  // The control: a spring that loses a hundredth of its amplitude per period.
  EXPECT_GT(space_error(1.0 / 240, true, 0.0016), 5e-2);
}

constexpr int kBodies = 6;

struct Spring {
  int a, b;
  Vec3 at_a, at_b;  // in the bodies' frames, level at t = 0
  double length;
};

/// Random bodies, each one tied to the next and to others at points off their centres.
struct Heap {
  std::mt19937 random{3};
  std::vector<Vec3> x, v, w;
  std::vector<double> mass;
  std::vector<Spring> springs;
  double u() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  explicit Heap(bool flat) {
    const auto any = [&](double most) { return Vec3{most * u(), most * u(), flat ? 0 : most * u()}; };
    for (int k = 0; k < kBodies; ++k) {
      x.push_back(any(2)), v.push_back(any(1)), mass.push_back(1 + 0.5 * u());
      w.push_back(flat ? Vec3{0, 0, 2 * u()} : any(2));
    }
    for (int a = 0; a < kBodies; ++a) {
      for (int b = a + 1; b < kBodies; ++b) {
        if (b != a + 1 && u() < 0.3) continue;
        const Vec3 at_a = any(0.15), at_b = any(0.15);
        springs.push_back({a, b, at_a, at_b, norm(x[b] + at_b - x[a] - at_a)});
      }
    }
  }
};

struct Energies {
  double kinetic_first = 0, kinetic_last = 0;  // means over the first and last ten seconds
  double first = 0, least = HUGE_VAL, most = 0, last = 0;
  void add(double kinetic, double total, double t) {
    if (t <= 10) kinetic_first += kinetic;
    if (t > 50) kinetic_last += kinetic;
    least = std::min(least, total), most = std::max(most, total), last = total;
  }
};

enum class By { stiffness, hertz };

Energies heap_in_space(By by, Rigid3dDef::Precision precision, double dt) {
  const Heap heap(false);
  Rigid3dDef d;
  d.sleeping = false, d.precision = precision;
  for (size_t k = 0; k < kBodies; ++k) {
    BoxBodyDef b = box({0.2, 0.15, 0.1}, heap.x[k]);
    b.mask = 0, b.mass = heap.mass[k], b.velocity = heap.v[k], b.angular_velocity = heap.w[k];
    d.bodies.push_back(b);
  }
  for (const Spring& s : heap.springs) {
    SpringJointDef j;
    j.a = s.a, j.b = s.b, j.anchor = heap.x[s.a] + s.at_a, j.anchor_b = heap.x[s.b] + s.at_b;
    if (by == By::stiffness) {
      j.stiffness = 30;
    } else {
      j.hertz = 1;
    }
    j.damping_ratio = 0;
    d.joints.push_back(j);
  }
  RigidRun run(d, dt, 1, {});
  const JointList built = build_joints(d, build_bodies(d, 7));
  const auto total = [&](double kinetic) {
    double sum = kinetic;
    for (size_t k = 0; k < heap.springs.size(); ++k) {
      const Spring& s = heap.springs[k];
      const auto at = [&](int i, Vec3 r) { return run.x(i) + rotation(run.q(i)).apply(r); };
      const Joint& j = built.joints[k];
      const double stretched = norm(at(s.b, j.anchor_b) - at(s.a, j.anchor_a)) - s.length;
      sum += 0.5 * built.drives[j.first_drive].stiffness * stretched * stretched;
    }
    return sum;
  };
  Energies e;
  e.first = total(run.observed("energy.kinetic"));
  while (run.t() < 60 - 0.5 * dt) {
    run.run(1);
    const double kinetic = run.observed("energy.kinetic");
    e.add(kinetic, total(kinetic), run.t());
  }
  return e;
}

TEST(UndampedSprings, AClosedHeapInSpaceKeepsItsEnergyForAMinute) {
  for (const By by : {By::stiffness, By::hertz}) {
    for (const auto precision : {Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64}) {
      const Energies e = heap_in_space(by, precision, 1.0 / 60);
      std::printf("%s %s: energy %.4f to %.4f of the first, kinetic %.3f of the first ten seconds'\n",
                  by == By::hertz ? "hertz" : "N/m", precision == Rigid3dDef::Precision::f32 ? "f32" : "f64",
                  e.least / e.first, e.most / e.first, e.kinetic_last / e.kinetic_first);
      // Springs oscillate by (h w)^2 / 8 = 1e-4 in a substep, and bodies between them rotate freely.
      EXPECT_GT(e.least / e.first, 0.998);
      EXPECT_LT(e.most / e.first, 1.002);
    }
  }
}

TEST(UndampedSprings, AClosedHeapInThePlaneKeepsItsEnergyForAMinute) {
  const Heap heap(true);
  for (const char* precision : {"f32", "f64"}) {
    const auto n = [](double x) { return FlatTrial::number(x); };
    const auto vec = [&](Vec3 r) { return "[" + n(r.x) + "," + n(r.y) + ",0]"; };
    std::string scene = std::string(R"("sleeping": false, "gravity": [0, 0, 0], "precision": ")") +
                        precision + R"(", "bodies": [)";
    for (size_t k = 0; k < kBodies; ++k) {
      scene += std::string(k ? "," : "") + R"({"mask": 0, "mass": )" + n(heap.mass[k]) + R"(, "position": )" +
               vec(heap.x[k]) + R"(, "velocity": )" + vec(heap.v[k]) + R"(, "angular_velocity": )" +
               n(heap.w[k].z) + R"(, "shapes": [{"type": "box", "half_extents": [0.2, 0.1, 0]}]})";
    }
    scene += R"(], "joints": [)";
    std::vector<double> stiffness;
    for (const Spring& s : heap.springs) {
      scene += std::string(&s == &heap.springs[0] ? "" : ",") + R"({"type": "distance", "a": )" +
               std::to_string(s.a) + R"(, "b": )" + std::to_string(s.b) + R"(, "anchor": )" +
               vec(heap.x[s.a] + s.at_a) + R"(, "anchor_b": )" + vec(heap.x[s.b] + s.at_b) +
               R"(, "hertz": 1, "damping_ratio": 0})";
      // A body's inertia is m (0.4^2 + 0.2^2) / 12.
      const Vec3 along = (heap.x[s.b] + s.at_b - heap.x[s.a] - s.at_a) / s.length;
      const auto turns = [&](Vec3 r) { return r.x * along.y - r.y * along.x; };
      const double k = 1 / heap.mass[s.a] + 1 / heap.mass[s.b] +
                       60 * (turns(s.at_a) * turns(s.at_a) / heap.mass[s.a] +
                             turns(s.at_b) * turns(s.at_b) / heap.mass[s.b]);
      stiffness.push_back(kTurn * kTurn / k);
    }
    FlatTrial t(scene + "]");
    const auto total = [&](double kinetic) {
      double sum = kinetic;
      for (size_t k = 0; k < heap.springs.size(); ++k) {
        const Spring& s = heap.springs[k];
        const auto at = [&](int i, Vec3 r) {
          const double c = std::cos(t.angle(i)), q = std::sin(t.angle(i));
          return t.position(i) + Vec3{c * r.x - q * r.y, q * r.x + c * r.y, 0};
        };
        const double stretched = norm(at(s.b, s.at_b) - at(s.a, s.at_a)) - s.length;
        sum += 0.5 * stiffness[k] * stretched * stretched;
      }
      return sum;
    };
    Energies e;
    e.first = total(t.observed("energy.kinetic"));
    for (int k = 1; k <= 3600; ++k) {
      t.steps(1);
      const double kinetic = t.observed("energy.kinetic");
      e.add(kinetic, total(kinetic), k / 60.0);
    }
    std::printf("plane %s: energy %.4f to %.4f of the first, kinetic %.3f of the first ten seconds'\n",
                precision, e.least / e.first, e.most / e.first, e.kinetic_last / e.kinetic_first);
    EXPECT_NEAR(e.last / e.first, 1, 0.02);
    EXPECT_GT(e.least / e.first, 0.96);
    EXPECT_LT(e.most / e.first, 1.04);
  }
}

/// Two boxes that spin, on one spring whose anchors lie off their centres: energy goes into fast rotations
/// whose axes change all the time. Means of the energy over the first and the last of four parts of the time,
/// relative to that at the start, and the change of the angular momentum relative to the largest that a box
/// has had.
struct OffCentre {
  double early = 0, late = 0, least = HUGE_VAL, most = 0, moment = 0;
};
OffCentre spinning_pair(double stiffness, Rigid3dDef::Precision precision, double seconds,
                        double damping = 0) {
  Rigid3dDef d;
  d.sleeping = false, d.precision = precision;
  for (const double side : {1.0, -1.0}) {
    BoxBodyDef b = box({0.1, 0.2, 0.15}, {side > 0 ? 0 : 0.8, 0, 0});
    b.mask = 0, b.mass = 1, b.velocity = {0.3 * side, side > 0 ? 0.2 : 0.1, 0};
    b.angular_velocity = side * Vec3{1.5, 0.9, 3};
    d.bodies.push_back(b);
  }
  SpringJointDef s;
  s.a = 0, s.b = 1, s.length = 0.4, s.stiffness = stiffness, s.damping = damping;
  s.anchor = Vec3{0.1, 0.1, 0}, s.anchor_b = Vec3{0.7, 0.05, 0};
  d.joints.push_back(s);
  RigidRun run(d, 1.0 / 60, 1, {});
  const BodyList bodies = build_bodies(d, 7);
  const auto own = [&](size_t i) {
    const BodyKind& kind = bodies.kinds[run.state.span<uint32_t>(columns::kind)[i]];
    return free_rotation::momentum({run.q(i), run.w(i)}, kind.moments);
  };
  const auto whole = [&] {
    Vec3 sum;
    for (size_t i = 0; i < 2; ++i) sum += cross(run.x(i), run.v(i)) + own(i);
    return sum;
  };
  const Vec3 before = whole();
  const double first = run.observed("energy.total");
  OffCentre out;
  double largest = 0;
  const int steps = static_cast<int>(60 * seconds), part = steps / 4;
  for (int k = 0; k < steps; ++k) {
    run.run(1);
    const double e = run.observed("energy.total") / first;
    out.least = std::min(out.least, e), out.most = std::max(out.most, e);
    if (k < part) out.early += e / part;
    if (k >= steps - part) out.late += e / part;
    largest = std::max(largest, norm(own(0)));
  }
  out.moment = norm(whole() - before) / largest;
  return out;
}

TEST(UndampedSprings, APairWithAnchorsOffCentreGainsNothing) {
  // The springs turn by 0.15 and 0.21 rad in a substep, half as much again at the ends of the arms; at twice
  // the stiffness they would be implicit in some poses.
  for (const double stiffness : {1000.0, 2000.0}) {
    for (const auto precision : {Rigid3dDef::Precision::f32, Rigid3dDef::Precision::f64}) {
      const OffCentre e = spinning_pair(stiffness, precision, 120);
      std::printf("%g N/m %s: energy %.4f, then %.4f (%.3f to %.3f), angular momentum %.1e\n", stiffness,
                  precision == Rigid3dDef::Precision::f32 ? "f32" : "f64", e.early, e.late, e.least, e.most,
                  e.moment);
      EXPECT_NEAR(e.late, e.early, 3e-3);
      EXPECT_GT(e.least, 0.97);  // (h w)^2 / 4 within an oscillation
      EXPECT_LT(e.most, 1.01);
      EXPECT_LT(e.moment, 1e-3);
    }
  }
  // At 5000 N/m an oscillation turns by up to 0.6 rad in a substep, more than half a radian in some poses.
  // While those were implicit, the pair kept 3 % of its energy after 20 s in the plane.
  const OffCentre stiff = spinning_pair(5000, Rigid3dDef::Precision::f64, 120);
  EXPECT_NEAR(stiff.late, stiff.early, 0.01);
  EXPECT_GT(stiff.least, 0.9);
  EXPECT_LT(stiff.most, 1.03);
  FlatTrial plane(R"("sleeping": false, "precision": "f64", "gravity": [0, 0, 0], "bodies": [
    {"mask": 0, "mass": 1, "velocity": [0.3, 0.2, 0], "angular_velocity": 3,
     "shapes": [{"type": "box", "half_extents": [0.1, 0.2, 0]}]},
    {"mask": 0, "mass": 1, "position": [0.8, 0, 0], "velocity": [-0.3, 0.1, 0], "angular_velocity": -3,
     "shapes": [{"type": "box", "half_extents": [0.1, 0.2, 0]}]}],
    "joints": [{"type": "spring", "a": 0, "b": 1, "anchor": [0.1, 0.1, 0], "anchor_b": [0.7, 0.05, 0],
                "length": 0.4, "stiffness": 5000, "damping": 0}])");
  const double first = plane.observed("energy.total");
  double mean = 0;
  plane.steps(6000);
  for (int k = 0; k < 1200; ++k) mean += plane.steps(1).observed("energy.total") / first / 1200;
  // What leapfrog keeps differs from the energy by up to (h w)^2 / 4 within an oscillation.
  EXPECT_GT(mean, 0.9);
  EXPECT_LT(mean, 1.03);
  // The control: a spring that loses a few parts in ten thousand of its amplitude per oscillation.
  const OffCentre damped = spinning_pair(1000, Rigid3dDef::Precision::f64, 120, 1e-3);
  EXPECT_GT(damped.early - damped.late, 3e-3);
}

// A spring on a hinge that is far stiffer than the step resolves, at the end of a chain of sliders: it was
// pulled back by its whole error in every substep, the sliders answered a pass late, and 12 J became 150 kJ.

/// Four boxes in a row that move and turn at random (seed 739342 of the campaign).
Rigid3dDef chain(double stiffness) {
  Rigid3dDef d;
  const struct {
    double mass;
    Vec3 v, w;
  } start[] = {{1.2177487, {0.9352436, 0.1691249, 0.4477647}, {-1.4805397, -0.5567157, 2.0506703}},
               {2.8478544, {-1.3515941, 0.1833195, -0.6713781}, {2.0092427, -1.1642148, -1.8378911}},
               {0.3511053, {-0.4180503, -1.0239258, -1.2076557}, {-2.6743591, -0.8038248, -1.9461303}},
               {2.6152521, {1.2295774, 1.2316407, 1.1636740}, {0.7702020, 0.8556183, 1.5325450}}};
  for (int i = 0; i < 4; ++i) {
    BoxBodyDef b = box({0.4, 0.2, 0.3}, {double(i), 0, 0});
    b.mass = start[i].mass, b.velocity = start[i].v, b.angular_velocity = start[i].w, b.mask = 0;
    d.bodies.push_back(b);
  }
  const auto join = [&](auto j, int a, Vec3 axis) {
    j.a = a, j.b = a + 1, j.axis = axis, j.anchor = Vec3{a + 0.5, 0, 0};
    d.joints.push_back(j);
  };
  join(SliderJointDef{}, 0, {0.9029426, 0.3057894, -0.3019727});
  join(SliderJointDef{}, 1, {0.5189856, -0.7799348, -0.3497937});
  HingeJointDef hinge;
  hinge.stiffness = stiffness, hinge.damping = 0;
  join(hinge, 2, {0.9800826, 0.1073307, -0.1670875});
  return d;
}

TEST(Rigid3dStiffDrives, AtTheEndOfSlidersAreNotFed) {
  for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240}) {
    for (const double stiffness : {1e4, 3e4, 9.4e4, 3e5}) {
      RigidRun run(chain(stiffness), dt, 1, {});
      const double first = run.observed("energy.kinetic");
      double most = 0;
      for (int k = 0; k < static_cast<int>(4 / dt); ++k) {
        run.run(1);
        most = std::max(most, run.observed("energy.total"));
      }
      // At 1e6 N m the angle that the joints leave open, some mrad, holds as much as the bodies have.
      EXPECT_LT(most, first) << dt << " s, " << stiffness << " N m";
    }
  }
}

TEST(Rigid3dStiffDrives, HoldTheirLoadWhereItBelongs) {
  // The equilibrium stays that of the spring, however stiff: a beam of 10 kg on a hinge, 1 m from its centre.
  for (const double stiffness : {1e3, 1e4, 1e6}) {
    Rigid3dDef d;
    BoxBodyDef beam = box({1, 0.1, 0.1}, {1, 0, 0});
    beam.mass = 10;
    d.bodies.push_back(beam);
    HingeJointDef hinge;
    hinge.b = 0, hinge.axis = {0, 0, 1}, hinge.anchor = Vec3{};
    hinge.stiffness = stiffness, hinge.damping = 0.1 * stiffness;
    d.joints.push_back(hinge);
    d.sleeping = false, d.precision = Rigid3dDef::Precision::f64;
    RigidRun run(d, 1.0 / 60);
    run.seconds(10);
    const double angle = -2 * std::atan2(run.q(0).z, run.q(0).w);
    // It has come to rest; the softest one swings with exp(-37) of its first amplitude.
    EXPECT_NEAR(angle * stiffness, 10 * 9.81 * std::cos(angle), 1e-6 * 98.1) << stiffness;
  }
}

}  // namespace
}  // namespace truestep::testing
