// A step of implicit Euler, linearised, of an elastic block of 20,480 tetrahedra that is let go at one end:
// ours beside a straightforward one of the same forces with Eigen: warped stiffness (Mueller, Gross 2004),
// the pattern analysed once, SimplicialLDLT factorised in every step. Errors are those of the places after
// half a second, root mean square over the length of the block, against our steps an eighth as long.
#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <string>
#include <vector>

#include "engine/systems/fem/fem.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
using namespace truestep::fem;
constexpr double kStep = 1.0 / 60, kGravity = -9.81;
constexpr int kSteps = 30, kFiner = 8;

FemDef bar() {
  FemDef d;
  d.block = SoftBlockShape{.size = {1, 0.25, 0.25}, .cells_x = 64, .cells_y = 8, .cells_z = 8};
  d.element = Cell::tet4, d.material = Law::corotated;
  d.youngs_modulus = 1e6, d.poisson_ratio = 0.3, d.density = 1000;
  d.pinned = {"x0"};
  d.integrator = "linear_implicit_euler";
  return d;
}

FemDef cube() {
  FemDef d = bar();
  d.block = SoftBlockShape{.size = {1, 1, 1}, .cells_x = 16, .cells_y = 16, .cells_z = 16};
  d.youngs_modulus = 1e5;
  return d;
}

class Eigens {
 public:
  explicit Eigens(const Body& body, double youngs, double poisson) : body_(body) {
    const size_t n = body.mesh.x.size();
    for (const Vec3& p : body.mesh.x) x_.insert(x_.end(), {p.x, p.y, p.z});
    rest_ = x_;
    v_.assign(3 * n, 0.0);
    held_.assign(n, false);
    for (const uint32_t p : body.pins) held_[p] = true;
    const double lambda = youngs * poisson / ((1 + poisson) * (1 - 2 * poisson)),
                 mu = youngs / (2 * (1 + poisson));
    Eigen::Matrix<double, 6, 6> law = Eigen::Matrix<double, 6, 6>::Zero();
    law.topLeftCorner<3, 3>().setConstant(lambda);
    for (int i = 0; i < 3; ++i) law(i, i) += 2 * mu, law(3 + i, 3 + i) = mu;
    std::vector<Eigen::Triplet<double>> pattern;
    for (size_t c = 0; c < body.mesh.cells(); ++c) {
      Tet t;
      Eigen::Matrix<double, 6, 12> strain = Eigen::Matrix<double, 6, 12>::Zero();
      for (size_t a = 0; a < 4; ++a) {
        t.node[a] = body.mesh.cell(c)[a];
        const Vec3 g = body.gradients[4 * c + a];
        t.gradient.row(long(a)) << g.x, g.y, g.z;
        const long k = long(3 * a);
        strain(0, k) = g.x, strain(1, k + 1) = g.y, strain(2, k + 2) = g.z;
        strain(3, k) = g.y, strain(3, k + 1) = g.x;
        strain(4, k + 1) = g.z, strain(4, k + 2) = g.y;
        strain(5, k) = g.z, strain(5, k + 2) = g.x;
      }
      t.stiffness = body.weights[c] * strain.transpose() * law * strain;
      tets_.push_back(t);
      for (size_t a = 0; a < 4; ++a) {
        for (size_t b = 0; b < 4; ++b) {
          for (int i = 0; i < 9; ++i) {
            pattern.emplace_back(int(3 * t.node[a]) + i / 3, int(3 * t.node[b]) + i % 3, 1.0);
          }
        }
      }
    }
    matrix_.resize(long(3 * n), long(3 * n));
    matrix_.setFromTriplets(pattern.begin(), pattern.end());
    for (Tet& t : tets_) {
      for (size_t a = 0; a < 4; ++a) {
        for (size_t b = 0; b < 4; ++b) {
          for (size_t column = 0; column < 3; ++column) {
            t.where[a][b][column] =
                &matrix_.coeffRef(long(3 * t.node[a]), long(3 * t.node[b] + column)) - matrix_.valuePtr();
          }
        }
      }
    }
    solver_.analyzePattern(matrix_);
  }

  // (M + h^2 K) dv = h (f - h K v)
  void step(double h) {
    std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(long(x_.size()));
    for (const Tet& t : tets_) add(t, h, right);
    for (size_t i = 0; i < held_.size(); ++i) {
      right(long(3 * i + 1)) += h * body_.masses[i] * kGravity;
      for (size_t c = 0; c < 3; ++c) {
        const long k = long(3 * i + c);
        matrix_.coeffRef(k, k) += held_[i] ? 1 : body_.masses[i];
        if (held_[i]) right(k) = 0;
      }
    }
    solver_.factorize(matrix_);
    const Eigen::VectorXd dv = solver_.solve(right);
    for (size_t k = 0; k < x_.size(); ++k) v_[k] += dv(long(k)), x_[k] += h * v_[k];
  }
  const std::vector<double>& places() const { return x_; }

