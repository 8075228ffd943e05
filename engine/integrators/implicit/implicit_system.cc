#include "engine/integrators/implicit/implicit_system.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/errors.h"

namespace truestep {

// Matrices of one field; rebuilt when the field says that its pattern changed.
struct ImplicitSystem::Matrices {
  const ForceField* field = nullptr;
  uint64_t version = 0;
  size_t rows = 0;
  BlockSparse dfdx, dfdv, system;
  BlockSparse dfdv_kept, unused;                        // when df/du is taken at another position
  BlockSparse definite;                                 // df/dx, for blending; without a pattern until
                                                        // reserved
  std::vector<BlockSparse::Slot> dfdx_slot, dfdv_slot;  // where their blocks go in `system`
  BlockSolver solver;

  void prepare(const ForceField& f, const State& state, size_t n) {
    if (field == &f && version == f.pattern_version(state) && rows == n) return;
    dfdv = dfdv_kept = unused = definite = BlockSparse();
    f.jacobian_pattern(state, dfdx, dfdv);
    const bool same = dfdv.empty() || dfdv.pattern_stamp() == dfdx.pattern_stamp();
    if (same) {
      system = dfdx;
    } else {
      std::vector<BlockSparse::Pair> pairs;
      for (const BlockSparse* m : {&dfdx, &dfdv}) {
        for (uint32_t i = 0; i < m->block_rows(); ++i) {
          for (auto s = m->row_begin(i); s < m->row_begin(i + 1); ++s) pairs.push_back({i, m->column(s)});
        }
      }
      system.set_pattern(dfdx.block_rows(), dfdx.block_size(), pairs);
    }
    const auto map = [this](const BlockSparse& m, std::vector<BlockSparse::Slot>& slots) {
      slots.clear();
      for (uint32_t i = 0; i < m.block_rows(); ++i) {
        for (auto s = m.row_begin(i); s < m.row_begin(i + 1); ++s)
          slots.push_back(system.slot(i, m.column(s)));
      }
    };
    map(dfdx, dfdx_slot);
    map(dfdv, dfdv_slot);
    field = &f, version = f.pattern_version(state), rows = n;
  }
};

ImplicitSystem::ImplicitSystem(Motion& m)
    : m_(m),
      w_(m.field.inverse_mass(m.state)),
      width_(m.v.size() / std::max<size_t>(w_.size(), 1)),
      contacts_(RowContacts::of(m.state)),
      matrices_(m.input.workspace.object<Matrices>("integrator.matrices")),
      partial_(m.scratch("integrator.partial", (w_.size() + kBlockRows - 1) / kBlockRows)) {
  matrices_.prepare(m.field, m.state, w_.size());
}

void ImplicitSystem::reserve() {
  if (!matrices_.definite.empty()) return;
  matrices_.definite = matrices_.dfdx;
  if (m_.field.symmetric_jacobian()) matrices_.solver.reserve(matrices_.system);
}

void ImplicitSystem::differentiate(double t, std::span<const double> x, std::span<const double> u,
                                   Derivatives which, std::span<const double> x_rate) {
  Evaluation e{m_.input.workspace, m_.input.arena};
  const Phase at{t, x, u, m_.state};
  if (width_ == 3) places_ = x;
  if (!x_rate.empty()) {
    // Both matrices come from one call; the one at the wrong position is discarded.
    if (matrices_.unused.empty()) matrices_.dfdv_kept = matrices_.dfdv, matrices_.unused = matrices_.dfdx;
    m_.field.jacobian({t, x_rate, u, m_.state}, matrices_.unused, matrices_.dfdv_kept, e);
  }
  if (which == Derivatives::exact) {
    m_.field.jacobian(at, matrices_.dfdx, matrices_.dfdv, e);
  } else if (which == Derivatives::definite) {
    m_.field.definite_jacobian(at, matrices_.dfdx, matrices_.dfdv, e);
  } else {
    reserve();
    m_.field.definite_jacobian(at, matrices_.definite, matrices_.dfdv, e);
  }
  if (!x_rate.empty()) std::swap(matrices_.dfdv, matrices_.dfdv_kept);
}

const BlockSparse& ImplicitSystem::force_slope() const {
  return matrices_.dfdx;
}

void ImplicitSystem::assemble(double g, double s, double definite) {
  BlockSparse& system = matrices_.system;
  const auto b = static_cast<size_t>(system.block_size()), bb = b * b;
  double* a = system.values().data();
  const auto add = [&](const BlockSparse& m, const std::vector<BlockSparse::Slot>& slots, size_t i,
                       double factor) {
    const double* from = m.values().data();
    for (auto k = m.row_begin(i); k < m.row_begin(i + 1); ++k) {
      double* to = a + slots[k] * bb;
      for (size_t e = 0; e < bb; ++e) to[e] -= factor * from[k * bb + e];
    }
  };
  m_.input.arena.for_blocks(system.block_rows(), kBlockRows, [&](size_t begin, size_t end) {
    std::fill(a + size_t{system.row_begin(begin)} * bb, a + size_t{system.row_begin(end)} * bb, 0.0);
    double most = 1;  // largest ratio of a diagonal block to its mass
    for (size_t i = begin; i < end; ++i) {
      double* diagonal = a + size_t{system.diagonal_slot(i)} * bb;
      if (w_[i] == 0) {
        for (size_t k = 0; k < b; ++k) diagonal[k * b + k] = 1;
        continue;
      }
      if (definite < 1) add(matrices_.dfdx, matrices_.dfdx_slot, i, (1 - definite) * g * s);
      if (definite > 0) add(matrices_.definite, matrices_.dfdx_slot, i, definite * g * s);
      if (!matrices_.dfdv.empty()) add(matrices_.dfdv, matrices_.dfdv_slot, i, g);
      for (auto k = system.row_begin(i); k < system.row_begin(i + 1); ++k) {
        if (w_[system.column(k)] == 0) std::fill(a + k * bb, a + (k + 1) * bb, 0.0);
      }
      double trace = 0;
      for (size_t k = 0; k < b; ++k) {
        diagonal[k * b + k] += 1 / w_[i];
        trace += diagonal[k * b + k];
      }
      most = std::max(most, trace * w_[i] / double(b));
    }
    partial_[begin / kBlockRows] = most;
  });
  // Eigenvalues lie between the mass and twice the diagonal.
  condition_ = 2 * *std::max_element(partial_.begin(), partial_.end());
}

void ImplicitSystem::multiply(std::span<const double> x, std::span<double> y) const {
  matrices_.system.multiply(x, y, m_.input.arena);
}

// S_i A_ij S_j with S = 1 - n n^T, 0 or 1, and n n^T / w on the diagonal.
void ImplicitSystem::constrain() {
  if (!contacts_) return;
  BlockSparse& system = matrices_.system;
  const RowContacts& on = *contacts_;
  double* a = system.values().data();
  m_.input.arena.for_blocks(system.block_rows(), kBlockRows, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (auto k = system.row_begin(i); k < system.row_begin(i + 1); ++k) {
        const size_t j = system.column(k);
        if (on.kind[i] == RowContacts::kFree && on.kind[j] == RowContacts::kFree) continue;
        double* block = a + 9 * size_t{k};
        // From the left column by column, from the right row by row.
        for (size_t c = 0; c < 3; ++c) store3(block, c, on.left(i, load3(block, c)));
        for (size_t r = 0; r < 3; ++r) {
          const Vec3 row = on.left(j, {block[r], block[3 + r], block[6 + r]});
          block[r] = row.x, block[3 + r] = row.y, block[6 + r] = row.z;
        }
      }
      if (on.kind[i] == RowContacts::kFree || w_[i] == 0) continue;
      double* diagonal = a + 9 * size_t{system.diagonal_slot(i)};
      for (size_t c = 0; c < 3; ++c) {
        Vec3 e{c == 0 ? 1.0 : 0, c == 1 ? 1.0 : 0, c == 2 ? 1.0 : 0};
        e -= on.left(i, e);
        store3(diagonal, c, load3(diagonal, c) + e / w_[i]);
      }
    }
  });
}

