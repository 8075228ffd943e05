// Complex numbers as two plain doubles, for factorisations: unlike std::complex, products carry no checks for
// infinities, so that loops vectorise and every compiler gives the same bits.
#pragma once

namespace truestep {

struct Complex {
  double re = 0, im = 0;

  constexpr Complex() = default;
  constexpr Complex(double real, double imaginary = 0) : re(real), im(imaginary) {}

  friend constexpr Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
  friend constexpr Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
  friend constexpr Complex operator-(Complex a) { return {-a.re, -a.im}; }
  friend constexpr Complex operator*(Complex a, Complex b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend constexpr Complex operator*(double a, Complex b) { return {a * b.re, a * b.im}; }
  constexpr Complex& operator+=(Complex b) { return *this = *this + b; }
  constexpr Complex& operator-=(Complex b) { return *this = *this - b; }
  constexpr Complex& operator*=(Complex b) { return *this = *this * b; }
};

/// 1 / a, without protection against overflow of |a|^2.
constexpr Complex reciprocal(Complex a) {
  const double s = 1 / (a.re * a.re + a.im * a.im);
  return {a.re * s, -a.im * s};
}
constexpr double reciprocal(double a) {
  return 1 / a;
}
/// Magnitude by which pivots are chosen: |re| + |im|.
constexpr double magnitude(Complex a) {
  return (a.re < 0 ? -a.re : a.re) + (a.im < 0 ? -a.im : a.im);
}
constexpr double magnitude(double a) {
  return a < 0 ? -a : a;
}

}  // namespace truestep
