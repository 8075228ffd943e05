// Curves through keys and orientations between them against closed forms and the reference cases anim.splines
// and anim.slerp.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/kernels/animation/arc_length.h"
#include "engine/kernels/animation/rotations.h"

namespace truestep::animation {
namespace {

constexpr Interpolation kAll[] = {Interpolation::step,    Interpolation::linear, Interpolation::catmull_rom,
                                  Interpolation::hermite, Interpolation::bezier, Interpolation::natural,
                                  Interpolation::monotone};

KeyCurve curve(const std::vector<double>& t, const std::vector<double>& v, Interpolation kind,
               Extend extend = Extend::clamp, const std::vector<double>& slopes = {}) {
  Keys keys{.width = 1, .times = t, .values = v};
  keys.slopes_in = slopes, keys.interpolation = kind, keys.extend = extend;
  return KeyCurve(keys);
}
double at(const KeyCurve& c, double t) {
  double v;
  c.sample(t, &v);
  return v;
}
double rate(const KeyCurve& c, double t) {
  double v, r;
  c.sample(t, &v, &r);
  return r;
}

TEST(KeyCurve, CatmullRomHasItsWeights) {
  // anim.splines
  const double want[] = {-0.0735, 0.8155, 0.2895, -0.0315};
  const FourWeights w = catmull_rom_weights(0.3);
  for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(w.w[k], want[k], 1e-14);
  const double half[] = {-1, 9, 9, -1};
  for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(catmull_rom_weights(0.5).w[k], half[k] / 16, 1e-14);
  // The curve through equally spaced keys is that sum.
  const std::vector<double> v{0.3, -1.2, 2.5, 0.7};
  double sum = 0;
  for (size_t k = 0; k < 4; ++k) sum += w.w[k] * v[k];
  EXPECT_NEAR(at(curve({0, 1, 2, 3}, v, Interpolation::catmull_rom), 1.3), sum, 1e-14);
}

TEST(KeyCurve, MiddleErrorOnASineIsTheReferencesOne) {
  // anim.splines: sin in the middle of the interval that begins at x = 0.7, keys h apart; order 4 there.
  const double want[] = {1.5962601e-6, 9.7118746e-8};
  for (int k = 0; k < 2; ++k) {
    const double h = k == 0 ? 0.1 : 0.05;
    std::vector<double> t, v;
    for (int i = -1; i <= 2; ++i) t.push_back(0.7 + i * h), v.push_back(std::sin(t.back()));
    const double x = 0.7 + 0.5 * h;
    const double error = std::abs(at(curve(t, v, Interpolation::catmull_rom), x) - std::sin(x));
    // The reference has eight digits.
    EXPECT_NEAR(error, want[k], 1e-7 * want[k] + 1e-15);
  }
}

TEST(KeyCurve, ReproducesPolynomials) {
  // Uneven times: quadratics by Catmull-Rom, cubics by Hermite with exact slopes, lines by every smooth kind.
  // 1e-13: rounding of values of order 10.
  const std::vector<double> t{-0.5, 0.1, 0.9, 1.0, 2.2};
  const auto values = [&](auto f) {
    std::vector<double> v;
    for (const double x : t) v.push_back(f(x));
    return v;
  };
  const auto square = [](double x) { return 3 * x * x - x + 2; };
  const auto cubic = [](double x) { return x * x * x - 2 * x * x + x + 1; };
  const auto slope = [](double x) { return 3 * x * x - 4 * x + 1; };
  const auto line = [](double x) { return 2 * x - 1; };
  const KeyCurve q = curve(t, values(square), Interpolation::catmull_rom);
  const KeyCurve c = curve(t, values(cubic), Interpolation::hermite, Extend::clamp, values(slope));
  const KeyCurve b = curve(t, values(cubic), Interpolation::bezier, Extend::clamp, values(slope));
  for (double x = -0.5; x <= 2.2; x += 0.0371) {
    EXPECT_NEAR(at(q, x), square(x), 1e-13);
    EXPECT_NEAR(at(c, x), cubic(x), 1e-13);
    EXPECT_NEAR(rate(c, x), slope(x), 1e-12);
    // A Bezier curve with handles of a third equals Hermite's.
    EXPECT_NEAR(at(b, x), cubic(x), 1e-12);
    EXPECT_NEAR(rate(b, x), slope(x), 1e-11);
    for (const Interpolation kind : kAll) {
      if (kind == Interpolation::step) continue;
      EXPECT_NEAR(at(curve(t, values(line), kind), x), line(x), 1e-13);
    }
  }
  // The control: the natural spline does not reproduce a quadratic.
  EXPECT_GT(std::abs(at(curve(t, values(square), Interpolation::natural), -0.3) - square(-0.3)), 1e-3);
}

TEST(KeyCurve, GoesThroughItsKeysWithRatesThatAreDerivatives) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> t, v;
  for (int i = 0; i < 9; ++i) t.push_back(i + 0.3 * u(engine)), v.push_back(u(engine));
  for (const Interpolation kind : kAll) {
    const KeyCurve c = curve(t, v, kind);
    for (size_t i = 0; i < t.size(); ++i) EXPECT_NEAR(at(c, t[i]), v[i], 1e-13);
    for (double x = t[0] + 0.01; x < t.back() - 0.01; x += 0.0913) {
      const double h = 1e-6;
      if (std::ranges::any_of(t, [&](double k) { return std::abs(k - x) < 2 * h; })) continue;
      // Central differences of a cubic: rounding 1e-10, third derivative times h^2 below that.
      EXPECT_NEAR(rate(c, x), (at(c, x + h) - at(c, x - h)) / (2 * h), 2e-8) << static_cast<int>(kind);
    }
  }
}

// Before the first key and behind the last one too, where a curve that turns back runs the other way.
TEST(KeyCurve, RatesFollowTheCurveBeyondItsEnds) {
  const std::vector<double> t{0, 0.7, 1.5, 3.1, 4}, v{1, -2, 0.5, 2, 1};
  for (const Interpolation kind : kAll) {
    for (const Extend extend : {Extend::clamp, Extend::loop, Extend::ping_pong}) {
      const KeyCurve c = curve(t, v, kind, extend);
      for (double x = -9.96; x < 14; x += 0.3713) {
        const double h = 1e-6;
        EXPECT_NEAR(rate(c, x), (at(c, x + h) - at(c, x - h)) / (2 * h), 2e-7)
            << static_cast<int>(kind) << " " << static_cast<int>(extend) << " at " << x;
      }
    }
  }
}

TEST(KeyCurve, NaturalHasContinuousBendingThatVanishesAtTheEnds) {
  const std::vector<double> t{0, 0.7, 1.5, 3.1, 4}, v{1, -2, 0.5, 2, 1};
  const KeyCurve c = curve(t, v, Interpolation::natural);
  const double h = 1e-4;
  const auto bend = [&](double x) { return (at(c, x + h) - 2 * at(c, x) + at(c, x - h)) / (h * h); };
  // One-sided second differences are off by h times the third derivative, of order 10.
  EXPECT_NEAR(bend(t.front() + h), 0, 1e-2);
  EXPECT_NEAR(bend(t.back() - h), 0, 1e-2);
  for (size_t i = 1; i + 1 < t.size(); ++i) EXPECT_NEAR(bend(t[i] - 2 * h), bend(t[i] + 2 * h), 2e-2);
  const KeyCurve other = curve(t, v, Interpolation::catmull_rom);
  const auto jump = [&](double x) {
    return std::abs((at(other, x + 2 * h) - 2 * at(other, x + h) + at(other, x)) -
                    (at(other, x) - 2 * at(other, x - h) + at(other, x - 2 * h))) /
           (h * h);
  };
  EXPECT_GT(jump(t[2]), 0.1) << "Catmull-Rom has corners in its slope: the control";
}

TEST(KeyCurve, MonotoneNeverLeavesTwoKeys) {
  const std::vector<double> t{0, 1, 1.1, 3, 4, 5}, v{0, 0.01, 5, 5.1, 5.1, 9};
  const KeyCurve c = curve(t, v, Interpolation::monotone), over = curve(t, v, Interpolation::catmull_rom);
  double before = 0, lowest = 0;
  for (double x = 0; x <= 5; x += 0.001) {
    EXPECT_GE(at(c, x), before - 1e-15);
    before = at(c, x), lowest = std::min(lowest, at(over, x));
  }
  EXPECT_LT(lowest, -0.1) << "Catmull-Rom overshoots: the control";
}

TEST(KeyCurve, BezierHandlesBendTime) {
  const std::vector<double> t{0, 1}, v{0, 1}, slopes{0, 0}, handles{0.5, 0.9, 0.9, 0.5};
  Keys keys{.width = 1, .times = t, .values = v};
  keys.slopes_in = slopes, keys.handles = handles, keys.interpolation = Interpolation::bezier;
  const KeyCurve c(keys);
  EXPECT_NEAR(at(c, 0.5), 0.5, 1e-15) << "symmetric";
  EXPECT_LT(at(c, 0.25), at(curve(t, v, Interpolation::hermite, Extend::clamp, slopes), 0.25) - 0.03);
  for (double x = 0; x <= 1; x += 0.01) {
    const double s = bezier_parameter(x, 0.9, 0.1), r = 1 - s;
    EXPECT_NEAR(3 * s * r * r * 0.9 + 3 * s * s * r * 0.1 + s * s * s, x, 1e-15);
  }
  for (const double a : {0.0, 1.0}) {
    for (const double b : {0.0, 1.0})
      EXPECT_NEAR(bezier_parameter(0, a, b) + 1 - bezier_parameter(1, a, b), 0, 1e-7);
  }
}

TEST(KeyCurve, LoopsAndTurnsBack) {
  const std::vector<double> t{1, 2, 4}, v{0, 3, 0};
  const KeyCurve loop = curve(t, v, Interpolation::linear, Extend::loop);
  const KeyCurve back = curve(t, v, Interpolation::linear, Extend::ping_pong);
  const KeyCurve clamp = curve(t, v, Interpolation::linear);
  for (double x = 1.05; x < 4; x += 0.1) {
    EXPECT_NEAR(at(loop, x + 9), at(clamp, x), 1e-12);
    EXPECT_NEAR(at(loop, x - 6), at(clamp, x), 1e-12);
    EXPECT_NEAR(at(back, x + 6), at(clamp, x), 1e-12);
    EXPECT_NEAR(at(back, 8 - x), at(clamp, x), 1e-12);
    EXPECT_EQ(rate(back, 8 - x), -rate(clamp, x));
  }
  EXPECT_EQ(at(clamp, 100), 0);
  EXPECT_EQ(rate(clamp, 100), 0);
  EXPECT_NEAR(rate(curve({0, 1, 2, 3}, {0, 1, -1, 0}, Interpolation::catmull_rom, Extend::loop), 3),
              rate(curve({0, 1, 2, 3}, {0, 1, -1, 0}, Interpolation::catmull_rom, Extend::loop), 1e-12), 1e-9)
      << "a closed loop has no corner";
}

TEST(FrameTime, FramesAreExact) {
  for (const double rate : {12.0, 24.0, 30.0, 60.0, 90.0}) {
    for (int k = 0; k < 1000; ++k) {
      const double frame = k / rate;
      EXPECT_EQ(frame_time(frame, rate), frame);
      EXPECT_EQ(frame_time(frame + 0.7 / rate, rate), frame);
    }
  }
  EXPECT_EQ(frame_time(0.123, 0), 0.123);
}

TEST(Rotations, SlerpIsTheReferencesOne) {
  // anim.slerp: the identity to a quarter turn about z.
  const Quat a, b = turn_about({0, 0, 1}, 1.5707963267948966);
  const Quat q = slerp(a, b, 0.3);
  EXPECT_NEAR(q.w, 0.97236992039767660183, 1e-12);
  EXPECT_NEAR(q.z, 0.23344536385590541177, 1e-12);
  double worst = 0, where = 0;
  for (double s = 0; s <= 0.5; s += 1e-5) {
    const Quat n = nlerp(a, b, s);
    const double off = std::abs(2 * std::atan2(n.z, n.w) - s * 1.5707963267948966) * 57.29577951308232;
    if (off > worst) worst = off, where = s;
  }
  // Samples 1e-5 apart: at the maximum the curve is flat, and its position is known to half a sample.
  EXPECT_NEAR(worst, 0.918815084302071, 1e-8);
  EXPECT_NEAR(where, 0.217459193499, 1e-5);
}

TEST(Rotations, SlerpTakesTheShorterArcAndKeepsItsSpeed) {
  const Quat a = turn_about(normalized(Vec3{1, 2, 3}), 0.4),
             b = turn_about(normalized(Vec3{-1, 1, 0.2}), 2.0);
  const Quat minus{-b.w, -b.x, -b.y, -b.z};
  const Quat p = slerp(a, b, 0.7), q = slerp(a, minus, 0.7);
  EXPECT_NEAR(std::abs(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z), 1, 1e-15);
  const auto angle = [](const Quat& from, const Quat& to) {
    return norm(free_rotation::rotation_vector(conjugate(from) * to));
  };
  for (double s = 0; s < 1; s += 0.1) {
    EXPECT_NEAR(angle(slerp(a, b, s), slerp(a, b, s + 0.1)), 0.1 * angle(a, b), 1e-13);
  }
}

TEST(Rotations, SquadHasNoCorners) {
  std::vector<double> t;
  std::vector<Quat> q;
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 6; ++i)
    t.push_back(i), q.push_back(free_rotation::turn({u(engine), u(engine), u(engine)}));
  const double h = 1e-5;
  const auto corner = [&](Turning turning) {
    const RotationCurve c(t, q, turning, Extend::clamp);
    double most = 0;
    for (int i = 1; i < 5; ++i) {
      const auto speed = [&](double x) {
        return free_rotation::rotation_vector(c.sample(x + h) * conjugate(c.sample(x))) / h;
      };
      most = std::max(most, norm(speed(i) - speed(i - h)));
    }
    return most;
  };
  // The angular velocity changes by its rate times h, of order 10 h.
  EXPECT_LT(corner(Turning::squad), 1e-3);
  EXPECT_GT(corner(Turning::slerp), 0.1) << "slerp has corners: the control";
}

