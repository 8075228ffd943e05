#include "engine/kernels/gravity/direct_sums.h"

#include <algorithm>

namespace truestep::gravity {

namespace {

using Lanes = Wide<double>;
constexpr size_t kLanes = Lanes::kLanes;
constexpr size_t kBlock = 64;      // bodies whose own pairs are computed both ways
constexpr size_t kTile = 256;      // bodies whose columns stay in the nearest cache
constexpr size_t kMostStrips = 8;  // shares of the work with sums of their own
constexpr double kTiny = 1e-180;   // m^2; its root's third power is still a number after times a mass

Lanes load(const double* p) {
  return {*reinterpret_cast<const Lanes::Raw*>(p)};
}
void store(double* p, Lanes a) {
  *reinterpret_cast<Lanes::Raw*>(p) = a.v;
}
double sum(Lanes a) {
  return (a[0] + a[2]) + (a[1] + a[3]);
}

/// Columns of what is summed over, and of what the sums are added to.
struct View {
  const double *x, *y, *z, *mu;
  double *ax, *ay, *az;
};

size_t filled(size_t n) {
  return (n + kLanes - 1) / kLanes * kLanes;
}

View columns(const Bodies& bodies, DirectScratch& scratch) {
  const size_t n = bodies.size(), rows = filled(n);
  if (scratch.columns.size() < 4 * rows) scratch.columns.resize(4 * rows);
  double* c = scratch.columns.data();
  for (size_t i = 0; i < rows; ++i) {
    const size_t from = std::min(i, n - 1);
    for (size_t k = 0; k < 3; ++k) c[k * rows + i] = bodies.x[3 * from + k];
    c[3 * rows + i] = i < n ? bodies.mu[i] : 0;
  }
  return {c, c + rows, c + 2 * rows, c + 3 * rows, nullptr, nullptr, nullptr};
}

/// Two bodies of a block against the lanes of another: what is done to the two stays in registers.
struct Row {
  Lanes x, y, z, mu, ax = Lanes::zero(), ay = Lanes::zero(), az = Lanes::zero();
  Row(const View& c, size_t i) : x(c.x[i]), y(c.y[i]), z(c.z[i]), mu(c.mu[i]) {}
  void add_to(const View& c, size_t i) const { c.ax[i] += sum(ax), c.ay[i] += sum(ay), c.az[i] += sum(az); }
};

/// Every body of [i0, i1) with every one of [j0, j1), for both. i1 - i0 is even, j1 - j0 whole lanes.
template <class Law>
void cross(const View& c, const Law& law, size_t i0, size_t i1, size_t j0, size_t j1) {
  Lanes unused;
  for (size_t i = i0; i < i1; i += 2) {
    Row p(c, i), q(c, i + 1);
    for (size_t j = j0; j < j1; j += kLanes) {
      const Lanes x = load(c.x + j), y = load(c.y + j), z = load(c.z + j), mu = load(c.mu + j);
      const Lanes px = x - p.x, py = y - p.y, pz = z - p.z, qx = x - q.x, qy = y - q.y, qz = z - q.z;
      const Lanes pw = law(madd(px, px, madd(py, py, pz * pz)), unused);
      const Lanes qw = law(madd(qx, qx, madd(qy, qy, qz * qz)), unused);
      const Lanes pf = pw * mu, qf = qw * mu, pb = pw * p.mu, qb = qw * q.mu;
      p.ax = madd(pf, px, p.ax), p.ay = madd(pf, py, p.ay), p.az = madd(pf, pz, p.az);
      q.ax = madd(qf, qx, q.ax), q.ay = madd(qf, qy, q.ay), q.az = madd(qf, qz, q.az);
      store(c.ax + j, nmadd(qb, qx, nmadd(pb, px, load(c.ax + j))));
      store(c.ay + j, nmadd(qb, qy, nmadd(pb, py, load(c.ay + j))));
      store(c.az + j, nmadd(qb, qz, nmadd(pb, pz, load(c.az + j))));
    }
    p.add_to(c, i), q.add_to(c, i + 1);
  }
}

/// The pairs within [i0, i1), each twice.
template <class Law>
void within(const View& c, const Law& law, size_t i0, size_t i1) {
  Lanes unused;
  for (size_t i = i0; i < i1; ++i) {
    Row p(c, i);
    for (size_t j = i0; j < i1; j += kLanes) {
      const Lanes x = load(c.x + j) - p.x, y = load(c.y + j) - p.y, z = load(c.z + j) - p.z;
      const Lanes f = law(madd(x, x, madd(y, y, z * z)), unused) * load(c.mu + j);
      p.ax = madd(f, x, p.ax), p.ay = madd(f, y, p.ay), p.az = madd(f, z, p.az);
    }
    p.add_to(c, i);
  }
}

/// pair(i0, i1, j0, j1) and self(i0, i1) over all pairs that the strip answers for.
template <class Pair, class Self>
void for_strip(size_t rows, size_t strip, size_t strips, const Pair& pair, const Self& self) {
  const size_t blocks = (rows + kBlock - 1) / kBlock;
  // There and back again, because later blocks have fewer others after them.
  const auto strip_of = [strips](size_t block) {
    const size_t at = block % (2 * strips);
    return at < strips ? at : 2 * strips - 1 - at;
  };
  for (size_t tile = 0; tile < rows; tile += kTile) {
    const size_t end = std::min(tile + kTile, rows);
    for (size_t b = 0; b < blocks && b * kBlock < end; ++b) {
      if (strip_of(b) != strip) continue;
      const size_t i0 = b * kBlock, i1 = std::min(i0 + kBlock, rows);
      if (i0 >= tile) self(i0, i1);
      if (std::max(i1, tile) < end) pair(i0, i1, std::max(i1, tile), end);
    }
  }
}

size_t strips_of(size_t rows) {
  return std::clamp<size_t>(rows / (4 * kBlock), 1, kMostStrips);
}

template <class Law>
void accelerations(const Bodies& bodies, const Law& law, std::span<double> a, DirectScratch& scratch,
                   const ThreadArena& arena) {
  const size_t n = bodies.size(), rows = filled(n), strips = strips_of(rows);
  const View base = columns(bodies, scratch);
  if (scratch.sums.size() < 3 * rows * strips) scratch.sums.resize(3 * rows * strips);
  arena.for_blocks(strips, 1, [&](size_t strip, size_t) {
    View c = base;
    double* own = scratch.sums.data() + 3 * rows * strip;
    std::fill_n(own, 3 * rows, 0.0);
    c.ax = own, c.ay = own + rows, c.az = own + 2 * rows;
    for_strip(
        rows, strip, strips,
        [&](size_t i0, size_t i1, size_t j0, size_t j1) { cross(c, law, i0, i1, j0, j1); },
        [&](size_t i0, size_t i1) { within(c, law, i0, i1); });
  });
  for (size_t k = 0; k < 3; ++k) {
    for (size_t i = 0; i < n; ++i) {
      double total = 0;
      for (size_t s = 0; s < strips; ++s) total += scratch.sums[(3 * s + k) * rows + i];
      a[3 * i + k] = total;
    }
  }
}

template <class Law>
double potential(const Bodies& bodies, const Law& law, DirectScratch& scratch, const ThreadArena& arena) {
  const size_t n = bodies.size(), rows = filled(n), strips = strips_of(rows);
  const View c = columns(bodies, scratch);
  const auto row = [&](size_t i, size_t first, size_t j0, size_t j1) {
    Lanes total = Lanes::zero(), p;
    const Lanes xi(c.x[i]), yi(c.y[i]), zi(c.z[i]);
    for (size_t j = j0; j < j1; j += kLanes) {
      const Lanes x = load(c.x + j) - xi, y = load(c.y + j) - yi, z = load(c.z + j) - zi;
      law(madd(x, x, madd(y, y, z * z)), p);
      Lanes mu = load(c.mu + j);
      for (size_t k = 0; k < kLanes && j < first; ++k) {
        if (j + k < first) mu.set(static_cast<int>(k), 0);
      }
      total = madd(mu, p, total);
    }
    return c.mu[i] * sum(total);
  };
  return arena.sum_blocks(strips, 1, [&](size_t strip, size_t) {
    double total = 0;
    for_strip(
        rows, strip, strips,
        [&](size_t i0, size_t i1, size_t j0, size_t j1) {
          for (size_t i = i0; i < i1; ++i) total += row(i, j0, j0, j1);
        },
        [&](size_t i0, size_t i1) {
          for (size_t i = i0; i < i1; ++i) total += row(i, i + 1, i0, i1);
        });
    return total;
  });
}

/// use(law) with the law of this softening.
template <class Use>
auto with_law(const Softening& s, const Use& use) {
  if (s.length == 0) return use(NewtonLaw<double>(kTiny));
  if (s.kind == SofteningKind::spline) return use(SplineLaw<double>(s.length, kTiny));
  return use(PlummerLaw<double>(s.length));
}

}  // namespace

void direct_accelerations(const Bodies& bodies, const Softening& softening, std::span<double> a,
                          DirectScratch& scratch, const ThreadArena& arena) {
  with_law(softening, [&](const auto& law) { accelerations(bodies, law, a, scratch, arena); });
}

double direct_potential(const Bodies& bodies, const Softening& softening, DirectScratch& scratch,
                        const ThreadArena& arena) {
  return with_law(softening, [&](const auto& law) { return potential(bodies, law, scratch, arena); });
}

}  // namespace truestep::gravity
