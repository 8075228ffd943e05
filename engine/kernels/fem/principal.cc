#include "engine/kernels/fem/principal.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/fem/laws.h"

namespace truestep::fem {

namespace {

using Three = std::array<double, 3>;

constexpr size_t third(size_t p, size_t q) {
  return 3 - p - q;
}

// d det / ds and the determinant.
struct Volume3 {
  double j;
  Three cofactor;
};
Volume3 volume_of(const Three& s) {
  return {s[0] * s[1] * s[2], {s[1] * s[2], s[0] * s[2], s[0] * s[1]}};
}

void add_diagonal(PrincipalSlope& h, double scale) {
  for (size_t a = 0; a < 3; ++a) h.stretch[4 * a] += scale;
  for (double& on : h.on) on += scale;
}
void add_outer(PrincipalSlope& h, double scale, const Three& a) {
  for (size_t i = 0; i < 3; ++i) {
    for (size_t k = 0; k < 3; ++k) h.stretch[3 * i + k] += scale * a[i] * a[k];
  }
}
// scale * d2 det / dF2
void add_determinant_curvature(PrincipalSlope& h, double scale, const Three& s) {
  for (size_t n = 0; n < 3; ++n) {
    const auto [p, q] = kPairs[n];
    const double other = scale * s[third(p, q)];
    h.stretch[3 * p + q] += other, h.stretch[3 * q + p] += other;
    h.off[n] -= other;
  }
}
// scale * d (F F^T F) / dF
void add_quartic_curvature(PrincipalSlope& h, double scale, const Three& s) {
  for (size_t a = 0; a < 3; ++a) h.stretch[4 * a] += 3 * scale * s[a] * s[a];
  for (size_t n = 0; n < 3; ++n) {
    const auto [p, q] = kPairs[n];
    h.on[n] += scale * (s[p] * s[p] + s[q] * s[q]);
    h.off[n] += scale * s[p] * s[q];
  }
}
// scale * d R / dF
void add_rotation_slope(PrincipalSlope& h, double scale, const Three& s) {
  for (size_t n = 0; n < 3; ++n) {
    const double turn = scale / sum_of_stretches(s[kPairs[n].first], s[kPairs[n].second]);
    h.on[n] += turn, h.off[n] -= turn;
  }
}

void add_log(PrincipalSlope& h, double modulus, const Volume3& v, const Three& s) {
  const Log log = log_of(v.j);
  add_outer(h, -modulus * log.ddl, v.cofactor);
  add_determinant_curvature(h, -modulus * log.dl, s);
}

}  // namespace

PrincipalTheta principal_theta(const Material& material, const Three& s) {
  switch (material.law) {
    case Law::corotated:
      return {s[0] + s[1] + s[2] - 3, {1, 1, 1}};
    case Law::st_venant_kirchhoff:
      return {0.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - 3), s};
    default: {
      const Volume3 v = volume_of(s);
      return {v.j, v.cofactor};
    }
  }
}

PrincipalSlope principal_slope(const Material& mat, const Three& s, const Dilatation& d) {
  PrincipalSlope h;
  const Volume3 v = volume_of(s);
  const double i1 = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
  switch (mat.law) {
    case Law::linear:
      break;
    case Law::corotated:
      add_diagonal(h, 2 * mat.mu);
      add_rotation_slope(h, d.u.du - 2 * mat.mu, s);
      break;
    case Law::st_venant_kirchhoff:
      add_quartic_curvature(h, mat.mu, s);
      add_diagonal(h, d.u.du - mat.mu);
      break;
    case Law::neo_hookean:
      add_diagonal(h, mat.mu);
      add_log(h, mat.mu, v, s);
      add_determinant_curvature(h, d.u.du, s);
      break;
    case Law::stable_neo_hookean: {
      const double m = smith_of(mat).m;
      add_diagonal(h, m * (1 - 1 / (i1 + 1)));
      add_outer(h, 2 * m / ((i1 + 1) * (i1 + 1)), s);
      add_determinant_curvature(h, d.u.du, s);
      break;
    }
    case Law::mooney_rivlin: {
      const Mooney k = mooney_of(mat);
      add_diagonal(h, 2 * k.c1 + 2 * k.c2 * i1);
      add_outer(h, 4 * k.c2, s);
      add_quartic_curvature(h, -2 * k.c2, s);
      add_log(h, k.d, v, s);
      add_determinant_curvature(h, d.u.du, s);
      break;
    }
  }
  if (d.own) add_outer(h, d.u.ddu, principal_theta(mat, s).slope);
  return h;
}

