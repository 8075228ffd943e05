#include "engine/kernels/fem/cell.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/kernels/fem/principal.h"
#include "engine/kernels/fem/relaxed_cell.h"

namespace truestep::fem {

namespace {

Mat3 gradient_of(const CellRule& rule, const Vec3* x, size_t point) {
  Mat3 f;
  const Vec3* g = rule.gradients + point * rule.nodes;
  for (size_t a = 0; a < rule.nodes; ++a) {
    f.m[0] += x[a].x * g[a].x, f.m[1] += x[a].x * g[a].y, f.m[2] += x[a].x * g[a].z;
    f.m[3] += x[a].y * g[a].x, f.m[4] += x[a].y * g[a].y, f.m[5] += x[a].y * g[a].z;
    f.m[6] += x[a].z * g[a].x, f.m[7] += x[a].z * g[a].y, f.m[8] += x[a].z * g[a].z;
  }
  if (rule.across != Across::space) f.m[8] = 1;
  return f;
}

// Axes of a membrane with gradient F: along the image of the first coordinate, across it in the tangent
// plane, and the normal. A membrane collapsed to a line or a point gets arbitrary ones.
Mat3 frame_of(const Mat3& f) {
  const auto unit = [](const Vec3& v, const Vec3& otherwise) {
    const double size = norm(v);
    return size > 0 ? v / size : otherwise;
  };
  const Vec3 e = unit(f.column(0), {1, 0, 0});
  const Vec3 aside = std::abs(e.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 n = unit(cross(e, f.column(1)), normalized(cross(e, aside))), t = cross(n, e);
  return {{e.x, t.x, n.x, e.y, t.y, n.y, e.z, t.z, n.z}};
}

// F in that frame: upper triangular, with the thickness unchanged.
Mat3 seen_in(const Mat3& frame, const Mat3& f) {
  Mat3 out = transposed(frame) * f;
  out.m[2] = out.m[5] = out.m[6] = out.m[7] = 0, out.m[8] = 1;
  return out;
}

bool is_thin(Across across) {
  return across == Across::plane_stress || across == Across::membrane;
}

// F_zz with P_zz = 0: Newton's method from 1, halved towards 0 and never below it.
double free_thickness(const Material& material, Mat3 f) {
  constexpr int kMost = 60;
  constexpr double kAccurate = 1e-14;
  for (int k = 0; k < kMost; ++k) {
    Response r;
    Curvature c;
    respond(material, f, r, &c);
    const Volumetric u = volumetric(material, r.theta);
    const double p = r.p.m[8] + u.du * r.dtheta.m[8];
    const double dp = c.shape[80] + u.du * c.theta[80] + u.ddu * r.dtheta.m[8] * r.dtheta.m[8];
    const double step = dp > 0 ? -p / dp : p > 0 ? -0.5 * f.m[8] : f.m[8];
    const double next = std::clamp(f.m[8] + step, 0.5 * f.m[8], 2 * f.m[8] + 1);
    const double moved = std::abs(next - f.m[8]);
    f.m[8] = next;
    if (moved <= kAccurate * next) break;
  }
  return f.m[8];
}

// Derivatives with F_zz eliminated: K - k k^T / K_zz.
void condense(Mat9& h) {
  const double stiff = h[80];
  if (!(stiff > 0)) return;
  std::array<double, 9> across;
  for (size_t k = 0; k < 9; ++k) across[k] = h[9 * k + 8];
  for (size_t k = 0; k < 9; ++k) {
    for (size_t l = 0; l < 9; ++l) h[9 * k + l] -= across[k] * across[l] / stiff;
  }
}

// Derivatives of a membrane in space from those in its frame: out of plane only its stress resists,
//   d2 psi (n (x) v) = v . S v,  S = F^-1 P   (with Definite, its tensile part).
Mat9 turned_membrane(const Mat3& frame, const Mat3& f, const Mat3& p, Definite definite, const Mat9& flat) {
  const double det = f(0, 0) * f(1, 1) - f(0, 1) * f(1, 0);
  double s00 = 0, s01 = 0, s11 = 0;
  if (std::abs(det) > 0) {
    s00 = (f(1, 1) * p(0, 0) - f(0, 1) * p(1, 0)) / det;
    s01 = (f(1, 1) * p(0, 1) - f(0, 1) * p(1, 1)) / det;
    s11 = (f(0, 0) * p(1, 1) - f(1, 0) * p(0, 1)) / det;
  }
  if (definite == Definite::yes) {
    const double middle = 0.5 * (s00 + s11), half = std::sqrt(0.25 * (s00 - s11) * (s00 - s11) + s01 * s01);
    const double high = std::max(middle + half, 0.0), low = std::max(middle - half, 0.0);
    // The matrix with these eigenvalues and the same axes.
    const double tilt = half > 0 ? 0.5 * (high - low) / half : 0, mean = 0.5 * (high + low);
    s00 = mean + tilt * (s00 - middle), s11 = mean + tilt * (s11 - middle), s01 *= tilt;
  }
  Mat9 local{};
  for (size_t r = 0; r < 2; ++r) {
    for (size_t c = 0; c < 2; ++c) {
      for (size_t i = 0; i < 2; ++i) {
        for (size_t j = 0; j < 2; ++j) local[9 * (3 * r + c) + 3 * i + j] = flat[9 * (3 * r + c) + 3 * i + j];
      }
    }
  }
  local[9 * 6 + 6] = s00, local[9 * 6 + 7] = local[9 * 7 + 6] = s01, local[9 * 7 + 7] = s11;
  Mat9 half{}, out{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t c = 0; c < 2; ++c) {
      for (size_t l = 0; l < 9; ++l) {
        for (size_t r = 0; r < 3; ++r) half[9 * (3 * i + c) + l] += frame(i, r) * local[9 * (3 * r + c) + l];
      }
    }
  }
  for (size_t k = 0; k < 9; ++k) {
    for (size_t i = 0; i < 3; ++i) {
      for (size_t c = 0; c < 2; ++c) {
        for (size_t r = 0; r < 3; ++r) out[9 * k + 3 * i + c] += frame(i, r) * half[9 * k + 3 * r + c];
      }
    }
  }
  return out;
}

double mean_theta(const CellRule& rule, const Response* at) {
  double whole = 0, sum = 0;
  for (size_t q = 0; q < rule.points; ++q) whole += rule.weights[q], sum += rule.weights[q] * at[q].theta;
  return sum / whole;
}

// k_ab += w grad N_a . h . grad N_b
void add_point(const CellRule& rule, const Vec3* g, double w, const Mat9& h, double* k) {
  for (size_t b = 0; b < rule.nodes; ++b) {
    // Column c of h . (e_c (x) grad N_b), as nine numbers.
    double t[3][9];
    for (size_t c = 0; c < 3; ++c) {
      for (size_t i = 0; i < 9; ++i) {
        const double* row = h.data() + 9 * i + 3 * c;
        t[c][i] = w * (row[0] * g[b].x + row[1] * g[b].y + row[2] * g[b].z);
      }
    }
    for (size_t a = 0; a <= b; ++a) {
      double* block = k + 9 * (a * rule.nodes + b);
      for (size_t c = 0; c < 3; ++c) {
        for (size_t r = 0; r < 3; ++r) {
          block[3 * c + r] += g[a].x * t[c][3 * r] + g[a].y * t[c][3 * r + 1] + g[a].z * t[c][3 * r + 2];
        }
      }
    }
  }
}

void mirror(size_t nodes, double* k) {
  for (size_t b = 0; b < nodes; ++b) {
    for (size_t a = 0; a < b; ++a) {
      const double* from = k + 9 * (a * nodes + b);
      double* to = k + 9 * (b * nodes + a);
      for (size_t c = 0; c < 3; ++c) {
        for (size_t r = 0; r < 3; ++r) to[3 * c + r] = from[3 * r + c];
      }
    }
  }
}

// What the mean volume's part of the stiffness needs from the points.
struct Pulls {
  std::array<Vec3, kMostNodes> slope_of_mean;
  double volume;
  Volumetric u;
};

}  // namespace

Mat3 deformation(const Material& material, const CellRule& rule, const Vec3* x, size_t point) {
  if (rule.modes > 0) {
    const RelaxedCell inner(material, rule, x);
    return deformation(material, inner.rule(), inner.x(), point);
  }
  Mat3 f = gradient_of(rule, x, point);
  if (rule.across == Across::membrane) f = seen_in(frame_of(f), f);
  if (is_thin(rule.across)) f.m[8] = free_thickness(material, f);
  return f;
}

double cell_forces(const Material& material, const CellRule& rule, const Vec3* x, Vec3* forces) {
  if (rule.modes > 0) return RelaxedCell(material, rule, x).forces(material, forces);
  std::array<Response, kMostPoints> at;
  double energy = 0;
  for (size_t q = 0; q < rule.points; ++q) {
    respond(material, deformation(material, rule, x, q), at[q], nullptr);
    energy += rule.weights[q] * at[q].energy;
  }
  Volumetric u{};
  if (rule.mean_volume) u = volumetric(material, mean_theta(rule, at.data()));
  for (size_t q = 0; q < rule.points; ++q) {
    const double w = rule.weights[q];
    if (!rule.mean_volume) u = volumetric(material, at[q].theta);
    energy += w * u.u;
    if (!forces) continue;
    Mat3 p = w * (at[q].p + u.du * at[q].dtheta);
    if (rule.across == Across::membrane) p = frame_of(gradient_of(rule, x, q)) * p;
    const Vec3* g = rule.gradients + q * rule.nodes;
    for (size_t a = 0; a < rule.nodes; ++a) forces[a] -= p * g[a];
  }
  return energy;
}

namespace {

// For isotropic laws in space and in plane strain; with mean volume, U'' is left out of the points.
Pulls add_definite_points(const Material& material, const CellRule& rule, const Vec3* x, double* k) {
  std::array<Svd3, kMostPoints> svd;
  std::array<PrincipalTheta, kMostPoints> theta;
  Pulls out{};
  double mean = 0;
  for (size_t q = 0; q < rule.points; ++q) {
    svd[q] = svd3(deformation(material, rule, x, q));
    theta[q] = principal_theta(material, svd[q].s);
    out.volume += rule.weights[q], mean += rule.weights[q] * theta[q].theta;
  }
  if (rule.mean_volume) out.u = volumetric(material, mean / out.volume);
  for (size_t q = 0; q < rule.points; ++q) {
    const double w = rule.weights[q];
    const std::span g(rule.gradients + q * rule.nodes, rule.nodes);
    const Volumetric u = rule.mean_volume ? out.u : volumetric(material, theta[q].theta);
    PrincipalSlope h = principal_slope(material, svd[q].s, {u, !rule.mean_volume});
    clamp(h);
    add_stiffness(h, svd[q], g, w, k);
    if (!rule.mean_volume) continue;
    const auto& t = theta[q].slope;
    const Mat3 dtheta = svd[q].u * Mat3::diagonal(t[0], t[1], t[2]) * transposed(svd[q].v);
    for (size_t a = 0; a < rule.nodes; ++a) out.slope_of_mean[a] += w * (dtheta * g[a]);
  }
  return out;
}

// For the linear law: lambda grad N_a (x) grad N_b (left out of the points with mean volume)
//   + mu grad N_b (x) grad N_a + mu grad N_a . grad N_b.
Pulls add_linear_points(const Material& material, const CellRule& rule, double* k) {
  Pulls out{};
  out.u = volumetric(material, 0);
  for (size_t q = 0; q < rule.points; ++q) {
    const double w = rule.weights[q], mu = w * material.mu, lambda = rule.mean_volume ? 0 : w * out.u.ddu;
    const Vec3* g = rule.gradients + q * rule.nodes;
    out.volume += w;
    for (size_t b = 0; b < rule.nodes; ++b) {
      const double right[] = {g[b].x, g[b].y, g[b].z};
      for (size_t a = 0; a <= b; ++a) {
        const double left[] = {g[a].x, g[a].y, g[a].z}, both = mu * dot(g[a], g[b]);
        double* block = k + 9 * (a * rule.nodes + b);
        for (size_t c = 0; c < 3; ++c) {
          for (size_t r = 0; r < 3; ++r) {
            block[3 * c + r] += lambda * left[r] * right[c] + mu * right[r] * left[c];
          }
          block[4 * c] += both;
        }
      }
      out.slope_of_mean[b] += w * g[b];
    }
  }
  return out;
}

Pulls add_points(const Material& material, const CellRule& rule, const Vec3* x, Definite definite,
                 double* k) {
  std::array<Response, kMostPoints> at;
  std::array<Mat3, kMostPoints> f;
  Pulls out{};
  for (size_t q = 0; q < rule.points; ++q) {
    f[q] = deformation(material, rule, x, q);
    respond(material, f[q], at[q], nullptr);
    out.volume += rule.weights[q];
  }
  if (rule.mean_volume) out.u = volumetric(material, mean_theta(rule, at.data()));
  for (size_t q = 0; q < rule.points; ++q) {
    const Dilatation d{rule.mean_volume ? out.u : volumetric(material, at[q].theta), !rule.mean_volume};
    Mat9 h = definite == Definite::yes ? definite_slope(material, f[q], d) : slope(material, f[q], d);
    if (is_thin(rule.across)) condense(h);
    if (rule.across == Across::membrane) {
      const Mat3 p = at[q].p + d.u.du * at[q].dtheta;
      h = turned_membrane(frame_of(gradient_of(rule, x, q)), f[q], p, definite, h);
    }
    const Vec3* g = rule.gradients + q * rule.nodes;
    add_point(rule, g, rule.weights[q], h, k);
    for (size_t a = 0; a < rule.nodes; ++a) out.slope_of_mean[a] += rule.weights[q] * (at[q].dtheta * g[a]);
  }
  return out;
}

}  // namespace

void cell_stiffness(const Material& material, const CellRule& rule, const Vec3* x, Definite definite,
                    double* k) {
  if (rule.modes > 0) return RelaxedCell(material, rule, x).stiffness(material, definite, k);
  std::fill_n(k, 9 * rule.nodes * rule.nodes, 0.0);
  const bool linear = material.law == Law::linear, condensed = is_thin(rule.across);
  const Pulls pulls = condensed                   ? add_points(material, rule, x, definite, k)
                      : linear                    ? add_linear_points(material, rule, k)
                      : definite == Definite::yes ? add_definite_points(material, rule, x, k)
                                                  : add_points(material, rule, x, definite, k);
  if (rule.mean_volume) {
    // V U''(mean) (d mean / dx) (d mean / dx)^T
    const double curved = pulls.u.ddu;
    const double stiff = (definite == Definite::yes ? std::max(curved, 0.0) : curved) / pulls.volume;
    for (size_t a = 0; a < rule.nodes; ++a) {
      const double left[] = {pulls.slope_of_mean[a].x, pulls.slope_of_mean[a].y, pulls.slope_of_mean[a].z};
      for (size_t b = a; b < rule.nodes; ++b) {
        const double right[] = {pulls.slope_of_mean[b].x, pulls.slope_of_mean[b].y, pulls.slope_of_mean[b].z};
        double* block = k + 9 * (a * rule.nodes + b);
        for (size_t c = 0; c < 3; ++c) {
          for (size_t r = 0; r < 3; ++r) block[3 * c + r] += stiff * left[r] * right[c];
        }
      }
    }
  }
  mirror(rule.nodes, k);
}

void cell_node(const Material& material, const CellRule& rule, const Vec3* x, size_t a, Vec3& force,
               double* k) {
  for (size_t q = 0; q < rule.points; ++q) {
    const double w = rule.weights[q];
    const Vec3 g = rule.gradients[q * rule.nodes + a];
    const Mat3 f = gradient_of(rule, x, q);
    Response at;
    respond(material, f, at, nullptr);
    const Volumetric u = volumetric(material, at.theta);
    force -= (w * (at.p + u.du * at.dtheta)) * g;
    if (material.law != Law::linear) {
      const Svd3 svd = svd3(f);
      PrincipalSlope h = principal_slope(material, svd.s, {u, true});
      clamp(h);
      add_stiffness(h, svd, {&g, 1}, w, k);
      continue;
    }
    const double along[] = {g.x, g.y, g.z};
    for (size_t c = 0; c < 3; ++c) {
      for (size_t r = 0; r < 3; ++r) k[3 * c + r] += w * (u.ddu + material.mu) * along[r] * along[c];
      k[4 * c] += w * material.mu * norm2(g);
    }
  }
}

}  // namespace truestep::fem
