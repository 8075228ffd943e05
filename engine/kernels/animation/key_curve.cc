#include "engine/kernels/animation/key_curve.h"

#include <algorithm>
#include <cmath>

namespace truestep::animation {

KeyTime within(double t, double first, double last, Extend extend) {
  const double period = last - first;
  if (!(period > 0) || extend == Extend::clamp) {
    return {std::clamp(t, first, last), t < first || t > last ? 0.0 : 1.0};
  }
  const double cycles = std::floor((t - first) / period);
  const double into = std::clamp(t - first - cycles * period, 0.0, period);
  if (extend == Extend::loop) return {first + into, 1};
  const bool backwards = cycles - 2 * std::floor(0.5 * cycles) != 0;
  return backwards ? KeyTime{last - into, -1} : KeyTime{first + into, 1};
}

double frame_time(double t, double rate) {
  if (!(rate > 0)) return t;
  constexpr double kSame = 1e-9;  // frames: tolerance for rounding errors of t and rate
  return std::floor(t * rate + kSame) / rate;
}

FourWeights catmull_rom_weights(double u) {
  const double u2 = u * u, u3 = u2 * u;
  return {
      {0.5 * (-u3 + 2 * u2 - u), 0.5 * (3 * u3 - 5 * u2 + 2), 0.5 * (-3 * u3 + 4 * u2 + u), 0.5 * (u3 - u2)}};
}

double bezier_parameter(double x, double a, double b) {
  // Newton's method while it stays within the bracket, bisection otherwise: t(s) increases, with slope 0 at
  // an end whose handle has share 0.
  double low = 0, high = 1, s = x;
  for (int k = 0; k < 64; ++k) {
    const double r = 1 - s;
    const double f = 3 * s * r * r * a + 3 * s * s * r * b + s * s * s - x;
    if (f == 0) break;
    (f < 0 ? low : high) = s;
    const double slope = 3 * r * r * a + 6 * s * r * (b - a) + 3 * s * s * (1 - b);
    double next = s - f / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == s) break;
    s = next;
  }
  return s;
}

KeyCurve::KeyCurve(const Keys& keys)
    : width_(keys.width),
      interpolation_(keys.times.size() < 2 ? Interpolation::step : keys.interpolation),
      extend_(keys.extend),
      times_(keys.times.begin(), keys.times.end()),
      values_(keys.values.begin(), keys.values.end()),
      handles_(keys.handles.begin(), keys.handles.end()) {
  using enum Interpolation;
  if (interpolation_ == step || interpolation_ == linear) return;
  if (interpolation_ == natural) {
    natural_slopes();
    return;
  }
  if (interpolation_ == monotone) {
    monotone_slopes();
    return;
  }
  parabola_slopes();
  if (interpolation_ == catmull_rom) return;
  if (!keys.slopes_in.empty()) in_.assign(keys.slopes_in.begin(), keys.slopes_in.end()), out_ = in_;
  if (!keys.slopes_out.empty()) out_.assign(keys.slopes_out.begin(), keys.slopes_out.end());
  if (handles_.empty()) handles_.assign(2 * times_.size(), 1.0 / 3);
}

void KeyCurve::parabola_slopes() {
  const size_t n = times_.size();
  in_.assign(n * width_, 0);
  const auto chord = [&](size_t i, size_t c) {
    return (values_[(i + 1) * width_ + c] - values_[i * width_ + c]) / (times_[i + 1] - times_[i]);
  };
  // Slope at the middle one of three points from the slopes of the two chords.
  const auto middle = [](double d0, double h0, double d1, double h1) {
    return (d0 * h1 + d1 * h0) / (h0 + h1);
  };
  for (size_t c = 0; c < width_; ++c) {
    for (size_t i = 1; i + 1 < n; ++i) {
      in_[i * width_ + c] =
          middle(chord(i - 1, c), times_[i] - times_[i - 1], chord(i, c), times_[i + 1] - times_[i]);
    }
    const double d0 = chord(0, c), d1 = chord(n - 2, c);
    double& first = in_[c];
    double& last = in_[(n - 1) * width_ + c];
    if (extend_ == Extend::loop && values_[c] == values_[(n - 1) * width_ + c]) {
      first = last = middle(d1, times_[n - 1] - times_[n - 2], d0, times_[1] - times_[0]);
    } else {
      first = n > 2 ? 2 * d0 - in_[width_ + c] : d0;
      last = n > 2 ? 2 * d1 - in_[(n - 2) * width_ + c] : d1;
    }
  }
  out_ = in_;
}

