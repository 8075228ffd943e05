#include "engine/lattice/solvers/multigrid.h"

#include <algorithm>
#include <cmath>

namespace truestep::lattice {

namespace {

constexpr size_t kSmallest = 3;  // cells; shorter axes are not coarsened
constexpr int kRelaxations = 2;  // before and after each: one gives convergence factors of 0.4 in space

/// The next coarser lattice; the same if there is none.
Lattice coarser(const Lattice& fine) {
  double finest = HUGE_VAL;
  for (size_t a = 0; a < fine.dimensions; ++a) {
    if (fine.axes[a].cells > kSmallest) finest = std::min(finest, fine.axes[a].spacing);
  }
  Lattice coarse = fine;
  for (size_t a = 0; a < fine.dimensions; ++a) {
    Axis& axis = coarse.axes[a];
    if (axis.cells <= kSmallest || axis.spacing > 1.5 * finest) continue;
    const size_t half = std::max((axis.cells + 1) / 2, axis.periodic() ? size_t{3} : size_t{2});
    axis.spacing *= static_cast<double>(axis.cells) / static_cast<double>(half);
    axis.cells = half;
  }
  return coarse;
}

double square(double v) {
  return v * v;
}
double square(Complex v) {
  return v.re * v.re + v.im * v.im;
}
bool finite(double v) {
  return std::isfinite(v);
}
bool finite(Complex v) {
  return std::isfinite(v.re) && std::isfinite(v.im);
}
bool nonzero(double v) {
  return v != 0;
}
bool nonzero(Complex v) {
  return v.re != 0 || v.im != 0;
}

}  // namespace

template <class T>
Multigrid<T>::Multigrid(const Lattice& finest, const Discretise& discretise) {
  Lattice l = finest;
  for (;;) {
    Level& level = levels_.emplace_back();
    level.a = discretise(l);
    const size_t n = l.nodes();
    level.diagonal.resize(n), level.volume.resize(n), level.inverse.resize(n);
    for (size_t i = 0; i < n; ++i) {
      const auto p = l.place(i);
      level.volume[i] = l.fixed(p) ? 0 : l.volume(p);
      level.a.entries(p, [&](size_t to, double w) { level.diagonal[i] += to == i ? w : 0; });
    }
    for (auto* v : {&level.x, &level.b, &level.r}) v->resize(n);
    const Lattice next = coarser(l);
    if (next == l) break;
    for (size_t a = 0; a < l.dimensions; ++a) {
      Transfer& t = level.to_coarser[a];
      const Axis &fine = l.axes[a], &coarse = next.axes[a];
      t.same = fine.cells == coarse.cells;
      if (t.same) continue;
      t.down.resize(coarse.nodes());
      for (size_t j = 0; j < fine.nodes(); ++j) {
        // In exact integers: position j / cells of the box in units of the coarse spacing.
        const size_t scaled = j * coarse.cells, low = scaled / fine.cells;
        const double part = static_cast<double>(scaled % fine.cells) / static_cast<double>(fine.cells);
        const size_t high = part > 0 ? coarse.after(low) : low;
        t.up.push_back({static_cast<uint32_t>(low), static_cast<uint32_t>(high), part});
        const double weight = fine.spacing * fine.share(j);
        const auto add = [&](size_t to, double w) {
          if (w > 0) {
            t.down[to].emplace_back(static_cast<uint32_t>(j),
                                    w * weight / (coarse.spacing * coarse.share(to)));
          }
        };
        add(low, 1 - part), add(high, part);
      }
    }
    l = next;
  }
  const size_t n = finest.nodes();
  for (auto* v : {&half_, &r_, &z_, &p_, &q_}) v->resize(n);
}

template <class T>
bool Multigrid<T>::factor(T shift, T step) {
  shift_ = shift, step_ = step;
  if (!finite(shift) || !finite(step)) return false;
  for (Level& l : levels_) {
    for (size_t i = 0; i < l.diagonal.size(); ++i) l.inverse[i] = reciprocal(shift - l.diagonal[i] * step);
  }
  const Level& last = levels_.back();
  const size_t n = last.diagonal.size();
  coarsest_.resize(n);
  T* m = coarsest_.matrix();
  std::fill_n(m, n * n, T(0));
  for (size_t i = 0; i < n; ++i) {
    m[i * n + i] = last.volume[i] > 0 ? shift : T(1);
    last.a.entries(last.a.lattice().place(i), [&](size_t to, double w) {
      if (last.volume[to] > 0) m[to * n + i] += T(0) - w * step;
    });
  }
  return coarsest_.factor();
}

// x = (b + step times the sum of the off-diagonal terms) / (shift - step diagonal) at the nodes of one
// colour.
template <class T>
void Multigrid<T>::relax(const Level& level, size_t colour, const T* b, T* x,
                         const ThreadArena& arena) const {
  const Lattice& l = level.a.lattice();
  const Coefficient& c = level.a.coefficient();
  const size_t nx = l.count(0), ny = l.count(1), rows = ny * l.count(2);
  const Axis& along = l.axes[0];
  // On a periodic axis with an odd number of nodes two neighbours have the same colour and use each other's
  // newest value in the order of the rows, so such lattices are not divided among threads.
  bool independent = true;
  for (size_t a = 0; a < l.dimensions; ++a) {
    independent = independent && !(l.axes[a].periodic() && l.axes[a].cells % 2);
  }
  arena.for_blocks(
      rows, independent ? std::max<size_t>(1, 2 * kBlockRows / nx) : rows, [&](size_t begin, size_t end) {
        for (size_t r = begin; r < end; ++r) {
          const std::array<size_t, 3> at = {0, r % ny, r / ny};
          const size_t start = r * nx;
          const T* neighbours[4];
          const double* faces[4];
          double scales[4];
          size_t count = 0;
          bool fixed = false;
          for (size_t a = 1; a < l.dimensions; ++a) {
            const Axis& axis = l.axes[a];
            const size_t stride = l.stride(a), i = at[a], line = start - i * stride;
            fixed = fixed || axis.fixed(i);
            for (const auto& [to, face] : {std::pair{axis.before(i), axis.face_before(i)},
                                           std::pair{axis.after(i), axis.face_after(i)}}) {
              neighbours[count] = x + line + to * stride;
              faces[count] = c.faces[a].data() + line + face * stride;
              scales[count++] = 1 / (axis.spacing * axis.spacing);
            }
          }
          if (fixed) continue;
          const double scale = 1 / (along.spacing * along.spacing);
          const double* face = c.faces[0].data() + start;
          const auto node = [&](size_t i, size_t before, size_t after, double low, double high) {
            T sum = scale * (low * x[start + before] + high * x[start + after]);
            for (size_t m = 0; m < count; ++m) sum += scales[m] * faces[m][i] * neighbours[m][i];
            x[start + i] = level.inverse[start + i] * (b[start + i] + step_ * sum);
          };
          const auto end_node = [&](size_t i) {
            if (along.fixed(i)) return;
            node(i, along.before(i), along.after(i), face[along.face_before(i)], face[along.face_after(i)]);
          };
          size_t i = (colour + at[1] + at[2]) % 2;
          if (i == 0) end_node(0), i = 2;
          for (; i + 1 < nx; i += 2) node(i, i - 1, i + 1, face[i - 1], face[i]);
          if (i + 1 == nx) end_node(i);
        }
      });
}

template <class T>
void Multigrid<T>::residual(const Level& level, const T* b, const T* x, T* r,
                            const ThreadArena& arena) const {
  const Lattice& l = level.a.lattice();
  const Coefficient& c = level.a.coefficient();
  const size_t nx = l.count(0), ny = l.count(1), rows = ny * l.count(2);
  const Axis& along = l.axes[0];
  arena.for_blocks(rows, std::max<size_t>(1, 2 * kBlockRows / nx), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const std::array<size_t, 3> at = {0, row % ny, row / ny};
      const size_t start = row * nx;
      const T* neighbours[4];
      const double* faces[4];
      double scales[4];
      size_t count = 0;
      bool fixed = false;
      for (size_t a = 1; a < l.dimensions; ++a) {
        const Axis& axis = l.axes[a];
        const size_t stride = l.stride(a), i = at[a], line = start - i * stride;
        fixed = fixed || axis.fixed(i);
        for (const auto& [to, face] :
             {std::pair{axis.before(i), axis.face_before(i)}, std::pair{axis.after(i), axis.face_after(i)}}) {
          neighbours[count] = x + line + to * stride;
          faces[count] = c.faces[a].data() + line + face * stride;
          scales[count++] = 1 / (axis.spacing * axis.spacing);
        }
      }
      if (fixed) {
        std::fill_n(r + start, nx, T(0));
        continue;
      }
      const double scale = 1 / (along.spacing * along.spacing);
      const double* face = c.faces[0].data() + start;
      const auto node = [&](size_t i, size_t before, size_t after, double low, double high) {
        T sum = level.diagonal[start + i] * x[start + i] +
                scale * (low * x[start + before] + high * x[start + after]);
        for (size_t m = 0; m < count; ++m) sum += scales[m] * faces[m][i] * neighbours[m][i];
        r[start + i] = b[start + i] + (step_ * sum - shift_ * x[start + i]);
      };
      for (const size_t i : {size_t{0}, nx - 1}) {
        if (along.fixed(i)) {
          r[start + i] = T(0);
        } else {
          node(i, along.before(i), along.after(i), face[along.face_before(i)], face[along.face_after(i)]);
        }
      }
      for (size_t i = 1; i + 1 < nx; ++i) node(i, i - 1, i + 1, face[i - 1], face[i]);
    }
  });
}

