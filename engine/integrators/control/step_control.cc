#include "engine/integrators/control/step_control.h"

#include <string>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"

namespace truestep::step_control {

namespace {
// Weighted root mean square of a over the weights at y.
double weighted_norm(const Tolerance& tolerance, size_t n, const double* a, const double* y) {
  double sum = 0;
  for (size_t i = 0; i < n; ++i) {
    const double q = a[i] / weight(tolerance, i, y[i]);
    sum += q * q;
  }
  return std::sqrt(sum / double(n));
}
}  // namespace

double first_step(const Advance& in, const double* y, const double* rate, int order, double* scratch,
                  double* scratch_rate) {
  const size_t n = in.f.size();
  const double length = in.t_end - in.t;
  const double d0 = weighted_norm(in.tolerance, n, y, y), d1 = weighted_norm(in.tolerance, n, rate, y);
  const double h0 = std::min(length, d0 < 1e-5 || d1 < 1e-5 ? 1e-6 : 0.01 * d0 / d1);
  for (size_t i = 0; i < n; ++i) scratch[i] = std::fma(h0, rate[i], y[i]);
  in.f.rate(in.t + h0, scratch, scratch_rate);
  for (size_t i = 0; i < n; ++i) scratch_rate[i] = (scratch_rate[i] - rate[i]) / h0;
  const double steepest = std::max(d1, weighted_norm(in.tolerance, n, scratch_rate, y));
  const double h1 =
      steepest <= 1e-15 ? std::max(1e-6, 1e-3 * h0) : rough_pow(0.01 / steepest, 1.0 / (order + 1));
  const double h = std::min({100 * h0, h1, length});
  return h > 0 && std::isfinite(h) ? h : 1e-3 * length;
}

void give_up(const Advance& in, double t, double h, const double* y, const double* candidate,
             long long worst) {
  for (const double* a : {y, candidate}) {
    for (size_t i = 0; i < in.f.size(); ++i) {
      if (std::isfinite(a[i])) continue;
      throw Instability("", "y", static_cast<long long>(i),
                        in.f.name_of(i) + " is not finite at t = " + short_number(t) +
                            " s, however short the internal step");
    }
  }
  throw Instability("", "y", worst,
                    "the tolerance cannot be met at t = " + short_number(t) +
                        " s: the internal step fell to " + short_number(h, 2) + " s (" +
                        in.f.name_of(worst < 0 ? 0 : static_cast<size_t>(worst)) + " has the largest error)");
}

std::string too_many_steps_message(uint64_t most, double t, double h) {
  return "one step would need more than " + std::to_string(most) + " internal steps, which have shrunk to " +
         short_number(h, 2) + " s at t = " + short_number(t) +
         " s: take a shorter dt, a larger tolerance, an implicit method such as radau5 if the equations are "
         "stiff, or raise max_internal_steps";
}

void too_many_steps(const Advance& in, double t, double h, long long worst) {
  std::string message = too_many_steps_message(in.max_steps, t, h);
  if (worst >= 0) message += " (" + in.f.name_of(static_cast<size_t>(worst)) + " has the largest error)";
  throw Instability("", "y", worst, message);
}

}  // namespace truestep::step_control
