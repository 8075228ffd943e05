#include "engine/systems/articulation/tree_newton.h"

#include <algorithm>
#include <cmath>

namespace truestep::articulation {

namespace {

bool finite(double x) {
  return std::isfinite(x);
}
bool finite(Complex x) {
  return std::isfinite(x.re) && std::isfinite(x.im);
}

// a x b of three numbers each, b real.
template <class T>
void add_cross(const T* a, const Vec3& b, T* out) {
  out[0] += b.z * a[1] - b.y * a[2], out[1] += b.x * a[2] - b.z * a[0], out[2] += b.y * a[0] - b.x * a[1];
}
template <class T>
void turn(const Rotation& R, const T* a, T* out) {
  for (int i = 0; i < 3; ++i) out[i] = R.row[i].x * a[0] + R.row[i].y * a[1] + R.row[i].z * a[2];
}
template <class T>
void turn_back(const Rotation& R, const T* a, T* out) {
  const auto at = [&](int i, int j) { return j == 0 ? R.row[i].x : j == 1 ? R.row[i].y : R.row[i].z; };
  for (int j = 0; j < 3; ++j) out[j] = at(0, j) * a[0] + at(1, j) * a[1] + at(2, j) * a[2];
}

// Frame::into of motions.
template <class T>
void into(const spatial::Frame& x, const T* m, T* out) {
  T v[3] = {m[3], m[4], m[5]};
  add_cross(m, x.p, v);
  turn_back(x.R, m, out), turn_back(x.R, v, out + 3);
}
// Frame::out of a wrench, added.
template <class T>
void add_out(const spatial::Frame& x, const T* f, T* sum) {
  T n[3], g[3];
  turn(x.R, f, n), turn(x.R, f + 3, g);
  add_cross(g, -x.p, n);
  for (int i = 0; i < 3; ++i) sum[i] += n[i], sum[3 + i] += g[i];
}

// sum += X^T M X for `width` / 6 matrices side by side; leaves M transformed.
template <class T, class Row>
void add_congruent(const spatial::Frame& x, Row* M, Row* sum, size_t width) {
  const Vec3 p = x.p;
  T turned[6][kMotionsAndPose];
  for (size_t b = 0; b < 6; b += 3) {
    for (size_t i = 0; i < 3; ++i) {
      const Vec3 r = x.R.row[i];
      for (size_t c = 0; c < width; ++c) {
        turned[b + i][c] = r.x * M[b][c] + r.y * M[b + 1][c] + r.z * M[b + 2][c];
      }
    }
  }
  // p x the lower half.
  for (size_t c = 0; c < width; ++c) {
    turned[0][c] += p.y * turned[5][c] - p.z * turned[4][c];
    turned[1][c] += p.z * turned[3][c] - p.x * turned[5][c];
    turned[2][c] += p.x * turned[4][c] - p.y * turned[3][c];
  }
  for (size_t r = 0; r < 6; ++r) {
    for (size_t c = 0; c < width; c += 6) {
      T w[3], v[3], minus[3] = {T(0), T(0), T(0)};
      turn(x.R, turned[r] + c, w), turn(x.R, turned[r] + c + 3, v);
      add_cross(v, p, minus);
      for (size_t k = 0; k < 3; ++k) sum[r][c + k] += w[k] - minus[k], sum[r][c + 3 + k] += v[k];
    }
  }
}

// (I + [w] + w w^T)^-1 = (I - [w]) / (1 + w w), with which a ball's quaternion follows from its angular
// velocity.
template <class T>
void turning(T half_z, const double* spin, T K[3][3]) {
  const T w[3] = {spin[0] * half_z, spin[1] * half_z, spin[2] * half_z};
  const T s = reciprocal(T(1) + w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
  const T x = s * w[0], y = s * w[1], z = s * w[2];
  const T rows[3][3] = {{s, z, -y}, {-z, s, x}, {y, -x, s}};
  std::copy_n(&rows[0][0], 9, &K[0][0]);
}

template <class T>
bool invert(const T (*D)[3], size_t m, T (*inverse)[3]) {
  if (m == 1) {
    inverse[0][0] = reciprocal(D[0][0]);
    return finite(inverse[0][0]);
  }
  const auto minor = [&](size_t i, size_t j) {
    const size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return D[a][c] * D[b][d] - D[a][d] * D[b][c];
  };
  T det = T(0);
  for (size_t j = 0; j < 3; ++j) det += D[0][j] * minor(0, j);
  const T one = reciprocal(det);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) inverse[j][i] = one * minor(i, j);
  }
  return finite(one);
}

// Hamilton product of quaternions, b real or of type T.
template <class T, class B>
void times(const T* a, const B* b, T* out) {
  out[0] = b[0] * a[0] - b[1] * a[1] - b[2] * a[2] - b[3] * a[3];
  out[1] = b[1] * a[0] + b[0] * a[1] + b[3] * a[2] - b[2] * a[3];
  out[2] = b[2] * a[0] - b[3] * a[1] + b[0] * a[2] + b[1] * a[3];
  out[3] = b[3] * a[0] + b[2] * a[1] - b[1] * a[2] + b[0] * a[3];
}

}  // namespace

