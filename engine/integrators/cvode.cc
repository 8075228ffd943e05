// CVODE behind the face of all methods. Every call is a run of its own that begins at order 1: nothing of
// CVODE's history survives, so a restored state repeats every choice; long calls suit it best. BDF solves its
// systems with the right-hand side's own Jacobian (or CVODE's differences, or ours for sparse patterns) and
// CVODE's dense or band factors; equations of second order with a band are interleaved, (x0, v0, x1, v1,
// ...), which keeps the band narrow; sparse ones go to our sparse factors (sparse_lu.h). Adams uses
// fixed-point iterations. CVODE calls the C library's pow: its bits are those of one machine.
#include "engine/integrators/cvode.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>
#include <memory>
#include <string>

#include "engine/base/errors.h"
#include "engine/integrators/cvode_jacobian.h"
#include "engine/integrators/implicit_methods.h"
#include "engine/integrators/step_control.h"

namespace truestep {

namespace {

struct ContextDeleter {
  void operator()(SUNContext c) const { SUNContext_Free(&c); }
};
struct MemoryDeleter {
  void operator()(void* m) const { CVodeFree(&m); }
};
struct VectorDeleter {
  void operator()(N_Vector v) const { N_VDestroy(v); }
};
struct MatrixDeleter {
  void operator()(SUNMatrix m) const { SUNMatDestroy(m); }
};
struct LinearDeleter {
  void operator()(SUNLinearSolver s) const { SUNLinSolFree(s); }
};
struct NonlinearDeleter {
  void operator()(SUNNonlinearSolver s) const { SUNNonlinSolFree(s); }
};

// One run. C++ exceptions must not pass through C frames: callbacks keep them in `thrown`.
class Run final : public Interpolant {
 public:
  Run(Advance& a, int method) : a_(a), jacobian_(a.f), n_(a.f.size()), scratch_(2 * n_) {
    SUNContext context = nullptr;
    check(SUNContext_Create(nullptr, &context), "SUNContext_Create");
    context_.reset(context);
    y_.reset(N_VNew_Serial(sunindextype(n_), context));
    tolerance_.reset(N_VNew_Serial(sunindextype(n_), context));
    memory_.reset(CVodeCreate(method, context));
    if (!y_ || !tolerance_ || !memory_) throw Error("cvode_failed", "CVODE could not allocate its memory");
    jacobian_.to_cvode(a.y, N_VGetArrayPointer(y_.get()));
    check(CVodeInit(memory_.get(), rate, a.t, y_.get()), "CVodeInit");
    check(CVodeSetUserData(memory_.get(), this), "CVodeSetUserData");
    check(CVodeSetErrHandlerFn(
              memory_.get(), [](int, const char*, const char*, char*, void*) {}, nullptr),
          "CVodeSetErrHandlerFn");
    set_tolerances();
    check(CVodeSetStopTime(memory_.get(), a.t_end), "CVodeSetStopTime");
    if (method == CV_ADAMS) {
      iteration_.reset(SUNNonlinSol_FixedPoint(y_.get(), 0, context));
      check(CVodeSetNonlinearSolver(memory_.get(), iteration_.get()), "CVodeSetNonlinearSolver");
    } else {
      set_linear_solver();
    }
  }

  void run() {
    double t = a_.t;
    uint64_t steps = 0;
    for (;;) {
      if (steps++ >= a_.max_steps) {
        double h = 0;
        CVodeGetLastStep(memory_.get(), &h);
        report();
        step_control::too_many_steps(a_, t, h);
      }
      double t1 = t;
      const int flag = CVode(memory_.get(), a_.t_end, y_.get(), &t1, CV_ONE_STEP);
      if (thrown_) std::rethrow_exception(thrown_);
      if (flag < 0) fail(t, flag_name(flag));
      if (t1 < a_.t_end && t1 - t <= step_control::smallest_step(a_, t)) {
        fail(t, "CVODE's steps have become as short as the rounding of the time");
      }
      t0_ = t, t1_ = t1;
      jacobian_.from_cvode(N_VGetArrayPointer(y_.get()), a_.y);
      const bool last = t1 >= a_.t_end;
      auto verdict = StepWatcher::Verdict::go_on;
      if (a_.watcher) verdict = a_.watcher->accepted(t, t1, a_.y, *this);
      t = t1;
      if (last || verdict == StepWatcher::Verdict::stop) break;
    }
    a_.reached = t;
    CVodeGetLastStep(memory_.get(), &a_.carry.step);
    report();
  }

  /// CVODE's own polynomial, of the order of the step.
  void at(double theta, double* y) const override {
    N_Vector out = tolerance_.get();
    CVodeGetDky(memory_.get(), t0_ + theta * (t1_ - t0_), 0, out);
    jacobian_.from_cvode(N_VGetArrayPointer(out), y);
  }

 private:
  static void check(int flag, const char* what) {
    if (flag < 0)
      throw Error("cvode_failed", std::string(what) + " failed with code " + std::to_string(flag));
  }
  static std::string flag_name(int flag) {
    const std::unique_ptr<char, void (*)(void*)> name(CVodeGetReturnFlagName(flag), std::free);
    return name ? std::string("CVODE reports ") + name.get() : "CVODE failed";
  }

  void set_tolerances() {
    const Tolerance& t = a_.tolerance;
    if (t.absolute_each.empty()) {
      check(CVodeSStolerances(memory_.get(), t.relative, t.absolute), "CVodeSStolerances");
      return;
    }
    jacobian_.to_cvode(t.absolute_each.data(), N_VGetArrayPointer(tolerance_.get()));
    check(CVodeSVtolerances(memory_.get(), t.relative, tolerance_.get()), "CVodeSVtolerances");
  }

