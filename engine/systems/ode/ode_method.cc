#include "engine/systems/ode/ode_method.h"

#include "engine/base/text/nearest_name.h"
#include "engine/integrators/table/integrators.h"

#include <cmath>

namespace truestep::ode {

namespace {

double norm(const std::vector<double>& v) {
  double sum = 0;
  for (const double e : v) sum += e * e;
  return std::sqrt(sum);
}

/// The dominant eigenvalue of df/dy at y if it is real, by power iteration; 0 if it belongs to a complex
/// pair.
double dominant_rate(const OdeEquations& f, const std::vector<double>& y) {
  const size_t n = y.size();
  std::vector<double> v(n), w(n), at(n), base(n);
  f.rate(0, y.data(), base.data());
  // A start vector with a component along everything, the same everywhere.
  for (size_t i = 0; i < n; ++i) v[i] = 1 + 0.1 * static_cast<double>((i * 2654435761u) % 17);
  double rate = 0;
  for (int k = 0; k < 25; ++k) {
    const double length = norm(v), size = norm(y);
    if (!(length > 0) || !std::isfinite(length)) return 0;
    const double step = 1e-7 * (1e-3 + size) / length;
    for (size_t i = 0; i < n; ++i) at[i] = y[i] + step * v[i];
    f.rate(0, at.data(), w.data());
    double up = 0, down = 0;
    for (size_t i = 0; i < n; ++i) {
      w[i] = (w[i] - base[i]) / step;
      up += v[i] * w[i], down += v[i] * v[i];
    }
    const double grown = norm(w);
    if (!(grown > 0) || !std::isfinite(grown)) return 0;
    // For an imaginary pair, v and J v never become parallel, whatever their product.
    constexpr double kParallel = 0.9;
    rate = up * up >= kParallel * down * grown * grown ? up / down : 0;
    for (size_t i = 0; i < n; ++i) v[i] = w[i] / grown;
  }
  return std::isfinite(rate) ? rate : 0;
}

/// Largest decay rate found at the start, and one Euler step of length dt later.
double decay_rate(const OdeModel& model, double dt) {
  OdeEquations f(model);
  f.set_parameters(model.parameter_values);
  std::vector<double> y = model.initial, dydt(y.size());
  double most = std::fmax(0, -dominant_rate(f, y));
  f.rate(0, y.data(), dydt.data());
  for (size_t i = 0; i < y.size(); ++i) y[i] += dt * dydt[i];
  return std::fmax(most, -dominant_rate(f, y));
}

const Integrator* first_that_serves(std::initializer_list<const char*> names, const RightHandSide& f) {
  for (const char* name : names) {
    const Integrator* row = find_integrator(name);
    if (row && row->advance && !refusal(*row, f)) return row;
  }
  return nullptr;
}

}  // namespace

OdeMethod choose_ode_method(const OdeDef& def, const OdeModel& model, double dt) {
  const OdeEquations f(model);
  if (!def.integrator.empty()) {
    const Integrator* row = find_integrator(def.integrator);
    const std::string why = !row            ? "no integrator has this name"
                            : !row->advance ? "this method supports only force laws"
                                            : refusal(*row, f).value_or("");
    if (why.empty()) return {row, "named by the scene"};
    std::string allowed;
    std::vector<std::string> fitting;
    for (const Integrator& m : integrators()) {
      if (!m.advance || refusal(m, f)) continue;
      allowed += (allowed.empty() ? "" : ", ") + std::string(m.name);
      fitting.emplace_back(m.name);
    }
    std::string name = def.integrator.substr(0, 40);
    throw Error("scene_invalid", "integrator " + name + ": " + why,
                {"/integrator", row ? "unsuitable_integrator" : "unknown_integrator", why, '"' + name + '"',
                 allowed, row ? "" : nearest_name(name, fitting), ""});
  }
  // Explicit methods are stable to about 3.3 / rate.
  constexpr double kManySteps = 50;
  const bool silent =
      !def.tolerance && !def.relative_tolerance && !def.absolute_tolerance && def.absolute_tolerances.empty();
  if (dt * decay_rate(model, dt) / 3.3 > kManySteps) {
    if (const Integrator* row = first_that_serves({"radau5", "rodas5p", "sdirk4"}, f)) {
      if (!silent) return {row, "the default where the equations look stiff"};
      // What nearly vanishes in the end (a species of 1e-10) decides what the others do.
      constexpr double kTrace = 1e-14;
      return {row,
              "the default where the equations look stiff, absolute_tolerance 1e-14 for what nearly vanishes",
              kOdeTolerance, kTrace};
    }
  }
  // Where errors grow as fast as in a chaotic flow, by 1e8 in twenty turns, only a small tolerance leaves a
  // result; with a method of order 8 it costs little. Many states keep the tolerance that their cost allows.
  constexpr double kFine = 1e-12;
  constexpr size_t kFew = 200;
  if (silent && model.size() <= kFew) {
    if (const Integrator* row = first_that_serves({"dop853"}, f))
      return {row, "the default where the equations do not look stiff, tolerance 1e-12", kFine, kFine};
  }
  const bool fine = def.tolerance.value_or(kOdeTolerance) < 1e-9;
  const Integrator* row = fine ? first_that_serves({"dop853", "tsit5", "dopri5", "rk4"}, f)
                               : first_that_serves({"tsit5", "dopri5", "rk4"}, f);
  return {row, "the default where the equations do not look stiff"};
}

}  // namespace truestep::ode
