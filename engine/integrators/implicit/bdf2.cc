// Backward differentiation of order 2 for steps of any ratio w = h / h_last:
//   y1 = ((1 + w)^2 y - w^2 y_last) / (1 + 2w) + h (1 + w)/(1 + 2w) f(t + h, y1)
// (Hairer, Norsett, Wanner 1993, section III.5). A-stable and L-stable for constant steps. The previous
// solution is kept in `memory`; if there is none, or y has been changed since, the method starts with one
// step of TR-BDF2.
#include <cmath>

#include "engine/integrators/equations.h"
#include "engine/integrators/explicit/drive_fixed.h"
#include "engine/integrators/implicit/implicit_methods.h"
#include "engine/integrators/implicit/newton/stage_solver.h"

namespace truestep {

namespace {

constexpr auto memory_size = bdf2_memory;

class Bdf2 final : public Interpolant {
 public:
  explicit Bdf2(Equations& eq)
      : eq_(eq), a_(eq.advance()), solver_(eq, IncrementScale<Equations>::By::solution) {
    const size_t n = eq.size();
    std::copy_n(a_.y, n, eq.array(y_));
    if (a_.memory.size() != memory_size(n) || !(a_.memory[0] > 0)) return;
    const double* before = a_.memory.data() + 1;
    const double* after = before + n;
    if (!std::equal(after, after + n, a_.y)) return;
    std::copy_n(before, n, eq.array(kBefore));
    h_before_ = a_.memory[0];
  }

  // --- drive_fixed.h

  void begin(double t) { eq_.rate(t, eq_.array(y_), eq_.array(kRate)); }
  bool step(double t, double h) {
    h_ = h;
    if (!(h_before_ > 0)) return first_step(t, h);
    const double w = h / h_before_, scale = 1 / (1 + 2 * w), z = h * (1 + w) * scale;
    const double now = (1 + w) * (1 + w) * scale, before = -w * w * scale;
    const double *y = eq_.array(y_), *last = eq_.array(kBefore), *rate = eq_.array(kRate);
    double *base = eq_.array(kBase), *y_new = eq_.array(1 - y_);
    do {
      for (size_t i = 0; i < eq_.padded(); ++i) {
        base[i] = now * y[i] + before * last[i];
        y_new[i] = base[i] + z * rate[i];
      }
      if (!solver_.prepare(t, y, rate, z)) return false;
      if (solver_.solve(t + h, base, z, y_new, eq_.array(kIncrement))) {
        double* end = eq_.array(kEndRate);
        for (size_t i = 0; i < eq_.padded(); ++i) end[i] = (y_new[i] - base[i]) * (1 / z);
        return true;
      }
    } while (solver_.try_again());
    return false;
  }
  double* candidate() { return eq_.array(1 - y_); }
  const double* solution() const { return eq_.array(y_); }
  const Interpolant& between(double, double) { return *this; }
  void accept(double) {
    std::copy_n(eq_.array(y_), eq_.padded(), eq_.array(kBefore));
    std::copy_n(eq_.array(kEndRate), eq_.padded(), eq_.array(kRate));
    h_before_ = h_;
    y_ = 1 - y_;
    solver_.step_accepted();
  }
  long long worst(double) const { return 0; }

  // --- Interpolant: Hermite, order 3

  void at(double s, double* out) const override {
    const double *y0 = eq_.array(y_), *y1 = eq_.array(1 - y_);
    const double *k0 = eq_.array(kRate), *k1 = eq_.array(kEndRate);
    const double r = 1 - s, w = s * s * (3 - 2 * s), w0 = h_ * s * r * r, w1 = -h_ * s * s * r;
    for (size_t i = 0; i < eq_.size(); ++i) {
      out[i] = y0[i] + (w * (y1[i] - y0[i]) + (w0 * k0[i] + w1 * k1[i]));
    }
  }

  /// Stores the last step for the next call, after drive_fixed.
  void remember() {
    const size_t n = eq_.size();
    if (a_.project) a_.project(a_.f, a_.y);
    if (a_.memory.size() != memory_size(n)) return;
    a_.memory[0] = h_;
    std::copy_n(eq_.array(y_), n, a_.memory.data() + 1);
    std::copy_n(a_.y, n, a_.memory.data() + 1 + n);
  }

 private:
  enum : size_t { kRate = 2, kEndRate, kBefore, kBase, kIncrement };

  bool first_step(double t, double h) {
    double* y_new = eq_.array(1 - y_);
    std::copy_n(eq_.array(y_), eq_.size(), y_new);
    Workspace& own = a_.workspace.object<Workspace>("integrator.bdf2_start");
    Carry carry;
    Advance start{.f = a_.f,
                  .t = t,
                  .t_end = t + h,
                  .y = y_new,
                  .workspace = own,
                  .carry = carry,
                  .newton_tolerance = a_.newton_tolerance};
    start.statistics = a_.statistics;
    advance_tr_bdf2_fixed(start);
    eq_.rate(t + h, y_new, eq_.array(kEndRate));
    // Prepares the next steps' matrix, so that they do not allocate.
    solver_.prepare(t, eq_.array(y_), eq_.array(kRate), h * (2.0 / 3));
    if (a_.statistics) --a_.statistics->steps;
    return true;
  }

  Equations& eq_;
  Advance& a_;
  StageSolver solver_;
  size_t y_ = 0;
  double h_ = 0, h_before_ = 0;
};

}  // namespace

// Layout: length of the last step, y before it, y after it.
size_t bdf2_memory(size_t n) {
  return 2 * n + 1;
}

void prepare_bdf2(const ForceField& field, State& state) {
  const size_t n = state.f64(state.at("position")).size() + state.f64(state.at("velocity")).size();
  add_memory(state, memory_size(n));
}

void advance_bdf2(Advance& a) {
  with_equations(a, [&a](Equations& eq) {
    Bdf2 method(eq);
    drive_fixed(a, method);
    method.remember();
  });
}

}  // namespace truestep