  void set_linear_solver() {
    SUNContext context = context_.get();
    const auto n = sunindextype(n_);
    if (jacobian_.kind() == CvodeJacobian::Kind::sparse) {
      matrix_.reset(jacobian_.sparse_matrix(context));
      solver_.reset(jacobian_.sparse_solver(context));
    } else if (jacobian_.kind() == CvodeJacobian::Kind::band) {
      matrix_.reset(
          SUNBandMatrix(n, sunindextype(jacobian_.lower()), sunindextype(jacobian_.upper()), context));
      solver_.reset(SUNLinSol_Band(y_.get(), matrix_.get(), context));
    } else {
      matrix_.reset(SUNDenseMatrix(n, n, context));
      solver_.reset(SUNLinSol_Dense(y_.get(), matrix_.get(), context));
    }
    if (!matrix_ || !solver_) throw Error("cvode_failed", "CVODE could not allocate its matrix");
    check(CVodeSetLinearSolver(memory_.get(), solver_.get(), matrix_.get()), "CVodeSetLinearSolver");
    if (jacobian_.analytic()) check(CVodeSetJacFn(memory_.get(), jacobian), "CVodeSetJacFn");
  }

  static int rate(realtype t, N_Vector y, N_Vector dydt, void* user) {
    Run& self = *static_cast<Run*>(user);
    try {
      const double* at = N_VGetArrayPointer(y);
      double* out = N_VGetArrayPointer(dydt);
      if (self.jacobian_.interleaved()) {
        double* moved = self.scratch_.data();
        self.jacobian_.from_cvode(at, moved);
        self.a_.f.rate(t, moved, moved + self.n_);
        self.jacobian_.to_cvode(moved + self.n_, out);
      } else {
        self.a_.f.rate(t, at, out);
      }
      // A value that is no number: CVODE may try a shorter step.
      for (size_t i = 0; i < self.n_; ++i) {
        if (!std::isfinite(out[i])) return 1;
      }
      return 0;
    } catch (...) {
      self.thrown_ = std::current_exception();
      return -1;
    }
  }
  static int jacobian(realtype t, N_Vector y, N_Vector, SUNMatrix j, void* user, N_Vector, N_Vector,
                      N_Vector) {
    Run& self = *static_cast<Run*>(user);
    try {
      self.jacobian_.evaluate(t, N_VGetArrayPointer(y), j);
      return 0;
    } catch (...) {
      self.thrown_ = std::current_exception();
      return -1;
    }
  }

  [[noreturn]] void fail(double t, const std::string& why) {
    report();
    long long worst = 0;
    for (size_t i = 0; i < n_; ++i) {
      if (!std::isfinite(a_.y[i])) worst = static_cast<long long>(i);
    }
    throw Instability("", "y", worst, why + " at t = " + std::to_string(t) + " s");
  }

  void report() {
    if (!a_.statistics) return;
    long steps = 0, rates = 0, setups = 0, failures = 0, jacobians = 0;
    CVodeGetNumSteps(memory_.get(), &steps);
    CVodeGetNumRhsEvals(memory_.get(), &rates);
    CVodeGetNumErrTestFails(memory_.get(), &failures);
    if (solver_) {
      CVodeGetNumLinSolvSetups(memory_.get(), &setups);
      CVodeGetNumJacEvals(memory_.get(), &jacobians);
      long extra = 0;
      CVodeGetNumLinRhsEvals(memory_.get(), &extra);
      rates += extra;
    }
    Statistics& s = *a_.statistics;
    s.steps += uint64_t(steps), s.rejected += uint64_t(failures), s.rates += uint64_t(rates);
    s.factorisations += uint64_t(setups), s.jacobians += uint64_t(jacobians);
  }

  Advance& a_;
  CvodeJacobian jacobian_;
  size_t n_;
  std::vector<double> scratch_;
  std::unique_ptr<std::remove_pointer_t<SUNContext>, ContextDeleter> context_;
  std::unique_ptr<std::remove_pointer_t<N_Vector>, VectorDeleter> y_, tolerance_;
  std::unique_ptr<std::remove_pointer_t<SUNMatrix>, MatrixDeleter> matrix_;
  std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, LinearDeleter> solver_;
  std::unique_ptr<std::remove_pointer_t<SUNNonlinearSolver>, NonlinearDeleter> iteration_;
  std::unique_ptr<void, MemoryDeleter> memory_;
  double t0_ = 0, t1_ = 0;
  std::exception_ptr thrown_;
};

void advance(Advance& a, int method) {
  if (a.f.size() == 0) {
    a.reached = a.t_end;
    return;
  }
  Run(a, method).run();
}

}  // namespace

void advance_cvode_bdf(Advance& a) {
  advance(a, CV_BDF);
}
void advance_cvode_adams(Advance& a) {
  advance(a, CV_ADAMS);
}

std::vector<double> reference_solution(const RightHandSide& f, double t, double t_end,
                                       std::span<const double> y, const Tolerance& tolerance) {
  std::vector<double> result(y.begin(), y.end());
  Workspace workspace;
  Carry carry;
  Advance a{.f = f,
            .t = t,
            .t_end = t_end,
            .y = result.data(),
            .workspace = workspace,
            .carry = carry,
            .tolerance = tolerance};
  advance_cvode_bdf(a);
  return result;
}

}  // namespace truestep