void clamp(PrincipalSlope& h) {
  for (size_t n = 0; n < 3; ++n) {
    // Eigenvectors are the sum and the difference.
    const double sum = std::max(h.on[n] + h.off[n], 0.0), difference = std::max(h.on[n] - h.off[n], 0.0);
    h.on[n] = 0.5 * (sum + difference), h.off[n] = 0.5 * (sum - difference);
  }
  // Sylvester's criterion: already definite.
  const auto& a = h.stretch;
  const double minor = a[0] * a[4] - a[1] * a[1],
               whole = minor * a[8] + a[1] * a[2] * a[5] * 2 - a[0] * a[5] * a[5] - a[4] * a[2] * a[2];
  if (a[0] > 0 && minor > 0 && whole > 0) return;
  const Eigen3 e = eigen3({a});
  h.stretch = {};
  for (size_t k = 0; k < 3; ++k) {
    const Vec3 q = e.vectors.column(k);
    add_outer(h, std::max(e.values[k], 0.0), {q.x, q.y, q.z});
  }
}

namespace {

// Element (i, l) of the block for y and z, gradients in principal axes: the sum over j and m of h_{ij,lm} y_j
// z_m.
Mat3 principal_block(const PrincipalSlope& h, const Three& y, const Three& z) {
  Mat3 out;
  for (size_t i = 0; i < 3; ++i) out(i, i) = h.stretch[4 * i] * y[i] * z[i];
  for (size_t n = 0; n < 3; ++n) {
    const auto [p, q] = kPairs[n];
    out(p, q) = h.stretch[3 * p + q] * y[p] * z[q] + h.off[n] * y[q] * z[p];
    out(q, p) = h.stretch[3 * p + q] * y[q] * z[p] + h.off[n] * y[p] * z[q];
    out(p, p) += h.on[n] * y[q] * z[q];
    out(q, q) += h.on[n] * y[p] * z[p];
  }
  return out;
}

Three turned_back(const Mat3& v, const Vec3& g) {
  return {dot(v.column(0), g), dot(v.column(1), g), dot(v.column(2), g)};
}

}  // namespace

Mat9 turned(const PrincipalSlope& h, const Svd3& svd) {
  const Mat3 back = transposed(svd.u);
  Mat9 out;
  for (size_t j = 0; j < 3; ++j) {
    const Vec3 y = svd.v.row(j);
    for (size_t m = 0; m < 3; ++m) {
      const Vec3 z = svd.v.row(m);
      const Mat3 block = svd.u * principal_block(h, {y.x, y.y, y.z}, {z.x, z.y, z.z}) * back;
      for (size_t i = 0; i < 3; ++i) {
        for (size_t l = 0; l < 3; ++l) out[9 * (3 * i + j) + 3 * l + m] = block(i, l);
      }
    }
  }
  return out;
}

void add_stiffness(const PrincipalSlope& h, const Svd3& svd, std::span<const Vec3> gradients, double weight,
                   double* k) {
  const Mat3 back = weight * transposed(svd.u);
  for (size_t b = 0; b < gradients.size(); ++b) {
    const Three z = turned_back(svd.v, gradients[b]);
    for (size_t a = 0; a <= b; ++a) {
      const Mat3 block = svd.u * principal_block(h, turned_back(svd.v, gradients[a]), z) * back;
      double* to = k + 9 * (a * gradients.size() + b);
      for (size_t c = 0; c < 3; ++c) {
        for (size_t r = 0; r < 3; ++r) to[3 * c + r] += block(r, c);
      }
    }
  }
}

}  // namespace truestep::fem
