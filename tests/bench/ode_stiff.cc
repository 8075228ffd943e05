// CPU time of one thread against error on stiff problems: rodas5p and radau5 beside CVODE's BDF, driven as
// its users do (analytic Jacobians where the problem has them, dense or a narrow band), and Boost.odeint's
// rosenbrock4 with dense output. Every solver runs over a range of tolerances, in turns; for each target
// error the cheapest run that met it counts. `bench_ode_stiff NAME` runs one problem, `bench_ode_stiff
// --table` prints every run.
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <boost/numeric/odeint.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_controller.hpp>
#include <boost/numeric/odeint/stepper/rosenbrock4_dense_output.hpp>
#include <boost/numeric/ublas/matrix.hpp>
#include <boost/numeric/ublas/vector.hpp>
#include <cstdio>
#include <functional>
#include <string>

#include "engine/base/errors.h"
#include "engine/integrators/implicit_methods.h"
#include "tests/bench/report.h"
#include "tests/support/stiff_problems.h"

namespace truestep::bench {
namespace {

using test::StiffCase;
using Vector = std::vector<double>;

struct Problem {
  std::string name;
  const RightHandSide& f;
  StiffCase at;
  double first_step;  // for odeint, which asks for one
  std::function<double(const double*)> error;
  int from, to;  // tolerances 10^-from ... 10^-to
  int from_cvode, to_cvode;
  bool odeint;
};

struct Run {
  double seconds = 0, error = HUGE_VAL;
};

// CVODE from its C interface; y' and the Jacobian straight from the problem.
class CvodePeer {
 public:
  explicit CvodePeer(const Problem& p)
      : p_(p), n_(p.f.size()), chain_(dynamic_cast<const test::Chain*>(&p.f)) {
    SUNContext_Create(nullptr, &context_);
  }
  ~CvodePeer() { SUNContext_Free(&context_); }
  CvodePeer(const CvodePeer&) = delete;

  // False: CVODE gave up.
  bool run(double relative, double absolute, Vector& out) {
    N_Vector y = N_VNew_Serial(long(n_), context_);
    double* data = N_VGetArrayPointer(y);
    const size_t m = n_ / 2;
    // The chain's unknowns alternate so that the band is narrow.
    for (size_t i = 0; i < n_; ++i) data[chain_ ? 2 * (i % m) + i / m : i] = p_.at.y0[i];
    void* memory = CVodeCreate(CV_BDF, context_);
    CVodeInit(memory, chain_ ? chain_rate : rate, 0, y);
    CVodeSStolerances(memory, relative, absolute);
    CVodeSetUserData(memory, this);
    CVodeSetMaxNumSteps(memory, 1'000'000);
    CVodeSetErrFile(memory, nullptr);
    SUNMatrix a =
        chain_ ? SUNBandMatrix(long(n_), 3, 3, context_) : SUNDenseMatrix(long(n_), long(n_), context_);
    SUNLinearSolver s = chain_ ? SUNLinSol_Band(y, a, context_) : SUNLinSol_Dense(y, a, context_);
    CVodeSetLinearSolver(memory, s, a);
    if (chain_ || p_.f.has_jacobian()) CVodeSetJacFn(memory, chain_ ? chain_jacobian : jacobian);
    CVodeSetStopTime(memory, p_.at.t_end);
    double t = 0;
    const int flag = CVode(memory, p_.at.t_end, y, &t, CV_NORMAL);
    out.resize(n_);
    for (size_t i = 0; i < n_; ++i) out[i] = data[chain_ ? 2 * (i % m) + i / m : i];
    CVodeFree(&memory);
    SUNLinSolFree(s);
    SUNMatDestroy(a);
    N_VDestroy(y);
    return flag >= 0;
  }

