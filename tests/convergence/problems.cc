// Free body: I w' = -w x I w, Kepler with G M = 1; both integrate exactly their equations and nothing else.
#include "tests/convergence/problems.h"

#include <algorithm>
#include <utility>

#include "engine/math/vec3.h"
#include "engine/systems/oscillator/oscillator.h"
#include "tests/convergence/equations.h"

namespace truestep::test {
using namespace oscillator;

namespace {

class Kepler : public ForceField {
 public:
  State initial_state() const override {
    State s;
    const double e = 0.2;
    s.f64(s.add({"position", "1", Scalar::f64, 3, Role::position}, 1))[0] = 1 - e;
    s.f64(s.add({"velocity", "1", Scalar::f64, 3, Role::velocity}, 1))[1] = std::sqrt((1 + e) / (1 - e));
    return s;
  }
  void acceleration(const Phase& at, std::span<double> a, Evaluation&) const override {
    kepler_acceleration(at.x.data(), a.data());
  }
  Dependence dependence() const override { return Dependence::position; }
  double kinetic(const Phase& at, Evaluation&) const override { return 0.5 * norm2(load3(at.v.data(), 0)); }
  std::optional<double> potential(const Phase& at, Evaluation&) const override {
    return -1 / norm(load3(at.x.data(), 0));
  }
};

class FreeBody : public ForceField {
 public:
  State initial_state() const override {
    State s;
    s.f64(s.add({"position", "1", Scalar::f64, 4, Role::position}, 1))[0] = 1;
    store3(s.f64(s.add({"velocity", "rad/s", Scalar::f64, 3, Role::velocity}, 1)).data(), 0,
           Vec3{0.7, 1.3, -0.5});
    return s;
  }
  void acceleration(const Phase& at, std::span<double> a, Evaluation&) const override {
    free_body_acceleration(at.v.data(), a.data());
  }
  std::span<const double> position_rate(const Phase& at, std::span<double> rate, Evaluation&) const override {
    free_body_rate(at.x.data(), at.v.data(), rate.data());
    return rate;
  }
  void project(std::span<double> x, std::span<double>, const State&) const override { normalise(x.data()); }
  Dependence dependence() const override { return Dependence::position_and_velocity; }
  double kinetic(const Phase& at, Evaluation&) const override {
    const Vec3 w = load3(at.v.data(), 0);
    return 0.5 * (kMoments[0] * w.x * w.x + kMoments[1] * w.y * w.y + kMoments[2] * w.z * w.z);
  }
};

Problem spring(double damping) {
  OscillatorDef d;
  d.stiffness = 4, d.damping = damping, d.velocity = 0.3;
  Problem p;
  p.field = make_oscillator_field(d);
  p.t_end = 5;
  const auto end = oscillator_exact(d, p.t_end);
  p.x_end = {end.x, 0, 0}, p.v_end = {end.v, 0, 0};
  return p;
}

}  // namespace

Problem oscillator() {
  return spring(0);
}
Problem damped_oscillator() {
  return spring(0.6);
}

Problem kepler() {
  Problem p;
  p.field = std::make_unique<Kepler>();
  p.t_end = 5;
  // M = E - e sin E by Newton's method; semi-major axis and mean motion are 1.
  const double e = 0.2, b = std::sqrt(1 - e * e);
  double ecc = p.t_end;
  for (int i = 0; i < 50; ++i) ecc -= (ecc - e * std::sin(ecc) - p.t_end) / (1 - e * std::cos(ecc));
  const double rate = 1 / (1 - e * std::cos(ecc));
  p.x_end = {std::cos(ecc) - e, b * std::sin(ecc), 0};
  p.v_end = {-std::sin(ecc) * rate, b * std::cos(ecc) * rate, 0};
  return p;
}

Problem free_body() {
  Problem p;
  p.field = std::make_unique<FreeBody>();
  p.t_end = 5;
  // Gragg's extrapolated midpoint rule (order 8) on y = (q, w): no row of the table is involved.
  const State s = p.field->initial_state();
  std::vector<double> y(s.f64(0).begin(), s.f64(0).end());
  y.insert(y.end(), s.f64(1).begin(), s.f64(1).end());
  Workspace workspace;
  const ThreadArena arena(1);
  Evaluation ev{workspace, arena};
  const auto f = [&](const std::vector<double>& at) {
    std::vector<double> d(7);
    const Phase phase{0, {at.data(), 4}, {at.data() + 4, 3}, s};
    p.field->position_rate(phase, {d.data(), 4}, ev);
    p.field->acceleration(phase, {d.data() + 4, 3}, ev);
    return d;
  };
  const auto combine = [](const std::vector<double>& a, double c, const std::vector<double>& b) {
    std::vector<double> out(a);
    for (size_t i = 0; i < a.size(); ++i) out[i] += c * b[i];
    return out;
  };
  const int steps = 600;
  const double h = p.t_end / steps;
  for (int n = 0; n < steps; ++n) {
    std::vector<std::vector<double>> row;
    const int counts[] = {2, 4, 6, 8};
    for (int k = 0; k < 3; ++k) {
      const double sub = h / counts[k];
      auto before = y, now = combine(y, sub, f(y));
      for (int i = 1; i < counts[k]; ++i) {
        auto next = combine(before, 2 * sub, f(now));
        before = std::move(now), now = std::move(next);
      }
      auto smooth = combine(combine(before, 1, now), sub, f(now));
      for (double& c : smooth) c *= 0.5;
      // Aitken and Neville: extrapolate in (1/n)^2 to 0; row[j] holds the newest value of column j.
      for (int j = 0; j <= k; ++j) {
        if (j == k) {
          row.push_back(smooth);
          break;
        }
        const double ratio = double(counts[k] * counts[k]) / (counts[k - 1 - j] * counts[k - 1 - j]);
        auto better = combine(smooth, 1 / (ratio - 1), combine(smooth, -1, row[size_t(j)]));
        row[size_t(j)] = std::move(smooth);
        smooth = std::move(better);
      }
    }
    y = row.back();
  }
  p.x_end.assign(y.begin(), y.begin() + 4);
  p.v_end.assign(y.begin() + 4, y.end());
  return p;
}

double end_error(const Integrator& method, const Problem& problem, size_t steps,
                 const IntegratorOptions& options) {
  State s = problem.field->initial_state();
  if (method.prepare) method.prepare(*problem.field, s);
  Workspace workspace;
  const ThreadArena arena(1);
  const double h = problem.t_end / double(steps);
  for (size_t n = 0; n < steps; ++n) {
    method.step(*problem.field, s,
                {.t = double(n) * h, .h = h, .step = n, .workspace = workspace, .arena = arena}, options);
  }
  double worst = 0;
  const auto x = s.f64(s.at("position")), v = s.f64(s.at("velocity"));
  for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(x[i] - problem.x_end[i]));
  for (size_t i = 0; i < v.size(); ++i) worst = std::max(worst, std::abs(v[i] - problem.v_end[i]));
  return worst;
}

