// Control of the internal step. After an accepted step of length h with error e (1 = the tolerance),
//   h' = h clamp(safety e^-alpha e_last^beta, shrink, grow),   alpha = 1/q - 3/4 beta,  q = order of e in h:
// proportional-integral control, Gustafsson 1991, "Control theoretic techniques for stepsize selection in
// explicit Runge-Kutta methods", as in Hairer and Wanner 1996, section IV.2; beta = 0 is the classical rule.
// The first step: Hairer, Norsett, Wanner 1993, section II.4, algorithm 4.14. A step's length need not be
// accurate, only the same on every machine: powers use polynomials for the base-2 logarithm and exponential
// that are accurate to 2e-6 and cost a tenth of those in math/trig.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>

#include "engine/integrators/advance.h"

namespace truestep::step_control {

/// log2(x) to 2e-6 for normal positive x; below them about -1022, above about 1024.
inline double rough_log2(double x) {
  const auto bits = std::bit_cast<uint64_t>(x);
  // Mantissa between 1/sqrt(2) and sqrt(2): the offset moves the exponent's carry there.
  const int64_t exponent = static_cast<int64_t>(bits - 0x3fe6a09e667f3bcdULL) >> 52;
  const double u = std::bit_cast<double>(bits - (static_cast<uint64_t>(exponent) << 52)) - 1, u2 = u * u;
  const double low = std::fma(u, -0.7213640398472614, 1.4426964322205758);
  const double middle = std::fma(u, -0.35935065283812206, 0.48062914692434333);
  const double high = std::fma(u2, 0.17212873067503098, std::fma(u, -0.2695062744410081, 0.2956336002605361));
  return std::fma(u, std::fma(u2, std::fma(u2, high, middle), low), static_cast<double>(exponent));
}

/// 2^x to a few 1e-6, |x| <= 1000.
inline double rough_exp2(double x) {
  const double k = (x + 0x1.8p52) - 0x1.8p52, u = x - k;
  const double p = std::fma(
      u,
      std::fma(u, std::fma(u, std::fma(u, 0.0013390867351598943, 0.009666373693209015), 0.05550357104252404),
               0.24022348940946972),
      0.6931471880293432);
  const auto scale = static_cast<uint64_t>(static_cast<int64_t>(k) + 1023) << 52;
  return std::fma(u, p, 1.0) * std::bit_cast<double>(scale);
}

/// x^p for x > 0 and a result between 2^-1000 and 2^1000.
inline double rough_pow(double x, double p) {
  return rough_exp2(std::clamp(p * rough_log2(x), -1000.0, 1000.0));
}

struct Law {
  double q = 5;  ///< the error is O(h^q)
  double beta = 0.04;
  double safety = 0.9, shrink = 0.2, grow = 10;
  /// How far a growth of e / h^q from one step to the next is extrapolated (Gustafsson 1994, "Control
  /// theoretic techniques for stepsize selection in implicit Runge-Kutta methods"): saves most of the
  /// rejected steps when a solution keeps getting steeper. 0: not at all.
  double foresight = 1;
};

/// Proposes step lengths from squared errors.
class Controller {
 public:
  Controller(const Law& law, double last_error)
      : law_(law), log_last_(last_error > 0 ? std::max(rough_log2(last_error), kFloor) : kFloor) {}

  /// Factor after an accepted step of length h.
  double accepted(double squared_error, double h) {
    const double log_error = squared_error > 1e-60 ? 0.5 * rough_log2(squared_error) : -100;
    const double alpha = 1 / law_.q - 0.75 * law_.beta;
    double log_factor = law_.beta * log_last_ - alpha * log_error;
    const double log_constant = log_error - law_.q * rough_log2(h);
    if (known_ && log_constant > log_constant_) {
      log_factor -= law_.foresight / law_.q * (log_constant - log_constant_);
    }
    known_ = true, log_constant_ = log_constant;
    const double factor = law_.safety * rough_exp2(std::clamp(log_factor, -50.0, 50.0));
    log_last_ = std::max(log_error, kFloor);
    const double most = rejected_ ? 1.0 : law_.grow;
    rejected_ = false;
    return std::clamp(factor, law_.shrink, most);
  }
  /// Factor after a rejected step; a NaN error divides the step by 10.
  double rejected(double squared_error) {
    rejected_ = true;
    if (!std::isfinite(squared_error)) return 0.1;
    return std::clamp(law_.safety * rough_pow(squared_error, -0.5 / law_.q), 0.1, 0.9);
  }
  double last_error() const { return rough_exp2(log_last_); }

 private:
  static constexpr double kFloor = -13.287712379549449;  // log2(1e-4)
  Law law_;
  double log_last_, log_constant_ = 0;
  bool rejected_ = false, known_ = false;
};

/// First step for y' = f(t, y) when nothing is known: y, rate and two scratch arrays as long as f; one
/// evaluation of f. `order` is the method's.
double first_step(const Advance& in, const double* y, const double* rate, int order, double* scratch,
                  double* scratch_rate);

/// A step no longer than this means that the method cannot continue: a few roundings of t itself, not of
/// t_end, because integrations over many decades begin with tiny steps.
inline double smallest_step(const Advance& in, double t) {
  return std::max(4e-16 * std::abs(t), 1e-24 * (in.t_end - in.t));
}

/// absolute + relative |y| of component i.
inline double weight(const Tolerance& tolerance, size_t i, double y) {
  const double absolute = tolerance.absolute_each.empty() ? tolerance.absolute : tolerance.absolute_each[i];
  return std::fma(tolerance.relative, std::abs(y), absolute);
}

/// Index of the component of y whose error(i) is largest relative to its tolerance, or of the first whose
/// error is NaN.
template <class Error>
long long worst_component(const Advance& in, size_t n, const double* y, Error error) {
  size_t most = 0;
  double largest = -1;
  for (size_t i = 0; i < n; ++i) {
    const double q = std::abs(error(i)) / weight(in.tolerance, i, y[i]);
    if (q != q) return static_cast<long long>(i);
    if (q > largest) largest = q, most = i;
  }
  return static_cast<long long>(most);
}

/// Throws Instability for a step that shrank to `h` at time t: names the first component of y or candidate
/// that is not finite, otherwise `worst`.
[[noreturn]] void give_up(const Advance& in, double t, double h, const double* y, const double* candidate,
                          long long worst);
/// The message in that case, with remedies.
std::string too_many_steps_message(uint64_t most, double t, double h);
/// Likewise for too many steps.
[[noreturn]] void too_many_steps(const Advance& in, double t, double h, long long worst = -1);

}  // namespace truestep::step_control
