#include "engine/systems/sph/solvers/divergence.h"

#include <algorithm>
#include <cmath>

#include "engine/systems/sph/neighbours.h"

namespace truestep::sph {

/// trace(A B^-1); 0 where B, of some 1 for a particle with all neighbours, is nearly singular.
template <int D>
double trace_of_quotient(const double A[9], const double B[9]) {
  constexpr double kSingular = 0.02;
  if constexpr (D == 2) {
    const double det = B[0] * B[4] - B[1] * B[3];
    if (!(det > kSingular)) return 0;
    return (A[0] * B[4] - A[1] * B[3] - A[3] * B[1] + A[4] * B[0]) / det;
  } else {
    double inverse[9];
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) {
        const int a = (c + 1) % 3, b = (c + 2) % 3, d = (r + 1) % 3, e = (r + 2) % 3;
        inverse[3 * r + c] = B[3 * a + d] * B[3 * b + e] - B[3 * a + e] * B[3 * b + d];
      }
    }
    const double det = B[0] * inverse[0] + B[1] * inverse[3] + B[2] * inverse[6];
    if (!(det > kSingular)) return 0;
    double sum = 0;
    for (int r = 0; r < 3; ++r) {
      for (int k = 0; k < 3; ++k) sum += A[3 * r + k] * inverse[3 * k + r];
    }
    return sum / det;
  }
}

template <int D, class T>
double largest_divergence(Fluid<D, T>& f, const T* velocity, const ThreadArena& arena) {
  using W = Wide<T>;
  for (size_t k = 0; k < f.n; ++k) {
    std::copy_n(velocity + 3 * f.row(k), 3, f.v.data() + 4 * k);
    f.v[4 * k + 3] = 0;
  }
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W flow[D][D], place[D][D];
    for (size_t a = 0; a < D; ++a) {
      for (size_t b = 0; b < D; ++b) flow[a][b] = place[a][b] = W::zero();
    }
    for (size_t k = begin; k < end; k += W::kLanes) {
      W u[4];
      c.rows_of(f.v, k, u);
      for (size_t b = 0; b < D; ++b) {
        const W g = c.gradient(b, k);
        for (size_t a = 0; a < D; ++a) {
          flow[a][b] = madd(g, u[a] - W::all(f.v[4 * i + a]), flow[a][b]);
          place[a][b] = madd(g, f.nearest_image(a, c.of(f.x[a], k) - W::all(f.x[a][i])), place[a][b]);
        }
      }
    }
    double A[9] = {}, B[9] = {};
    for (size_t a = 0; a < D; ++a) {
      for (size_t b = 0; b < D; ++b) {
        A[3 * a + b] = double{f.unit * sum(flow[a][b])}, B[3 * a + b] = double{f.unit * sum(place[a][b])};
      }
    }
    f.push[i] = static_cast<T>(std::abs(trace_of_quotient<D>(A, B)));
  });
  const auto last = f.push.begin() + static_cast<std::ptrdiff_t>(f.n);
  return f.n > 0 ? double{*std::max_element(f.push.begin(), last)} : 0;
}

template double largest_divergence(Fluid<2, float>&, const float*, const ThreadArena&);
template double largest_divergence(Fluid<3, float>&, const float*, const ThreadArena&);
template double largest_divergence(Fluid<2, double>&, const double*, const ThreadArena&);
template double largest_divergence(Fluid<3, double>&, const double*, const ThreadArena&);

}  // namespace truestep::sph
