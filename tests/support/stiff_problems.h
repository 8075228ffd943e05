// Stiff problems with known solutions, for tests and benchmarks: Van der Pol, ROBER, HIRES and BEAM of the
// IVP test set (Mazzia, Magherini), a chain of masses, Curtiss-Hirschfelder and Prothero-Robinson.
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "engine/core/equations/right_hand_side.h"
#include "engine/math/trig.h"

namespace truestep::test {

/// Initial values of a problem and its solution at the end.
struct StiffCase {
  double t_end = 1;
  std::vector<double> y0, reference;
  /// Absolute tolerance as a fraction of the relative one, below the smallest component.
  double absolute_scale = 1;
  enum class Measure { norm, component } measure = Measure::norm;  ///< of the relative error

  double error(const double* y) const {
    double difference = 0, size = 0, worst = 0;
    for (size_t i = 0; i < reference.size(); ++i) {
      const double d = y[i] - reference[i];
      difference += d * d, size += reference[i] * reference[i];
      worst = std::fmax(worst, std::abs(d / reference[i]));
      if (!std::isfinite(y[i])) return HUGE_VAL;
    }
    return measure == Measure::norm ? std::sqrt(difference / size) : worst;
  }
};

/// x'' = ((1 - x^2) x' - x) / epsilon.
class VanDerPol final : public RightHandSide {
 public:
  explicit VanDerPol(double epsilon = 1e-6) : stiffness_(1 / epsilon) {}
  size_t size() const override { return 2; }
  bool autonomous() const override { return true; }
  void rate(double, const double* y, double* d) const override {
    d[0] = y[1];
    d[1] = ((1 - y[0] * y[0]) * y[1] - y[0]) * stiffness_;
  }
  bool has_jacobian() const override { return true; }
  void jacobian(double, const double* y, double* j) const override {
    j[0] = 0, j[1] = (-2 * y[0] * y[1] - 1) * stiffness_;
    j[2] = 1, j[3] = (1 - y[0] * y[0]) * stiffness_;
  }
  /// epsilon = 1e-6, t = 2.
  static StiffCase published() { return {2, {2, 0}, {0.1706167732170483e1, -0.8928097010247975}}; }

