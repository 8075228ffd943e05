#include "engine/kernels/molecular/mesh_ewald.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"

namespace truestep::molecular {
namespace {

constexpr double kMeshHalfTurn = 3.141592653589793, kMeshTurn = 6.283185307179586;
constexpr size_t kAtoms = 256;  // of a block

double component(const Vec3& v, size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// The smallest number of at least n whose prime factors are 2, 3 and 5.
size_t smooth_number(size_t n) {
  for (;; ++n) {
    size_t left = n;
    for (const size_t prime : {2, 3, 5}) {
      while (left % prime == 0) left /= prime;
    }
    if (left == 1) return n;
  }
}

/// M_p(w + j) and its slope for j = 0 ... p - 1 by the recursion of eqs. 4.1 and 4.2, stored from the last to
/// the first, so that they belong to mesh points in ascending order.
void splines(double w, size_t p, double* weight, double* slope) {
  double m[8] = {w, 1 - w};
  for (size_t n = 3; n <= p; ++n) {
    if (n == p) {
      slope[p - 1] = m[0], slope[0] = -m[p - 2];
      for (size_t j = 1; j + 1 < p; ++j) slope[p - 1 - j] = m[j] - m[j - 1];
    }
    const double d = 1 / static_cast<double>(n - 1), order = static_cast<double>(n);
    m[n - 1] = d * (1 - w) * m[n - 2];
    for (size_t j = n - 2; j > 0; --j) {
      const double at = w + static_cast<double>(j);
      m[j] = d * (at * m[j] + (order - at) * m[j - 1]);
    }
    m[0] = d * w * m[0];
  }
  for (size_t j = 0; j < p; ++j) weight[p - 1 - j] = m[j];
}

size_t wave_number(size_t m, size_t points) {
  return m <= points / 2 ? m : points - m;
}

}  // namespace

MeshSetting mesh_setting(const EwaldSetting& s, const Vec3& edges, double accuracy) {
  MeshSetting out{.ewald = s, .order = accuracy >= 2e-4 ? 4 : accuracy >= 2e-6 ? 6 : 8, .points = {}};
  // The splines' error scales as (alpha h)^p; measured against the plain sum.
  const double p = out.order, constant = out.order == 4 ? 1.3 : out.order == 6 ? 1.5 : 1.45;
  const double h = constant * trig::pow(accuracy, 1 / p) / s.alpha;
  for (size_t a = 0; a < 3; ++a) {
    const double wanted = std::min(component(edges, a) / h, 4096.0);
    out.points[a] =
        smooth_number(std::max(static_cast<size_t>(wanted) + 1, 2 * static_cast<size_t>(out.order)));
  }
  return out;
}

void MeshEwald::plan(const MeshSetting& s, const Vec3& edges) {
  edges_ = edges;
  if (s == planned_) return;
  planned_ = s;
  const auto& k = s.points;
  ffts_.clear();
  for (const size_t n : k) ffts_.emplace_back(n);
  const auto p = static_cast<size_t>(s.order);
  double weight[kMostOrder], slope[kMostOrder];
  splines(0, p, weight, slope);  // M_p(j) at p - 1 - j
  for (size_t a = 0; a < 3; ++a) {
    moduli_[a].resize(k[a]);
    for (size_t m = 0; m < k[a]; ++m) {
      double re = 0, im = 0;
      for (size_t j = 0; j + 1 < p; ++j) {
        const trig::SinCos c =
            trig::sincos(kMeshTurn * static_cast<double>(m * j % k[a]) / static_cast<double>(k[a]));
        re += weight[p - 2 - j] * c.cos, im += weight[p - 2 - j] * c.sin;
      }
      moduli_[a][m] = 1 / (re * re + im * im);
    }
  }
  const auto up = [](size_t n) { return (n + kLanes - 1) / kLanes * kLanes; };
  z_stride_ = up(k[2]), half_ = k[2] / 2 + 1, h_stride_ = up(half_);
  mesh_.assign(k[0] * k[1] * z_stride_, 0);
  re_.assign(k[0] * k[1] * h_stride_, 0), im_.assign(re_.size(), 0);
  const size_t longest = std::max({k[0], k[1], k[2]});
  lines_.resize(std::max(k[0], k[1]));
  for (Line& l : lines_) {
    l.data.resize(longest * Fft::kElement);
    l.scratch.resize(std::max({ffts_[0].scratch_size(), ffts_[1].scratch_size(), ffts_[2].scratch_size()}));
  }
  sums_.resize(k[0]);
}

void MeshEwald::place(const Vec3& edges, std::span<const double> x, const ThreadArena& arena) {
  const size_t n = x.size() / 3, p = static_cast<size_t>(planned_.order);
  spread_.resize(n), by_plane_.resize(n), starts_.resize(planned_.points[0] + 1);
  arena.for_blocks(n, kAtoms, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Spread& s = spread_[i];
      for (size_t a = 0; a < 3; ++a) {
        const auto points = static_cast<double>(planned_.points[a]);
        const double share = x[3 * i + a] / component(edges, a), u = (share - std::floor(share)) * points;
        // Rounding may bring u to K itself; NaN goes to 0.
        const double cell = u >= 0 ? std::min(std::floor(u), points - 1) : 0;
        s.last[a] = static_cast<uint32_t>(cell);
        splines(u - cell, p, s.weight[a].data(), s.slope[a].data());
      }
    }
  });
  std::fill(starts_.begin(), starts_.end(), 0);
  for (const Spread& s : spread_) ++starts_[s.last[0] + 1];
  for (size_t b = 1; b < starts_.size(); ++b) starts_[b] += starts_[b - 1];
  for (size_t i = 0; i < n; ++i) by_plane_[starts_[spread_[i].last[0]]++] = static_cast<uint32_t>(i);
  for (size_t b = starts_.size() - 1; b > 0; --b) starts_[b] = starts_[b - 1];
  starts_[0] = 0;
}

