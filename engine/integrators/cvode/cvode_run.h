// One integration by CVODE of SUNDIALS 6.4 (Hindmarsh et al. 2005) from a point in time on, step by step: a
// C++ interface to its memory, callbacks and errors. Steps are not shortened to hit requested times;
// solutions come from CVODE's own polynomial. BDF solves its systems with the right-hand side's own Jacobian
// (or CVODE's differences, or ours for sparse patterns) and CVODE's dense or band factors; equations of
// second order with a band are interleaved, (x0, v0, x1, v1, ...), which keeps the band narrow; sparse ones
// go to our sparse factors (sparse_factors.h), in half the size. Adams uses fixed-point iterations.
#pragma once
#include <exception>
#include <memory>
#include <vector>

#include "engine/integrators/advance.h"
#include "engine/integrators/cvode/cvode_jacobian.h"

namespace truestep {

enum class CvodeMethod : uint8_t { adams, bdf };

class CvodeRun {
 public:
  /// Where an integration begins, and what its steps depend on besides the right-hand side.
  struct Start {
    CvodeMethod method = CvodeMethod::bdf;
    double t = 0;
    double first_aim = 0;  ///< s, a later time from which CVODE judges how long its first step may be
    std::vector<double> y;
    double relative = 0, absolute = 0;
    std::vector<double> absolute_each;  ///< as in Tolerance
    friend bool operator==(const Start&, const Start&) = default;
  };

  /// Error "cvode_failed" when CVODE refuses or has no memory.
  /// `surroundings`: see Advance.
  CvodeRun(Start start, const RightHandSide& f, uint64_t surroundings);
  ~CvodeRun();
  CvodeRun(const CvodeRun&) = delete;
  CvodeRun& operator=(const CvodeRun&) = delete;

  const Start& start() const { return start_; }
  uint64_t surroundings() const { return surroundings_; }
  /// Continues with another object for the same equations; call before every use after the first.
  void bind(const RightHandSide& f);

  /// No step goes beyond t; the run ends there.
  void stop_at(double t);
  /// One internal step. Instability, or what the right-hand side threw.
  void step();
  uint64_t steps() const { return steps_; }
  /// Both ends of the last step; equal before the first.
  double t0() const { return t0_; }
  double t1() const { return t1_; }
  double last_step() const { return t1_ - t0_; }
  /// The solution at t in [t0, t1].
  void at(double t, double* y) const;

  /// Work since the start.
  Statistics work() const;

 private:
  struct Memory;  // CVODE's objects and callbacks
  [[noreturn]] void fail(const std::string& why);
  void set_tolerances();
  void set_linear_solver();

  Start start_;
  const RightHandSide* f_;
  uint64_t surroundings_;
  CvodeJacobian jacobian_;
  size_t n_;
  std::vector<double> scratch_;
  std::unique_ptr<Memory> memory_;
  uint64_t steps_ = 0;
  double t0_ = 0, t1_ = 0;
  std::exception_ptr thrown_;
};

}  // namespace truestep
