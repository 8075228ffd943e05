// Small vectors and matrices whose elements are lanes, for constraint rows solved side by side
// (contact_rows3.h, joint_rows3.h, ball_rows3.h).
#pragma once
#include "engine/math/wide.h"

namespace truestep {

/// Whether another substep follows that is warm-started with the joints' impulses.
enum class Renewal : uint8_t { goes_on, last };

enum class ContactSolve : uint8_t {
  bias,  ///< penetration and position errors are recovered
  relax  ///< velocities only: removes what `bias` added to them
};

namespace contact_rows {

template <class W>
W dot(const W a[3], const W b[3]) {
  return madd(a[2], b[2], madd(a[1], b[1], a[0] * b[0]));
}
template <class W>
void cross(const W a[3], const W b[3], W out[3]) {
  out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2], out[2] = a[0] * b[1] - a[1] * b[0];
}
/// S a, with S stored by rows.
template <class W>
void apply(const W s[9], const W a[3], W out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = madd(s[3 * k + 2], a[2], madd(s[3 * k + 1], a[1], s[3 * k] * a[0]));
}
/// S^T a.
template <class W>
void apply_transposed(const W s[9], const W a[3], W out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = madd(s[6 + k], a[2], madd(s[3 + k], a[1], s[k] * a[0]));
}
/// v += s j.
template <class W>
void add(W v[3], const W& s, const W j[3]) {
  for (int k = 0; k < 3; ++k) v[k] = madd(s, j[k], v[k]);
}
template <class W>
void subtract(W v[3], const W& s, const W j[3]) {
  for (int k = 0; k < 3; ++k) v[k] = nmadd(s, j[k], v[k]);
}
/// Two unit vectors perpendicular to n (Duff et al. 2017, "Building an orthonormal basis, revisited").
template <class W>
void basis(const W n[3], W t[2][3]) {
  const W one(1), sign = where_positive(n[2], one, -one), a = -one / (sign + n[2]), b = n[0] * n[1] * a;
  t[0][0] = one + sign * n[0] * n[0] * a, t[0][1] = sign * b, t[0][2] = -sign * n[0];
  t[1][0] = b, t[1][1] = sign + n[1] * n[1] * a, t[1][2] = -n[1];
}
/// Inverse of ((xx, xy), (xy, yy)), or zero if it is singular.
template <class W>
void invert(const W& xx, const W& xy, const W& yy, W out[3]) {
  const W det = xx * yy - xy * xy, inv = where_positive(det, W(1) / det, W(0));
  out[0] = yy * inv, out[1] = -xy * inv, out[2] = xx * inv;
}
/// Inverse of a symmetric positive definite matrix; the result is its lower triangle by rows.
template <int n, class W>
void invert_positive(const W k[n][n], W out[n * (n + 1) / 2]) {
  W l[n][n], m[n][n];
  for (int p = 0; p < n; ++p) {
    for (int q = 0; q <= p; ++q) {
      W sum = k[p][q];
      for (int e = 0; e < q; ++e) sum = nmadd(l[p][e], l[q][e], sum);
      l[p][q] = p == q ? sqrt(max(sum, W(1e-30))) : sum * m[q][q];
    }
    m[p][p] = W(1) / l[p][p];
  }
  for (int p = 0; p < n; ++p) {
    for (int q = 0; q < p; ++q) {
      W sum(0);
      for (int e = q; e < p; ++e) sum = nmadd(l[p][e], m[e][q], sum);
      m[p][q] = sum * m[p][p];
    }
  }
  for (int p = 0, at = 0; p < n; ++p) {
    for (int q = 0; q <= p; ++q, ++at) {
      W sum(0);
      for (int e = p; e < n; ++e) sum = madd(m[e][p], m[e][q], sum);
      out[at] = sum;
    }
  }
}
/// Adds two impulses to `total`, clipped to the disc of radius `limit`; `added` is the actual change.
template <class W>
void clip(W total[2], const W d[2], const W& limit, W added[2]) {
  const W x = total[0] + d[0], y = total[1] + d[1], length = sqrt(madd(y, y, x * x));
  const W share = where_positive(length - limit, limit / length, W(1));
  const W cx = x * share, cy = y * share;
  added[0] = cx - total[0], added[1] = cy - total[1];
  total[0] = cx, total[1] = cy;
}

}  // namespace contact_rows

}  // namespace truestep
