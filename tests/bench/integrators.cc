// Cost of a step of every method on a cloth of 9,702 springs beside a hand-written loop around the same force
// evaluation; of a linear implicit step of a 100 x 100 cloth beside the same equations solved with Eigen's
// SimplicialLDLT (order analysed once, as a user would); and of the elementary functions beside the C
// library's.
#include <Eigen/SparseCholesky>
#include <cmath>
#include <functional>
#include <vector>

#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "engine/math/block_sparse.h"
#include "engine/math/trig.h"
#include "engine/systems/mass_spring/mass_spring_def.h"
#include "engine/systems/mass_spring/mass_spring_field.h"
#include "tests/bench/report.h"
#include "tests/support/block_sparse_eigen.h"

namespace truestep::bench {
using namespace mass_spring;
namespace {

using Values = std::vector<double, CacheLineAllocator<double>>;

MassSpringDef cloth(int points) {
  MassSpringDef d;
  d.cloth_grid.emplace();
  d.cloth_grid->nx = d.cloth_grid->ny = points;
  d.mass = 1e-3, d.stiffness = 100, d.shear_stiffness = 50;
  d.pins = {0, points - 1};
  return d;
}

// What a user without a library would write: one array per quantity, loops around a(x, v).
struct ByHand {
  const ForceField& field;
  State state;
  Values x, v, k1, k2, k3, k4, xs, vs;
  Workspace workspace;
  ThreadArena arena{1};
  Evaluation e{workspace, arena};
  double h;

  ByHand(const ForceField& f, double step) : field(f), state(f.initial_state()), h(step) {
    x.assign(state.f64(0).begin(), state.f64(0).end());
    v.assign(state.f64(1).begin(), state.f64(1).end());
    for (Values* a : {&k1, &k2, &k3, &k4, &xs, &vs}) a->resize(x.size());
    force(x, v, k1);
  }
  void force(const Values& at, const Values& rate, Values& a) {
    field.acceleration({0, at, rate, state}, a, e);
  }
  // out = y + c k
  void move(Values& out, const Values& y, double c, const Values& k) const {
    double* o = out.data();
    const double *p = y.data(), *q = k.data();
#pragma GCC ivdep
    for (size_t i = 0; i < y.size(); ++i) o[i] = p[i] + c * q[i];
  }

  void euler() {
    force(x, v, k1);
    move(x, x, h, v);
    move(v, v, h, k1);
  }
  void symplectic_euler() {
    force(x, v, k1);
    move(v, v, h, k1);
    move(x, x, h, v);
  }
  void midpoint() {
    force(x, v, k1);
    move(xs, x, h / 2, v);
    move(vs, v, h / 2, k1);
    force(xs, vs, k2);
    move(x, x, h, vs);
    move(v, v, h, k2);
  }
  void heun() {
    force(x, v, k1);
    move(xs, x, h, v);
    move(vs, v, h, k1);
    force(xs, vs, k2);
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] += h / 2 * (v[i] + vs[i]);
      v[i] += h / 2 * (k1[i] + k2[i]);
    }
  }
  void velocity_verlet() {  // keeps the last acceleration, as nothing else changes the state
    move(v, v, h / 2, k1);
    move(x, x, h, v);
    force(x, v, k1);
    move(v, v, h / 2, k1);
  }
  void leapfrog() {
    move(x, x, h / 2, v);
    force(x, v, k1);
    move(v, v, h, k1);
    move(x, x, h / 2, v);
  }
  void rk4() {
    Values &v1 = v, &v2 = vs;
    force(x, v1, k1);
    move(xs, x, h / 2, v1), move(v2, v, h / 2, k1);
    force(xs, v2, k2);
    Values &v3 = v3_, &v4 = v4_;
    v3.resize(x.size()), v4.resize(x.size());
    move(xs, x, h / 2, v2), move(v3, v, h / 2, k2);
    force(xs, v3, k3);
    move(xs, x, h, v3), move(v4, v, h, k3);
    force(xs, v4, k4);
    for (size_t i = 0; i < x.size(); ++i) {
      x[i] += h / 6 * (v1[i] + 2 * (v2[i] + v3[i]) + v4[i]);
      v[i] += h / 6 * (k1[i] + 2 * (k2[i] + k3[i]) + k4[i]);
    }
  }

 private:
  Values v3_, v4_;
};

double difference(const State& state, const Values& x) {
  double worst = 0;
  for (size_t i = 0; i < x.size(); ++i) worst = std::max(worst, std::abs(state.f64(0)[i] - x[i]));
  return worst;
}

void explicit_methods() {
  const MassSpringField field(cloth(50), {.id = "cloth"});
  const double h = 1e-4;
  const std::pair<const char*, void (ByHand::*)()> methods[] = {
      {"euler", &ByHand::euler},
      {"symplectic_euler", &ByHand::symplectic_euler},
      {"midpoint", &ByHand::midpoint},
      {"heun", &ByHand::heun},
      {"velocity_verlet", &ByHand::velocity_verlet},
      {"leapfrog", &ByHand::leapfrog},
      {"rk4", &ByHand::rk4}};
  for (const auto& [name, by_hand] : methods) {
    const Integrator& m = *find_integrator(name);
    State state = field.initial_state();
    if (m.prepare) m.prepare(field, state);
    Workspace workspace;
    const ThreadArena arena(1);
    ByHand hand(field, h);
    uint64_t step = 0;
    constexpr int kSteps = 5;  // short turns, so that a busy machine disturbs both alike
    const Times t = interleaved(
        101,
        [&] {
          for (int i = 0; i < kSteps; ++i, ++step) {
            m.step(field, state,
                   {.t = double(step) * h, .h = h, .step = step, .workspace = workspace, .arena = arena}, {});
          }
        },
        [&] {
          for (int i = 0; i < kSteps; ++i) (hand.*by_hand)();
        });
    report({.bench = "integrators." + std::string(name),
            .metric = "seconds per step, cloth of 9702 springs",
            .ours = t.ours / kSteps,
            .peer = t.peer / kSteps,
            .peer_name = "hand-written loop, same forces",
            .error_ours = difference(state, hand.x),
            .error_peer = 0});
  }
}

