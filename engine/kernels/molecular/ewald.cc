#include "engine/kernels/molecular/ewald.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/math/trig.h"
#include "engine/math/wide.h"

namespace truestep::molecular {
namespace {

constexpr double kHalfTurn = 3.141592653589793, kTurn = 6.283185307179586;

using W = Wide<double>;
W load(const double* p) {
  W w;
  std::memcpy(&w.v, p, sizeof w.v);
  return w;
}

double component(const Vec3& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

}  // namespace

EwaldSetting ewald_setting(double coulomb, double cutoff, double accuracy) {
  const double ends = std::sqrt(-trig::log(accuracy));
  return {coulomb, ends / cutoff, 2 * ends * ends / cutoff};
}

void EwaldSum::plan(const EwaldSetting& s, const Vec3& edges) {
  if (s == planned_ && edges == edges_) return;
  planned_ = s, edges_ = edges;
  rows_.clear(), weight_.clear(), waves_ = 0;
  const double volume = edges.x * edges.y * edges.z;
  for (int a = 0; a < 3; ++a) most_[a] = static_cast<int>(s.k_max * component(edges, a) / kTurn);
  for (int nx = 0; nx <= most_[0]; ++nx) {
    for (int ny = nx == 0 ? 0 : -most_[1]; ny <= most_[1]; ++ny) {
      const double kx = kTurn * nx / edges.x, ky = kTurn * ny / edges.y;
      const double left = s.k_max * s.k_max - kx * kx - ky * ky;
      if (left < 0) continue;
      const int nz = static_cast<int>(std::sqrt(left) * edges.z / kTurn);
      const int from = nx == 0 && ny == 0 ? 1 : -nz;
      if (from > nz) continue;
      rows_.push_back({nx, ny, from, nz + 1, waves_});
      for (int n = from; n <= nz; ++n, ++waves_) {
        const double kz = kTurn * n / edges.z, k2 = kx * kx + ky * ky + kz * kz;
        weight_.push_back(2 * kTurn * s.coulomb / volume * trig::exp(-k2 / (4 * s.alpha * s.alpha)) / k2);
      }
    }
  }
}

void EwaldSum::fill(const Vec3& edges, std::span<const double> x, size_t begin, size_t end, Tables& t) const {
  for (int a = 0; a < 3; ++a) {
    const size_t rows = static_cast<size_t>(most_[a]) + 1;
    t.c[a].resize(std::max(t.c[a].size(), rows * kBlock)),
        t.s[a].resize(std::max(t.s[a].size(), rows * kBlock));
    double *c = t.c[a].data(), *s = t.s[a].data();
    for (size_t i = begin; i < end; ++i) {
      const double share = x[3 * i + static_cast<size_t>(a)] / component(edges, a);
      const trig::SinCos one = trig::sincos(kTurn * (share - std::floor(share)));
      double re = 1, im = 0;
      for (size_t n = 0; n < rows; ++n) {
        c[n * kBlock + i - begin] = re, s[n * kBlock + i - begin] = im;
        const double next = re * one.cos - im * one.sin;
        im = re * one.sin + im * one.cos, re = next;
      }
    }
  }
}

EwaldEnergy EwaldSum::add(const EwaldSetting& setting, const Vec3& edges, std::span<const double> x,
                          std::span<const double> charge, std::span<double> force, const ThreadArena& arena) {
  plan(setting, edges);
  const size_t n = charge.size(), blocks = (n + kBlock - 1) / kBlock;
  tables_.resize(std::max(tables_.size(), blocks));
  sums_.resize(std::max(sums_.size(), 2 * waves_ * blocks));
  // exp(i (kx x + ky y)) of a block, times charge.
  struct Plane {
    double c[kBlock], s[kBlock];
  };
  const auto plane = [&](const Row& row, const Tables& t, const double* q, size_t m, Plane& p) {
    const double *cx = t.c[0].data() + static_cast<size_t>(row.nx) * kBlock,
                 *sx = t.s[0].data() + static_cast<size_t>(row.nx) * kBlock;
    const size_t ny = static_cast<size_t>(std::abs(row.ny));
    const double *cy = t.c[1].data() + ny * kBlock, *sy = t.s[1].data() + ny * kBlock;
    const double sign = row.ny < 0 ? -1 : 1;
    for (size_t i = 0; i < m; ++i) {
      const double s = sign * sy[i];
      p.c[i] = q[i] * (cx[i] * cy[i] - sx[i] * s), p.s[i] = q[i] * (sx[i] * cy[i] + cx[i] * s);
    }
    for (size_t i = m; i < kBlock; ++i) p.c[i] = p.s[i] = 0;
  };
  arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
    Tables& t = tables_[begin / kBlock];
    fill(edges, x, begin, end, t);
    double* out = sums_.data() + 2 * waves_ * (begin / kBlock);
    Plane p;
    const size_t fours = (end - begin + 3) / 4 * 4;
    for (const Row& row : rows_) {
      plane(row, t, charge.data() + begin, end - begin, p);
      for (int nz = row.from; nz < row.to; ++nz) {
        const size_t at = static_cast<size_t>(std::abs(nz)) * kBlock;
        const double *cz = t.c[2].data() + at, *sz = t.s[2].data() + at;
        const W sign(nz < 0 ? -1.0 : 1.0);
        W re = W::zero(), im = W::zero();
        for (size_t i = 0; i < fours; i += 4) {
          const W c = load(cz + i), s = load(sz + i) * sign, pc = load(p.c + i), ps = load(p.s + i);
          re = madd(pc, c, nmadd(ps, s, re)), im = madd(ps, c, madd(pc, s, im));
        }
        double* wave = out + 2 * (row.first + static_cast<size_t>(nz - row.from));
        wave[0] = (re[0] + re[1]) + (re[2] + re[3]), wave[1] = (im[0] + im[1]) + (im[2] + im[3]);
      }
    }
  });
  for (size_t b = 1; b < blocks; ++b) {
    for (size_t k = 0; k < 2 * waves_; ++k) sums_[k] += sums_[2 * waves_ * b + k];
  }
  EwaldEnergy out;
  for (const Row& row : rows_) {
    for (int nz = row.from; nz < row.to; ++nz) {
      const size_t k = row.first + static_cast<size_t>(nz - row.from);
      const Vec3 wave{kTurn * row.nx / edges.x, kTurn * row.ny / edges.y, kTurn * nz / edges.z};
      const double u = weight_[k] * (sums_[2 * k] * sums_[2 * k] + sums_[2 * k + 1] * sums_[2 * k + 1]);
      out.energy += u, out.virial += u * (1 - norm2(wave) / (2 * setting.alpha * setting.alpha));
    }
  }
  double squares = 0, net = 0;
  for (const double q : charge) squares += q * q, net += q;
  const double volume = edges.x * edges.y * edges.z;
  const double background =
      -kHalfTurn * setting.coulomb * net * net / (2 * volume * setting.alpha * setting.alpha);
  out.energy += background - setting.coulomb * setting.alpha / std::sqrt(kHalfTurn) * squares;
  out.virial += 3 * background;
  if (force.empty()) return out;
  arena.for_blocks(n, kBlock, [&](size_t begin, size_t end) {
    const Tables& t = tables_[begin / kBlock];
    double fx[kBlock] = {}, fy[kBlock] = {}, fz[kBlock] = {};
    Plane p;
    const size_t fours = (end - begin + 3) / 4 * 4;
    for (const Row& row : rows_) {
      plane(row, t, charge.data() + begin, end - begin, p);
      const double kx = kTurn * row.nx / edges.x, ky = kTurn * row.ny / edges.y;
      for (int nz = row.from; nz < row.to; ++nz) {
        const size_t k = row.first + static_cast<size_t>(nz - row.from),
                     at = static_cast<size_t>(std::abs(nz)) * kBlock;
        const double *cz = t.c[2].data() + at, *sz = t.s[2].data() + at;
        const double sign = nz < 0 ? -1 : 1, kz = kTurn * nz / edges.z;
        const double re = 2 * weight_[k] * sums_[2 * k], im = 2 * weight_[k] * sums_[2 * k + 1];
        for (size_t i = 0; i < fours; ++i) {
          const double s = sign * sz[i];
          const double pull = re * (p.s[i] * cz[i] + p.c[i] * s) - im * (p.c[i] * cz[i] - p.s[i] * s);
          fx[i] += kx * pull, fy[i] += ky * pull, fz[i] += kz * pull;
        }
      }
    }
    for (size_t i = begin; i < end; ++i) {
      force[3 * i] += fx[i - begin], force[3 * i + 1] += fy[i - begin], force[3 * i + 2] += fz[i - begin];
    }
  });
  return out;
}

}  // namespace truestep::molecular