// Axis by axis: b of the coarse level = adjoint of the interpolation, weighted by volumes.
template <class T>
void Multigrid<T>::restrict_to(const Level& fine, Level& coarse, const T* r) {
  const Lattice &from = fine.a.lattice(), &to = coarse.a.lattice();
  std::array<size_t, 3> n = {from.count(0), from.count(1), from.count(2)};
  const T* source = r;
  for (size_t k = 0; k < from.dimensions; ++k) {
    const size_t a = from.dimensions - 1 - k;
    const Transfer& t = fine.to_coarser[a];
    if (t.same) continue;
    const size_t inner = a == 0 ? 1 : a == 1 ? n[0] : n[0] * n[1];
    const size_t outer = n[0] * n[1] * n[2] / (inner * n[a]), count = to.count(a);
    Vector& out = source == half_.data() ? q_ : half_;
    for (size_t o = 0; o < outer; ++o) {
      for (size_t j = 0; j < count; ++j) {
        T* line = out.data() + (o * count + j) * inner;
        std::fill_n(line, inner, T(0));
        for (const auto& [index, w] : t.down[j]) {
          const T* one = source + (o * n[a] + index) * inner;
          for (size_t i = 0; i < inner; ++i) line[i] += w * one[i];
        }
      }
    }
    n[a] = count;
    source = out.data();
  }
  std::copy_n(source, coarse.b.size(), coarse.b.data());
  for (size_t i = 0; i < coarse.b.size(); ++i) {
    if (coarse.volume[i] == 0) coarse.b[i] = T(0);
  }
}

