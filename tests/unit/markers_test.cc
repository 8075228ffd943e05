// Places out of pictures and skeletons out of markers, on data whose truth is known.
#include <cmath>

#include "engine/geometry/read/trc.h"
#include "engine/kernels/animation/marker_fit.h"
#include "engine/kernels/animation/triangulation.h"
#include "tests/unit/animation_rig.h"

namespace truestep::animation {
namespace {

std::vector<PinholeCamera> ring_of_cameras() {
  std::vector<PinholeCamera> out;
  for (int k = 0; k < 4; ++k) {
    const double a = 1.5707963267948966 * k + 0.3;
    out.push_back(
        camera_looking_at({4 * std::cos(a), 1.5, 4 * std::sin(a)}, {0, 1, 0}, {0, 1, 0}, 1000, 640, 480));
  }
  return out;
}

TEST(Triangulation, ACameraSeesWhatItLooksAtInItsMiddle) {
  const PinholeCamera c = camera_looking_at({1, 2, 5}, {0, 1, 0}, {0, 1, 0}, 800, 320, 240);
  const auto middle = project(c, {0, 1, 0});
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->u, 320, 1e-9);
  EXPECT_NEAR(middle->v, 240, 1e-9);
  EXPECT_LT(project(c, {0, 1.1, 0})->v, 240) << "up is up: v counts downwards";
  EXPECT_GT(project(c, Vec3{0, 1, 0} + normalized(cross(Vec3{-1, -1, -5}, Vec3{0, 1, 0})) * 0.1)->u, 320);
  EXPECT_FALSE(project(c, {2, 3, 10})) << "behind it";
}

TEST(Triangulation, ExactPicturesGiveExactPlaces) {
  const auto cameras = ring_of_cameras();
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> u(-0.8, 0.8);
  for (int k = 0; k < 50; ++k) {
    const Vec3 truth{u(engine), 1 + u(engine), u(engine)};
    std::vector<Sighting> seen;
    for (uint32_t c = 0; c < cameras.size(); ++c) seen.push_back({c, *project(cameras[c], truth)});
    const auto found = triangulate(cameras, seen);
    ASSERT_TRUE(found);
    EXPECT_LT(norm(found->place - truth), 1e-12);
    EXPECT_LT(found->residual, 1e-9);
  }
}

TEST(Triangulation, NoiseCostsWhatLeastSquaresSay) {
  // Covariance of the place: s^2 (sum du du^T + dv dv^T)^-1, whose trace is what errors have on average.
  const auto cameras = ring_of_cameras();
  std::mt19937 engine(5);
  constexpr double kNoise = 0.5;
  std::normal_distribution<double> noise(0, kNoise);
  const Vec3 truth{0.2, 1.3, -0.4};
  double g[3][3] = {};
  for (const PinholeCamera& c : cameras) {
    const double h = 1e-5;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const auto slope = [&](int axis) {
          Vec3 by;
          (&by.x)[axis] = h;
          const auto a = *project(c, truth + by), b = *project(c, truth - by);
          return ImagePoint{(a.u - b.u) / (2 * h), (a.v - b.v) / (2 * h)};
        };
        const auto si = slope(i), sj = slope(j);
        g[i][j] += si.u * sj.u + si.v * sj.v;
      }
    }
  }
  const double det = g[0][0] * (g[1][1] * g[2][2] - g[1][2] * g[2][1]) -
                     g[0][1] * (g[1][0] * g[2][2] - g[1][2] * g[2][0]) +
                     g[0][2] * (g[1][0] * g[2][1] - g[1][1] * g[2][0]);
  const double trace = ((g[1][1] * g[2][2] - g[1][2] * g[2][1]) + (g[0][0] * g[2][2] - g[0][2] * g[2][0]) +
                        (g[0][0] * g[1][1] - g[0][1] * g[1][0])) /
                       det * kNoise * kNoise;
  double sum = 0;
  constexpr int kTries = 2000;
  for (int k = 0; k < kTries; ++k) {
    std::vector<Sighting> seen;
    for (uint32_t c = 0; c < cameras.size(); ++c) {
      ImagePoint p = *project(cameras[c], truth);
      p.u += noise(engine), p.v += noise(engine);
      seen.push_back({c, p});
    }
    sum += norm2(triangulate(cameras, seen)->place - truth);
  }
  // 2,000 tries of three coordinates tell a mean square to sqrt(2/6000) = 1.8 %: five of that.
  EXPECT_NEAR(sum / kTries / trace, 1, 0.09);
  EXPECT_GT(std::sqrt(trace), 5e-4) << "the control: half a pixel at 4 m is more than rounding";
}

