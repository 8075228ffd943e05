// Heat conduction on a lattice of 257 x 257 nodes: CPU time against the largest error at the end for nine
// methods and for CVODE as its users run it (BDF with its Krylov solver, plain and with its own band
// preconditioner, and our row of it with sparse factors), all on the same right-hand side and in one process.
// The reference is the lattice's own solution, wave by wave, so that only errors in time are seen. Then 1e6
// nodes stepped by explicit Euler and waves by leapfrog, beside the machine's triad.
#include <cvode/cvode.h>
#include <cvode/cvode_bandpre.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_spgmr.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include "engine/integrators/advance.h"
#include "engine/integrators/table/integrators.h"
#include "engine/math/solvers/trig_transform.h"
#include "engine/systems/heat/heat.h"
#include "engine/systems/wave/wave.h"
#include "tests/bench/report.h"

namespace truestep::bench {
namespace {

constexpr int kCells = 256;
constexpr double kEnd = 0.2, kOmega = 20;
const ThreadArena kSerial(1);

// A hump that spreads on a square with cold sides while a source oscillates: u_t = div grad u + s cos(20 t).
heat::HeatDef stiff_square() {
  heat::HeatDef d;
  d.cells = {kCells, kCells};
  d.all = lattice::SideDef{};
  d.initial = "exp(-100*((x - 0.4)^2 + (y - 0.6)^2))";
  d.source = "20*x*(1 - x)*y*(1 - y)*(1 + x)*cos(20*t)";
  return d;
}

struct Problem {
  Problem() {
    const auto d = stiff_square();
    system = heat::build_heat(&d, {.id = "square", .dt = kEnd});
    model = &static_cast<const heat::Heat&>(*system).model();
    work.bind(*model, {.coefficient = 1}, kSerial);
    const State s = system->initial_state();
    start.assign(s.f64(0).begin(), s.f64(0).end());
    solve();
  }
  // c' = -l c + s cos(w t) for every wave:
  // c(t) = e^-lt (c0 - s l / (l^2 + w^2)) + s (l cos wt + w sin wt) / (l^2 + w^2).
  void solve() {
    const size_t n = kCells + 1;
    exact = start;
    // The source at t = 0 is the forcing's contribution there.
    std::vector<double> source(n * n), none(n * n);
    work.rate(0, none.data(), source.data());
    const TrigTransform t(TrigTransform::End::zero, TrigTransform::End::zero, kCells);
    std::vector<double> scratch(t.scratch_size());
    const auto both = [&](std::vector<double>& x, bool forward) {
      for (size_t k = 0; k < n; ++k) {
        forward ? t.forward(&x[k * n], 1, 1, 1, scratch.data())
                : t.backward(&x[k * n], 1, 1, 1, scratch.data());
      }
      for (size_t k = 0; k < n; ++k) {
        forward ? t.forward(&x[k], n, 1, 1, scratch.data()) : t.backward(&x[k], n, 1, 1, scratch.data());
      }
    };
    both(exact, true), both(source, true);
    for (size_t j = 1; j < kCells; ++j) {
      for (size_t i = 1; i < kCells; ++i) {
        const auto eigenvalue = [](size_t k) {
          const double s = std::sin(0.5 * std::numbers::pi * double(k) / kCells);
          return 4.0 * kCells * kCells * s * s;
        };
        const double l = eigenvalue(i) + eigenvalue(j), q = source[j * n + i] / (l * l + kOmega * kOmega);
        double& c = exact[j * n + i];
        c = std::exp(-l * kEnd) * (c - q * l) +
            q * (l * std::cos(kOmega * kEnd) + kOmega * std::sin(kOmega * kEnd));
      }
    }
    both(exact, false);
  }
  double error(const std::vector<double>& y) const {
    double worst = 0;
    for (size_t i = 0; i < y.size(); ++i) worst = std::max(worst, std::abs(y[i] - exact[i]));
    return worst;
  }

