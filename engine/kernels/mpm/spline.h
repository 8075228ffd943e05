// Weights of a particle on the nodes around it along one axis: quadratic and cubic B-splines (Steffen, Kirby,
// Berzins 2008). They sum to 1, their first moment about the particle is 0, their second is
// kSecond dx^2 wherever the particle is (Jiang, Schroeder, Teran 2017).
#pragma once

namespace truestep::mpm {

/// Nodes that a particle reaches along an axis: 3 for quadratic splines, 4 for cubic ones.
template <int Nodes, class T>
struct Spline {
  static_assert(Nodes == 3 || Nodes == 4);
  static constexpr T kSecond = Nodes == 3 ? T(1) / 4 : T(1) / 3;  ///< dx^2, second moment
  /// From a particle's place in cells to where its first node lies: base = floor(place - kShift).
  static constexpr T kShift = Nodes == 3 ? T(0.5) : T(1);

  /// `f` is the particle's place behind its first node, in cells: in [0.5, 1.5) or [1, 2).
  static void weights(T f, T* w) {
    if constexpr (Nodes == 3) {
      const T a = T(1.5) - f, b = f - 1, c = f - T(0.5);
      w[0] = T(0.5) * a * a, w[1] = T(0.75) - b * b, w[2] = T(0.5) * c * c;
    } else {
      const T t = f - 1, u = 1 - t, sixth = T(1) / 6, two_thirds = T(2) / 3;
      w[0] = sixth * u * u * u;
      w[1] = (T(0.5) * t - 1) * t * t + two_thirds;
      w[2] = (T(0.5) * u - 1) * u * u + two_thirds;
      w[3] = sixth * t * t * t;
    }
  }
};

}  // namespace truestep::mpm