 private:
  struct Tet {
    size_t node[4];
    Eigen::Matrix<double, 4, 3> gradient;
    Eigen::Matrix<double, 12, 12> stiffness;
    long where[4][4][3];
  };

  void add(const Tet& t, double h, Eigen::VectorXd& right) {
    Eigen::Matrix3d f = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 12, 1> x, rest, v;
    for (size_t a = 0; a < 4; ++a) {
      for (size_t c = 0; c < 3; ++c) {
        const long k = long(3 * a + c);
        const size_t from = 3 * t.node[a] + c;
        x(k) = x_[from], rest(k) = rest_[from], v(k) = v_[from];
      }
      f += x.segment<3>(long(3 * a)) * t.gradient.row(long(a));
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(f, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d turn = svd.matrixU() * svd.matrixV().transpose();
    Eigen::Matrix<double, 12, 12> warped;
    Eigen::Matrix<double, 12, 1> back;
    for (long a = 0; a < 4; ++a) {
      back.segment<3>(3 * a) = turn.transpose() * x.segment<3>(3 * a) - rest.segment<3>(3 * a);
      for (long b = 0; b < 4; ++b) {
        warped.block<3, 3>(3 * a, 3 * b) = turn * t.stiffness.block<3, 3>(3 * a, 3 * b) * turn.transpose();
      }
    }
    const Eigen::Matrix<double, 12, 1> inner = t.stiffness * back, slope = warped * v;
    for (long a = 0; a < 4; ++a) {
      const size_t i = t.node[a];
      right.segment<3>(long(3 * i)) -= h * (turn * inner.segment<3>(3 * a) + h * slope.segment<3>(3 * a));
      for (long b = 0; b < 4; ++b) {
        if (held_[i] || held_[t.node[b]]) continue;
        for (long c = 0; c < 3; ++c) {
          double* column = matrix_.valuePtr() + t.where[a][b][c];
          for (long r = 0; r < 3; ++r) column[r] += h * h * warped(3 * a + r, 3 * b + c);
        }
      }
    }
  }

  const Body& body_;
  std::vector<Tet> tets_;
  std::vector<double> x_, rest_, v_;
  std::vector<bool> held_;
  Eigen::SparseMatrix<double> matrix_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

struct Ours {
  explicit Ours(const FemDef& def, double dt, int threads = 1)
      : system(Fem::make(def, BuildContext{.id = "block", .gravity = {0, kGravity, 0}, .dt = dt})),
        state(system->initial_state()),
        arena(threads),
        h(dt) {}
  void step() {
    system->step(state,
                 {.t = h * double(steps), .h = h, .step = steps, .workspace = workspace, .arena = arena});
    ++steps;
  }
  std::unique_ptr<const Fem> system;
  State state;
  Workspace workspace;
  ThreadArena arena;
  double h;
  uint64_t steps = 0;
};

double distance(const double* a, const double* b, size_t n) {
  double sum = 0;
  for (size_t k = 0; k < n; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return std::sqrt(3 * sum / double(n));
}

void compare(const char* name, const FemDef& def) {
  Ours ours(def, kStep), two(def, kStep, 2), exact(def, kStep / kFiner);
  Eigens peer(ours.system->body(), def.youngs_modulus, def.poisson_ratio);
  std::vector<double> times, peer_times, wall, two_wall;
  for (int n = 0; n < kSteps; ++n) {
    const double t0 = bench::thread_seconds(), w0 = bench::now_seconds();
    ours.step();
    const double t1 = bench::thread_seconds(), w1 = bench::now_seconds();
    peer.step(kStep);
    const double t2 = bench::thread_seconds(), w2 = bench::now_seconds();
    two.step();
    // The first step allocates memory.
    if (n == 0) continue;
    times.push_back(t1 - t0), peer_times.push_back(t2 - t1);
    wall.push_back(w1 - w0), two_wall.push_back(bench::now_seconds() - w2);
  }
  for (int n = 0; n < kFiner * kSteps; ++n) exact.step();
  const auto x = ours.state.f64(FemColumns::position), best = exact.state.f64(FemColumns::position);
  const double error = distance(x.data(), best.data(), x.size()),
               peer_error = distance(peer.places().data(), best.data(), x.size());
  const int n = int(times.size());
  bench::report({.bench = "fem_step",
                 .metric = std::string("CPU seconds per implicit step, 20480 tetrahedra, ") + name,
                 .ours = bench::median(times.data(), n),
                 .peer = bench::median(peer_times.data(), n),
                 .peer_name = "Eigen SimplicialLDLT",
                 .error_ours = error,
                 .error_peer = peer_error});
  bench::report({.bench = "fem_step",
                 .metric = std::string("wall seconds per implicit step, two threads beside one, ") + name,
                 .ours = bench::median(two_wall.data(), n),
                 .peer = bench::median(wall.data(), n),
                 .peer_name = "ourselves, one thread",
                 .error_ours = error,
                 .error_peer = error,
                 .threads = 2});
}

}  // namespace

int main() {
  compare("bar", bar());
  compare("cube", cube());
}