  std::unique_ptr<const System> system;
  const lattice::LatticeModel* model;
  lattice::LatticeWork work;
  std::vector<double> start, exact;
};

struct Point {
  double seconds, error;
};

// --- ours

Point run_ours(Problem& p, const Integrator& method, double tolerance, uint64_t steps) {
  const heat::HeatEquations f(p.work, p.model->lattice(), kSerial);
  auto y = p.start;
  Workspace workspace;
  Carry carry;
  Advance run{.f = f,
              .t = 0,
              .t_end = kEnd,
              .y = y.data(),
              .workspace = workspace,
              .carry = carry,
              .tolerance = {tolerance, tolerance},
              .fixed_steps = steps};
  const double t0 = thread_seconds();
  method.advance(run);
  return {thread_seconds() - t0, p.error(y)};
}

// --- CVODE as its users run it

enum class Preconditioner { none, band };

/// A run that takes longer counts as one that does not reach its error.
constexpr double kMostSeconds = 20;
struct User {
  const heat::HeatEquations& f;
  double until;
};

Point run_cvode(Problem& p, Preconditioner preconditioner, double tolerance) {
  const heat::HeatEquations f(p.work, p.model->lattice(), kSerial);
  const auto n = static_cast<sunindextype>(f.size());
  const double t0 = thread_seconds();
  SUNContext context = nullptr;
  SUNContext_Create(nullptr, &context);
  N_Vector y = N_VNew_Serial(n, context);
  std::copy(p.start.begin(), p.start.end(), N_VGetArrayPointer(y));
  void* cvode = CVodeCreate(CV_BDF, context);
  CVodeInit(
      cvode,
      [](realtype t, N_Vector at, N_Vector rate, void* data) {
        const User& u = *static_cast<const User*>(data);
        u.f.rate(t, N_VGetArrayPointer(at), N_VGetArrayPointer(rate));
        return thread_seconds() < u.until ? 0 : -1;
      },
      0, y);
  CVodeSStolerances(cvode, tolerance, tolerance);
  User user{f, t0 + kMostSeconds};
  CVodeSetUserData(cvode, &user);
  CVodeSetMaxNumSteps(cvode, 1000000);
  const bool band = preconditioner == Preconditioner::band;
  SUNLinearSolver linear = SUNLinSol_SPGMR(y, band ? SUN_PREC_LEFT : SUN_PREC_NONE, 0, context);
  CVodeSetLinearSolver(cvode, linear, nullptr);
  if (band) CVBandPrecInit(cvode, n, 1, 1);
  CVodeSetStopTime(cvode, kEnd);
  realtype t = 0;
  const int flag = CVode(cvode, kEnd, y, &t, CV_NORMAL);
  const double seconds = thread_seconds() - t0;
  std::vector<double> end(N_VGetArrayPointer(y), N_VGetArrayPointer(y) + n);
  CVodeFree(&cvode);
  SUNLinSolFree(linear);
  N_VDestroy(y);
  SUNContext_Free(&context);
  return {seconds, flag < 0 ? HUGE_VAL : p.error(end)};
}

/// Seconds at an error of `wanted`, interpolated between the neighbouring points on logarithmic scales; empty
/// if no point reaches it.
std::optional<double> seconds_at(const std::vector<Point>& points, double wanted) {
  std::optional<double> best;
  const auto take = [&](double s) { best = std::min(best.value_or(s), s); };
  for (size_t k = 0; k < points.size(); ++k) {
    const Point& b = points[k];
    if (!(b.error <= wanted)) continue;
    if (k > 0 && points[k - 1].error > wanted && points[k - 1].error < HUGE_VAL) {
      const Point& a = points[k - 1];
      const double part = std::log(a.error / wanted) / std::log(a.error / b.error);
      take(a.seconds * std::pow(b.seconds / a.seconds, part));
    } else {
      take(b.seconds);
    }
  }
  return best;
}

using Sweep = std::vector<Point>;

void print(const char* name, const Sweep& sweep) {
  std::fprintf(stderr, "%-22s", name);
  for (const Point& p : sweep) std::fprintf(stderr, "  %.1e: %.0f ms", p.error, 1e3 * p.seconds);
  std::fprintf(stderr, "\n");
}

void work_precision() {
  Problem p;
  struct Row {
    std::string name;
    Sweep sweep;
  };
  std::vector<Row> ours, peers;
  const auto adaptive = [&](const char* name, double first, double last) {
    Row row{name, {}};
    for (double tolerance = first; tolerance >= 0.9 * last; tolerance *= 0.1) {
      row.sweep.push_back(run_ours(p, *find_integrator(name), tolerance, 1));
    }
    print(name, row.sweep);
    return row;
  };
  const auto fixed = [&](const char* name, uint64_t first, uint64_t last) {
    Row row{name, {}};
    for (uint64_t n = first; n <= last; n *= 2)
      row.sweep.push_back(run_ours(p, *find_integrator(name), 1e-6, n));
    print(name, row.sweep);
    return row;
  };
  for (const char* name : {"rkc2", "tr_bdf2", "sdirk4", "rodas5p", "radau5"}) {
    ours.push_back(adaptive(name, 1e-3, 1e-7));
  }
  for (const char* name : {"trapezoid", "implicit_midpoint", "bdf2"}) ours.push_back(fixed(name, 32, 512));
  const auto cvode = [&](const char* name, Preconditioner with) {
    Row row{name, {}};
    for (const double tolerance : {1e-4, 1e-5, 1e-6}) {
      row.sweep.push_back(run_cvode(p, with, tolerance));
    }
    print(name, row.sweep);
    return row;
  };
  peers.push_back(cvode("CVODE Krylov", Preconditioner::none));
  peers.push_back(cvode("CVODE Krylov band", Preconditioner::band));
  Row sparse = adaptive("cvode_bdf", 1e-4, 1e-7);
  sparse.name = "CVODE sparse";
  peers.push_back(sparse);
  // Explicit Euler beside its limit, 2 over 8 / dx^2.
  ours.push_back(fixed("euler", 53'000, 53'000));
  for (const double wanted : {1e-4, 1e-5, 1e-6}) {
    const Row *best = nullptr, *peer = nullptr;
    const auto better = [&](const Row& r, const Row*& known) {
      const auto s = seconds_at(r.sweep, wanted);
      if (s && (!known || *s < *seconds_at(known->sweep, wanted))) known = &r;
    };
    for (const Row& r : ours) better(r, best);
    for (const Row& r : peers) better(r, peer);
    if (!best || !peer) continue;
    char metric[64];
    std::snprintf(metric, sizeof metric, "seconds at an error of %.0e (%s)", wanted, best->name.c_str());
    report({.bench = "heat",
            .metric = metric,
            .ours = *seconds_at(best->sweep, wanted),
            .peer = *seconds_at(peer->sweep, wanted),
            .peer_name = peer->name,
            .error_ours = wanted,
            .error_peer = wanted});
  }
}

// --- bandwidth

void bandwidth() {
  constexpr size_t kNodes = 1'000'000;
  constexpr int kRounds = 15, kSteps = 20;
  std::vector<double> a(kNodes), b(kNodes, 1.5), c(kNodes, 2.5);
  const auto triad = [&] {
    for (int k = 0; k < kSteps; ++k) {
      const double s = 1e-3 * k;
      for (size_t i = 0; i < kNodes; ++i) a[i] = b[i] + s * c[i];
      asm volatile("" : : "r"(a.data()) : "memory");
    }
  };
  const auto compare = [&](const char* what, const System& system, double dt, double bytes) {
    State s = system.initial_state();
    Workspace workspace;
    uint64_t n = 0;
    const auto ours = [&] {
      for (int k = 0; k < kSteps; ++k, ++n) {
        system.step(s, {.t = double(n) * dt, .h = dt, .step = n, .workspace = workspace, .arena = kSerial});
      }
    };
    ours();
    triad();
    const Paired p = paired(kRounds, ours, triad, thread_seconds);
    const double mine = bytes * kNodes * kSteps / p.times.ours,
                 theirs = 24.0 * kNodes * kSteps / p.times.peer;
    report({.bench = "heat",
            .metric = what,
            .ours = mine,
            .peer = theirs,
            .peer_name = "triad",
            .better = Comparison::Better::higher});
  };
  heat::HeatDef d;
  d.cells = {999, 999};
  d.all = lattice::SideDef{};
  d.initial = "sin(pi*x)*sin(pi*y)";
  d.integrator = "euler";
  const double dt = 0.2 / (999.0 * 999.0);
  // Every node is read once and written once.
  compare("bytes/s, euler, 1e6 nodes", *heat::build_heat(&d, {.id = "a", .dt = dt}), dt, 16);
  d.order = lattice::LatticeDef::Order::fourth;
  compare("bytes/s, euler, order 4", *heat::build_heat(&d, {.id = "a", .dt = dt}), 0.5 * dt, 16);
  d.order = lattice::LatticeDef::Order::second;
  d.cells = {99, 99, 99};
  d.initial += "*sin(pi*z)";
  compare("bytes/s, euler, 100^3 nodes", *heat::build_heat(&d, {.id = "a", .dt = 1e-5}), 1e-5, 16);
  wave::WaveDef w;
  w.cells = {999, 999};
  w.initial = "sin(pi*x)*sin(pi*y)";
  w.integrator = "leapfrog";
  // Value and rate, each read once and written once.
  compare("bytes/s, wave by leapfrog, 1e6 nodes", *wave::build_wave(&w, {.id = "a", .dt = 5e-4}), 5e-4, 32);
}

}  // namespace
}  // namespace truestep::bench

int main() {
  truestep::bench::bandwidth();
  truestep::bench::work_precision();
}
