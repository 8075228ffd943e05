// What is read off the gradient of the velocity: eddies that are driven (vorticity.h), and divergence.
#include <algorithm>
#include <cmath>

#include "engine/systems/sph/neighbours.h"
#include "engine/systems/sph/solvers/divergence.h"
#include "engine/systems/sph/solvers/passes.h"
#include "engine/systems/sph/solvers/vorticity.h"

namespace truestep::sph {

template <int D, class T>
void confine_vorticity(Fluid<D, T>& f, T strength, T spacing, T h, const ThreadArena& arena) {
  using W = Wide<T>;
  f.omega.resize(4 * f.n);
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W curl[3] = {W::zero(), W::zero(), W::zero()};
    for (size_t k = begin; k < end; k += W::kLanes) {
      W u[4], g[3] = {W::zero(), W::zero(), W::zero()};
      c.rows_of(f.v, k, u);
      for (size_t a = 0; a < 3; ++a) u[a] = u[a] - W::all(f.v[4 * i + a]);
      for (size_t a = 0; a < D; ++a) g[a] = c.gradient(a, k);
      curl[0] += g[1] * u[2] - g[2] * u[1];
      curl[1] += g[2] * u[0] - g[0] * u[2];
      curl[2] += g[0] * u[1] - g[1] * u[0];
    }
    T* o = f.omega.data() + 4 * i;
    for (size_t a = 0; a < 3; ++a) o[a] = f.unit * sum(curl[a]);
    o[3] = std::sqrt(o[0] * o[0] + o[1] * o[1] + o[2] * o[2]);
  });
  f.each(arena, [&](size_t i, const Chunk<T>& c, size_t begin, size_t end) {
    W eta[D];
    for (auto& e : eta) e = W::zero();
    const T* o = f.omega.data() + 4 * i;
    for (size_t k = begin; k < end; k += W::kLanes) {
      W other[4];
      c.rows_of(f.omega, k, other);
      for (size_t a = 0; a < D; ++a) eta[a] = madd(c.gradient(a, k), other[3] - W::all(o[3]), eta[a]);
    }
    T n[3] = {};
    for (size_t a = 0; a < D; ++a) n[a] = sum(eta[a]);
    const T length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    const T scale = length > 0 ? strength * spacing / length : T{0};
    T* out = f.a.data() + 4 * i;
    out[0] = scale * (n[1] * o[2] - n[2] * o[1]);
    out[1] = scale * (n[2] * o[0] - n[0] * o[2]);
    out[2] = D == 3 ? scale * (n[0] * o[1] - n[1] * o[0]) : T{0};
    out[3] = 0;
  });
  kick(f, h, arena);
}

template void confine_vorticity(Fluid<2, float>&, float, float, float, const ThreadArena&);
template void confine_vorticity(Fluid<3, float>&, float, float, float, const ThreadArena&);
template void confine_vorticity(Fluid<2, double>&, double, double, double, const ThreadArena&);
template void confine_vorticity(Fluid<3, double>&, double, double, double, const ThreadArena&);

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