TEST(Triangulation, SightingsOfSomethingElseAreSetAside) {
  // Half a pixel of noise, a camera out of four blocked for a fifth of the places, one sighting of ten false
  // by 20 to 300 pixels.
  const auto cameras = ring_of_cameras();
  std::mt19937 engine(23);
  std::normal_distribution<double> noise(0, 0.5);
  std::uniform_real_distribution<double> u(-1, 1);
  constexpr int kPlaces = 400;
  std::vector<Vec3> truth;
  std::vector<std::vector<Sighting>> seen(kPlaces);
  std::vector<uint32_t> wrong(kPlaces, 0), sightings;
  std::vector<Triangulated> plain;
  for (int k = 0; k < kPlaces; ++k) {
    truth.push_back({0.8 * u(engine), 1 + 0.8 * u(engine), 0.8 * u(engine)});
    for (uint32_t c = 0; c < cameras.size(); ++c) {
      ImagePoint p = *project(cameras[c], truth.back());
      p.u += noise(engine), p.v += noise(engine);
      const bool blocked = c == 2 && k % 5 == 0;
      // At most one of a place, where there are three cameras or more.
      const double way = 160 + 140 * u(engine), angle = 3.14 * u(engine), chance = 0.5 * (1 + u(engine));
      if (!blocked && chance < 0.1 && wrong[k] == 0)
        p.u += way * std::cos(angle), p.v += way * std::sin(angle), wrong[k] = 1;
      if (!blocked) seen[k].push_back({c, p});
    }
    if (const auto found = triangulate(cameras, seen[k])) {
      plain.push_back(*found), sightings.push_back(static_cast<uint32_t>(seen[k].size()));
    }
  }
  const double s = picture_noise(plain, sightings);
  // A third of the places is misled, which a median bears: it is pulled up from the middle to their two
  // thirds'.
  EXPECT_GT(s, 0.4);
  EXPECT_LT(s, 0.9);
  double worst_robust = 0, worst_plain = 0;
  size_t misled = 0, of_three = 0, of_three_off = 0;
  for (int k = 0; k < kPlaces; ++k) {
    const auto agreed = triangulate_agreed(cameras, seen[k], s);
    ASSERT_TRUE(agreed) << k;
    misled += wrong[k];
    const double off = norm(agreed->found.place - truth[k]);
    if (seen[k].size() == 3 && wrong[k] > 0) {
      // Two rays against one: a false one that happens to meet another is as good as the true pair.
      ++of_three, of_three_off += off > 0.02;
    } else {
      worst_robust = std::max(worst_robust, off);
    }
    if (const auto p = triangulate(cameras, seen[k]))
      worst_plain = std::max(worst_plain, norm(p->place - truth[k]));
  }
  EXPECT_GT(misled, 100u);
  // Half a pixel at 4 m and 1000 pixels of focal length is 2 mm, some more at the edges.
  EXPECT_LT(worst_robust, 0.02);
  // False ones miss the other rays by less than three pixels of some 160 in one case of fifty, for either.
  EXPECT_GT(of_three, 10u);
  EXPECT_LE(of_three_off, of_three / 8);
  EXPECT_GT(worst_plain, 0.2) << "the control: they do mislead";
}

TEST(Triangulation, SaysWhereItCannot) {
  const auto cameras = ring_of_cameras();
  const Vec3 truth{0, 1, 0};
  const Sighting one{0, *project(cameras[0], truth)};
  EXPECT_FALSE(triangulate(cameras, std::span(&one, 1)));
  const std::vector<Sighting> twice{one, one};
  EXPECT_FALSE(triangulate(cameras, twice)) << "the same ray twice";
}

