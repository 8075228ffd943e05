#include "engine/systems/articulation/closures.h"

#include <algorithm>
#include <cmath>

namespace truestep::articulation {

Vec3 point(const Tree& tree, std::span<const NodeWork> work, int32_t node, const Vec3& r, Of what,
           const Vec3& gravity) {
  if (node == kGround) return what == Of::place ? r : what == Of::velocity ? Vec3{} : -gravity;
  const spatial::Frame f = world_frame(tree, work, node);
  const NodeWork& w = work[size_t(node)];
  if (what == Of::place) return f.R.apply(r) + f.p;
  const Vec3 velocity = w.v.v + cross(w.v.w, r);
  if (what == Of::velocity) return f.R.apply(velocity);
  return f.R.apply(w.a.v + cross(w.a.w, r) + cross(w.v.w, velocity));
}

namespace {

constexpr double kRate =
    20;  // 1/s, of Baumgarte's terms: corrects the drift of one step without adding stiffness
constexpr double kLeastPivot = 1e-11;  // share of the largest

Vec3 apart(const Tree& tree, std::span<const NodeWork> work, const Closure& c, Of what, const Vec3& gravity) {
  return point(tree, work, c.a, c.at_a, what, gravity) - point(tree, work, c.b, c.at_b, what, gravity);
}

Vec3 unit(size_t k) {
  return {k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0};
}

void pull(const Closure& c, const Vec3& force, std::vector<Push>& pushes) {
  if (c.a != kGround) pushes.push_back({.node = c.a, .at = c.at_a, .force = force});
  if (c.b != kGround) pushes.push_back({.node = c.b, .at = c.at_b, .force = -force});
}

// J M^-1 J^T and the responses it is made of.
void respond(const Tree& tree, std::span<const Closure> closures, std::span<const double> q, ClosureWork& s) {
  const size_t rows = 3 * closures.size(), n = tree.velocities;
  s.response.resize(rows * n), s.matrix.resize(rows * rows), s.lambda.resize(rows), s.residual.resize(rows);
  s.change.assign(n, 0.0), s.work.resize(tree.nodes.size()), s.rate.resize(q.size());
  for (size_t row = 0; row < rows; ++row) {
    s.pushes.clear();
    pull(closures[row / 3], unit(row % 3), s.pushes);
    const std::span<double> response(s.response.data() + row * n, n);
    accelerations(tree, q, {}, s.change, {}, s.pushes, s.work, response);
    for (size_t k = 0; k < closures.size(); ++k) {
      store3(s.matrix.data() + row * rows, k, apart(tree, s.work, closures[k], Of::acceleration, {}));
    }
  }
}

// lambda = -matrix^-1 residual by elimination with diagonal pivoting; components beyond the matrix's rank
// stay 0. Overwrites the matrix.
void solve(ClosureWork& s) {
  const size_t n = s.residual.size();
  double* A = s.matrix.data();
  s.order.clear();
  double largest = 0;
  std::fill(s.lambda.begin(), s.lambda.end(), 0.0);
  for (size_t step = 0; step < n; ++step) {
    size_t best = n;
    for (size_t i = 0; i < n; ++i) {
      const bool used = std::find(s.order.begin(), s.order.end(), i) != s.order.end();
      if (!used && (best == n || A[i * n + i] > A[best * n + best])) best = i;
    }
    const double pivot = A[best * n + best];
    largest = std::max(largest, pivot);
    if (!(pivot > kLeastPivot * largest)) break;
    s.order.push_back(static_cast<uint32_t>(best));
    for (size_t i = 0; i < n; ++i) {
      if (std::find(s.order.begin(), s.order.end(), i) != s.order.end()) continue;
      const double factor = A[i * n + best] / pivot;
      for (size_t j = 0; j < n; ++j) A[i * n + j] -= factor * A[best * n + j];
      s.residual[i] -= factor * s.residual[best];
    }
  }
  // In this order row k has only the columns from k on.
  for (size_t k = s.order.size(); k-- > 0;) {
    const size_t row = s.order[k];
    double sum = -s.residual[row];
    for (size_t l = k + 1; l < s.order.size(); ++l) sum -= A[row * n + s.order[l]] * s.lambda[s.order[l]];
    s.lambda[row] = sum / A[row * n + row];
  }
}

// change = M^-1 J^T lambda.
void combine(size_t n, ClosureWork& s) {
  std::fill(s.change.begin(), s.change.end(), 0.0);
  for (size_t row = 0; row < s.lambda.size(); ++row) {
    for (size_t i = 0; i < n; ++i) s.change[i] += s.lambda[row] * s.response[row * n + i];
  }
}

}  // namespace

void closed_accelerations(const Tree& tree, std::span<const Closure> closures, std::span<const double> q,
                          std::span<const double> v, std::span<const double> tau, const Vec3& gravity,
                          std::span<const Push> pushes, std::span<NodeWork> work, ClosureWork& s,
                          std::span<double> qdd) {
  respond(tree, closures, q, s);
  s.pushes.assign(pushes.begin(), pushes.end());
  accelerations(tree, q, v, tau, gravity, s.pushes, work, qdd);
  for (size_t k = 0; k < closures.size(); ++k) {
    const Closure& c = closures[k];
    store3(s.residual.data(), k,
           apart(tree, work, c, Of::acceleration, gravity) +
               apart(tree, work, c, Of::velocity, {}) * (2 * kRate) +
               apart(tree, work, c, Of::place, {}) * (kRate * kRate));
  }
  solve(s);
  for (size_t k = 0; k < closures.size(); ++k) pull(closures[k], load3(s.lambda.data(), k), s.pushes);
  accelerations(tree, q, v, tau, gravity, s.pushes, work, qdd);
}

void close(const Tree& tree, std::span<const Closure> closures, std::span<double> q, std::span<double> v,
           ClosureWork& s) {
  // Newton's method with the matrix of the current point; two rounds suffice after a step.
  constexpr int kMostRounds = 20;
  for (int round = 0; round < kMostRounds; ++round) {
    respond(tree, closures, q, s);
    double largest = 0;
    move(tree, q, {}, s.work);
    for (size_t k = 0; k < closures.size(); ++k) {
      const Vec3 phi = apart(tree, s.work, closures[k], Of::place, {});
      largest = std::max(largest, norm(phi));
      store3(s.residual.data(), k, phi);
    }
    if (!(largest > 1e-14)) break;
    solve(s);
    combine(tree.velocities, s);
    position_rate(tree, q, s.change, s.rate);
    for (size_t i = 0; i < q.size(); ++i) q[i] += s.rate[i];
    normalise(tree, q);
    if (largest < 1e-8) break;  // the next error is its square
  }
  respond(tree, closures, q, s);
  move(tree, q, v, s.work);
  for (size_t k = 0; k < closures.size(); ++k) {
    store3(s.residual.data(), k, apart(tree, s.work, closures[k], Of::velocity, {}));
  }
  solve(s);
  combine(tree.velocities, s);
  for (size_t i = 0; i < v.size(); ++i) v[i] += s.change[i];
}

double gap(const Tree& tree, std::span<const Closure> closures, std::span<const double> q, Work& work) {
  double largest = 0;
  move(tree, q, {}, work);
  for (const Closure& c : closures) largest = std::max(largest, norm(apart(tree, work, c, Of::place, {})));
  return largest;
}

}  // namespace truestep::articulation
