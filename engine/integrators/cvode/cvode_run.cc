#include "engine/integrators/cvode/cvode_run.h"

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
#include <string>
#include <utility>

#include "engine/base/errors.h"

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

void check(int flag, const char* what) {
  if (flag < 0) throw Error("cvode_failed", std::string(what) + " failed with code " + std::to_string(flag));
}
std::string flag_name(int flag) {
  const std::unique_ptr<char, void (*)(void*)> name(CVodeGetReturnFlagName(flag), std::free);
  return name ? std::string("CVODE reports ") + name.get() : "CVODE failed";
}

}  // namespace

struct CvodeRun::Memory {
  std::unique_ptr<std::remove_pointer_t<SUNContext>, ContextDeleter> context;
  std::unique_ptr<std::remove_pointer_t<N_Vector>, VectorDeleter> y, other;
  std::unique_ptr<std::remove_pointer_t<SUNMatrix>, MatrixDeleter> matrix;
  std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, LinearDeleter> linear;
  std::unique_ptr<std::remove_pointer_t<SUNNonlinearSolver>, NonlinearDeleter> iteration;
  std::unique_ptr<void, MemoryDeleter> cvode;

  // C++ exceptions must not pass through C frames: callbacks keep them in `thrown_`.
  static int rate(realtype t, N_Vector y, N_Vector dydt, void* user) {
    CvodeRun& run = *static_cast<CvodeRun*>(user);
    try {
      const double* at = N_VGetArrayPointer(y);
      double* out = N_VGetArrayPointer(dydt);
      if (run.jacobian_.interleaved()) {
        double* moved = run.scratch_.data();
        run.jacobian_.from_cvode(at, moved);
        run.f_->rate(t, moved, moved + run.n_);
        run.jacobian_.to_cvode(moved + run.n_, out);
      } else {
        run.f_->rate(t, at, out);
      }
      // A NaN: CVODE may try a shorter step.
      for (size_t i = 0; i < run.n_; ++i) {
        if (!std::isfinite(out[i])) return 1;
      }
      return 0;
    } catch (...) {
      run.thrown_ = std::current_exception();
      return -1;
    }
  }
  static int jacobian(realtype t, N_Vector y, N_Vector, SUNMatrix j, void* user, N_Vector, N_Vector,
                      N_Vector) {
    CvodeRun& run = *static_cast<CvodeRun*>(user);
    try {
      run.jacobian_.evaluate(t, N_VGetArrayPointer(y), j);
      return 0;
    } catch (...) {
      run.thrown_ = std::current_exception();
      return -1;
    }
  }
};

CvodeRun::CvodeRun(Start start, const RightHandSide& f, uint64_t surroundings)
    : start_(std::move(start)),
      f_(&f),
      surroundings_(surroundings),
      jacobian_(f),
      n_(f.size()),
      scratch_(2 * n_),
      memory_(std::make_unique<Memory>()),
      t0_(start_.t),
      t1_(start_.t) {
  Memory& m = *memory_;
  SUNContext context = nullptr;
  check(SUNContext_Create(nullptr, &context), "SUNContext_Create");
  m.context.reset(context);
  m.y.reset(N_VNew_Serial(sunindextype(n_), context));
  m.other.reset(N_VNew_Serial(sunindextype(n_), context));
  const bool bdf = start_.method == CvodeMethod::bdf;
  m.cvode.reset(CVodeCreate(bdf ? CV_BDF : CV_ADAMS, context));
  if (!m.y || !m.other || !m.cvode) throw Error("cvode_failed", "CVODE could not allocate its memory");
  jacobian_.to_cvode(start_.y.data(), N_VGetArrayPointer(m.y.get()));
  check(CVodeInit(m.cvode.get(), Memory::rate, start_.t, m.y.get()), "CVodeInit");
  check(CVodeSetUserData(m.cvode.get(), this), "CVodeSetUserData");
  check(CVodeSetErrHandlerFn(
            m.cvode.get(), [](int, const char*, const char*, char*, void*) {}, nullptr),
        "CVodeSetErrHandlerFn");
  set_tolerances();
  if (bdf) {
    set_linear_solver();
  } else {
    m.iteration.reset(SUNNonlinSol_FixedPoint(m.y.get(), 0, context));
    check(CVodeSetNonlinearSolver(m.cvode.get(), m.iteration.get()), "CVodeSetNonlinearSolver");
  }
}