template <size_t P>
void MeshEwald::spread(std::span<const double> charge, const ThreadArena& arena) {
  const auto [kx, ky, kz] = planned_.points;
  arena.for_blocks(kx, 1, [&, kx = kx, ky = ky, kz = kz](size_t begin, size_t end) {
    for (size_t plane = begin; plane < end; ++plane) {
      double* mesh = mesh_.data() + plane * ky * z_stride_;
      std::fill_n(mesh, ky * z_stride_, 0.0);
      for (size_t j = 0; j < P; ++j) {
        const size_t last = (plane + j) % kx;
        for (uint32_t k = starts_[last]; k < starts_[last + 1]; ++k) {
          const Spread& s = spread_[by_plane_[k]];
          const double qx = charge[by_plane_[k]] * s.weight[0][P - 1 - j];
          const size_t z0 = s.last[2] + 1;  // P points end here
          for (size_t b = 0; b < P; ++b) {
            const size_t y = (s.last[1] + ky + 1 - P + b) % ky;
            const double qy = qx * s.weight[1][b];
            double* row = mesh + y * z_stride_;
            if (z0 >= P) {
              for (size_t c = 0; c < P; ++c) row[z0 - P + c] += qy * s.weight[2][c];
            } else {
              for (size_t c = 0; c < P; ++c) row[(z0 + kz - P + c) % kz] += qy * s.weight[2][c];
            }
          }
        }
      }
    }
  });
}

template <size_t P>
void MeshEwald::gather(const Vec3& edges, std::span<const double> charge, const ThreadArena& arena) {
  const auto [kx, ky, kz] = planned_.points;
  const Vec3 by_length{static_cast<double>(kx) / edges.x, static_cast<double>(ky) / edges.y,
                       static_cast<double>(kz) / edges.z};
  arena.for_blocks(charge.size(), kAtoms, [&, kx = kx, ky = ky, kz = kz](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Spread& s = spread_[i];
      Vec3 g;
      const size_t z0 = s.last[2] + 1;
      for (size_t a = 0; a < P; ++a) {
        const double* plane = mesh_.data() + (s.last[0] + kx + 1 - P + a) % kx * ky * z_stride_;
        double value = 0, by_y = 0, by_z = 0;
        for (size_t b = 0; b < P; ++b) {
          const double* row = plane + (s.last[1] + ky + 1 - P + b) % ky * z_stride_;
          double v = 0, dv = 0;
          if (z0 >= P) {
            for (size_t c = 0; c < P; ++c) {
              v += row[z0 - P + c] * s.weight[2][c], dv += row[z0 - P + c] * s.slope[2][c];
            }
          } else {
            for (size_t c = 0; c < P; ++c) {
              const double at = row[(z0 + kz - P + c) % kz];
              v += at * s.weight[2][c], dv += at * s.slope[2][c];
            }
          }
          value += s.weight[1][b] * v, by_y += s.slope[1][b] * v, by_z += s.weight[1][b] * dv;
        }
        g += Vec3{s.slope[0][a] * value, s.weight[0][a] * by_y, s.weight[0][a] * by_z};
      }
      store3(force_.data(), i, Vec3{g.x * by_length.x, g.y * by_length.y, g.z * by_length.z} * -charge[i]);
    }
  });
}

