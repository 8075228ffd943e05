// Animation beside a straightforward implementation: skeletons of 60 joints sampled (keys for every joint),
// posed, and their 10,000 vertices skinned, with Eigen's types as the peer; inverse kinematics solvers beside
// FABRIK on chains of 3 to 100 joints; and 10,000 channels sampled beside a copy of as many keys.
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <random>

#include "engine/kernels/animation/inverse_kinematics.h"
#include "engine/kernels/animation/skinning.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::animation;

constexpr size_t kJoints = 60, kVertices = 10'000, kKeys = 30;

struct Skin {
  std::vector<Joint> joints{kJoints};
  /// Two motions, of which the second is blended in.
  static constexpr double kShare = 0.3;
  std::vector<RotationCurve> curves[2];
  std::vector<std::vector<Eigen::Quaterniond>> keys[2]{std::vector<std::vector<Eigen::Quaterniond>>(kJoints),
                                                       std::vector<std::vector<Eigen::Quaterniond>>(kJoints)};
  std::vector<SkinWeights> weights{kVertices};
  std::vector<double> rest = std::vector<double>(3 * kVertices), out = rest;
  std::vector<Eigen::Vector3d> eigen_rest{kVertices}, eigen_out{kVertices};
  std::vector<Pose> rest_poses{kJoints}, poses{kJoints};
  std::vector<JointMotion> motion{kJoints};
  std::vector<BoneMatrix> bones{kJoints};
  std::vector<DualQuat> duals{kJoints};

  Skin() {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> u(-1, 1);
    std::vector<double> times;
    for (size_t k = 0; k < kKeys; ++k) times.push_back(static_cast<double>(k) / 30);
    for (size_t j = 0; j < kJoints; ++j) {
      joints[j].parent = j == 0 ? -1 : static_cast<int32_t>(engine() % j);
      joints[j].rest.position = {u(engine), u(engine), u(engine)};
      for (int motion = 0; motion < 2; ++motion) {
        std::vector<Quat> turns;
        for (size_t k = 0; k < kKeys; ++k) {
          turns.push_back(free_rotation::turn({u(engine), u(engine), u(engine)}));
          keys[motion][j].emplace_back(turns.back().w, turns.back().x, turns.back().y, turns.back().z);
        }
        curves[motion].emplace_back(times, turns, Turning::slerp, Extend::loop);
      }
    }
    forward_kinematics(joints, motion, {}, rest_poses);
    for (size_t i = 0; i < kVertices; ++i) {
      double sum = 0;
      for (size_t b = 0; b < kMostBones; ++b) {
        weights[i].bone[b] = static_cast<uint32_t>(engine() % kJoints);
        sum += weights[i].weight[b] = 1 + u(engine);
      }
      for (double& w : weights[i].weight) w /= sum;
      for (size_t k = 0; k < 3; ++k)
        rest[3 * i + k] = eigen_rest[i][static_cast<Eigen::Index>(k)] = u(engine);
    }
  }
  void pose(double t) {
    for (size_t j = 0; j < kJoints; ++j)
      motion[j].turn = slerp(curves[0][j].sample(t), curves[1][j].sample(t), kShare);
    forward_kinematics(joints, motion, {}, poses);
  }
  void linear(double t) {
    pose(t);
    for (size_t j = 0; j < kJoints; ++j) bones[j] = bone_matrix(rest_poses[j], poses[j]);
    skin_linear(bones, weights, rest.data(), out.data(), 0, kVertices);
  }
  void dual(double t) {
    pose(t);
    for (size_t j = 0; j < kJoints; ++j) duals[j] = dual_quaternion(rest_poses[j], poses[j]);
    skin_dual_quaternion(duals, weights, rest.data(), out.data(), 0, kVertices);
  }
  void eigen(double t) {
    using M = Eigen::Matrix4d;
    static std::vector<M, Eigen::aligned_allocator<M>> world(kJoints), bone(kJoints);
    const double place = t * 30;
    const auto k = static_cast<size_t>(place);
    for (size_t j = 0; j < kJoints; ++j) {
      M local = M::Identity();
      const auto at = [&](int m) {
        return keys[m][j][k].slerp(place - static_cast<double>(k), keys[m][j][k + 1]);
      };
      local.block<3, 3>(0, 0) = at(0).slerp(kShare, at(1)).toRotationMatrix();
      const Vec3& p = joints[j].rest.position;
      local.block<3, 1>(0, 3) = Eigen::Vector3d(p.x, p.y, p.z);
      world[j] = joints[j].parent < 0 ? local : M(world[static_cast<size_t>(joints[j].parent)] * local);
      M back = M::Identity();
      const Vec3& r = rest_poses[j].position;
      back.block<3, 1>(0, 3) = -Eigen::Vector3d(r.x, r.y, r.z);
      bone[j] = world[j] * back;
    }
    for (size_t i = 0; i < kVertices; ++i) {
      M m = weights[i].weight[0] * bone[weights[i].bone[0]];
      for (size_t b = 1; b < kMostBones; ++b) m += weights[i].weight[b] * bone[weights[i].bone[b]];
      eigen_out[i] = (m * eigen_rest[i].homogeneous()).head<3>();
    }
  }
  double difference() const {
    double most = 0;
    for (size_t i = 0; i < kVertices; ++i) {
      for (size_t k = 0; k < 3; ++k) {
        most = std::max(most, std::abs(out[3 * i + k] - eigen_out[i][static_cast<Eigen::Index>(k)]));
      }
    }
    return most;
  }
};

