// Initial value problems with known solutions, for validation and benchmarks: right-hand sides as users of
// the library would write them, y = (x, v) for second-order ones. References: the IVP test set (Mazzia,
// Magherini), DETEST (Enright, Pryce 1987), Hairer, Norsett, Wanner 1993 and 2006, and Taylor integration in
// quadruple precision; digits beyond double are kept as published.
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "engine/core/equations/right_hand_side.h"

namespace truestep::test {

/// y' = f(t, y) from a callable f(t, y, dydt).
template <class F>
class Equations final : public RightHandSide {
 public:
  Equations(size_t n, F f) : n_(n), f_(f) {}
  size_t size() const override { return n_; }
  void rate(double t, const double* y, double* dydt) const override { f_(t, y, dydt); }

 private:
  size_t n_;
  F f_;
};

/// x'' = a(x) from a callable a(x, out) on m positions.
template <class A>
class Motions final : public RightHandSide, public SecondOrder {
 public:
  Motions(size_t m, A a) : m_(m), a_(a) {}
  size_t size() const override { return 2 * m_; }
  void rate(double, const double* y, double* dydt) const override {
    for (size_t i = 0; i < m_; ++i) dydt[i] = y[m_ + i];
    a_(y, dydt + m_);
  }
  bool autonomous() const override { return true; }
  const SecondOrder* second_order() const override { return this; }
  void acceleration(double, const double* x, const double*, double* a) const override { a_(x, a); }
  bool depends_on_velocity() const override { return false; }

 private:
  size_t m_;
  A a_;
};

struct KeplerForce {
  void operator()(const double* x, double* a) const {
    const double r2 = x[0] * x[0] + x[1] * x[1], w = -1 / (r2 * std::sqrt(r2));
    a[0] = w * x[0], a[1] = w * x[1];
  }
};
inline Motions<KeplerForce> kepler_orbit() {
  return {2, {}};
}
/// From the pericentre of an ellipse with semi-major axis 1.
inline std::vector<double> kepler_start(double e) {
  return {1 - e, 0, 0, std::sqrt((1 + e) / (1 - e))};
}
/// The state at time t: Kepler's equation by Newton's method.
inline std::vector<double> kepler_state(double e, double t) {
  double anomaly = t;
  for (int i = 0; i < 60; ++i) {
    anomaly -= (anomaly - e * std::sin(anomaly) - t) / (1 - e * std::cos(anomaly));
  }
  const double rate = 1 / (1 - e * std::cos(anomaly)), b = std::sqrt(1 - e * e);
  return {std::cos(anomaly) - e, b * std::sin(anomaly), -std::sin(anomaly) * rate,
          b * std::cos(anomaly) * rate};
}

/// Seven stars of masses 1 to 7 in a plane, all x, then all y.
struct PleiadesForce {
  void operator()(const double* x, double* a) const {
    const double* y = x + 7;
    for (int i = 0; i < 14; ++i) a[i] = 0;
    for (int i = 0; i < 7; ++i) {
      for (int j = i + 1; j < 7; ++j) {
        const double dx = x[j] - x[i], dy = y[j] - y[i], r2 = dx * dx + dy * dy, w = 1 / (r2 * std::sqrt(r2));
        a[i] += (j + 1) * w * dx, a[7 + i] += (j + 1) * w * dy;
        a[j] -= (i + 1) * w * dx, a[7 + j] -= (i + 1) * w * dy;
      }
    }
  }
};
inline Motions<PleiadesForce> pleiades() {
  return {14, {}};
}
inline std::vector<double> pleiades_start() {
  return {3, 3, -1, -3, 2, -2,   2,    3, -3, 2, 0,     0, -4, 4,  //
          0, 0, 0,  0,  0, 1.75, -1.5, 0, 0,  0, -1.25, 1, 0,  0};
}
/// At t = 3.
inline std::vector<double> pleiades_end() {
  return {0.3706139143970502,    0.3237284092057233e1,  -0.3222559032418324e1, 0.6597091455775310,
          0.3425581707156584,    0.1562172101400631e1,  -0.7003092922212495,   -0.3943437585517392e1,
          -0.3271380973972550e1, 0.5225081843456543e1,  -0.2590612434977470e1, 0.1198213693392275e1,
          -0.2429682344935824,   0.1091449240428980e1,  0.3417003806314313e1,  0.1354584501625501e1,
          -0.2590065597810775e1, 0.2025053734714242e1,  -0.1155815100160448e1, -0.8072988170223021,
          0.5952396354208710,    -0.3741244961234010e1, 0.3773459685750630,    0.9386858869551073,
          0.3667922227200571,    -0.3474046353808490,   0.2344915448180937e1,  -0.1947020434263292e1};
}

/// The restricted three-body problem in a rotating frame; the orbit closes after kArenstorfPeriod.
struct ArenstorfRate {
  void operator()(double, const double* y, double* d) const {
    constexpr double m = 0.012277471, n = 1 - m;
    const double p = y[0] + m, q = y[0] - n, y2 = y[1] * y[1];
    const double r1 = p * p + y2, r2 = q * q + y2;
    const double d1 = n / (r1 * std::sqrt(r1)), d2 = m / (r2 * std::sqrt(r2));
    d[0] = y[2], d[1] = y[3];
    d[2] = y[0] + 2 * y[3] - d1 * p - d2 * q;
    d[3] = y[1] - 2 * y[2] - (d1 + d2) * y[1];
  }
};
inline Equations<ArenstorfRate> arenstorf() {
  return {4, {}};
}
inline constexpr double kArenstorfPeriod = 17.0652165601579625588917206249;
inline std::vector<double> arenstorf_start() {
  return {0.994, 0, 0, -2.00158510637908252240537862224};
}

/// n bodies in three dimensions, (x1 y1 z1 x2 ...), with gravitational constant g.
struct GravityForce {
  std::vector<double> masses;
  double g = 1;
  size_t dimensions = 3;
  void operator()(const double* x, double* a) const {
    const size_t n = masses.size(), d = dimensions;
    for (size_t i = 0; i < n * d; ++i) a[i] = 0;
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = i + 1; j < n; ++j) {
        double r2 = 0;
        for (size_t k = 0; k < d; ++k) r2 += (x[d * j + k] - x[d * i + k]) * (x[d * j + k] - x[d * i + k]);
        const double w = g / (r2 * std::sqrt(r2));
        for (size_t k = 0; k < d; ++k) {
          const double dx = x[d * j + k] - x[d * i + k];
          a[d * i + k] += masses[j] * w * dx, a[d * j + k] -= masses[i] * w * dx;
        }
      }
    }
  }
  /// For y = (x, v), summed in extended precision so that the rounding of the sum is invisible.
  long double energy(const double* y) const {
    const size_t n = masses.size(), d = dimensions;
    long double e = 0;
    for (size_t i = 0; i < n; ++i) {
      for (size_t k = 0; k < d; ++k) {
        const long double v = y[d * (n + i) + k];
        e += 0.5L * masses[i] * v * v;
      }
      for (size_t j = i + 1; j < n; ++j) {
        long double r2 = 0;
        for (size_t k = 0; k < d; ++k) {
          const long double dx = static_cast<long double>(y[d * j + k]) - y[d * i + k];
          r2 += dx * dx;
        }
        e -= static_cast<long double>(g) * masses[i] * masses[j] / std::sqrt(r2);
      }
    }
    return e;
  }
};

