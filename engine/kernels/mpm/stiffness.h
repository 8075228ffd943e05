// Energy, first Piola-Kirchhoff stress P = dpsi/dF and its derivative dP = (d2psi/dF2) : dF of the elastic
// laws, by singular values F = U diag(s) V^T (Stomakhin, Howes, Schroeder, Teran 2012, section 4; Smith, de
// Goes, Kim 2019): in the axes of U and V the derivative splits into a matrix of the stretches and one 2 x 2
// matrix for each pair of axes,
//   d2psi/ds_i ds_j,    (psi_i - psi_j) / (s_i - s_j) for shears,    (psi_i + psi_j) / (s_i + s_j) for
//   rotations.
// Their negative parts are dropped, so that the whole is positive semidefinite and Newton's direction
// descends (Teran, Sifakis, Irving, Fedkiw 2005).
#pragma once
#include "engine/kernels/mpm/laws.h"

namespace truestep::mpm {

/// Whether a law has a stiffness here.
constexpr bool has_stiffness(Law law) {
  return law == Law::corotated || law == Law::neo_hookean;
}

template <int D, class T>
struct Stiffness {
  static constexpr int kPairs = D * (D - 1) / 2;
  Square<D, T> u, v;
  Square<D, T> stretch;                 ///< Pa, symmetric
  Wide<T> shear[kPairs], turn[kPairs];  ///< Pa, of axes (0, 1), (0, 2), (1, 2)

  /// dP for a change of F.
  Square<D, T> apply(const Square<D, T>& df) const {
    const Square<D, T> g = transposed(u) * df * v;
    Square<D, T> k;
    for (int i = 0; i < D; ++i) {
      Wide<T> sum = stretch(i, 0) * g(0, 0);
      for (int j = 1; j < D; ++j) sum = madd(stretch(i, j), g(j, j), sum);
      k(i, i) = sum;
    }
    const Wide<T> half(0.5);
    for (int i = 0, pair = 0; i < D; ++i) {
      for (int j = i + 1; j < D; ++j, ++pair) {
        const Wide<T> a = half * shear[pair] * (g(i, j) + g(j, i)),
                      b = half * turn[pair] * (g(i, j) - g(j, i));
        k(i, j) = a + b, k(j, i) = a - b;
      }
    }
    return u * k * transposed(v);
  }
};

/// The positive semidefinite part of a symmetric matrix: half of the sum of the matrix and its absolute
/// value.
template <int D, class T>
Square<D, T> positive_part(const Square<D, T>& a) {
  const Svd<D, T> d = svd(a);
  Wide<T> size[D];
  for (int k = 0; k < D; ++k) size[k] = abs(d.s[k]);
  Square<D, T> out = compose(d.v, size, d.v);
  for (int k = 0; k < D * D; ++k) out.m[k] = Wide<T>(0.5) * (out.m[k] + a.m[k]);
  return out;
}

/// P (Pa) at F; `out` gets the stiffness there without its negative parts.
template <int D, class T>
Square<D, T> stress_and_stiffness(const Material& mat, const Square<D, T>& f, Stiffness<D, T>& out) {
  using W = Wide<T>;
  const W mu(mat.mu), lambda(mat.lambda), one(1), zero = W::zero(), two_mu = mu + mu;
  const Svd<D, T> d = svd(f);
  out.u = d.u, out.v = d.v;
  W slope[D];
  if (mat.law == Law::neo_hookean) {
    W j = one, s[D];
    for (int k = 0; k < D; ++k) s[k] = max(d.s[k], W(kLeastVolume)), j *= s[k];
    const W l = log(j), c = nmadd(lambda, l, mu);  // mu - lambda ln J
    for (int i = 0; i < D; ++i) {
      slope[i] = mu * s[i] - c / s[i];
      for (int k = 0; k < D; ++k) {
        const W over = one / (s[i] * s[k]);
        out.stretch(i, k) = i == k ? madd(c + lambda, over, mu) : lambda * over;
      }
    }
    for (int i = 0, pair = 0; i < D; ++i) {
      for (int k = i + 1; k < D; ++k, ++pair) {
        const W over = c / (s[i] * s[k]);
        out.shear[pair] = max(mu + over, zero), out.turn[pair] = max(mu - over, zero);
      }
    }
  } else {
    // Cofactors: the product of the others; in space, for a pair, the third.
    W j = one, others[D];
    for (int k = 0; k < D; ++k) j *= d.s[k];
    for (int i = 0; i < D; ++i) others[i] = D == 2 ? d.s[1 - i] : d.s[(i + 1) % D] * d.s[(i + 2) % D];
    const W p = lambda * (j - one);
    for (int i = 0; i < D; ++i) slope[i] = madd(two_mu, d.s[i] - one, p * others[i]);
    for (int i = 0, pair = 0; i < D; ++i) {
      out.stretch(i, i) = madd(lambda * others[i], others[i], two_mu);
      for (int k = i + 1; k < D; ++k, ++pair) {
        const W third = D == 2 ? one : d.s[D - i - k];
        out.stretch(i, k) = out.stretch(k, i) = madd(lambda * others[i], others[k], p * third);
        out.shear[pair] = max(two_mu - p * third, zero);
        out.turn[pair] = max(two_mu + p * third - (two_mu + two_mu) / max(d.s[i] + d.s[k], W(1e-6)), zero);
      }
    }
  }
  out.stretch = positive_part(out.stretch);
  return compose(d.u, slope, d.v);
}

}  // namespace truestep::mpm