/// Chains of n joints, 1 m in total, and targets for their ends.
struct Reach {
  enum class Kind { reachable, unreachable, singular };
  std::vector<Joint> joints;
  std::vector<std::vector<JointMotion>> starts;
  std::vector<Vec3> targets;
  Vec3 end;
  IkWork work;

  Reach(size_t n, Kind kind) : joints(n), end{1 / static_cast<double>(n), 0, 0} {
    std::mt19937 engine(static_cast<unsigned>(n));
    std::uniform_real_distribution<double> u(-1, 1);
    for (size_t j = 0; j < n; ++j) {
      joints[j].parent = static_cast<int32_t>(j) - 1;
      if (j > 0) joints[j].rest.position = end;
    }
    for (int k = 0; k < 20; ++k) {
      const Vec3 direction = normalized(Vec3{u(engine), u(engine), u(engine)});
      std::vector<JointMotion> start(n);
      for (JointMotion& m : start) m.turn = free_rotation::turn(Vec3{u(engine), u(engine), u(engine)} * 0.1);
      if (kind == Kind::singular) start.assign(n, {});
      targets.push_back(kind == Kind::unreachable ? direction * 1.3
                        : kind == Kind::singular  ? Vec3{0.5, 0, 0}
                                                  : direction * (0.55 + 0.35 * u(engine)));
      starts.push_back(start);
    }
  }
  struct Row {
    double iterations = 0, seconds = 0, error = 0;
    int reached = 0;
  };
  Row run(IkMethod method, double tolerance = 1e-4) {
    Row row;
    std::vector<JointMotion> motion;
    for (size_t k = 0; k < targets.size(); ++k) {
      IkGoal g;
      g.joint = static_cast<uint32_t>(joints.size() - 1), g.point = end, g.target = targets[k];
      double best = 1e300;
      IkResult r;
      for (int again = 0; again < 3; ++again) {
        motion = starts[k];
        const double t0 = bench::thread_seconds();
        r = solve_ik(joints, {}, std::span(&g, 1), {.method = method, .tolerance = tolerance, .most = 1000},
                     motion, work);
        best = std::min(best, bench::thread_seconds() - t0);
      }
      row.iterations += r.iterations, row.seconds += best, row.reached += r.end == IkResult::End::reached;
      row.error = std::max(row.error, r.error);
    }
    const auto n = static_cast<double>(targets.size());
    row.iterations /= n, row.seconds /= n;
    return row;
  }
};

void skins() {
  Skin skin;
  double t = 0.013;
  const auto linear = bench::interleaved(
      41, [&] { skin.linear(t); }, [&] { skin.eigen(t); });
  bench::report(
      {.bench = "animation",
       .metric = "seconds per skeleton of 60 joints, two motions blended, 10,000 vertices, matrices",
       .ours = linear.ours,
       .peer = linear.peer,
       .peer_name = "the same in Eigen",
       .error_ours = skin.difference(),
       .error_peer = 0.0});
  const auto dual = bench::interleaved(
      41, [&] { skin.dual(t); }, [&] { skin.eigen(t); });
  bench::report(
      {.bench = "animation",
       .metric = "seconds per skeleton of 60 joints, two motions blended, 10,000 vertices, dual quaternions",
       .ours = dual.ours,
       .peer = dual.peer,
       .peer_name = "matrices in Eigen"});
}