 private:
  double stiffness_;
};

/// Robertson's reaction.
class Rober final : public RightHandSide {
 public:
  size_t size() const override { return 3; }
  bool autonomous() const override { return true; }
  void rate(double, const double* y, double* d) const override {
    d[0] = -0.04 * y[0] + 1e4 * y[1] * y[2];
    d[2] = 3e7 * y[1] * y[1];
    d[1] = -d[0] - d[2];
  }
  bool has_jacobian() const override { return true; }
  void jacobian(double, const double* y, double* j) const override {
    j[0] = -0.04, j[3] = 1e4 * y[2], j[6] = 1e4 * y[1];
    j[2] = 0, j[5] = 6e7 * y[1], j[8] = 0;
    j[1] = 0.04, j[4] = -j[3] - j[5], j[7] = -j[6];
  }
  static StiffCase published() {
    return {1e11,
            {1, 0, 0},
            {0.2083340149701255e-7, 0.8333360770334713e-13, 0.9999999791665050},
            1e-8,
            StiffCase::Measure::component};
  }
};

/// High irradiance response of photomorphogenesis.
class Hires final : public RightHandSide {
 public:
  size_t size() const override { return 8; }
  bool autonomous() const override { return true; }
  void rate(double, const double* y, double* d) const override {
    d[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
    d[1] = 1.71 * y[0] - 8.75 * y[1];
    d[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
    d[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
    d[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
    d[5] = -280 * y[5] * y[7] + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
    d[6] = 280 * y[5] * y[7] - 1.81 * y[6];
    d[7] = -d[6];
  }
  bool has_jacobian() const override { return true; }
  void jacobian(double, const double* y, double* j) const override {
    for (size_t k = 0; k < 64; ++k) j[k] = 0;
    const auto at = [j](size_t row, size_t column) -> double& { return j[column * 8 + row]; };
    at(0, 0) = -1.71, at(0, 1) = 0.43, at(0, 2) = 8.32;
    at(1, 0) = 1.71, at(1, 1) = -8.75;
    at(2, 2) = -10.03, at(2, 3) = 0.43, at(2, 4) = 0.035;
    at(3, 1) = 8.32, at(3, 2) = 1.71, at(3, 3) = -1.12;
    at(4, 4) = -1.745, at(4, 5) = 0.43, at(4, 6) = 0.43;
    at(5, 3) = 0.69, at(5, 4) = 1.71, at(5, 5) = -0.43 - 280 * y[7], at(5, 6) = 0.69, at(5, 7) = -280 * y[5];
    at(6, 5) = 280 * y[7], at(6, 6) = -1.81, at(6, 7) = 280 * y[5];
    at(7, 5) = -280 * y[7], at(7, 6) = 1.81, at(7, 7) = -280 * y[5];
  }
  static StiffCase published() {
    return {321.8122,
            {1, 0, 0, 0, 0, 0, 0, 0.0057},
            {0.7371312573325668e-3, 0.1442485726316185e-3, 0.5888729740967575e-4, 0.1175651343283149e-2,
             0.2386356198831331e-2, 0.6238968252742796e-2, 0.2849998395185769e-2, 0.2850001604814231e-2},
            1e-4,
            StiffCase::Measure::component};
  }
};

/// Inextensible elastic beam of 40 segments, clamped at one end, pulled at the other until t = pi (Hairer,
/// Wanner 1996, section IV.10): angles and angular velocities.
///   theta'' = C v + D w,  C w = D v + theta'^2,  C_ij, D_ij = -cos, sin of differences of neighbours
class Beam final : public RightHandSide, public SecondOrder {
 public:
  static constexpr size_t kSegments = 40;

  size_t size() const override { return 2 * kSegments; }
  void rate(double t, const double* y, double* d) const override {
    for (size_t i = 0; i < kSegments; ++i) d[i] = y[kSegments + i];
    acceleration(t, y, y + kSegments, d + kSegments);
  }
  const SecondOrder* second_order() const override { return this; }
  bool depends_on_velocity() const override { return true; }
  void acceleration(double t, const double* x, const double* v, double* a) const override {
    constexpr size_t n = kSegments;
    std::array<double, n + 1> s{}, c{};  // of x[i] - x[i - 1]
    for (size_t i = 1; i < n; ++i) {
      const auto sc = trig::sincos(x[i] - x[i - 1]);
      s[i] = sc.sin, c[i] = sc.cos;
    }
    constexpr double n2 = n * n, n4 = n2 * n2;
    const double pull = t <= 3.14159265358979323846 ? 1.5 * trig::sin(t) * trig::sin(t) : 0;
    std::array<double, n> f;
    for (size_t i = 0; i < n; ++i) {
      const double below = i > 0 ? x[i - 1] : -x[0], above = i + 1 < n ? x[i + 1] : x[i];
      const auto sc = trig::sincos(x[i]);
      f[i] = n4 * (below - 2 * x[i] + above) + n2 * pull * (sc.cos + sc.sin);
    }
    std::array<double, n> w, alpha;
    for (size_t i = 0; i < n; ++i) {
      w[i] = v[i] * v[i] + (i + 1 < n ? s[i + 1] * f[i + 1] : 0) - (i > 0 ? s[i] * f[i - 1] : 0);
      alpha[i] = i == 0 ? 1 : i + 1 < n ? 2 : 3;
    }
    for (size_t i = n - 1; i-- > 0;) {
      const double q = -c[i + 1] / alpha[i + 1];
      w[i] -= q * w[i + 1], alpha[i] += q * c[i + 1];
    }
    w[0] /= alpha[0];
    for (size_t i = 1; i < n; ++i) w[i] = (w[i] + c[i] * w[i - 1]) / alpha[i];
    for (size_t i = 0; i < n; ++i) {
      double sum = (i == 0 ? 1 : i + 1 < n ? 2 : 3) * f[i];
      if (i > 0) sum -= c[i] * f[i - 1] + s[i] * w[i - 1];
      if (i + 1 < n) sum += s[i + 1] * w[i + 1] - c[i + 1] * f[i + 1];
      a[i] = sum;
    }
  }
  /// t = 5; the reference holds y1, y10, y20, y40, y41, y50, y60, y80 (see `picked`).
  static StiffCase published() {
    return {5,
            std::vector<double>(2 * kSegments, 0.0),
            {-0.5792366591285007e-2, -0.9119134654647947e-1, -0.1483595472463012, -0.1767201761075488,
             0.3747362681329794e-1, 0.5987609702624270, 0.9868747821728363, 1.186724615113034}};
  }
  static std::array<double, 8> picked(const double* y) {
    return {y[0], y[9], y[19], y[39], y[40], y[49], y[59], y[79]};
  }
};

/// Masses of 1 kg in a row, springs k and dampers c between neighbours, the first one held to a wall, gravity
/// along the row: x = displacements, tridiagonal derivatives.
class Chain final : public RightHandSide, public SecondOrder {
 public:
  Chain(size_t masses, double k, double c) : n_(masses), k_(k), c_(c) {}

  double stiffness() const { return k_; }
  double damping() const { return c_; }
  size_t size() const override { return 2 * n_; }
  bool autonomous() const override { return true; }
  void rate(double t, const double* y, double* d) const override {
    const double* v = y + n_;
    for (size_t i = 0; i < n_; ++i) d[i] = v[i];
    acceleration(t, y, v, d + n_);
  }
  const SecondOrder* second_order() const override { return this; }
  bool depends_on_velocity() const override { return c_ != 0; }
  void acceleration(double, const double* x, const double* v, double* a) const override {
    const double k = k_, c = c_;
    const auto end = n_ - 1;
    a[0] = k * (x[1] - 2 * x[0]) + c * (v[1] - 2 * v[0]) - kGravity;
#pragma GCC ivdep
    for (size_t i = 1; i < end; ++i) {
      a[i] = k * ((x[i - 1] - x[i]) + (x[i + 1] - x[i])) + c * ((v[i - 1] - v[i]) + (v[i + 1] - v[i])) -
             kGravity;
    }
    a[end] = k * (x[end - 1] - x[end]) + c * (v[end - 1] - v[end]) - kGravity;
  }
  MatrixShape shape() const override {
    return {.kind = MatrixShape::Kind::banded, .lower = 1, .upper = 1, .column_start = {}, .rows = {}};
  }
  bool has_jacobian() const override {
    return true;
  }
  void jacobian(double, const double*, const double*, double* dadx, double* dadv) const override {
    for (size_t j = 0; j < n_; ++j) {
      const double diagonal = j + 1 < n_ ? -2 : -1;
      dadx[3 * j] = dadx[3 * j + 2] = k_, dadx[3 * j + 1] = diagonal * k_;
      dadv[3 * j] = dadv[3 * j + 2] = c_, dadv[3 * j + 1] = diagonal * c_;
    }
  }
  /// From rest in displacements 0, by modes.
  StiffCase fall(double t_end) const {
    StiffCase result{t_end, std::vector<double>(2 * n_, 0.0), std::vector<double>(2 * n_, 0.0)};
    const double pi = 3.14159265358979323846;
    for (size_t j = 1; j <= n_; ++j) {
      const double angle = double(2 * j - 1) * pi / double(2 * n_ + 1);
      const double half = std::sin(angle / 2), lambda = 4 * half * half;
      double norm = 0, force = 0;
      for (size_t i = 1; i <= n_; ++i) {
        const double shape = std::sin(double(i) * angle);
        norm += shape * shape, force -= kGravity * shape;
      }
      const double rest = force / norm / (k_ * lambda), w2 = k_ * lambda, b = c_ * lambda / 2;
      const double discriminant = w2 - b * b;
      double x, v;
      if (discriminant > 0) {
        const double w = std::sqrt(discriminant), decay = std::exp(-b * t_end);
        x = rest - rest * decay * (std::cos(w * t_end) + b / w * std::sin(w * t_end));
        v = rest * decay * (w2 / w) * std::sin(w * t_end);
      } else {
        const double s = std::sqrt(-discriminant), r1 = w2 / (-b - s), r2 = -b - s;
        const double p = rest * r2 / (r1 - r2), q = -rest * r1 / (r1 - r2);
        x = rest + p * std::exp(r1 * t_end) + q * std::exp(r2 * t_end);
        v = p * r1 * std::exp(r1 * t_end) + q * r2 * std::exp(r2 * t_end);
      }
      for (size_t i = 1; i <= n_; ++i) {
        const double shape = std::sin(double(i) * angle);
        result.reference[i - 1] += x * shape, result.reference[n_ + i - 1] += v * shape;
      }
    }
    return result;
  }

 private:
  static constexpr double kGravity = 9.81;
  size_t n_;
  double k_, c_;
};

/// y' = lambda (y - cos t) - w sin t: Curtiss and Hirschfelder 1952 with lambda = -50, w = 0 and y(0) = 0;
/// Prothero and Robinson 1974 with w = 1, y(0) = 1 and the solution cos t for any lambda.
class DrivenDecay final : public RightHandSide {
 public:
  DrivenDecay(double lambda, double w) : lambda_(lambda), w_(w) {}
  size_t size() const override { return 1; }
  void rate(double t, const double* y, double* d) const override {
    d[0] = lambda_ * (y[0] - trig::cos(t)) - w_ * trig::sin(t);
  }

 private:
  double lambda_, w_;
};

}  // namespace truestep::test