/// A body of nine joints: hips, spine, head, arms and legs, of balls and hinges.
struct Body {
  std::vector<Joint> joints;
  std::vector<MarkerPlacement> markers;
  Body() {
    const auto add = [&](int parent, const Vec3& at, JointKind kind) {
      Joint j;
      j.parent = parent, j.kind = kind, j.rest.position = at, j.axis = {1, 0, 0};
      joints.push_back(j);
      const auto n = static_cast<uint32_t>(joints.size() - 1);
      // Three on each, off its axis.
      markers.push_back({n, {0.08, -0.1, 0.03}});
      markers.push_back({n, {-0.07, -0.15, 0.05}});
      markers.push_back({n, {0.02, -0.25, -0.06}});
    };
    add(-1, {0, 0, 0}, JointKind::ball);
    add(0, {0, 0.2, 0}, JointKind::ball);
    add(1, {0, 0.4, 0}, JointKind::ball);
    add(1, {0.2, 0.35, 0}, JointKind::ball);
    add(3, {0, -0.3, 0}, JointKind::revolute);
    add(1, {-0.2, 0.35, 0}, JointKind::ball);
    add(5, {0, -0.3, 0}, JointKind::revolute);
    add(0, {0.1, -0.05, 0}, JointKind::ball);
    add(7, {0, -0.42, 0}, JointKind::revolute);
  }
  std::vector<JointMotion> pose(double t) const {
    std::vector<JointMotion> out(joints.size());
    for (size_t j = 0; j < joints.size(); ++j) {
      const double p = static_cast<double>(j);
      out[j].turn = free_rotation::turn(
          {0.5 * std::sin(2 * t + p), 0.3 * std::cos(1.7 * t + 2 * p), 0.4 * std::sin(1.3 * t - p)});
      out[j].value = 0.6 + 0.5 * std::sin(2 * t + p);
      if (joints[j].kind != JointKind::ball) out[j].turn = {};
    }
    out[0].shift = {0.5 * t, 1 + 0.05 * std::sin(6 * t), 0.1};
    return out;
  }
  std::vector<Vec3> places(const std::vector<JointMotion>& motion) const {
    std::vector<Pose> poses(joints.size());
    forward_kinematics(joints, motion, {}, poses);
    std::vector<Vec3> out;
    for (const MarkerPlacement& m : markers)
      out.push_back(poses[m.joint].position + rotate(poses[m.joint].orientation, m.point));
    return out;
  }
};
double angle_between(const Joint& j, const JointMotion& a, const JointMotion& b) {
  return j.kind == JointKind::ball ? norm(free_rotation::rotation_vector(conjugate(a.turn) * b.turn))
                                   : std::abs(a.value - b.value);
}

TEST(MarkerFit, ExactMarkersGiveThePose) {
  const Body body;
  std::vector<JointMotion> motion = body.pose(0);
  std::vector<uint8_t> known(9);
  const std::vector<uint8_t> seen(body.markers.size(), 1);
  MarkerWork work;
  for (int f = 1; f <= 30; ++f) {
    const auto truth = body.pose(f / 30.0);
    const MarkerFit fit =
        fit_markers(body.joints, body.markers, body.places(truth), seen, motion, known, work);
    // Held to the pose before with 1e-8 m^2 a rad against markers at 0.1 m: 1e-8 / 0.01 of a step of 0.05 rad
    // in the first iterations, which take it away.
    ASSERT_LT(fit.error, 1e-7) << f;
    for (size_t j = 0; j < 9; ++j) {
      ASSERT_LT(angle_between(body.joints[j], truth[j], motion[j]), 1e-5) << f << " joint " << j;
      ASSERT_EQ(known[j], 1);
    }
  }
}

