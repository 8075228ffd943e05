#include "engine/lattice/solvers/staggered_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/math/trig.h"

namespace truestep::lattice {

using mac::Mirror;

StaggeredSolver::AxisWaves StaggeredSolver::waves(const mac::MacGrid& g, size_t place, size_t a,
                                                  const std::array<Mirror, 2>& mirrors) {
  using End = TrigTransform::End;
  const auto end = [](Mirror m) {
    return m == Mirror::periodic ? End::periodic : m == Mirror::even ? End::even : End::zero;
  };
  const bool periodic = mirrors[0] == Mirror::periodic;
  const bool doubled = place != a && !periodic;
  const size_t n = g.cells[a];
  AxisWaves w{.transform = TrigTransform(end(mirrors[0]), end(mirrors[1]), doubled ? 2 * n : n)};
  w.doubled = doubled;
  w.first = doubled || periodic ? 0 : w.transform.first();
  w.count = doubled || periodic ? n : w.transform.last() + 1 - w.first;
  for (size_t i = 0; i < w.count; ++i) w.node.push_back(doubled ? 2 * i + 1 : w.first + i);
  const double h2 = g.spacing[a] * g.spacing[a];
  for (size_t k = w.transform.first(); k <= w.transform.last(); ++k) {
    const double angle = w.transform.angle(k);
    if (doubled) {
      // On the odd nodes, waves above pi/2 are indistinguishable from those below.
      constexpr double kMiddle = 0.5 * std::numbers::pi, kRounding = 1e-9;
      if (angle > kMiddle + kRounding) continue;
      const double s = trig::sin(angle);
      w.weight.push_back(angle < kMiddle - kRounding ? 2 : 1);
      w.eigenvalue.push_back(-4 * s * s / h2);
    } else {
      const double s = trig::sin(0.5 * angle);
      w.weight.push_back(1), w.eigenvalue.push_back(-4 * s * s / h2);
    }
    w.wave.push_back(k);
  }
  // The line mirrored at the other end numbers its waves downwards; only their set matters.
  if (w.wave.size() > w.count) {
    w.wave.resize(w.count), w.weight.resize(w.count), w.eigenvalue.resize(w.count);
  }
  return w;
}

StaggeredSolver::StaggeredSolver(const mac::MacGrid& grid, size_t place,
                                 const std::array<std::array<Mirror, 2>, 3>& mirrors, Differences differences)
    : grid_(grid) {
  for (size_t a = 0; a < grid.dimensions; ++a) {
    axes_.push_back(waves(grid, place, a, mirrors[a]));
    // With s = sin(k dx / 2), the second difference of a wave is -4 s^2 / dx^2, of fourth order -4 (s^2 + s^4
    // / 3) / dx^2, and the staggered first difference of fourth order 2 i (s + s^3 / 6) / dx.
    const double scale = -4 / (grid.spacing[a] * grid.spacing[a]);
    for (double& e : axes_[a].eigenvalue) {
      const double s2 = e / scale;
      if (differences == Differences::fourth) e *= 1 + s2 / 3;
      if (differences == Differences::fourth_divergence) e *= (1 + s2 / 6) * (1 + s2 / 6);
    }
    counts_[a] = axes_[a].count;
  }
  x_.resize(counts_[0] * counts_[1] * counts_[2]);
}

void StaggeredSolver::lines(const AxisWaves& w, Way way, double* x, size_t stride, size_t line_stride,
                            size_t count, double* scratch) const {
  constexpr size_t kLines = TrigTransform::kLines;
  const size_t nodes = w.transform.nodes();
  double *line = scratch, *rest = scratch + nodes * kLines;
  std::fill(line, rest, 0.0);
  const auto& in = way == Way::forward ? w.node : w.wave;
  const auto& out = way == Way::forward ? w.wave : w.node;
  for (size_t i = 0; i < w.count; ++i) {
    for (size_t l = 0; l < count; ++l) line[in[i] * kLines + l] = x[i * stride + l * line_stride];
  }
  if (way == Way::forward) {
    w.transform.forward(line, kLines, 1, count, rest);
    for (size_t i = 0; i < w.count; ++i) {
      for (size_t l = 0; l < count; ++l)
        x[i * stride + l * line_stride] = w.weight[i] * line[out[i] * kLines + l];
    }
  } else {
    w.transform.backward(line, kLines, 1, count, rest);
    for (size_t i = 0; i < w.count; ++i) {
      for (size_t l = 0; l < count; ++l) x[i * stride + l * line_stride] = line[out[i] * kLines + l];
    }
  }
}

void StaggeredSolver::transform(size_t a, Way way, const ThreadArena& arena) {
  constexpr size_t kLines = TrigTransform::kLines;
  const AxisWaves& w = axes_[a];
  const size_t stride = a == 0 ? 1 : a == 1 ? counts_[0] : counts_[0] * counts_[1];
  const size_t group = a == 0 ? x_.size() / w.count : stride, groups = x_.size() / w.count / group;
  const size_t batches = (group + kLines - 1) / kLines;
  arena.for_blocks(groups * batches, 4, [&](size_t begin, size_t end) {
    thread_local std::vector<double, CacheLineAllocator<double>> scratch;
    const size_t needed = w.transform.nodes() * kLines + w.transform.scratch_size();
    if (scratch.size() < needed) scratch.resize(needed);
    for (size_t k = begin; k < end; ++k) {
      const size_t first = k % batches * kLines, count = std::min(kLines, group - first);
      double* at = a == 0 ? x_.data() + first * w.count : x_.data() + k / batches * w.count * stride + first;
      lines(w, way, at, stride, a == 0 ? w.count : 1, count, scratch.data());
    }
  });
}

void StaggeredSolver::solve(double shift, double step, double* x, const ThreadArena& arena) {
  const size_t nx = counts_[0], ny = counts_[1], rows = ny * counts_[2];
  const size_t block = std::max<size_t>(1, kBlockRows / nx);
  size_t first[3] = {};
  for (size_t a = 0; a < grid_.dimensions; ++a) first[a] = axes_[a].first;
  const auto row_of = [&](size_t r) { return x + grid_.at(first[0], first[1] + r % ny, first[2] + r / ny); };
  arena.for_blocks(rows, block, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) std::copy_n(row_of(r), nx, x_.data() + r * nx);
  });
  for (size_t a = 0; a < grid_.dimensions; ++a) transform(a, Way::forward, arena);
  arena.for_blocks(rows, block, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) {
      double rest = axes_[1].eigenvalue[r % ny];
      if (grid_.dimensions > 2) rest += axes_[2].eigenvalue[r / ny];
      const double* e = axes_[0].eigenvalue.data();
      double* row = x_.data() + r * nx;
      for (size_t i = 0; i < nx; ++i) {
        const double d = shift - step * (e[i] + rest);
        row[i] = d != 0 ? row[i] / d : 0;
      }
    }
  });
  for (size_t a = grid_.dimensions; a-- > 0;) transform(a, Way::backward, arena);
  arena.for_blocks(rows, block, [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) std::copy_n(x_.data() + r * nx, nx, row_of(r));
  });
}

}  // namespace truestep::lattice