template <class T>
bool TreeFactors<T>::factor(const LinearTree& tree, T with_x, T with_v, T half_z) {
  const auto& slopes = tree.nodes();
  const size_t width = tree.width();
  with_v_ = with_v, half_z_ = half_z;
  nodes_.resize(slopes.size());
  for (size_t i = 0; i < slopes.size(); ++i) {
    for (size_t r = 0; r < 6; ++r) {
      for (size_t c = 0; c < width; ++c) nodes_[i].P[r][c] = T(slopes[i].own[r][c]);
    }
  }
  for (size_t i = slopes.size(); i-- > 0;) {
    if (!eliminate(slopes[i], nodes_[i], with_x, width)) return false;
  }
  return true;
}

// Eliminates d of the node and passes the rest on to its parent.
template <class T>
bool TreeFactors<T>::eliminate(const NodeSlope& n, Node& f, T with_x, size_t width) {
  const size_t m = velocities_of(n.move);
  // alpha contains -S v_j x nu: row (r_w, r_v) of P_alpha takes (r_w x w + r_v x v, r_v x w) from P_nu.
  if (m > 0) {
    for (size_t r = 0; r < 6; ++r) {
      T minus[6] = {T(0), T(0), T(0), T(0), T(0), T(0)};
      add_cross(f.P[r] + 6, n.joint.w, minus);
      add_cross(f.P[r] + 9, n.joint.v, minus);
      add_cross(f.P[r] + 9, n.joint.w, minus + 3);
      for (size_t c = 0; c < 6; ++c) f.P[r][c] -= minus[c];
    }
  }
  for (size_t i = 0; i < m; ++i) {
    for (size_t j = 0; j < m; ++j) f.Ax[i][j] = T(i == j ? 1 : 0);
  }
  if (n.move == Move::spherical) turning(half_z_, n.spin, f.Ax);
  for (size_t i = 0; i < m; ++i) {
    for (size_t j = 0; j < m; ++j) f.Ax[i][j] *= with_x;
  }
  for (size_t r = 0; r < width; ++r) {
    for (size_t k = 0; k < m; ++k) {
      T sum = n.with_v[r][k] * with_v_;
      for (size_t j = 0; j < m; ++j) sum += n.with_p[r][j] * f.Ax[j][k];
      if (r >= 6 && r < 12) sum += T(n.S[r - 6][k]);
      f.W[r][k] = sum;
    }
  }
  T U[6][3], D[3][3];
  for (size_t r = 0; r < 6; ++r) {
    for (size_t k = 0; k < m; ++k) {
      T sum = T(0);
      for (size_t c = 0; c < width; ++c) sum += f.P[r][c] * f.W[c][k];
      U[r][k] = sum;
      for (size_t j = 0; j < m; ++j) sum += n.turned[r][j] * f.Ax[j][k];
      f.left[r][k] = sum;
    }
  }
  for (size_t i = 0; i < m; ++i) {
    for (size_t k = 0; k < m; ++k) {
      T sum = i == k ? n.drive.damping * with_v_ : T(0);
      for (size_t j = 0; j < m; ++j) sum += n.drive.stiffness[i][j] * f.Ax[j][k];
      for (size_t r = 0; r < 6; ++r) sum += n.S[r][i] * U[r][k];
      D[i][k] = sum;
    }
  }
  if (m > 0 && !invert(D, m, f.Dinv)) return false;
  for (size_t k = 0; k < m; ++k) {
    for (size_t c = 0; c < width; ++c) f.G[k][c] = T(0);
  }
  for (size_t j = 0; j < m; ++j) {
    T row[kMotionsAndPose];
    for (size_t c = 0; c < width; ++c) row[c] = T(0);
    for (size_t r = 0; r < 6; ++r) {
      const double s = n.S[r][j];
      if (s == 0) continue;
      for (size_t c = 0; c < width; ++c) row[c] += s * f.P[r][c];
    }
    for (size_t k = 0; k < m; ++k) {
      for (size_t c = 0; c < width; ++c) f.G[k][c] += f.Dinv[k][j] * row[c];
    }
  }
  if (n.parent == kGround) return true;
  T shown[6][kMotionsAndPose];
  for (size_t r = 0; r < 6; ++r) {
    for (size_t c = 0; c < width; ++c) shown[r][c] = f.P[r][c];
    for (size_t k = 0; k < m; ++k) {
      for (size_t c = 0; c < width; ++c) shown[r][c] -= f.left[r][k] * f.G[k][c];
    }
  }
  add_congruent<T>(n.frame, shown, nodes_[size_t(n.parent)].P, width);
  return true;
}