BlockSolver::Result::Sign ImplicitSystem::solve(std::span<const double> b, std::span<double> d,
                                                double accuracy) {
  const auto result =
      matrices_.solver.solve(matrices_.system, b, d,
                             {.tolerance = accuracy,
                              .condition = condition_,
                              .symmetry = m_.field.symmetric_jacobian() ? BlockSolver::Symmetry::symmetric
                                                                        : BlockSolver::Symmetry::general,
                              .places = places_},
                             m_.input.arena);
  if (!result.solved) {
    throw Instability("", "velocity", -1,
                      "the system of an implicit step is singular; a smaller dt would help");
  }
  return result.sign;
}

void ImplicitSystem::solve_again(std::span<const double> b, std::span<double> d, double accuracy) {
  matrices_.solver.solve_again(matrices_.system, b, d, accuracy, m_.input.arena);
}

namespace {

// sum_j |block_ij| |y_j|
double row_size(const BlockSparse& m, size_t i, std::span<const double> y) {
  const auto b = static_cast<size_t>(m.block_size()), bb = b * b;
  double total = 0;
  for (auto k = m.row_begin(i); k < m.row_begin(i + 1); ++k) {
    const double* block = m.values().data() + size_t{k} * bb;
    double block2 = 0, y2 = 0;
    for (size_t e = 0; e < bb; ++e) block2 += block[e] * block[e];
    for (size_t e = 0; e < b; ++e) y2 += y[m.column(k) * b + e] * y[m.column(k) * b + e];
    total += std::sqrt(block2 * y2);
  }
  return total;
}

double length(std::span<const double> y, size_t i, size_t width) {
  double y2 = 0;
  for (size_t k = i * width; k < (i + 1) * width; ++k) y2 += y[k] * y[k];
  return std::sqrt(y2);
}

}  // namespace

double ImplicitSystem::rounding_floor(std::span<const double> x, std::span<const double> u, double g) {
  // Two units of rounding: one for x0 + s u, one for evaluating the force.
  constexpr double kUnits = 2 * std::numeric_limits<double>::epsilon();
  return kUnits * std::sqrt(sum([&](size_t i) {
           if (w_[i] == 0) return 0.0;
           double r = g * row_size(matrices_.dfdx, i, x) + length(u, i, width_) / w_[i];
           if (!matrices_.dfdv.empty()) r += g * row_size(matrices_.dfdv, i, u);
           return w_[i] * r * r;
         }));
}

double ImplicitSystem::rounding_energy(std::span<const double> x) {
  return sum(
      [&](size_t i) { return w_[i] > 0 ? length(x, i, width_) * row_size(matrices_.dfdx, i, x) : 0.0; });
}

}  // namespace truestep