// x += interpolated x of the coarse level.
template <class T>
void Multigrid<T>::correct(const Level& fine, const Level& coarse, T* x) {
  const Lattice &to = fine.a.lattice(), &from = coarse.a.lattice();
  std::array<size_t, 3> n = {from.count(0), from.count(1), from.count(2)};
  const T* source = coarse.x.data();
  for (size_t a = 0; a < to.dimensions; ++a) {
    const Transfer& t = fine.to_coarser[a];
    if (t.same) continue;
    const size_t inner = a == 0 ? 1 : a == 1 ? n[0] : n[0] * n[1];
    const size_t outer = n[0] * n[1] * n[2] / (inner * n[a]), count = to.count(a);
    Vector& out = source == half_.data() ? q_ : half_;
    for (size_t o = 0; o < outer; ++o) {
      for (size_t j = 0; j < count; ++j) {
        const auto& [low, high, part] = t.up[j];
        T* line = out.data() + (o * count + j) * inner;
        const T *p = source + (o * n[a] + low) * inner, *q = source + (o * n[a] + high) * inner;
        for (size_t i = 0; i < inner; ++i) line[i] = (1 - part) * p[i] + part * q[i];
      }
    }
    n[a] = count;
    source = out.data();
  }
  for (size_t i = 0; i < fine.volume.size(); ++i) {
    if (fine.volume[i] > 0) x[i] += source[i];
  }
}

