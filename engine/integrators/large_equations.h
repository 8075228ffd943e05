// The equations of an integration in any number: arrays in the workspace, linear systems by their shape.
#pragma once
#include "engine/integrators/equations.h"
#include "engine/integrators/implicit/newton/newton_matrix.h"

namespace truestep {

class LargeEquations final : public Equations {
 public:
  explicit LargeEquations(Advance& a) : LargeEquations(a, a.f.size()) {}

  NewtonMatrix& matrix() { return matrix_; }

  void differentiate(double t, const double* y, const double* fy) override {
    matrix_.differentiate(t, y, fy, typical_size(a_.tolerance), count_);
  }
  bool factor(double z) override {
    ++count_.factorisations;
    return matrix_.factor(z);
  }
  bool factor(Complex z) override {
    ++count_.factorisations;
    return matrix_.factor(z);
  }
  void solve(double* b) override {
    ++count_.solves;
    matrix_.solve(b);
  }
  void solve(double* re, double* im) override {
    ++count_.solves;
    matrix_.solve(re, im);
  }

 private:
  LargeEquations(Advance& a, size_t n) : LargeEquations(a, n, (n + 7) / 8 * 8 + 8) {}
  // One extra cache line in the stride, so that arrays of 4096 bytes do not map to the same cache sets.
  LargeEquations(Advance& a, size_t n, size_t stride)
      : Equations(a, n, a.workspace.doubles("integrator.implicit_arrays", kWorkArrays * stride).data(),
                  stride),
        matrix_(a.workspace.object<NewtonMatrix>("integrator.newton_matrix")) {
    matrix_.bind(a.f);
  }

  NewtonMatrix& matrix_;
};

}  // namespace truestep
