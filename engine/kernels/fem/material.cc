#include "engine/kernels/fem/material.h"

#include <algorithm>
#include <cmath>

#include "engine/kernels/fem/laws.h"
#include "engine/kernels/fem/principal.h"

namespace truestep::fem {

namespace {

void add_outer(Mat9& h, double scale, const Mat3& a, const Mat3& b) {
  for (size_t k = 0; k < 9; ++k) {
    for (size_t l = 0; l < 9; ++l) h[9 * k + l] += scale * a.m[k] * b.m[l];
  }
}
void add_scaled(Mat9& h, double scale, const Mat9& g) {
  for (size_t k = 0; k < 81; ++k) h[k] += scale * g[k];
}
void add_identity(Mat9& h, double scale) {
  for (size_t k = 0; k < 9; ++k) h[10 * k] += scale;
}

// h_{ij,kl} += scale * (d2 det / dF_ij dF_kl) = scale * e_ikm e_jln F_mn.
void add_determinant_curvature(Mat9& h, double scale, const Mat3& f) {
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      double* row = h.data() + 9 * (3 * i + j);
      row[3 * i1 + j1] += scale * f(i2, j2);
      row[3 * i2 + j2] += scale * f(i1, j1);
      row[3 * i1 + j2] -= scale * f(i2, j1);
      row[3 * i2 + j1] -= scale * f(i1, j2);
    }
  }
}

// h_{ij,kl} += scale * d(F C)_ij / dF_kl with C = F^T F; F C is the derivative of |C|^2 / 4 = |F^T F|^2 / 4.
void add_quartic_curvature(Mat9& h, double scale, const Mat3& f) {
  const Mat3 c = transposed(f) * f, b = f * transposed(f);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      double* row = h.data() + 9 * (3 * i + j);
      for (size_t k = 0; k < 3; ++k) {
        for (size_t l = 0; l < 3; ++l) {
          row[3 * k + l] += scale * ((i == k ? c(j, l) : 0) + f(i, l) * f(k, j) + (j == l ? b(i, k) : 0));
        }
      }
    }
  }
}

// d R / dF: each pair of axes turns at 2 / (s_i + s_j) (McAdams and others 2011, section 4).
void add_rotation_slope(Mat9& h, double scale, const Svd3& svd) {
  for (const auto& [p, q] : kPairs) {
    Mat3 t;
    const Vec3 up = svd.u.column(p), uq = svd.u.column(q), vp = svd.v.column(p), vq = svd.v.column(q);
    const double u[2][3] = {{up.x, up.y, up.z}, {uq.x, uq.y, uq.z}};
    const double v[2][3] = {{vp.x, vp.y, vp.z}, {vq.x, vq.y, vq.z}};
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) t(r, c) = u[0][r] * v[1][c] - u[1][r] * v[0][c];
    }
    add_outer(h, scale / sum_of_stretches(svd.s[p], svd.s[q]), t, t);
  }
}

void respond_linear(const Material& mat, const Mat3& f, Response& out, Curvature* curvature) {
  const Mat3 e = 0.5 * (f + transposed(f)) - Mat3::identity();
  out = {mat.mu * inner(e, e), 2 * mat.mu * e, trace(e), Mat3::identity()};
  if (!curvature) return;
  add_identity(curvature->shape, mat.mu);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) curvature->shape[9 * (3 * i + j) + 3 * j + i] += mat.mu;
  }
}

void respond_corotated(const Material& mat, const Mat3& f, Response& out, Curvature* curvature) {
  const Svd3 svd = svd3(f);
  const Mat3 r = svd.u * transposed(svd.v), d = f - r;
  out = {mat.mu * inner(d, d), 2 * mat.mu * d, svd.s[0] + svd.s[1] + svd.s[2] - 3, r};
  if (!curvature) return;
  add_identity(curvature->shape, 2 * mat.mu);
  add_rotation_slope(curvature->shape, -2 * mat.mu, svd);
  add_rotation_slope(curvature->theta, 1, svd);
}

void respond_kirchhoff(const Material& mat, const Mat3& f, Response& out, Curvature* curvature) {
  const Mat3 e = 0.5 * (transposed(f) * f - Mat3::identity());
  out = {mat.mu * inner(e, e), 2 * mat.mu * (f * e), trace(e), f};
  if (!curvature) return;
  // F E = (F C - F) / 2
  add_quartic_curvature(curvature->shape, mat.mu, f);
  add_identity(curvature->shape, -mat.mu);
  add_identity(curvature->theta, 1);
}