template <class T>
void Multigrid<T>::descend(size_t k, const T* b, T* x, const ThreadArena& arena) {
  Level& l = levels_[k];
  if (k + 1 == levels_.size()) {
    std::copy_n(b, l.x.size(), x);
    for (size_t i = 0; i < l.volume.size(); ++i) {
      if (l.volume[i] == 0) x[i] = T(0);
    }
    coarsest_.solve(x);
    return;
  }
  for (int k = 0; k < kRelaxations; ++k) relax(l, 0, b, x, arena), relax(l, 1, b, x, arena);
  residual(l, b, x, l.r.data(), arena);
  Level& next = levels_[k + 1];
  restrict_to(l, next, l.r.data());
  std::ranges::fill(next.x, T(0));
  descend(k + 1, next.b.data(), next.x.data(), arena);
  correct(l, next, x);
  for (int k = 0; k < kRelaxations; ++k) relax(l, 1, b, x, arena), relax(l, 0, b, x, arena);
}

template <class T>
void Multigrid<T>::cycle(const T* b, T* x, const ThreadArena& arena) {
  descend(0, b, x, arena);
}

template <class T>
void Multigrid<T>::residual(const T* b, const T* x, T* r, const ThreadArena& arena) const {
  residual(levels_[0], b, x, r, arena);
}

template <class T>
double Multigrid<T>::norm(const T* r, const ThreadArena& arena) const {
  const double* volume = levels_[0].volume.data();
  return std::sqrt(arena.sum_blocks(levels_[0].volume.size(), 4 * kBlockRows, [=](size_t begin, size_t end) {
    double sum = 0;
    for (size_t i = begin; i < end; ++i) sum += volume[i] * square(r[i]);
    return sum;
  }));
}

template <class T>
T Multigrid<T>::product(const T* a, const T* b, const ThreadArena&) const {
  const double* volume = levels_[0].volume.data();
  T lanes[4] = {T(0), T(0), T(0), T(0)};
  const size_t n = levels_[0].volume.size();
  for (size_t i = 0; i < n; ++i) lanes[i % 4] += volume[i] * (a[i] * b[i]);
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

template <class T>
int Multigrid<T>::solve(const T* b, T* x, double reduction, const ThreadArena& arena) {
  const size_t n = levels_[0].volume.size();
  const double* volume = levels_[0].volume.data();
  Vector &p = p_, &z = z_, &r = r_;
  std::fill_n(x, n, T(0));
  for (size_t i = 0; i < n; ++i) r[i] = volume[i] > 0 ? b[i] : T(0);
  const double goal = reduction * norm(r.data(), arena);
  if (!(goal > 0)) return 0;
  Vector& ap = levels_[0].x;
  T rho{0};
  for (int k = 0; k < kMostIterations; ++k) {
    std::ranges::fill(z, T(0));
    cycle(r.data(), z.data(), arena);
    const T now = product(r.data(), z.data(), arena);
    if (!nonzero(now) || !finite(now)) return k;
    if (k == 0) {
      p = z;
    } else {
      const T beta = now * reciprocal(rho);
      for (size_t i = 0; i < n; ++i) p[i] = z[i] + beta * p[i];
    }
    rho = now;
    // A p as minus the residual of p with b = 0.
    std::ranges::fill(levels_[0].b, T(0));
    residual(levels_[0].b.data(), p.data(), ap.data(), arena);
    const T alpha = rho * reciprocal(T(0) - product(p.data(), ap.data(), arena));
    for (size_t i = 0; i < n; ++i) x[i] += alpha * p[i], r[i] += alpha * ap[i];
    if (norm(r.data(), arena) <= goal) return k + 1;
  }
  return kMostIterations;
}

template class Multigrid<double>;
template class Multigrid<Complex>;

}  // namespace truestep::lattice