// d of all joints from cx, cv and ca.
template <class T>
void TreeFactors<T>::sweep(const LinearTree& tree) {
  const auto& slopes = tree.nodes();
  const size_t width = tree.width();
  for (Node& f : nodes_) std::fill_n(f.p, 6, T(0));
  for (size_t i = slopes.size(); i-- > 0;) {
    const NodeSlope& n = slopes[i];
    Node& f = nodes_[i];
    const size_t m = velocities_of(n.move);
    const T *cx = cx_.data() + n.v, *cv = cv_.data() + n.v, *ca = ca_.data() + n.v;
    T u[6];
    std::copy_n(f.p, 6, u);
    std::fill_n(f.change, width, T(0));
    if (m > 0) {
      for (size_t r = 0; r < width; ++r) {
        for (size_t k = 0; k < m; ++k) f.change[r] += n.with_p[r][k] * cx[k] + n.with_v[r][k] * cv[k];
      }
      for (size_t r = 0; r < 6; ++r) {
        for (size_t k = 0; k < m; ++k) f.change[6 + r] += n.S[r][k] * ca[k];
      }
      for (size_t r = 0; r < 6; ++r) {
        for (size_t c = 0; c < width; ++c) u[r] += f.P[r][c] * f.change[c];
      }
      T rest[3];
      for (size_t k = 0; k < m; ++k) {
        rest[k] = n.drive.damping * cv[k];
        for (size_t j = 0; j < m; ++j) rest[k] += n.drive.stiffness[k][j] * cx[j];
        for (size_t r = 0; r < 6; ++r) rest[k] += n.S[r][k] * u[r];
      }
      for (size_t k = 0; k < m; ++k) {
        f.y[k] = T(0);
        for (size_t j = 0; j < m; ++j) f.y[k] += f.Dinv[k][j] * rest[j];
      }
      for (size_t r = 0; r < 6; ++r) {
        for (size_t k = 0; k < m; ++k) u[r] += n.turned[r][k] * cx[k] - f.left[r][k] * f.y[k];
      }
    }
    if (n.parent != kGround) add_out(n.frame, u, nodes_[size_t(n.parent)].p);
  }
  for (size_t i = 0; i < slopes.size(); ++i) {
    const NodeSlope& n = slopes[i];
    Node& f = nodes_[i];
    const size_t m = velocities_of(n.move);
    T seen[kMotionsAndPose];
    std::fill_n(seen, width, T(0));
    if (n.parent != kGround) {
      for (size_t c = 0; c < width; c += 6) into(n.frame, nodes_[size_t(n.parent)].change + c, seen + c);
    }
    for (size_t k = 0; k < m; ++k) {
      T d = -f.y[k];
      for (size_t c = 0; c < width; ++c) d -= f.G[k][c] * seen[c];
      d_[n.v + k] = d;
    }
    for (size_t r = 0; r < width; ++r) {
      T sum = f.change[r] + seen[r];
      for (size_t k = 0; k < m; ++k) sum += f.W[r][k] * d_[n.v + k];
      f.change[r] = sum;
    }
    T* alpha = f.change + 6;
    add_cross(f.change, n.joint.w, alpha);
    add_cross(f.change + 3, n.joint.w, alpha + 3);
    add_cross(f.change, n.joint.v, alpha + 3);
  }
}