 private:
  static int rate(double t, N_Vector y, N_Vector d, void* user) {
    static_cast<CvodePeer*>(user)->p_.f.rate(t, N_VGetArrayPointer(y), N_VGetArrayPointer(d));
    return 0;
  }
  static int jacobian(double t, N_Vector y, N_Vector, SUNMatrix j, void* user, N_Vector, N_Vector, N_Vector) {
    static_cast<CvodePeer*>(user)->p_.f.jacobian(t, N_VGetArrayPointer(y), SM_DATA_D(j));
    return 0;
  }
  static int chain_rate(double, N_Vector state, N_Vector rates, void* user) {
    const auto& self = *static_cast<CvodePeer*>(user);
    const double *y = N_VGetArrayPointer(state), k = self.chain_->stiffness(), c = self.chain_->damping();
    double* d = N_VGetArrayPointer(rates);
    const size_t n = self.n_ / 2;
    for (size_t i = 0; i < n; ++i) {
      const double xl = i ? y[2 * i - 2] : 0, vl = i ? y[2 * i - 1] : 0;
      double a = k * (xl - y[2 * i]) + c * (vl - y[2 * i + 1]);
      if (i + 1 < n) a += k * (y[2 * i + 2] - y[2 * i]) + c * (y[2 * i + 3] - y[2 * i + 1]);
      d[2 * i] = y[2 * i + 1], d[2 * i + 1] = a - 9.81;
    }
    return 0;
  }
  static int chain_jacobian(double, N_Vector, N_Vector, SUNMatrix j, void* user, N_Vector, N_Vector,
                            N_Vector) {
    const auto& self = *static_cast<CvodePeer*>(user);
    const double k = self.chain_->stiffness(), c = self.chain_->damping();
    const long n = long(self.n_ / 2);
    SUNMatZero(j);
    for (long i = 0; i < n; ++i) {
      const long x = 2 * i, v = x + 1;
      const double d = i + 1 < n ? 2 : 1;
      SM_ELEMENT_B(j, x, v) = 1;
      SM_ELEMENT_B(j, v, x) = -d * k, SM_ELEMENT_B(j, v, v) = -d * c;
      if (i > 0) SM_ELEMENT_B(j, v, x - 2) = k, SM_ELEMENT_B(j, v, v - 2) = c;
      if (i + 1 < n) SM_ELEMENT_B(j, v, x + 2) = k, SM_ELEMENT_B(j, v, v + 2) = c;
    }
    return 0;
  }