// Transforms rows of charges, eight at a time, to waves along z.
void MeshEwald::transform_z(const ThreadArena& arena) {
  const auto [kx, ky, kz] = planned_.points;
  arena.for_blocks(kx, 1, [&, ky = ky, kz = kz](size_t plane, size_t) {
    Line& line = lines_[plane];
    for (size_t y = 0; y < ky; y += kLanes) {
      const size_t lanes = std::min(kLanes, ky - y);
      double* d = line.data.data();
      for (size_t z = 0; z < kz; ++z) {
        for (size_t l = 0; l < kLanes; ++l) {
          d[z * Fft::kElement + l] = l < lanes ? mesh_[(plane * ky + y + l) * z_stride_ + z] : 0;
          d[z * Fft::kElement + kLanes + l] = 0;
        }
      }
      ffts_[2].run(d, line.scratch.data());
      for (size_t l = 0; l < lanes; ++l) {
        double *re = re_.data() + (plane * ky + y + l) * h_stride_,
               *im = im_.data() + (plane * ky + y + l) * h_stride_;
        for (size_t m = 0; m < half_; ++m) {
          re[m] = d[m * Fft::kElement + l], im[m] = d[m * Fft::kElement + kLanes + l];
        }
      }
    }
  });
}

namespace {

/// One transform of eight neighbours along the last axis; elements are `step` doubles apart.
void transform_lanes(const Fft& fft, double* re, double* im, size_t step, double* d, double* scratch) {
  constexpr size_t kLanes = Fft::kLanes;
  for (size_t e = 0; e < fft.size(); ++e) {
    for (size_t l = 0; l < kLanes; ++l) {
      d[e * Fft::kElement + l] = re[e * step + l], d[e * Fft::kElement + kLanes + l] = im[e * step + l];
    }
  }
  fft.run(d, scratch);
  for (size_t e = 0; e < fft.size(); ++e) {
    for (size_t l = 0; l < kLanes; ++l) {
      re[e * step + l] = d[e * Fft::kElement + l], im[e * step + l] = d[e * Fft::kElement + kLanes + l];
    }
  }
}

}  // namespace

void MeshEwald::transform_y(const ThreadArena& arena) {
  const auto [kx, ky, kz] = planned_.points;
  arena.for_blocks(kx, 1, [&, ky = ky](size_t plane, size_t) {
    Line& line = lines_[plane];
    for (size_t z = 0; z < h_stride_; z += kLanes) {
      const size_t at = plane * ky * h_stride_ + z;
      transform_lanes(ffts_[1], re_.data() + at, im_.data() + at, h_stride_, line.data.data(),
                      line.scratch.data());
    }
  });
}

void MeshEwald::transform_x(const ThreadArena& arena) {
  const auto [kx, ky, kz] = planned_.points;
  arena.for_blocks(ky, 1, [&, ky = ky](size_t y, size_t) {
    Line& line = lines_[y];
    for (size_t z = 0; z < h_stride_; z += kLanes) {
      const size_t at = y * h_stride_ + z;
      transform_lanes(ffts_[0], re_.data() + at, im_.data() + at, ky * h_stride_, line.data.data(),
                      line.scratch.data());
    }
  });
}

