#include "engine/lattice/solvers/spectral_solver.h"

#include <algorithm>
#include <cmath>

#include "engine/math/trig.h"

namespace truestep::lattice {

bool SpectralSolver::serves(const Diffusion& d) {
  if (d.coefficient().variable()) return false;
  for (size_t a = 0; a < d.lattice().dimensions; ++a) {
    for (const Side& s : d.lattice().axes[a].sides) {
      if (s.kind == SideKind::robin) return false;
    }
  }
  return true;
}

SpectralSolver::SpectralSolver(const Diffusion& diffusion) : diffusion_(diffusion) {
  const Lattice& l = diffusion_.lattice();
  const auto end_of = [](SideKind k) {
    return k == SideKind::periodic    ? TrigTransform::End::periodic
           : k == SideKind::dirichlet ? TrigTransform::End::zero
                                      : TrigTransform::End::even;
  };
  for (size_t a = 0; a < l.dimensions; ++a) {
    const Axis& axis = l.axes[a];
    const TrigTransform& t =
        transforms_.emplace_back(end_of(axis.sides[0].kind), end_of(axis.sides[1].kind), axis.cells);
    const double scale = diffusion_.coefficient().constant / (axis.spacing * axis.spacing);
    for (size_t i = 0; i < axis.nodes(); ++i) {
      // 2 - 2 cos as 4 sin^2 of half the angle, which loses no digits for long waves.
      const double half = trig::sin(0.5 * t.angle(i)), s = 4 * half * half;
      eigenvalues_[a].push_back(-scale * (diffusion_.order() == 4 ? s * (1 + s / 12) : s));
    }
  }
  for (size_t a = l.dimensions; a < 3; ++a) eigenvalues_[a].push_back(0);
  for (size_t node = 0; node < l.nodes(); ++node) {
    if (l.fixed(l.place(node))) fixed_.push_back(static_cast<uint32_t>(node));
  }
}

bool SpectralSolver::factor(double shift, double step) {
  shift_ = shift, step_ = step;
  return std::isfinite(shift + step);
}

bool SpectralSolver::factor(Complex shift, Complex step) {
  complex_shift_ = shift, complex_step_ = step;
  return std::isfinite(shift.re + shift.im + step.re + step.im);
}

// b += with L (values at Dirichlet nodes, 0 elsewhere), and b = 0 at these nodes; their values are saved in
// kept_.
void SpectralSolver::move_given(double* b, double with, double* to, const ThreadArena& arena) {
  bool any = false;
  for (const uint32_t node : fixed_) any = any || b[node] != 0;
  if (!any) return;
  given_.assign(diffusion_.lattice().nodes(), 0);
  moved_.resize(given_.size());
  for (const uint32_t node : fixed_) given_[node] = b[node];
  diffusion_.apply(given_.data(), moved_.data(), 0, 1, arena);
  for (size_t i = 0; i < given_.size(); ++i) to[i] += with * moved_[i];
}

void SpectralSolver::transform(double* x, Way way, const ThreadArena& arena) {
  const Lattice& l = diffusion_.lattice();
  const size_t nodes = l.nodes();
  for (size_t a = 0; a < l.dimensions; ++a) {
    const TrigTransform& t = transforms_[a];
    const size_t n = l.count(a), stride = l.stride(a);
    const auto run = [&](double* at, size_t line_stride, size_t count, double* scratch) {
      way == Way::forward ? t.forward(at, stride, line_stride, count, scratch)
                          : t.backward(at, stride, line_stride, count, scratch);
    };
    constexpr size_t kLines = TrigTransform::kLines;
    // Lines along axis 0 are consecutive, those along other axes interleaved in groups of `stride`.
    const size_t group = a == 0 ? nodes / n : stride, groups = nodes / n / group;
    const size_t batches = (group + kLines - 1) / kLines;
    arena.for_blocks(groups * batches, 4, [&](size_t begin, size_t end) {
      thread_local std::vector<double, CacheLineAllocator<double>> scratch;
      if (scratch.size() < t.scratch_size()) scratch.resize(t.scratch_size());
      for (size_t k = begin; k < end; ++k) {
        const size_t first = k % batches * kLines, count = std::min(kLines, group - first);
        double* at = a == 0 ? x + first * n : x + k / batches * n * stride + first;
        run(at, a == 0 ? n : 1, count, scratch.data());
      }
    });
  }
}

template <class Divide>
void SpectralSolver::divide(const ThreadArena& arena, Divide&& divide) const {
  const Lattice& l = diffusion_.lattice();
  const size_t nx = l.count(0), ny = l.count(1);
  arena.for_blocks(ny * l.count(2), std::max<size_t>(1, kBlockRows / nx), [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      const double rest = eigenvalues_[1][r % ny] + eigenvalues_[2][r / ny];
      const double* e = eigenvalues_[0].data();
#pragma GCC ivdep
      for (size_t i = 0; i < nx; ++i) divide(r * nx + i, e[i] + rest);
    }
  });
}

void SpectralSolver::solve(double* b, const ThreadArena& arena) {
  kept_.clear();
  for (const uint32_t node : fixed_) kept_.push_back(b[node]);
  move_given(b, step_, b, arena);
  for (const uint32_t node : fixed_) b[node] = 0;
  transform(b, Way::forward, arena);
  const double shift = shift_, step = step_;
  divide(arena, [=](size_t i, double eigenvalue) { b[i] /= shift - step * eigenvalue; });
  transform(b, Way::backward, arena);
  for (size_t k = 0; k < fixed_.size(); ++k) b[fixed_[k]] = kept_[k];
}

void SpectralSolver::solve(double* re, double* im, const ThreadArena& arena) {
  kept_.clear();
  for (const uint32_t node : fixed_) kept_.push_back(re[node]), kept_.push_back(im[node]);
  // (step.re + i step.im) L (re + i im) of the given values.
  re_.assign(re, re + diffusion_.lattice().nodes()), im_.assign(im, im + re_.size());
  move_given(re_.data(), complex_step_.re, re, arena);
  move_given(re_.data(), complex_step_.im, im, arena);
  move_given(im_.data(), -complex_step_.im, re, arena);
  move_given(im_.data(), complex_step_.re, im, arena);
  for (const uint32_t node : fixed_) re[node] = im[node] = 0;
  transform(re, Way::forward, arena);
  transform(im, Way::forward, arena);
  const Complex shift = complex_shift_, step = complex_step_;
  divide(arena, [=](size_t i, double eigenvalue) {
    const double dr = shift.re - step.re * eigenvalue, di = shift.im - step.im * eigenvalue;
    const double s = 1 / (dr * dr + di * di), r = re[i], m = im[i];
    re[i] = (r * dr + m * di) * s, im[i] = (m * dr - r * di) * s;
  });
  transform(re, Way::backward, arena);
  transform(im, Way::backward, arena);
  for (size_t k = 0; k < fixed_.size(); ++k) re[fixed_[k]] = kept_[2 * k], im[fixed_[k]] = kept_[2 * k + 1];
}

}  // namespace truestep::lattice