TEST(MarkerFit, NoiseAndOcclusionStayWithinWhatTheyMustCost) {
  // 2 mm of noise a coordinate, a tenth of the markers out of sight in every frame.
  const Body body;
  std::mt19937 engine(11);
  constexpr double kNoise = 0.002;
  std::normal_distribution<double> noise(0, kNoise);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<JointMotion> motion = body.pose(0);
  std::vector<uint8_t> known(9);
  MarkerWork work;
  double squares = 0, angles = 0, worst = 0;
  size_t seen_all = 0;
  constexpr int kFrames = 120;
  for (int f = 1; f <= kFrames; ++f) {
    const auto truth = body.pose(f / 30.0);
    auto places = body.places(truth);
    std::vector<uint8_t> seen(places.size());
    for (size_t i = 0; i < places.size(); ++i) {
      places[i] += Vec3{noise(engine), noise(engine), noise(engine)};
      seen[i] = u(engine) < 0.9;
      if (!seen[i]) places[i] = {1e3, -1e3, 1e3};  // whatever stands there is not looked at
      seen_all += seen[i];
    }
    const MarkerFit fit = fit_markers(body.joints, body.markers, places, seen, motion, known, work);
    double count = 0;
    for (const uint8_t s : seen) count += s;
    squares += fit.error * fit.error * count;
    for (size_t j = 0; j < 9; ++j) {
      const double a = angle_between(body.joints[j], truth[j], motion[j]);
      angles += a * a, worst = std::max(worst, a);
    }
  }
  // Residuals of a least squares fit: s^2 (3 m - p) / m a marker, with p = 6 + 5 x 3 + 3 = 24 coordinates.
  const double m = static_cast<double>(seen_all) / kFrames;
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(seen_all)) / (kNoise * std::sqrt(3 - 24 / m)), 1, 0.05);
  // Three markers within 0.1 m of their axis tell an angle to 2 mm / (0.1 m sqrt 2) or so, and a parent's
  // angle counts again at its child: 0.03 rad, some less seen.
  EXPECT_LT(std::sqrt(angles / (9 * kFrames)), 0.035);
  EXPECT_GT(std::sqrt(angles / (9 * kFrames)), 0.003) << "the control: noise does cost something";
  EXPECT_LT(worst, 0.3);
}

/// Angles that a fit leaves (root of the mean square, rad), frame by frame from the one before: 2 mm of
/// noise, a tenth of the markers out of sight, and of those in sight a share somewhere within half a metre.
struct Misled {
  double angles = 0;
  size_t false_ones = 0, found = 0, right_ones = 0, lost = 0;
};
template <class FitFrame>
Misled with_outliers(double share, FitFrame fit_frame) {
  const Body body;
  std::mt19937 engine(17);
  std::normal_distribution<double> noise(0, 0.002);
  std::uniform_real_distribution<double> u(0, 1);
  std::vector<JointMotion> motion = body.pose(0);
  MarkerWork work;
  Misled out;
  constexpr int kFrames = 120;
  for (int f = 1; f <= kFrames; ++f) {
    const auto truth = body.pose(f / 30.0);
    auto places = body.places(truth);
    std::vector<uint8_t> seen(places.size()), wrong(places.size(), 0);
    std::vector<uint8_t> taken(9, 0);  // at most one a joint: two of three that agree would be believed
    for (size_t i = 0; i < places.size(); ++i) {
      places[i] += Vec3{noise(engine), noise(engine), noise(engine)};
      seen[i] = u(engine) < 0.9;
      const double chance = u(engine);
      const Vec3 off{u(engine) - 0.5, u(engine) - 0.5, u(engine) - 0.5};
      if (!seen[i] || chance > share || taken[body.markers[i].joint] || norm(off) < 0.1) continue;
      places[i] += off, wrong[i] = 1, taken[body.markers[i].joint] = 1;
    }
    fit_frame(body, places, seen, wrong, motion, work);
    for (size_t i = 0; i < places.size(); ++i) {
      const bool aside = seen[i] && !(work.weights[i] > 0);
      out.false_ones += wrong[i], out.found += wrong[i] && aside;
      out.right_ones += seen[i] && !wrong[i], out.lost += aside && !wrong[i];
    }
    for (size_t j = 0; j < 9; ++j) {
      const double a = angle_between(body.joints[j], truth[j], motion[j]);
      out.angles += a * a / (9 * kFrames);
    }
  }
  out.angles = std::sqrt(out.angles);
  return out;
}