// With h_{i-1} and h_i the intervals before and after key i: h_i m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_{i-1}
// m_{i+1} = 3 (h_i d_{i-1} + h_{i-1} d_i), and 2 m_0 + m_1 = 3 d_0 at the ends; elimination needs no pivoting
// because the matrix is diagonally dominant.
void KeyCurve::natural_slopes() {
  const size_t n = times_.size();
  in_.assign(n * width_, 0);
  std::vector<double> upper(n);
  for (size_t c = 0; c < width_; ++c) {
    const auto chord = [&](size_t i) {
      return (values_[(i + 1) * width_ + c] - values_[i * width_ + c]) / (times_[i + 1] - times_[i]);
    };
    const auto m = [&](size_t i) -> double& { return in_[i * width_ + c]; };
    upper[0] = 0.5, m(0) = 1.5 * chord(0);
    for (size_t i = 1; i < n; ++i) {
      const bool end = i + 1 == n;
      const double h0 = times_[i] - times_[i - 1], h1 = end ? 0 : times_[i + 1] - times_[i];
      const double lower = end ? 1 : h1, diagonal = end ? 2 : 2 * (h0 + h1);
      const double right = end ? 3 * chord(i - 1) : 3 * (h1 * chord(i - 1) + h0 * chord(i));
      const double pivot = diagonal - lower * upper[i - 1];
      upper[i] = end ? 0 : h0 / pivot;
      m(i) = (right - lower * m(i - 1)) / pivot;
    }
    for (size_t i = n - 1; i-- > 0;) m(i) -= upper[i] * m(i + 1);
  }
  out_ = in_;
}

void KeyCurve::monotone_slopes() {
  const size_t n = times_.size();
  in_.assign(n * width_, 0);
  for (size_t c = 0; c < width_; ++c) {
    const auto chord = [&](size_t i) {
      return (values_[(i + 1) * width_ + c] - values_[i * width_ + c]) / (times_[i + 1] - times_[i]);
    };
    for (size_t i = 1; i + 1 < n; ++i) {
      const double d0 = chord(i - 1), d1 = chord(i);
      if (!(d0 * d1 > 0)) continue;  // extrema are preserved
      const double h0 = times_[i] - times_[i - 1], h1 = times_[i + 1] - times_[i];
      in_[i * width_ + c] = 3 * (h0 + h1) / ((2 * h1 + h0) / d0 + (h1 + 2 * h0) / d1);
    }
    // At an end, the slope of the parabola, limited so that it does not overshoot.
    const auto end = [&](double d0, double inner) {
      const double m = 2 * d0 - inner;
      return m * d0 <= 0 ? 0.0 : std::abs(m) > 3 * std::abs(d0) ? 3 * d0 : m;
    };
    in_[c] = n > 2 ? end(chord(0), in_[width_ + c]) : chord(0);
    in_[(n - 1) * width_ + c] = n > 2 ? end(chord(n - 2), in_[(n - 2) * width_ + c]) : chord(0);
  }
  out_ = in_;
}

size_t KeyCurve::segment(double t) const {
  const auto after = std::upper_bound(times_.begin() + 1, times_.end() - 1, t);
  return static_cast<size_t>(after - times_.begin()) - 1;
}

void KeyCurve::sample(double at, double* value, double* rate) const {
  using enum Interpolation;
  const auto [t, direction] = within(at, times_.front(), times_.back(), extend_);
  if (times_.size() < 2 || (interpolation_ == step && t >= times_.back())) {
    std::copy_n(values_.end() - static_cast<std::ptrdiff_t>(width_), width_, value);
    if (rate) std::fill_n(rate, width_, 0.0);
    return;
  }
  const size_t i = segment(t);
  const double h = times_[i + 1] - times_[i], u = (t - times_[i]) / h;
  const double *v0 = &values_[i * width_], *v1 = v0 + width_;
  if (interpolation_ == step || interpolation_ == linear) {
    const double share = interpolation_ == step ? 0 : u;
    for (size_t c = 0; c < width_; ++c) {
      value[c] = v0[c] + share * (v1[c] - v0[c]);
      if (rate) rate[c] = interpolation_ == step ? 0 : direction * (v1[c] - v0[c]) / h;
    }
    return;
  }
  const double *m0 = &out_[i * width_], *m1 = &in_[(i + 1) * width_];
  if (interpolation_ == bezier) {
    const double a = handles_[2 * i + 1], b = 1 - handles_[2 * i + 2];
    const double s = bezier_parameter(u, a, b), r = 1 - s;
    const double speed = 3 * r * r * a + 6 * s * r * (b - a) + 3 * s * s * (1 - b);  // du/ds
    for (size_t c = 0; c < width_; ++c) {
      const double p1 = v0[c] + a * h * m0[c], p2 = v1[c] - (1 - b) * h * m1[c];
      value[c] = r * r * r * v0[c] + 3 * s * r * r * p1 + 3 * s * s * r * p2 + s * s * s * v1[c];
      if (!rate) continue;
      const double ds = 3 * (r * r * (p1 - v0[c]) + 2 * s * r * (p2 - p1) + s * s * (v1[c] - p2));
      rate[c] = speed > 0 ? direction * ds / (speed * h) : 0;
    }
    return;
  }
  const double u2 = u * u, u3 = u2 * u;
  const double a0 = 2 * u3 - 3 * u2 + 1, b0 = (u3 - 2 * u2 + u) * h, b1 = (u3 - u2) * h;
  const double da = 6 * (u2 - u) / h, db0 = 3 * u2 - 4 * u + 1, db1 = 3 * u2 - 2 * u;
  for (size_t c = 0; c < width_; ++c) {
    value[c] = a0 * v0[c] + (1 - a0) * v1[c] + b0 * m0[c] + b1 * m1[c];
    if (rate) rate[c] = direction * (da * (v0[c] - v1[c]) + db0 * m0[c] + db1 * m1[c]);
  }
}

}  // namespace truestep::animation