template <class T>
void TreeFactors<T>::solve(const LinearTree& tree, T* x, T* v) {
  const auto& slopes = tree.nodes();
  size_t total = 0;
  for (const NodeSlope& n : slopes) total += velocities_of(n.move);
  for (auto* c : {&cx_, &cv_, &ca_, &d_}) c->resize(total);
  const T z = with_v_;
  for (NodeSlope const& n : slopes) {
    const size_t m = velocities_of(n.move);
    T* cx = cx_.data() + n.v;
    for (size_t k = 0; k < m; ++k) cv_[n.v + k] = v[n.v + k], ca_[n.v + k] = T(0);
    if (n.move == Move::spherical) {
      // b = orientation (b_s, b_e).
      const double* o = n.orientation;
      const double per = 1 / (o[0] * o[0] + o[1] * o[1] + o[2] * o[2] + o[3] * o[3]);
      const T back[4] = {T(per * o[0]), T(-per * o[1]), T(-per * o[2]), T(-per * o[3])};
      T b[4], K[3][3], rest[3];
      times(back, x + n.q, b);
      std::copy_n(b, 4, x + n.q);
      turning(half_z_, n.spin, K);
      for (size_t k = 0; k < 3; ++k) rest[k] = 2.0 * b[1 + k] + z * (n.spin[k] * b[0] + v[n.v + k]);
      for (size_t k = 0; k < 3; ++k) cx[k] = K[k][0] * rest[0] + K[k][1] * rest[1] + K[k][2] * rest[2];
    } else {
      for (size_t k = 0; k < m; ++k) cx[k] = x[n.q + k] + z * v[n.v + k];
    }
  }
  sweep(tree);
  for (NodeSlope const& n : slopes) {
    const size_t m = velocities_of(n.move);
    for (size_t k = 0; k < m; ++k) v[n.v + k] += z * d_[n.v + k];
    if (n.move == Move::spherical) {
      T K[3][3], rest[3], change[4];
      turning(half_z_, n.spin, K);
      const T* b = x + n.q;
      for (size_t k = 0; k < 3; ++k) rest[k] = b[1 + k] + half_z_ * (n.spin[k] * b[0] + v[n.v + k]);
      change[0] = b[0];
      for (size_t k = 0; k < 3; ++k) {
        change[1 + k] = K[k][0] * rest[0] + K[k][1] * rest[1] + K[k][2] * rest[2];
        change[0] -= half_z_ * (n.spin[k] * change[1 + k]);
      }
      const T o[4] = {T(n.orientation[0]), T(n.orientation[1]), T(n.orientation[2]), T(n.orientation[3])};
      T out[4];
      times(o, change, out);
      std::copy_n(out, 4, x + n.q);
    } else {
      for (size_t k = 0; k < m; ++k) x[n.q + k] += z * v[n.v + k];
    }
  }
}

template <class T>
void TreeFactors<T>::solve_second_order(const LinearTree& tree, T* b) {
  size_t total = 0;
  for (const NodeSlope& n : tree.nodes()) total += velocities_of(n.move);
  for (auto* c : {&cx_, &cv_, &ca_, &d_}) c->assign(total, T(0));
  for (size_t k = 0; k < total; ++k) ca_[k] = -b[k];
  sweep(tree);
  std::copy_n(d_.data(), total, b);
}

template class TreeFactors<double>;
template class TreeFactors<Complex>;

}  // namespace truestep::articulation