CvodeRun::~CvodeRun() = default;

void CvodeRun::bind(const RightHandSide& f) {
  f_ = &f;
  jacobian_.bind(f);
}

void CvodeRun::set_tolerances() {
  void* cvode = memory_->cvode.get();
  if (start_.absolute_each.empty()) {
    check(CVodeSStolerances(cvode, start_.relative, start_.absolute), "CVodeSStolerances");
    return;
  }
  jacobian_.to_cvode(start_.absolute_each.data(), N_VGetArrayPointer(memory_->other.get()));
  check(CVodeSVtolerances(cvode, start_.relative, memory_->other.get()), "CVodeSVtolerances");
}

void CvodeRun::set_linear_solver() {
  Memory& m = *memory_;
  SUNContext context = m.context.get();
  const auto n = sunindextype(n_);
  if (jacobian_.kind() == CvodeJacobian::Kind::sparse) {
    m.matrix.reset(jacobian_.sparse_matrix(context));
    m.linear.reset(jacobian_.sparse_solver(context));
  } else if (jacobian_.kind() == CvodeJacobian::Kind::band) {
    m.matrix.reset(
        SUNBandMatrix(n, sunindextype(jacobian_.lower()), sunindextype(jacobian_.upper()), context));
    m.linear.reset(SUNLinSol_Band(m.y.get(), m.matrix.get(), context));
  } else {
    m.matrix.reset(SUNDenseMatrix(n, n, context));
    m.linear.reset(SUNLinSol_Dense(m.y.get(), m.matrix.get(), context));
  }
  if (!m.matrix || !m.linear) throw Error("cvode_failed", "CVODE could not allocate its matrix");
  check(CVodeSetLinearSolver(m.cvode.get(), m.linear.get(), m.matrix.get()), "CVodeSetLinearSolver");
  if (jacobian_.analytic()) check(CVodeSetJacFn(m.cvode.get(), Memory::jacobian), "CVodeSetJacFn");
}

void CvodeRun::stop_at(double t) {
  check(CVodeSetStopTime(memory_->cvode.get(), t), "CVodeSetStopTime");
}

void CvodeRun::step() {
  double t = t1_;
  const int flag = CVode(memory_->cvode.get(), start_.first_aim, memory_->y.get(), &t, CV_ONE_STEP);
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  if (flag < 0) fail(flag_name(flag));
  // A few roundings of the time itself.
  if (t - t1_ <= std::max(4e-16 * std::abs(t1_), 1e-24 * (start_.first_aim - start_.t))) {
    fail("CVODE's steps have shrunk to the rounding error of the time");
  }
  t0_ = t1_, t1_ = t;
  ++steps_;
}

void CvodeRun::at(double t, double* y) const {
  N_Vector out = memory_->other.get();
  check(CVodeGetDky(memory_->cvode.get(), t, 0, out), "CVodeGetDky");
  jacobian_.from_cvode(N_VGetArrayPointer(out), y);
}

void CvodeRun::fail(const std::string& why) {
  const double* y = N_VGetArrayPointer(memory_->y.get());
  jacobian_.from_cvode(y, scratch_.data());
  long long worst = 0;
  for (size_t i = 0; i < n_; ++i) {
    if (!std::isfinite(scratch_[i])) worst = static_cast<long long>(i);
  }
  throw Instability("", "y", worst, why + " at t = " + std::to_string(t1_) + " s");
}

Statistics CvodeRun::work() const {
  void* cvode = memory_->cvode.get();
  long steps = 0, rates = 0, setups = 0, failures = 0, jacobians = 0, solves = 0;
  CVodeGetNumSteps(cvode, &steps);
  CVodeGetNumRhsEvals(cvode, &rates);
  CVodeGetNumErrTestFails(cvode, &failures);
  if (memory_->linear) {
    CVodeGetNumLinSolvSetups(cvode, &setups);
    CVodeGetNumJacEvals(cvode, &jacobians);
    long extra = 0;
    CVodeGetNumLinRhsEvals(cvode, &extra);
    rates += extra;
    CVodeGetNumNonlinSolvIters(cvode, &solves);
  }
  Statistics s;
  s.steps = uint64_t(steps), s.rejected = uint64_t(failures), s.rates = uint64_t(rates);
  s.factorisations = uint64_t(setups), s.jacobians = uint64_t(jacobians);
  s.solves = uint64_t(solves);
  return s;
}

}  // namespace truestep
