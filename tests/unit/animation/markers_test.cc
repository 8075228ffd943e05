// 3-D points from images and skeletons from markers, on data whose truth is known.
#include <cmath>

#include "engine/geometry/read/trc.h"
#include "engine/kernels/animation/marker_fit.h"
#include "engine/kernels/animation/triangulation.h"
#include "tests/unit/animation/markers_rig.h"

namespace truestep::animation {
namespace {

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
  // Covariance of the position: s^2 (sum du du^T + dv dv^T)^-1, whose trace is the mean squared error.
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
  // 2,000 trials of three coordinates determine a mean square to sqrt(2/6000) = 1.8 %; five times that.
  EXPECT_NEAR(sum / kTries / trace, 1, 0.09);
  EXPECT_GT(std::sqrt(trace), 5e-4) << "the control: half a pixel at 4 m is more than rounding";
}

TEST(Triangulation, SaysWhereItCannot) {
  const auto cameras = ring_of_cameras();
  const Vec3 truth{0, 1, 0};
  const Sighting one{0, *project(cameras[0], truth)};
  EXPECT_FALSE(triangulate(cameras, std::span(&one, 1)));
  const std::vector<Sighting> twice{one, one};
  EXPECT_FALSE(triangulate(cameras, twice)) << "the same ray twice";
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
    // Held to the previous pose with 1e-8 m^2 per rad against markers at 0.1 m: 1e-8 / 0.01 of a step of 0.05
    // rad in the first iterations, which later ones remove.
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
      if (!seen[i]) places[i] = {1e3, -1e3, 1e3};  // the position of an unseen marker is ignored
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
  // Three markers within 0.1 m of their axis determine an angle to about 2 mm / (0.1 m sqrt 2), and a
  // parent's angle counts again at its child: 0.03 rad, with some markers unseen.
  EXPECT_LT(std::sqrt(angles / (9 * kFrames)), 0.035);
  EXPECT_GT(std::sqrt(angles / (9 * kFrames)), 0.003) << "the control: noise does cost something";
  EXPECT_LT(worst, 0.3);
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
