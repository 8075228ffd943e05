#include "engine/integrators/explicit/tableau_dop853.h"

namespace truestep {

void dop853_dense_stage(size_t e, size_t n, double h, const double* y, const double* const* k, double* out) {
  for (size_t i = 0; i < n; ++i) {
    double sum = 0;
    for (size_t j = 0; j < 13 + e; ++j) sum += kDop853Dense.a[e][j] * k[j][i];
    out[i] = y[i] + h * sum;
  }
}

// Hairer's CONTD8: y + s(r0 + r(r1 + s(r2 + r(r3 + s(r4 + r(r5 + s r6)))))), s = theta, r = 1 - theta.
void dop853_between(size_t n, double h, double theta, const double* y0, const double* y1,
                    const double* const* k, double* y) {
  const double *k0 = k[0], *k1 = k[12];
  const double s = theta, r = 1 - theta;
  for (size_t i = 0; i < n; ++i) {
    double q[4] = {};
    for (size_t p = 0; p < 4; ++p) {
      for (size_t j = 0; j < 16; ++j) q[p] += kDop853Dense.dense[p][j] * k[j][i];
      q[p] *= h;
    }
    const double rise = y1[i] - y0[i], bend = h * k0[i] - rise;
    const double skew = 2 * rise - h * (k1[i] + k0[i]);
    y[i] = y0[i] + s * (rise + r * (bend + s * (skew + r * (q[0] + s * (q[1] + r * (q[2] + s * q[3]))))));
  }
}

}  // namespace truestep