/// Sun and inner planets as one, Jupiter to Neptune, Pluto; AU, days, solar masses (Hairer, Lubich, Wanner
/// 2006, section I.2.4).
inline GravityForce outer_solar_force() {
  return {
      {1.00000597682, 0.000954786104043, 0.000285583733151, 4.37273164546e-05, 5.17759138449e-05, 1 / 1.3e8},
      0.000295912208286,
      3};
}
inline std::vector<double> outer_solar_start() {
  return {0,          0,           0,           -3.5023653,  -3.8169847,  -1.5507963,
          9.0755314,  -3.0458353,  -1.6483708,  8.310142,    -16.2901086, -7.2521278,
          11.4707666, -25.7294829, -10.8169456, -15.5387357, -25.2225594, -3.1902382,  //
          0,          0,           0,           0.00565429,  -0.0041249,  -0.00190589,
          0.00168318, 0.00483525,  0.00192462,  0.00354178,  0.00137102,  0.00055029,
          0.0028893,  0.00114527,  0.00039677,  0.00276725,  -0.00170702, -0.00136504};
}

/// Euclidean error relative to the reference.
inline double relative_error(const std::vector<double>& y, const std::vector<double>& reference) {
  double difference = 0, size = 0;
  for (size_t i = 0; i < reference.size(); ++i) {
    difference += (y[i] - reference[i]) * (y[i] - reference[i]), size += reference[i] * reference[i];
  }
  return std::sqrt(difference / size);
}

}  // namespace truestep::test