void solvers() {
  constexpr IkMethod kMethods[] = {IkMethod::gradient, IkMethod::gauss_newton, IkMethod::damped_least_squares,
                                   IkMethod::ccd};
  const char* const names[] = {"gradient", "gauss_newton", "damped_least_squares", "ccd"};
  const char* const kinds[] = {"reachable", "unreachable", "singular"};
  for (const size_t n : {3, 10, 30, 100}) {
    for (int kind = 0; kind < 3; ++kind) {
      Reach reach(n, static_cast<Reach::Kind>(kind));
      const Reach::Row fabrik = reach.run(IkMethod::fabrik);
      for (int m = 0; m < 4; ++m) {
        const Reach::Row row = reach.run(kMethods[m]);
        char metric[160];
        std::snprintf(metric, sizeof metric,
                      "seconds per solution, %s, %zu joints, %s (iterations %.1f beside %.1f, reached %d "
                      "beside %d of 20)",
                      names[m], n, kinds[kind], row.iterations, fabrik.iterations, row.reached,
                      fabrik.reached);
        bench::report({.bench = "animation",
                       .metric = metric,
                       .ours = row.seconds,
                       .peer = fabrik.seconds,
                       .peer_name = "fabrik (ours)",
                       .error_ours = row.error,
                       .error_peer = fabrik.error});
      }
    }
  }
}

/// The cost of a smaller residual: iterations and time of every solver until the end is within it.
void residuals() {
  struct Solver {
    IkMethod method;
    const char* name;
  };
  constexpr Solver kSolvers[] = {{IkMethod::gradient, "gradient"},
                                 {IkMethod::gauss_newton, "gauss_newton"},
                                 {IkMethod::damped_least_squares, "damped_least_squares"},
                                 {IkMethod::ccd, "ccd"},
                                 {IkMethod::fabrik, "fabrik"}};
  for (const size_t n : {3, 10, 30, 100}) {
    Reach reach(n, Reach::Kind::reachable);
    for (const Solver& s : kSolvers) {
      const Reach::Row coarse = reach.run(s.method, 1e-2);
      for (const double residual : {1e-4, 1e-6, 1e-8}) {
        const Reach::Row row = reach.run(s.method, residual);
        char metric[160];
        std::snprintf(
            metric, sizeof metric,
            "seconds per solution, %s, %zu joints, to %.0e m (iterations %.1f beside %.1f, reached %d of 20)",
            s.name, n, residual, row.iterations, coarse.iterations, row.reached);
        bench::report({.bench = "animation",
                       .metric = metric,
                       .ours = row.seconds,
                       .peer = coarse.seconds,
                       .peer_name = "the same to 1e-2 m",
                       .error_ours = row.error,
                       .error_peer = coarse.error});
      }
    }
  }
}

/// A chain of 100 joints whose end follows a path, 1 cm per step: each solution starts from the previous one.
void following() {
  Reach reach(100, Reach::Kind::reachable);
  const auto run = [&](IkMethod method) {
    std::vector<JointMotion> motion = reach.starts[0];
    std::vector<double> seconds;
    for (int k = 0; k < 300; ++k) {
      const double a = 0.02 * k;
      IkGoal g;
      g.joint = 99, g.point = reach.end,
      g.target = Vec3{0.5 * std::cos(a), 0.5 * std::sin(a), 0.3 * std::sin(2 * a)};
      const double t0 = bench::thread_seconds();
      solve_ik(reach.joints, {}, std::span(&g, 1), {.method = method, .tolerance = 1e-4, .most = 1000},
               motion, reach.work);
      if (k > 20) seconds.push_back(bench::thread_seconds() - t0);
    }
    return bench::median(seconds.data(), static_cast<int>(seconds.size()));
  };
  bench::report({.bench = "animation",
                 .metric = "seconds per solution, fabrik, 100 joints, following a path at 1 cm a step",
                 .ours = run(IkMethod::fabrik),
                 .peer = run(IkMethod::damped_least_squares),
                 .peer_name = "damped_least_squares (ours)"});
}

void channels() {
  constexpr size_t kChannels = 10'000;
  std::vector<double> times, values;
  for (int k = 0; k < 30; ++k) {
    times.push_back(k / 30.0);
    for (size_t c = 0; c < kChannels; ++c)
      values.push_back(static_cast<double>((c * 7 + static_cast<size_t>(k) * 13) % 101));
  }
  Keys keys{.width = kChannels, .times = times, .values = values};
  const KeyCurve curve(keys);
  std::vector<double> out(kChannels), copied(2 * kChannels);
  double t = 0.5;
  // What a sample has to read: the values and slopes of two keys.
  const auto both = bench::interleaved(
      101,
      [&] {
        t = t > 0.9 ? 0.01 : t + 0.0371;
        curve.sample(t, out.data());
      },
      [&] {
        for (int k = 0; k < 2; ++k) {
          std::copy_n(values.data() + static_cast<size_t>(t * 29) * kChannels, 2 * kChannels, copied.data());
          asm volatile("" ::: "memory");
        }
      });
  bench::report({.bench = "animation",
                 .metric = "seconds per sample of 10,000 channels between two keys",
                 .ours = both.ours,
                 .peer = both.peer,
                 .peer_name = "copies of as many numbers"});
}

}  // namespace

int main() {
  skins();
  solvers();
  residuals();
  following();
  channels();
}