TEST(Rotations, SwingAndTwistMakeTheTurn) {
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> u(-3, 3);
  for (int k = 0; k < 100; ++k) {
    const Quat q = free_rotation::turn({u(engine), u(engine), u(engine)});
    const Vec3 axis = normalized(Vec3{u(engine), u(engine), u(engine)});
    const auto [swing, twist] = swing_twist(q, axis);
    const Quat back = swing * turn_about(axis, twist);
    EXPECT_NEAR(std::abs(back.w * q.w + back.x * q.x + back.y * q.y + back.z * q.z), 1, 1e-14);
    EXPECT_NEAR(dot(axis, Vec3{swing.x, swing.y, swing.z}), 0, 1e-14);
  }
}

TEST(ArcLength, ACircleIsRunThroughEvenly) {
  // Keys on a circle, uneven in time.
  std::vector<double> t, x;
  for (int i = 0; i <= 32; ++i) {
    const double s = i / 32.0, a = 2 * 3.141592653589793 * s * s;
    t.push_back(s), x.insert(x.end(), {std::cos(a), std::sin(a), 0});
  }
  Keys keys{.width = 3, .times = t, .values = x};
  keys.interpolation = Interpolation::natural;
  const KeyCurve c(keys);
  const ArcLength length(c);
  // The spline is not a circle: its ends are straight over one of 32 intervals.
  EXPECT_NEAR(length.total(), 2 * 3.141592653589793, 3e-3);
  for (double s = 0; s <= 1; s += 0.05) {
    const double way = s * length.total();
    EXPECT_NEAR(length.length(c, length.time_at(c, way)), way, 1e-12);
  }
  // A straight line with increasing speed: s = t^2.
  const std::vector<double> lt{0, 1}, lv{0, 0, 0, 1, 0, 0}, m0{0, 0, 0, 2, 0, 0};
  Keys line{.width = 3, .times = lt, .values = lv};
  line.slopes_in = m0, line.interpolation = Interpolation::hermite;
  const KeyCurve l(line);
  const ArcLength ll(l);
  EXPECT_NEAR(ll.total(), 1, 1e-14);
  EXPECT_NEAR(ll.time_at(l, 0.49), 0.7, 1e-12);
}

}  // namespace
}  // namespace truestep::animation
