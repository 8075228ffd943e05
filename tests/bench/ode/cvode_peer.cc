// CVODE from its C interface, as its users drive it: BDF with a dense or banded direct solver, Adams with
// functional iteration. Nothing of ours stands between CVODE and the problem.
#include <cvode/cvode.h>
#include <cvode/cvode_ls.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_band.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_band.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <memory>
#include <utility>

#include "tests/bench/ode/problems.h"

namespace truestep::bench {
namespace {

// y' as CVODE asks for it. `order[i]` is where component i of the case stands in CVODE's vector.
struct Task {
  const RightHandSide* f = nullptr;  // null: a chain
  const Case* at = nullptr;
  std::vector<size_t> order = {};
};

int rate(double t, N_Vector y, N_Vector d, void* user) {
  static_cast<const Task*>(user)->f->rate(t, N_VGetArrayPointer(y), N_VGetArrayPointer(d));
  return 0;
}

int jacobian(double t, N_Vector y, N_Vector, SUNMatrix j, void* user, N_Vector, N_Vector, N_Vector) {
  static_cast<const Task*>(user)->f->jacobian(t, N_VGetArrayPointer(y), SM_DATA_D(j));
  return 0;
}

// Displacement and velocity of each mass beside one another.
int chain_rate(double, N_Vector state, N_Vector rates, void* user) {
  const auto& task = *static_cast<const Task*>(user);
  const double *y = N_VGetArrayPointer(state), k = task.at->stiffness, c = task.at->damping;
  double* d = N_VGetArrayPointer(rates);
  const size_t n = task.order.size() / 2;
  for (size_t i = 0; i < n; ++i) {
    const double xl = i ? y[2 * i - 2] : 0, vl = i ? y[2 * i - 1] : 0;
    double a = k * (xl - y[2 * i]) + c * (vl - y[2 * i + 1]);
    if (i + 1 < n) a += k * (y[2 * i + 2] - y[2 * i]) + c * (y[2 * i + 3] - y[2 * i + 1]);
    d[2 * i] = y[2 * i + 1], d[2 * i + 1] = a - 9.81;
  }
  return 0;
}

int chain_jacobian(double, N_Vector, N_Vector, SUNMatrix j, void* user, N_Vector, N_Vector, N_Vector) {
  const auto& task = *static_cast<const Task*>(user);
  const double k = task.at->stiffness, c = task.at->damping;
  const long n = static_cast<long>(task.order.size() / 2);
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

class Context {
 public:
  Context() { SUNContext_Create(nullptr, &context_); }
  ~Context() { SUNContext_Free(&context_); }
  Context(const Context&) = delete;
  operator SUNContext() const { return context_; }

 private:
  SUNContext context_ = nullptr;
};

Outcome run_cvode(Task& task, int method, double tolerance) {
  static const Context context;
  const size_t n = task.order.size();
  const auto rows = static_cast<sunindextype>(n);
  N_Vector y = N_VNew_Serial(rows, context);
  double* data = N_VGetArrayPointer(y);
  for (size_t i = 0; i < n; ++i) data[task.order[i]] = task.at->start[i];
  void* memory = CVodeCreate(method, context);
  CVodeInit(memory, task.f ? rate : chain_rate, 0, y);
  CVodeSStolerances(memory, tolerance, tolerance * task.at->absolute_scale);
  CVodeSetUserData(memory, &task);
  CVodeSetMaxNumSteps(memory, 1'000'000);
  CVodeSetErrFile(memory, nullptr);
  SUNMatrix matrix = nullptr;
  SUNLinearSolver linear = nullptr;
  SUNNonlinearSolver nonlinear = nullptr;
  if (method == CV_ADAMS) {
    nonlinear = SUNNonlinSol_FixedPoint(y, 0, context);
    CVodeSetNonlinearSolver(memory, nonlinear);
  } else {
    matrix = task.f ? SUNDenseMatrix(rows, rows, context) : SUNBandMatrix(rows, 3, 3, context);
    linear = task.f ? SUNLinSol_Dense(y, matrix, context) : SUNLinSol_Band(y, matrix, context);
    CVodeSetLinearSolver(memory, linear, matrix);
    if (!task.f) CVodeSetJacFn(memory, chain_jacobian);
    if (task.f && task.f->has_jacobian()) CVodeSetJacFn(memory, jacobian);
  }
  CVodeSetStopTime(memory, task.at->t_end);
  double t = 0;
  const int flag = CVode(memory, task.at->t_end, y, &t, CV_NORMAL);
  Outcome out;
  if (flag >= 0) {
    long calls = 0, differences = 0;
    CVodeGetNumRhsEvals(memory, &calls);
    if (linear) CVodeGetNumLinRhsEvals(memory, &differences);
    out.evaluations = static_cast<uint64_t>(calls + differences);
    out.end.resize(n);
    for (size_t i = 0; i < n; ++i) out.end[i] = data[task.order[i]];
  }
  CVodeFree(&memory);
  if (linear) SUNLinSolFree(linear);
  if (matrix) SUNMatDestroy(matrix);
  if (nonlinear) SUNNonlinSolFree(nonlinear);
  N_VDestroy(y);
  return out;
}

Solver solver(const char* name, int method, Task task, int from, int to) {
  const size_t n = task.at->start.size();
  for (size_t i = 0; i < n; ++i) task.order.push_back(task.f ? i : 2 * (i % (n / 2)) + i / (n / 2));
  const auto shared = std::make_shared<Task>(std::move(task));
  return {.name = name, .side = "CVODE", .from = from, .to = to, .run = [shared, method](double tolerance) {
            return run_cvode(*shared, method, tolerance);
          }};
}

}  // namespace

Solver cvode_bdf(const RightHandSide& f, const Case& at, int from, int to) {
  return solver("CVODE BDF", CV_BDF, {.f = &f, .at = &at}, from, to);
}

Solver cvode_adams(const RightHandSide& f, const Case& at, int from, int to) {
  return solver("CVODE Adams", CV_ADAMS, {.f = &f, .at = &at}, from, to);
}

Solver cvode_chain(const Case& at, int from, int to) {
  return solver("CVODE BDF band", CV_BDF, {.at = &at}, from, to);
}

}  // namespace truestep::bench
