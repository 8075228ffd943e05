// Weights of a particle on the nodes around it along one axis: quadratic and cubic B-splines (Steffen, Kirby,
// Berzins 2008). They sum to 1, their first moment about the particle is 0, their second is kSecond dx^2 at
// every position (Jiang, Schroeder, Teran 2017).
#pragma once

namespace truestep::mpm {

/// `f` is the particle's offset from its first node, in cells: in [0.5, 1.5) or [1, 2). F is a number or a
/// vector of numbers.
template <int Nodes, class F>
[[gnu::always_inline]] inline void spline_weights(F f, F* w) {
  const F one(1), half(0.5);
  if constexpr (Nodes == 3) {
    const F a = F(1.5) - f, b = f - one, c = f - half;
    w[0] = half * a * a, w[1] = F(0.75) - b * b, w[2] = half * c * c;
  } else {
    const F t = f - one, u = one - t, sixth(1.0 / 6), two_thirds(2.0 / 3);
    w[0] = sixth * u * u * u;
    w[1] = (half * t - one) * t * t + two_thirds;
    w[2] = (half * u - one) * u * u + two_thirds;
    w[3] = sixth * t * t * t;
  }
}

/// Nodes that a particle reaches along an axis: 3 for quadratic splines, 4 for cubic ones.
template <int Nodes, class T>
struct Spline {
  static_assert(Nodes == 3 || Nodes == 4);
  static constexpr T kSecond = Nodes == 3 ? T(1) / 4 : T(1) / 3;  ///< dx^2, second moment
  /// From a particle's position in cells to its first node: base = floor(position - kShift).
  static constexpr T kShift = Nodes == 3 ? T(0.5) : T(1);

  static void weights(T f, T* w) { spline_weights<Nodes>(f, w); }
};

}  // namespace truestep::mpm