  const Problem& p_;
  size_t n_;
  const test::Chain* chain_;
  SUNContext context_ = nullptr;
};

bool odeint(const Problem& p, double relative, double absolute, Vector& out) {
  namespace od = boost::numeric::odeint;
  namespace ub = boost::numeric::ublas;
  using State = ub::vector<double>;
  const size_t n = p.f.size();
  State y(n);
  std::copy(p.at.y0.begin(), p.at.y0.end(), y.begin());
  Vector values(n * n);
  const auto rate = [&](const State& x, State& d, double t) { p.f.rate(t, &x[0], &d[0]); };
  const auto jacobian = [&](const State& x, ub::matrix<double>& j, double t, State& time) {
    p.f.jacobian(t, &x[0], values.data());
    for (size_t i = 0; i < n; ++i) {
      time[i] = 0;
      for (size_t c = 0; c < n; ++c) j(i, c) = values[c * n + i];
    }
  };
  od::integrate_adaptive(od::make_dense_output<od::rosenbrock4<double>>(absolute, relative),
                         std::make_pair(rate, jacobian), y, 0.0, p.at.t_end, p.first_step);
  out.assign(y.begin(), y.end());
  return true;
}

bool ours(AdvanceFunction* method, const Problem& p, double relative, double absolute, Workspace& workspace,
          Vector& out) {
  out = p.at.y0;
  Carry carry;
  Advance a{.f = p.f,
            .t = 0,
            .t_end = p.at.t_end,
            .y = out.data(),
            .workspace = workspace,
            .carry = carry,
            .tolerance = {.relative = relative, .absolute = absolute}};
  try {
    method(a);
  } catch (const Error&) {
    return false;
  }
  return true;
}

struct Solver {
  std::string name;
  enum class Whose : uint8_t { ours, peer } whose;
  std::function<bool(double, double, Vector&)> run;
  int from, to;
  std::vector<Run> runs = {};
};

// Cheapest run within the error; nothing when none is.
std::optional<Run> cheapest(const Solver& s, double error) {
  std::optional<Run> best;
  for (const Run& r : s.runs) {
    if (r.error <= error && (!best || r.seconds < best->seconds)) best = r;
  }
  return best;
}

// Median CPU time of one run, repeated inside a measurement until it lasts.
double measure(const std::function<void()>& run) {
  double samples[5];
  int count = 0;
  for (; count < 5; ++count) {
    const double start = thread_seconds();
    int times = 0;
    do run(), ++times;
    while (thread_seconds() - start < 0.004);
    samples[count] = (thread_seconds() - start) / times;
    if (samples[count] > 0.5) break;
  }
  return median(samples, std::min(count + 1, 5));
}

enum class Output : uint8_t { comparisons, table };

void compare(const Problem& p, Output output) {
  Workspace workspace;
  CvodePeer cvode(p);
  std::vector<Solver> solvers = {
      {"rodas5p", Solver::Whose::ours,
       [&](double r, double a, Vector& y) { return ours(advance_rodas5p, p, r, a, workspace, y); }, p.from,
       p.to},
      {"radau5", Solver::Whose::ours,
       [&](double r, double a, Vector& y) { return ours(advance_radau5, p, r, a, workspace, y); }, p.from,
       p.to},
      {"CVODE BDF", Solver::Whose::peer, [&](double r, double a, Vector& y) { return cvode.run(r, a, y); },
       p.from_cvode, p.to_cvode}};
  if (p.odeint) {
    solvers.push_back({"odeint rosenbrock4", Solver::Whose::peer,
                       [&](double r, double a, Vector& y) { return odeint(p, r, a, y); }, p.from, 9});
  }
  for (int digits = 1; digits <= 12; ++digits) {
    for (Solver& s : solvers) {
      if (digits < s.from || digits > s.to) continue;
      const double relative = std::pow(10, -digits);
      Vector y;
      bool solved = true;
      const double seconds = measure([&] { solved = s.run(relative, relative * p.at.absolute_scale, y); });
      s.runs.push_back({seconds, solved ? p.error(y.data()) : HUGE_VAL});
      if (output == Output::table) {
        std::printf("%-10s %-20s 1e-%02d  %10.4f ms  error %.2e\n", p.name.c_str(), s.name.c_str(), digits,
                    1e3 * seconds, s.runs.back().error);
      }
    }
  }
  if (output == Output::table) return;
  for (const double target : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const Solver* best = nullptr;
    for (const Solver& s : solvers) {
      if (s.whose != Solver::Whose::ours || !cheapest(s, target)) continue;
      if (!best || cheapest(s, target)->seconds < cheapest(*best, target)->seconds) best = &s;
    }
    if (!best) continue;
    const Run mine = *cheapest(*best, target);
    for (const Solver& s : solvers) {
      if (s.whose == Solver::Whose::ours) continue;
      const auto theirs = cheapest(s, target);
      if (!theirs) continue;
      char metric[96];
      std::snprintf(metric, sizeof metric, "%s to %.0e with %s, CPU seconds", p.name.c_str(), target,
                    best->name.c_str());
      report({.bench = "ode_stiff",
              .metric = metric,
              .ours = mine.seconds,
              .peer = theirs->seconds,
              .peer_name = s.name,
              .error_ours = mine.error,
              .error_peer = theirs->error});
    }
  }
}

void run(const std::string& only, Output output) {
  const test::VanDerPol vdp;
  const test::Rober rober;
  const test::Hires hires;
  const test::Beam beam;
  const test::Chain mild(1000, 1e6, 1e3), stiff(1000, 1e8, 1e5);
  const auto by_case = [](const StiffCase& c) { return [c](const double* y) { return c.error(y); }; };
  const auto beam_error = [](const double* y) {
    const auto got = test::Beam::picked(y);
    const StiffCase want = test::Beam::published();
    double worst = 0;
    for (size_t i = 0; i < got.size(); ++i) worst = std::max(worst, std::abs(got[i] - want.reference[i]));
    return worst;
  };
  const auto v = test::VanDerPol::published(), r = test::Rober::published(), h = test::Hires::published();
  const auto m = mild.fall(10), s = stiff.fall(10);
  const Problem problems[] = {{"vdpol", vdp, v, 1e-6, by_case(v), 2, 12, 3, 12, true},
                              {"rober", rober, r, 1e-8, by_case(r), 2, 12, 3, 12, true},
                              {"hires", hires, h, 1e-6, by_case(h), 2, 12, 3, 12, true},
                              {"beam", beam, test::Beam::published(), 1e-6, beam_error, 2, 9, 5, 8, false},
                              {"chain_1e6", mild, m, 1e-4, by_case(m), 2, 9, 3, 9, false},
                              {"chain_1e8", stiff, s, 1e-4, by_case(s), 2, 9, 3, 9, false}};
  for (const Problem& p : problems) {
    if (only.empty() || only == p.name) compare(p, output);
  }
}

}  // namespace
}  // namespace truestep::bench

int main(int count, char** arguments) {
  std::string only;
  auto output = truestep::bench::Output::comparisons;
  for (int i = 1; i < count; ++i) {
    if (std::string(arguments[i]) == "--table") {
      output = truestep::bench::Output::table;
    } else if (arguments[i][0] != '-') {
      only = arguments[i];
    }
  }
  truestep::bench::run(only, output);
}
