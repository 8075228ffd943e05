// How the attraction of two bodies is taken from Newton's when they are near. Per unit of mass and G:
//   acceleration towards the other = w(r) d,  potential = -p(r)
//   none, plummer  w = (r^2 + eps^2)^(-3/2), p = (r^2 + eps^2)^(-1/2)
//   spline         the field of a body spread by the cubic spline kernel of radius h = 2.8 eps (Monaghan &
//   Lattanzio
//                  1985): Newton's beyond h, and as deep as Plummer's in the middle (Springel 2005, eq. 71
//                  and section 2)
// Not here: softenings of single bodies.
#pragma once
#include "engine/kernels/gravity/inverse_root.h"

namespace truestep::gravity {

enum class SofteningKind : uint8_t { plummer, spline };

/// Of all bodies. `length` eps in m, 0: none.
struct Softening {
  SofteningKind kind = SofteningKind::plummer;
  double length = 0;
};

/// Radius of the spline's support over its eps.
inline constexpr double kSplineSupport = 2.8;

/// w and p (left in `inverse`) of eight or four pairs at the squared distances r2; eps > 0.
template <class T>
struct PlummerLaw {
  Wide<T> eps2;
  explicit PlummerLaw(double eps) : eps2(static_cast<T>(eps * eps)) {}
  Wide<T> operator()(Wide<T> r2, Wide<T>& inverse) const {
    inverse = inverse_root(r2 + eps2);
    return inverse * inverse * inverse;
  }
};

/// Without softening; w = p = 0 at distance 0. `tiny` (m^2) is below the square of any other distance.
template <class T>
struct NewtonLaw {
  Wide<T> tiny;
  explicit NewtonLaw(T least) : tiny(least) {}
  Wide<T> operator()(Wide<T> r2, Wide<T>& inverse) const {
    inverse = select(r2 > tiny, inverse_root(r2 + tiny), Wide<T>::zero());
    return inverse * inverse * inverse;
  }
};

template <class T>
struct SplineLaw {
  Wide<T> h, per_h, tiny;
  SplineLaw(double eps, T least) : h(kSplineSupport * eps), per_h(1 / (kSplineSupport * eps)), tiny(least) {}
  Wide<T> operator()(Wide<T> r2, Wide<T>& inverse) const {
    const auto c = [](double a) { return Wide<T>(a); };
    const Wide<T> newton = inverse_root(r2 + tiny), u = r2 * newton * per_h, u2 = u * u;
    // Inner half: u < 1/2. The outer one's 1/u is h newton.
    const Wide<T> inner_w = madd(u2, madd(u, c(32), c(-38.4)), c(32.0 / 3));
    const Wide<T> inner_p = nmadd(u2, madd(u2, madd(u, c(6.4), c(-9.6)), c(16.0 / 3)), c(2.8));
    const Wide<T> v = h * newton;
    const Wide<T> outer_w =
        nmadd(v * v * v, c(1.0 / 15), madd(u, madd(u, nmadd(u, c(32.0 / 3), c(38.4)), c(-48)), c(64.0 / 3)));
    const Wide<T> outer_p = nmadd(u2, madd(u, madd(u, nmadd(u, c(32.0 / 15), c(9.6)), c(-16)), c(32.0 / 3)),
                                  nmadd(v, c(1.0 / 15), c(3.2)));
    const auto half = u<c(0.5), outside = u> c(1);
    inverse = select(outside, newton, select(half, inner_p, outer_p) * per_h);
    return select(outside, newton * newton * newton, select(half, inner_w, outer_w) * per_h * per_h * per_h);
  }
};

}  // namespace truestep::gravity