double observed_order(const std::function<double(size_t steps)>& error, size_t first, size_t doublings) {
  double coarse = error(first), slope = 0, order = 0;
  for (size_t k = 0, n = first; k < doublings; ++k) {
    const double fine = error(n *= 2);
    if (fine < 1e-12) break;
    const double last = std::exchange(slope, std::log2(coarse / fine));
    order = k == 0 ? slope : 2 * slope - last;
    coarse = fine;
  }
  return order;
}

double fitted_order(const std::function<double(size_t)>& error, const Fit& fit) {
  // Normal equations of the unknowns, summed over the step counts used; the last column is the right-hand
  // side.
  constexpr int kMost = 4;
  const int terms = fit.terms;
  double a[kMost][kMost + 1] = {};
  size_t points = 0, first = 0;
  for (size_t n = 2; n < 6000; n += n / 16 + 1) {
    const double e = error(n);
    if (e > fit.largest || std::isnan(e)) continue;
    if (e < fit.smallest) break;
    if (points == 0) first = n;
    const double h = double(first) / double(n), row[kMost] = {1, std::log(h), h, h * h};
    for (int i = 0; i < terms; ++i) {
      for (int j = 0; j < terms; ++j) a[i][j] += row[i] * row[j];
      a[i][kMost] += row[i] * std::log(e);
    }
    ++points;
  }
  if (points < 6) return 0;
  for (int k = 0; k < terms; ++k) {
    int pivot = k;
    for (int i = k; i < terms; ++i) {
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    }
    std::swap(a[k], a[pivot]);
    for (int i = 0; i < terms; ++i) {
      if (i == k) continue;
      const double f = a[i][k] / a[k][k];
      for (int j = k; j <= kMost; ++j) a[i][j] -= f * a[k][j];
    }
  }
  return a[1][kMost] / a[1][1];
}

}  // namespace truestep::test
