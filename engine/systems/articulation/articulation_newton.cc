// A tree of links for implicit methods (tree_newton.h): the linearisation of its field, including the
// derivatives of its drives.
#include <algorithm>

#include "engine/core/equations/linear_solver.h"
#include "engine/systems/articulation/articulation_field.h"
#include "engine/systems/articulation/ball_limits.h"
#include "engine/systems/articulation/tree_newton.h"

namespace truestep::articulation {

namespace {

class TreeSolver final : public FieldLinearSolver {
 public:
  explicit TreeSolver(const ArticulationField& field) : field_(field) {}

  void linearise(const Phase& at, Evaluation& e) override { field_.linearise(at, tree_, e); }
  bool factor(double z) override { return real_.factor(tree_, z); }
  bool factor(Complex z) override { return complex_.factor(tree_, z); }
  void solve(double* b) override { real_.solve(tree_, b, b + field_.model().tree.positions); }
  void solve(double* re, double* im) override {
    const uint32_t nx = field_.model().tree.positions, n = nx + field_.model().tree.velocities;
    b_.resize(n);
    for (size_t i = 0; i < n; ++i) b_[i] = {re[i], im[i]};
    complex_.solve(tree_, b_.data(), b_.data() + nx);
    for (size_t i = 0; i < n; ++i) re[i] = b_[i].re, im[i] = b_[i].im;
  }
  bool factor_second_order(double with_x, double with_v) override {
    return real_.factor_second_order(tree_, with_x, with_v);
  }
  void solve_second_order(double* b) override { real_.solve_second_order(tree_, b); }

 private:
  const ArticulationField& field_;
  LinearTree tree_;
  TreeFactors<double> real_;
  TreeFactors<Complex> complex_;
  std::vector<Complex> b_;
};

// For the unit quaternion (w, u), the torque -2 k w u changes by -k (w^2 + w [u] - u u^T) per unit rotation.
void ball_slope(double k, const double* q, DriveSlope& out) {
  const double n2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  const double s = k / n2, w = q[0], u[] = {q[1], q[2], q[3]};
  const double across[3][3] = {{0, -u[2], u[1]}, {u[2], 0, -u[0]}, {-u[1], u[0], 0}};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      out.stiffness[i][j] = s * ((i == j ? w * w : 0) + w * across[i][j] - u[i] * u[j]);
    }
  }
}

// Beyond a limit, where spring and damper push.
void add_limit_slope(const Drive& d, double q, double v, DriveSlope& out) {
  const bool low = d.limits == Drive::Limits::lower || d.limits == Drive::Limits::both;
  const bool high = d.limits == Drive::Limits::upper || d.limits == Drive::Limits::both;
  const bool pushes = (low && q < d.lowest && d.limit_stiffness * (d.lowest - q) > d.limit_damping * v) ||
                      (high && q > d.highest && d.limit_stiffness * (q - d.highest) > -d.limit_damping * v);
  if (pushes) out.stiffness[0][0] += d.limit_stiffness, out.damping += d.limit_damping;
}

DriveSlope slope_of(const Drive& d, const Node& node, const double* q, const double* v) {
  const Move move = node.move;
  DriveSlope out;
  out.damping = d.damping;
  if (move == Move::spherical) {
    ball_slope(d.stiffness, q, out);
    if (d.limited()) add_ball_limit_slope(d, node.axis, q, out);
    return out;
  }
  for (size_t k = 0; k < velocities_of(move); ++k) out.stiffness[k][k] = d.stiffness;
  if (move == Move::revolute || move == Move::prismatic) add_limit_slope(d, *q, *v, out);
  return out;
}

}  // namespace

std::unique_ptr<FieldLinearSolver> ArticulationField::linear_solver() const {
  if (!model_.closures.empty() || !model_.springs.empty()) return nullptr;
  return std::make_unique<TreeSolver>(*this);
}

void ArticulationField::linearise(const Phase& at, LinearTree& out, Evaluation& e) const {
  auto& work = e.workspace.object<Work>("articulation.nodes");
  auto& slopes = e.workspace.object<std::vector<DriveSlope>>("articulation.slopes");
  auto& scratch = e.workspace.object<ClosureWork>("articulation.closures");
  const auto a = e.workspace.doubles("articulation.linearised", at.v.size());
  const size_t n = model_.tree.nodes.size();
  work.resize(n), slopes.resize(n);
  solve(at, work, e.workspace.doubles("articulation.efforts", at.v.size()), scratch, a);
  for (size_t i = 0; i < n; ++i) {
    const Node& node = model_.tree.nodes[i];
    slopes[i] = slope_of(model_.drives[i], node, at.x.data() + node.q, at.v.data() + node.v);
  }
  out.linearise(model_.tree, at.x, at.v, a, work, scratch.outside, slopes);
}

}  // namespace truestep::articulation