void respond_neo_hookean(const Material& mat, const Mat3& f, Response& out, Curvature* curvature) {
  const double j = determinant(f);
  const Mat3 c = cofactor(f);
  const Log log = log_of(j);
  out = {0.5 * mat.mu * (inner(f, f) - 3) - mat.mu * log.l, mat.mu * f - mat.mu * log.dl * c, j, c};
  if (!curvature) return;
  add_identity(curvature->shape, mat.mu);
  add_outer(curvature->shape, -mat.mu * log.ddl, c, c);
  add_determinant_curvature(curvature->shape, -mat.mu * log.dl, f);
  add_determinant_curvature(curvature->theta, 1, f);
}

void respond_stable(const Material& mat, const Mat3& f, Response& out, Curvature* curvature) {
  const double m = smith_of(mat).m, i1 = inner(f, f), share = 1 - 1 / (i1 + 1);
  out = {0.5 * m * (i1 - 3) - 0.5 * m * trig::log(0.25 * (i1 + 1)), m * share * f, determinant(f),
         cofactor(f)};
  if (!curvature) return;
  add_identity(curvature->shape, m * share);
  add_outer(curvature->shape, 2 * m / ((i1 + 1) * (i1 + 1)), f, f);
  add_determinant_curvature(curvature->theta, 1, f);
}

void respond_mooney(const Material& mat, const Mat3& f, Response& out, Curvature* curvature) {
  const Mooney k = mooney_of(mat);
  const double j = determinant(f), i1 = inner(f, f);
  const Mat3 right = transposed(f) * f, cof = cofactor(f), fc = f * right;
  const Log log = log_of(j);
  const double i2 = 0.5 * (i1 * i1 - inner(right, right));
  out = {k.c1 * (i1 - 3) + k.c2 * (i2 - 3) - k.d * log.l,
         (2 * k.c1 + 2 * k.c2 * i1) * f - 2 * k.c2 * fc - k.d * log.dl * cof, j, cof};
  if (!curvature) return;
  add_identity(curvature->shape, 2 * k.c1 + 2 * k.c2 * i1);
  add_outer(curvature->shape, 4 * k.c2, f, f);
  add_quartic_curvature(curvature->shape, -2 * k.c2, f);
  add_outer(curvature->shape, -k.d * log.ddl, cof, cof);
  add_determinant_curvature(curvature->shape, -k.d * log.dl, f);
  add_determinant_curvature(curvature->theta, 1, f);
}

}  // namespace

Material material_of(Law law, double e, double nu, double second) {
  return {law, e / (2 * (1 + nu)), e * nu / ((1 + nu) * (1 - 2 * nu)), second};
}

void respond(const Material& material, const Mat3& f, Response& out, Curvature* curvature) {
  if (curvature) *curvature = {};
  switch (material.law) {
    case Law::linear:
      return respond_linear(material, f, out, curvature);
    case Law::corotated:
      return respond_corotated(material, f, out, curvature);
    case Law::st_venant_kirchhoff:
      return respond_kirchhoff(material, f, out, curvature);
    case Law::neo_hookean:
      return respond_neo_hookean(material, f, out, curvature);
    case Law::stable_neo_hookean:
      return respond_stable(material, f, out, curvature);
    case Law::mooney_rivlin:
      return respond_mooney(material, f, out, curvature);
  }
}

Volumetric volumetric(const Material& material, double theta) {
  switch (material.law) {
    case Law::linear:
    case Law::corotated:
    case Law::st_venant_kirchhoff:
      return {0.5 * material.lambda * theta * theta, material.lambda * theta, material.lambda};
    case Law::stable_neo_hookean: {
      const Smith k = smith_of(material);
      const double d = theta - k.a, rest = 1 - k.a;
      return {0.5 * k.l * (d * d - rest * rest), k.l * d, k.l};
    }
    case Law::neo_hookean:
    case Law::mooney_rivlin:
      break;
  }
  const double l = material.law == Law::neo_hookean ? material.lambda : mooney_of(material).l;
  const Log log = log_of(theta);
  return {0.5 * l * log.l * log.l, l * log.l * log.dl, l * (log.dl * log.dl + log.l * log.ddl)};
}

Mat9 slope(const Material& material, const Mat3& f, const Dilatation& d) {
  Response r;
  Curvature c;
  respond(material, f, r, &c);
  add_scaled(c.shape, d.u.du, c.theta);
  if (d.own) add_outer(c.shape, d.u.ddu, r.dtheta, r.dtheta);
  return c.shape;
}

Mat9 definite_slope(const Material& material, const Mat3& f, const Dilatation& d) {
  if (material.law == Law::linear) return slope(material, f, d);
  const Svd3 svd = svd3(f);
  PrincipalSlope principal = principal_slope(material, svd.s, d);
  clamp(principal);
  return turned(principal, svd);
}

Stress stress(const Material& material, const Mat3& f) {
  Response r;
  respond(material, f, r, nullptr);
  const Volumetric u = volumetric(material, r.theta);
  return {r.energy + u.u, r.p + u.du * r.dtheta, slope(material, f, {u, true})};
}

}  // namespace truestep::fem
