// Square matrices of two or three rows, a particle per lane, with a branch-free singular value decomposition:
// one-sided Jacobi rotations (Golub, Van Loan 2013, section 8.6.3) in a fixed number of sweeps; and the
// nearest rotation, which is cheaper.
#pragma once
#include "engine/math/wide.h"

namespace truestep::mpm {

template <int D, class T>
struct Square {
  using W = Wide<T>;
  W m[D * D];  ///< row by row
  W& operator()(int r, int c) { return m[D * r + c]; }
  const W& operator()(int r, int c) const { return m[D * r + c]; }

  static Square identity() {
    Square out;
    for (int k = 0; k < D * D; ++k) out.m[k] = W::all(k % (D + 1) == 0 ? T{1} : T{0});
    return out;
  }
};

template <int D, class T>
Square<D, T> operator*(const Square<D, T>& a, const Square<D, T>& b) {
  Square<D, T> out;
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) {
      Wide<T> sum = a(r, 0) * b(0, c);
      for (int k = 1; k < D; ++k) sum = madd(a(r, k), b(k, c), sum);
      out(r, c) = sum;
    }
  }
  return out;
}

template <int D, class T>
Square<D, T> transposed(const Square<D, T>& a) {
  Square<D, T> out;
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) out(r, c) = a(c, r);
  }
  return out;
}

/// a diag(s) b^T.
template <int D, class T>
Square<D, T> compose(const Square<D, T>& a, const Wide<T>* s, const Square<D, T>& b) {
  Square<D, T> out;
  for (int r = 0; r < D; ++r) {
    for (int c = 0; c < D; ++c) {
      Wide<T> sum = a(r, 0) * s[0] * b(c, 0);
      for (int k = 1; k < D; ++k) sum = madd(a(r, k) * s[k], b(c, k), sum);
      out(r, c) = sum;
    }
  }
  return out;
}

template <int D, class T>
Wide<T> determinant(const Square<D, T>& a) {
  if constexpr (D == 2) {
    return a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
  } else {
    return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) -
           a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
           a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
  }
}

template <class T>
Wide<T> abs(Wide<T> a) {
  return max(a, -a);
}

/// A = U diag(s) V^T with rotations U and V; s[0] >= ... >= |s[D - 1]|, the last with the sign of det A
/// (Irving, Teran, Fedkiw 2004).
template <int D, class T>
struct Svd {
  Square<D, T> u, v;
  Wide<T> s[D];
};

namespace detail {

/// Columns p and q of a become c a_p - s a_q and s a_p + c a_q.
template <int D, class T>
void rotate_columns(Square<D, T>& a, int p, int q, Wide<T> c, Wide<T> s) {
  for (int i = 0; i < D; ++i) {
    const Wide<T> x = a(i, p), y = a(i, q);
    a(i, p) = nmadd(s, y, c * x);
    a(i, q) = madd(s, x, c * y);
  }
}

template <int D, class T>
Wide<T> dot_columns(const Square<D, T>& a, int p, int q) {
  Wide<T> sum = a(0, p) * a(0, q);
  for (int i = 1; i < D; ++i) sum = madd(a(i, p), a(i, q), sum);
  return sum;
}

/// Makes columns p and q of b orthogonal, by at most 45 degrees.
template <int D, class T>
void orthogonalise(Square<D, T>& b, Square<D, T>& v, int p, int q) {
  using W = Wide<T>;
  const W one(T{1}), half(T{0.5}), tiny(sizeof(T) == 4 ? T(1e-35) : T(1e-300));
  const W xx = dot_columns(b, p, p), yy = dot_columns(b, q, q), xy = dot_columns(b, p, q);
  // Scaled by the larger of the two, so that no square underflows.
  const W larger = max(abs(yy - xx), abs(xy + xy));
  const auto turns = larger > tiny;
  const W inverse = one / max(larger, tiny), d = (yy - xx) * inverse, o = xy * inverse;
  const W h = sqrt(madd(d, d, W(T{4}) * o * o)), safe = select(turns, h, one);
  const W c = select(turns, sqrt(madd(half, abs(d) / safe, half)), one);
  const W s = select(turns, select(d < W::zero(), -o, o) / (safe * c), W::zero());
  rotate_columns(b, p, q, c, s);
  rotate_columns(v, p, q, c, s);
}

/// Larger column first; an exchange is a rotation by 90 degrees.
template <int D, class T>
void order_columns(Square<D, T>& b, Square<D, T>& v, int p, int q) {
  using W = Wide<T>;
  const auto swap = dot_columns(b, p, p) < dot_columns(b, q, q);
  const W c = select(swap, W::zero(), W(T{1})), s = select(swap, W(T{-1}), W::zero());
  rotate_columns(b, p, q, c, s);
  rotate_columns(v, p, q, c, s);
}

}  // namespace detail