void implicit_step() {
  MassSpringDef d = cloth(100);
  d.stiffness = 1000, d.shear_stiffness = 500, d.bending_stiffness = 100;
  const MassSpringField field(d, {.id = "cloth"});
  const double h = 1.0 / 60;
  const Integrator& m = *find_integrator("linear_implicit_euler");
  State state = field.initial_state();
  Workspace workspace, hand_workspace;
  const ThreadArena arena(1);

  State hand = state;
  BlockSparse dfdx, dfdv;
  field.jacobian_pattern(hand, dfdx, dfdv);
  // Where each value of Eigen's matrix comes from.
  BlockSparse index = dfdx;
  for (size_t i = 0; i < index.values().size(); ++i) index.values()[i] = double(i + 1);
  Eigen::SparseMatrix<double> a = to_eigen(index);
  std::vector<size_t> from(static_cast<size_t>(a.nonZeros()));
  for (size_t i = 0; i < from.size(); ++i) from[i] = static_cast<size_t>(a.valuePtr()[i]) - 1;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt;
  ldlt.analyzePattern(a);
  Evaluation e{hand_workspace, arena};
  const auto w = hand.f64(hand.at("inverse_mass"));
  const auto n = static_cast<Eigen::Index>(hand.f64(0).size());

  const auto by_hand = [&] {
    const auto x = hand.f64(0), v = hand.f64(1);
    Eigen::VectorXd f(n), kv(n);
    field.acceleration({h, x, v, hand}, {f.data(), static_cast<size_t>(n)}, e);
    field.definite_jacobian({h, x, v, hand}, dfdx, dfdv, e);
    dfdx.multiply(v, {kv.data(), static_cast<size_t>(n)}, arena);
    for (size_t i = 0; i < from.size(); ++i) a.valuePtr()[i] = -h * h * dfdx.values()[from[i]];
    for (Eigen::Index c = 0; c < n; ++c) {
      const double wc = w[static_cast<size_t>(c) / 3];
      for (Eigen::SparseMatrix<double>::InnerIterator it(a, c); it; ++it) {
        const double wr = w[static_cast<size_t>(it.row()) / 3];
        if (wr == 0 || wc == 0) it.valueRef() = 0;
        if (it.row() == c) it.valueRef() += wc == 0 ? 1 : 1 / wc;
      }
      f[c] = wc == 0 ? 0 : h * (f[c] / wc + h * kv[c]);
    }
    ldlt.factorize(a);
    const Eigen::VectorXd dv = ldlt.solve(f);
    for (Eigen::Index i = 0; i < n; ++i) {
      v[static_cast<size_t>(i)] += dv[i];
      x[static_cast<size_t>(i)] += h * v[static_cast<size_t>(i)];
    }
  };
  uint64_t step = 0;
  const auto ours = [&] {
    m.step(field, state,
           {.t = double(step) * h, .h = h, .step = step, .workspace = workspace, .arena = arena}, {});
    ++step;
  };
  ours();
  by_hand();
  const Times t = interleaved(3, ours, by_hand);
  report({.bench = "integrators.linear_implicit_euler",
          .metric = "seconds per step, cloth 100 x 100",
          .ours = t.ours,
          .peer = t.peer,
          .peer_name = "Eigen SimplicialLDLT, order analysed once",
          .error_ours = difference(state, Values(hand.f64(0).begin(), hand.f64(0).end())),
          .error_peer = 0});
}

void elementary_functions() {
  Values x(20000);
  for (size_t i = 0; i < x.size(); ++i) x[i] = 0.001 + 0.0005 * double(i);
  const auto compare = [&](const char* name, auto ours, auto libm) {
    double sum = 0, other = 0;
    const Times t = interleaved(
        101,
        [&] {
          for (const double v : x) sum += ours(v);
        },
        [&] {
          for (const double v : x) other += libm(v);
        });
    report({.bench = std::string("trig.") + name,
            .metric = "seconds per call",
            .ours = t.ours / double(x.size()),
            .peer = t.peer / double(x.size()),
            .peer_name = "C library",
            .error_ours = std::abs(sum - other) / std::abs(other),
            .error_peer = 0});
  };
  compare(
      "sin", [](double v) { return trig::sin(v); }, [](double v) { return std::sin(v); });
  compare(
      "cos", [](double v) { return trig::cos(v); }, [](double v) { return std::cos(v); });
  compare(
      "sincos",
      [](double v) {
        const auto s = trig::sincos(v);
        return s.sin + s.cos;
      },
      [](double v) { return std::sin(v) + std::cos(v); });
  compare(
      "exp", [](double v) { return trig::exp(v); }, [](double v) { return std::exp(v); });
  compare(
      "log", [](double v) { return trig::log(v); }, [](double v) { return std::log(v); });
  compare(
      "pow", [](double v) { return trig::pow(v, 1.7); }, [](double v) { return std::pow(v, 1.7); });
  compare(
      "atan2", [](double v) { return trig::atan2(v, 3.0); }, [](double v) { return std::atan2(v, 3.0); });
}

}  // namespace
}  // namespace truestep::bench

int main() {
  truestep::bench::explicit_methods();
  truestep::bench::implicit_step();
  truestep::bench::elementary_functions();
}