MeshEwald::Sums MeshEwald::convolve(const Vec3& edges, const ThreadArena& arena) {
  const auto [kx, ky, kz] = planned_.points;
  const EwaldSetting& s = planned_.ewald;
  const double volume = edges.x * edges.y * edges.z, factor = 2 * kMeshTurn * s.coulomb / volume,
               damp = 1 / (4 * s.alpha * s.alpha);
  const auto square = [](size_t m, size_t points, double edge) {
    const double k = kMeshTurn * static_cast<double>(wave_number(m, points)) / edge;
    return k * k;
  };
  arena.for_blocks(kx, 1, [&, kx = kx, ky = ky, kz = kz](size_t x, size_t) {
    Sums sum;
    for (size_t y = 0; y < ky; ++y) {
      double *re = re_.data() + (x * ky + y) * h_stride_, *im = im_.data() + (x * ky + y) * h_stride_;
      const double xy = square(x, kx, edges.x) + square(y, ky, edges.y), b = moduli_[0][x] * moduli_[1][y];
      for (size_t z = 0; z < half_; ++z) {
        const double k2 = xy + square(z, kz, edges.z);
        const double w = k2 > 0 ? factor * trig::exp(-k2 * damp) / k2 * b * moduli_[2][z] : 0;
        // Waves along -z are the conjugates of those along z.
        const double twice = z == 0 || 2 * z == kz ? 1 : 2;
        const double u = 0.5 * twice * w * (re[z] * re[z] + im[z] * im[z]);
        sum.energy += u, sum.virial += u * (1 - 2 * damp * k2);
        re[z] *= w, im[z] *= -w;
      }
    }
    sums_[x] = sum;
  });
  Sums all;
  for (const Sums& sum : sums_) all.energy += sum.energy, all.virial += sum.virial;
  return all;
}

// Back to the potential at every point, which is real.
void MeshEwald::transform_z_back(const ThreadArena& arena) {
  const auto [kx, ky, kz] = planned_.points;
  arena.for_blocks(kx, 1, [&, ky = ky, kz = kz](size_t plane, size_t) {
    Line& line = lines_[plane];
    for (size_t y = 0; y < ky; y += kLanes) {
      const size_t lanes = std::min(kLanes, ky - y);
      double* d = line.data.data();
      for (size_t l = 0; l < kLanes; ++l) {
        const size_t at = (plane * ky + y + std::min(l, lanes - 1)) * h_stride_;
        for (size_t m = 0; m < half_; ++m) {
          d[m * Fft::kElement + l] = re_[at + m], d[m * Fft::kElement + kLanes + l] = im_[at + m];
        }
        for (size_t m = half_; m < kz; ++m) {
          d[m * Fft::kElement + l] = re_[at + kz - m], d[m * Fft::kElement + kLanes + l] = -im_[at + kz - m];
        }
      }
      ffts_[2].run(d, line.scratch.data());
      for (size_t l = 0; l < lanes; ++l) {
        double* row = mesh_.data() + (plane * ky + y + l) * z_stride_;
        for (size_t z = 0; z < kz; ++z) row[z] = d[z * Fft::kElement + l];
      }
    }
  });
}

EwaldEnergy MeshEwald::add(const MeshSetting& setting, const Vec3& edges, std::span<const double> x,
                           std::span<const double> charge, std::span<double> force,
                           const ThreadArena& arena) {
  plan(setting, edges);
  place(edges, x, arena);
  const auto by_order = [&](auto four, auto six, auto eight) {
    setting.order == 4 ? four() : setting.order == 6 ? six() : eight();
  };
  by_order([&] { spread<4>(charge, arena); }, [&] { spread<6>(charge, arena); },
           [&] { spread<8>(charge, arena); });
  transform_z(arena), transform_y(arena), transform_x(arena);
  const Sums sums = convolve(edges, arena);
  const EwaldSetting& s = setting.ewald;
  double squares = 0, net = 0;
  for (const double q : charge) squares += q * q, net += q;
  const double volume = edges.x * edges.y * edges.z;
  const double background = -kMeshHalfTurn * s.coulomb * net * net / (2 * volume * s.alpha * s.alpha);
  const EwaldEnergy out{sums.energy + background - s.coulomb * s.alpha / std::sqrt(kMeshHalfTurn) * squares,
                        sums.virial + 3 * background};
  if (force.empty()) return out;
  transform_x(arena), transform_y(arena), transform_z_back(arena);
  const size_t n = charge.size();
  force_.resize(3 * n);
  by_order([&] { gather<4>(edges, charge, arena); }, [&] { gather<6>(edges, charge, arena); },
           [&] { gather<8>(edges, charge, arena); });
  Vec3 mean;
  for (size_t i = 0; i < n; ++i) mean += load3(force_.data(), i);
  mean = mean / static_cast<double>(n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 f = load3(force_.data(), i) - mean;
    force[3 * i] += f.x, force[3 * i + 1] += f.y, force[3 * i + 2] += f.z;
  }
  return out;
}

}  // namespace truestep::molecular