template <int D, class T>
Svd<D, T> svd(const Square<D, T>& a) {
  using W = Wide<T>;
  using detail::dot_columns;
  // Quadratic convergence; the number was measured on the matrices of tests/unit/mpm/mpm_matrix_test.cc.
  constexpr int kSweeps = D == 2 ? 2 : sizeof(T) == 4 ? 4 : 6;
  const W tiny(sizeof(T) == 4 ? T(1e-18) : T(1e-140)), one(T{1}), zero = W::zero();
  Square<D, T> b = a;
  Svd<D, T> out{.u = Square<D, T>::identity(), .v = Square<D, T>::identity(), .s = {}};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    detail::orthogonalise(b, out.v, 0, 1);
    if constexpr (D == 3) {
      detail::orthogonalise(b, out.v, 0, 2);
      detail::orthogonalise(b, out.v, 1, 2);
    }
  }
  detail::order_columns(b, out.v, 0, 1);
  if constexpr (D == 3) {
    detail::order_columns(b, out.v, 0, 2);
    detail::order_columns(b, out.v, 1, 2);
  }
  const W n0 = sqrt(dot_columns(b, 0, 0)), safe0 = max(n0, tiny);
  auto& u = out.u;
  for (int i = 0; i < D; ++i) u(i, 0) = select(n0 > tiny, b(i, 0) / safe0, i == 0 ? one : zero);
  if constexpr (D == 2) {
    u(0, 1) = -u(1, 0), u(1, 1) = u(0, 0);
  } else {
    // The second direction: the rest of the second column, or any perpendicular to the first.
    constexpr T kEps = sizeof(T) == 4 ? T(5e-7) : T(1e-15);
    W w[3], along = madd(u(2, 0), b(2, 1), madd(u(1, 0), b(1, 1), u(0, 0) * b(0, 1)));
    for (int i = 0; i < 3; ++i) w[i] = nmadd(along, u(i, 0), b(i, 1));
    const W left = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    const auto plain = left > max(W(kEps) * n0, tiny);
    const auto flat = abs(u(0, 0)) < W(T(0.6));
    const W other[3] = {select(flat, zero, -u(2, 0)), select(flat, u(2, 0), zero),
                        select(flat, -u(1, 0), u(0, 0))};
    for (int i = 0; i < 3; ++i) w[i] = select(plain, w[i], other[i]);
    // Twice: if the columns are nearly parallel, the first pass leaves rounding errors of the larger one.
    W length = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    for (int i = 0; i < 3; ++i) w[i] = w[i] / length;
    along = madd(u(2, 0), w[2], madd(u(1, 0), w[1], u(0, 0) * w[0]));
    for (int i = 0; i < 3; ++i) w[i] = nmadd(along, u(i, 0), w[i]);
    length = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    for (int i = 0; i < 3; ++i) u(i, 1) = w[i] / length;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      u(i, 2) = u(j, 0) * u(k, 1) - u(k, 0) * u(j, 1);
    }
  }
  for (int k = 0; k < D; ++k) {
    W sum = u(0, k) * b(0, k);
    for (int i = 1; i < D; ++i) sum = madd(u(i, k), b(i, k), sum);
    out.s[k] = sum;
  }
  return out;
}