TEST(MarkerFit, OutliersAreSetAside) {
  std::vector<uint8_t> known(9);
  const auto robust = [&](const Body& b, const auto& places, const auto& seen, const auto&, auto& motion,
                          auto& work) {
    fit_markers(b.joints, b.markers, places, seen, motion, known, work);
  };
  // The same with the false ones out of sight: what is the best that can be had.
  const auto told = [&](const Body& b, const auto& places, const auto& seen, const auto& wrong, auto& motion,
                        auto& work) {
    auto right = seen;
    for (size_t i = 0; i < right.size(); ++i) right[i] = seen[i] && !wrong[i];
    fit_markers(b.joints, b.markers, places, right, motion, known, work);
  };
  const Misled found = with_outliers(0.1, robust), best = with_outliers(0.1, told),
               none = with_outliers(0, robust);
  ASSERT_GT(found.false_ones, 150u) << "the control: there are false ones";
  // A joint with one marker of three right and one out of sight cannot tell which is which: a tenth of the
  // false ones lies beside one out of sight twice in ten. Nine tenths must be found.
  EXPECT_GT(static_cast<double>(found.found), 0.9 * static_cast<double>(found.false_ones));
  // Beyond 4.7 spreads lie 3 in 10,000 of three normal numbers' lengths; some are lost beside a false one.
  EXPECT_LT(static_cast<double>(found.lost), 0.03 * static_cast<double>(found.right_ones));
  // Twice what knowing them would leave, and a fraction of what half a metre does to a limb of 0.3 m.
  EXPECT_LT(found.angles, 2 * best.angles);
  EXPECT_EQ(none.found, 0u);
  EXPECT_EQ(none.lost, 0u) << "where none is false nothing is set aside";
}

TEST(MarkerFit, SaysWhatNothingTellsAbout) {
  const Body body;
  std::vector<JointMotion> motion = body.pose(0.5);
  const auto before = motion;
  std::vector<uint8_t> known(9), seen(body.markers.size(), 1);
  // All of the right forearm, joint 6, is out of sight.
  for (size_t i = 0; i < seen.size(); ++i) {
    if (body.markers[i].joint == 6) seen[i] = 0;
  }
  MarkerWork work;
  fit_markers(body.joints, body.markers, body.places(body.pose(0.6)), seen, motion, known, work);
  for (size_t j = 0; j < 9; ++j) EXPECT_EQ(known[j], j != 6) << j;
  EXPECT_NEAR(motion[6].value, before[6].value, 1e-9) << "it stays as it was";
}

std::vector<std::string> trc() {
  return {"PathFileType\t4\t(X/Y/Z)\ta.trc",
          "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits",
          "100\t100\t2\t2\tmm",
          "Frame#\tTime\tA\t\t\tB\t\t",
          "\t\tX1\tY1\tZ1\tX2\tY2\tZ2",
          "1\t0.00\t1000\t2000\t-500\t1\t2\t3",
          "2\t0.01\t\t\t\t4\t5\t6"};
}

TEST(Trc, ReadsPlacesAndGaps) {
  const MarkerTracks t = read_trc(trc());
  EXPECT_EQ(t.names, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(t.rate, 100);
  EXPECT_EQ(t.frames, 2u);
  EXPECT_EQ(t.places[0].y, 2);
  EXPECT_EQ(t.seen, (std::vector<uint8_t>{1, 1, 0, 1}));
  EXPECT_DOUBLE_EQ(t.places[3].z, 0.006);
}

TEST(Trc, FaultsHaveTheirLine) {
  const auto line = [](size_t k, const std::string& text) {
    auto lines = trc();
    if (k < lines.size()) {
      lines[k] = text;
    } else {
      lines.resize(std::stoul(text));
    }
    try {
      read_trc(lines);
    } catch (const TrcFault& f) {
      return f.line;
    }
    return size_t{0};
  };
  EXPECT_EQ(line(0, "HIERARCHY"), 1u);
  EXPECT_EQ(line(2, "100\t100\t2\t3\tmm"), 4u);
  EXPECT_EQ(line(2, "100\t100\t1e300\t2\tmm"), 3u);
  EXPECT_EQ(line(2, "100\t100\t2\t2\tinch"), 3u);
  EXPECT_EQ(line(5, "1\t0.00\t1000\tx\t-500\t1\t2\t3"), 6u);
  EXPECT_EQ(line(5, "1\t0.00\t1000\t2\t\t1\t2\t3"), 6u);
  EXPECT_EQ(line(5, "1\t0.00\t1e30\t2\t3\t1\t2\t3"), 6u);
  EXPECT_EQ(line(99, "6"), 6u) << "it ends after one of two frames";
  EXPECT_EQ(line(99, "3"), 3u);
}

}  // namespace
}  // namespace truestep::animation
