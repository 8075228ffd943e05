#include "engine/integrators/control/spectrum.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/base/random.h"

namespace truestep {

namespace {

double norm(const std::vector<double>& u) {
  double s = 0;
  for (const double c : u) s += c * c;
  return std::sqrt(s);
}

struct Dominant {
  double value = 0, residual = 0;
  int iterations = 0;
};

// Largest |eigenvalue| of the operator apply(u, out) on n numbers.
template <class Apply>
Dominant dominant(size_t n, const SpectrumEffort& effort, Apply apply) {
  Dominant d;
  std::vector<double> u(n), w(n);
  for (size_t i = 0; i < n; ++i) u[i] = uniform4(7, 0, i)[0] - 0.5;
  double length = norm(u);
  for (d.iterations = 0; d.iterations < effort.most_iterations && length > 0; ++d.iterations) {
    for (double& c : u) c /= length;
    apply(u, w);
    double value = 0, off = 0;
    for (size_t i = 0; i < n; ++i) value += u[i] * w[i];
    for (size_t i = 0; i < n; ++i) off += (w[i] - value * u[i]) * (w[i] - value * u[i]);
    length = norm(w);
    const bool settled = std::abs(value - d.value) <= effort.settled * std::abs(value);
    d.value = value;
    d.residual = length > 0 ? std::sqrt(off) / length : 0;
    std::swap(u, w);
    if (settled && d.iterations > 4) break;
  }
  return d;
}

}  // namespace

Spectrum estimate_spectrum(const ForceField& field, const State& state, double t,
                           const SpectrumEffort& effort) {
  static const ThreadArena kSerial(1);
  Workspace workspace;
  Evaluation e{workspace, kSerial};
  const auto x = state.f64(state.at("position")), v = state.f64(state.at("velocity"));
  const size_t n = v.size();
  if (x.empty() || n == 0) return {};
  double reach = 0;
  for (const double c : x) reach = std::max(reach, std::abs(c));
  // Balances truncation against rounding of a central difference.
  const double step = 1e-5 * std::max(reach, 1e-3);
  std::vector<double> direction(x.size()), moved(std::max(x.size(), n)), plus(n), minus(n);
  // out = -(a(base + s d) - a(base - s d)) / 2 s, with both arguments passed to `acceleration`.
  const auto derivative = [&](std::span<const double> base, std::span<const double> d,
                              std::vector<double>& out, const auto& acceleration) {
    const double s = step * std::sqrt(static_cast<double>(n));
    const std::span<double> at(moved.data(), base.size());
    for (size_t i = 0; i < base.size(); ++i) at[i] = base[i] + s * d[i];
    acceleration(at, plus);
    for (size_t i = 0; i < base.size(); ++i) at[i] = base[i] - s * d[i];
    acceleration(at, minus);
    for (size_t i = 0; i < n; ++i) out[i] = -(plus[i] - minus[i]) / (2 * s);
  };
  const Dominant frequency = dominant(n, effort, [&](const std::vector<double>& u, std::vector<double>& out) {
    const auto along = field.position_rate({t, x, u, state}, direction, e);
    derivative(x, along, out, [&](std::span<const double> at, std::span<double> a) {
      field.acceleration({t, at, v, state}, a, e);
    });
  });
  Dominant damping;
  if (field.dependence() == Dependence::position_and_velocity) {
    damping = dominant(n, effort, [&](const std::vector<double>& u, std::vector<double>& out) {
      derivative(v, u, out, [&](std::span<const double> at, std::span<double> a) {
        field.acceleration({t, x, at, state}, a, e);
      });
    });
  }
  return {.omega = std::sqrt(std::max(0.0, frequency.value)),
          .damping = std::max(0.0, damping.value),
          .iterations = frequency.iterations + damping.iterations,
          .residual = frequency.residual};
}

}  // namespace truestep