/// The rotation nearest to A, U V^T, without singular values; `known` marks the lanes where it was found. In
/// the plane these are all lanes, in closed form (if every rotation is equally near, the identity); in space
/// those where A is neither reflected nor nearly singular, by scaled Newton iteration (Higham 2008, section
/// 8.6).
template <int D, class T>
Square<D, T> nearest_rotation(const Square<D, T>& a, typename Wide<T>::Mask& known) {
  using W = Wide<T>;
  const W one(T{1}), zero = W::zero(), half(T{0.5});
  if constexpr (D == 2) {
    const W c = a(0, 0) + a(1, 1), s = a(1, 0) - a(0, 1), length = sqrt(madd(c, c, s * s));
    const auto turns = length > W(sizeof(T) == 4 ? T(1e-18) : T(1e-140));
    const W over = one / select(turns, length, one);
    Square<D, T> r;
    r(0, 0) = r(1, 1) = select(turns, c * over, one);
    r(1, 0) = select(turns, s * over, zero), r(0, 1) = -r(1, 0);
    known = one > zero;
    return r;
  } else {
    // Condition numbers up to a hundred converge to rounding in this many iterations.
    constexpr int kRounds = sizeof(T) == 4 ? 5 : 7;
    constexpr double kMostCondition = 100;
    const auto squares = [](const Square<D, T>& m) {
      W sum = m.m[0] * m.m[0];
      for (int k = 1; k < D * D; ++k) sum = madd(m.m[k], m.m[k], sum);
      return sum;
    };
    Square<D, T> x = a, c;
    for (int round = 0; round < kRounds; ++round) {
      for (int i = 0; i < 3; ++i) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int k = 0; k < 3; ++k) {
          const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
          c(i, k) = nmadd(x(i1, k2), x(i2, k1), x(i1, k1) * x(i2, k2));
        }
      }
      const W det = madd(x(0, 0), c(0, 0), madd(x(0, 1), c(0, 1), x(0, 2) * c(0, 2)));
      const W of_x = sqrt(squares(x)), of_c = sqrt(squares(c));
      // |A| |A^-1| = |A| |cofactors| / det.
      if (round == 0) known = det > of_x * of_c * W(T(1 / kMostCondition));
      const W safe = max(det, W(sizeof(T) == 4 ? T(1e-30) : T(1e-200)));
      const W scale = sqrt(of_c / max(safe * of_x, W(sizeof(T) == 4 ? T(1e-30) : T(1e-200))));
      const W p = half * scale, q = half / max(scale * safe, W(sizeof(T) == 4 ? T(1e-30) : T(1e-200)));
      for (int k = 0; k < D * D; ++k) x.m[k] = madd(p, x.m[k], q * c.m[k]);
    }
    return x;
  }
}

/// The same in every lane, from singular values where necessary.
template <int D, class T>
Square<D, T> nearest_rotation(const Square<D, T>& a) {
  typename Wide<T>::Mask known;
  Square<D, T> r = nearest_rotation(a, known);
  if constexpr (D == 3) {
    bool all = true;
    for (int i = 0; i < Wide<T>::kLanes; ++i) all = all && known[i] != 0;
    if (all) return r;
    const Svd<D, T> d = svd(a);
    const Wide<T> one[3] = {Wide<T>(T{1}), Wide<T>(T{1}), Wide<T>(T{1})};
    const Square<D, T> other = compose(d.u, one, d.v);
    for (int k = 0; k < D * D; ++k) r.m[k] = select(known, r.m[k], other.m[k]);
  }
  return r;
}

}  // namespace truestep::mpm
