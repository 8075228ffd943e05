// Implicit Euler with the field's sparse Jacobian. Unknown is v'; with x' = x + h v' the equations are
//   r(v') = M (v' - v) - h f(x', v', t + h) = 0,       A = M - h df/dv - h^2 df/dx.
// Held rows keep their velocity: their rows and columns of A become those of the identity. Newton's direction
// descends |r| in the norm weighted with 1/M, which the line search uses. Compressed springs can make A
// indefinite; then the direction is taken with the field's definite Jacobian instead, and the single step of
// linear_implicit_euler always is.
#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/integrators/implicit.h"
#include "engine/math/block_sparse.h"
#include "engine/math/solvers/block_solver.h"

namespace truestep {

namespace {

// Matrices of one field; rebuilt when the field says that its pattern changed.
struct Matrices {
  const ForceField* field = nullptr;
  uint64_t version = 0;
  size_t rows = 0;
  BlockSparse dfdx, dfdv, system;
  std::vector<BlockSparse::Slot> dfdx_slot, dfdv_slot;  // where their blocks go in `system`
  BlockSolver solver;

  void prepare(const ForceField& f, const State& state, size_t n) {
    if (field == &f && version == f.pattern_version(state) && rows == n) return;
    dfdv = BlockSparse();
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

  // system = M - h df/dv - h^2 df/dx, and the largest ratio of a diagonal block to its mass.
  double assemble(std::span<const double> w, double h, const ThreadArena& arena, std::span<double> worst) {
    const auto b = static_cast<size_t>(system.block_size()), bb = b * b;
    double* a = system.values().data();
    const auto add = [&](const BlockSparse& m, const std::vector<BlockSparse::Slot>& slots, size_t i,
                         double factor) {
      const double* from = m.values().data();
      for (auto s = m.row_begin(i); s < m.row_begin(i + 1); ++s) {
        double* to = a + slots[s] * bb;
        for (size_t e = 0; e < bb; ++e) to[e] -= factor * from[s * bb + e];
      }
    };
    arena.for_blocks(system.block_rows(), kBlockRows, [&](size_t begin, size_t end) {
      std::fill(a + size_t{system.row_begin(begin)} * bb, a + size_t{system.row_begin(end)} * bb, 0.0);
      double most = 1;
      for (size_t i = begin; i < end; ++i) {
        double* diagonal = a + size_t{system.diagonal_slot(i)} * bb;
        if (w[i] == 0) {
          for (size_t k = 0; k < b; ++k) diagonal[k * b + k] = 1;
          continue;
        }
        add(dfdx, dfdx_slot, i, h * h);
        if (!dfdv.empty()) add(dfdv, dfdv_slot, i, h);
        for (auto s = system.row_begin(i); s < system.row_begin(i + 1); ++s) {
          if (w[system.column(s)] == 0) std::fill(a + s * bb, a + (s + 1) * bb, 0.0);
        }
        double trace = 0;
        for (size_t k = 0; k < b; ++k) {
          diagonal[k * b + k] += 1 / w[i];
          trace += diagonal[k * b + k];
        }
        most = std::max(most, trace * w[i] / double(b));
      }
      worst[begin / kBlockRows] = most;
    });
    return *std::max_element(worst.begin(), worst.end());
  }
};

class SparseStep {
 public:
  SparseStep(Motion& m, const IntegratorOptions& options)
      : m_(m),
        options_(options),
        w_(m.field.inverse_mass(m.state)),
        width_(m.v.size() / std::max<size_t>(w_.size(), 1)),
        n_(m.v.size()),
        e_{m.input.workspace, m.input.arena},
        matrices_(m.input.workspace.object<Matrices>("integrator.matrices")),
        a_(m.scratch("integrator.k1", n_)),
        b_(m.scratch("integrator.rhs", n_)),
        dv_(m.scratch("integrator.dv", n_)),
        x_(m.scratch("integrator.x", n_)),
        v_(m.scratch("integrator.v", n_)),
        partial_(m.scratch("integrator.partial", (w_.size() + kBlockRows - 1) / kBlockRows)) {
    matrices_.prepare(m.field, m.state, w_.size());
  }

  void one() {
    const double h = m_.input.h;
    m_.acceleration(end(), m_.x, m_.v, a_);
    // Not the exact Jacobian: one step along an indefinite system throws compressed cloth apart.
    m_.field.definite_jacobian({end(), m_.x, m_.v, m_.state}, matrices_.dfdx, matrices_.dfdv, e_);
    // h (f + h df/dx v); the velocity of held rows counts on the right-hand side.
    each_row([&](size_t begin, size_t end) {
      matrices_.dfdx.multiply_rows(m_.v.data(), b_.data(), begin, end);
      for (size_t i = begin; i < end; ++i) {
        for (size_t k = i * width_; k < (i + 1) * width_; ++k) {
          b_[k] = w_[i] > 0 ? h * (a_[k] / w_[i] + h * b_[k]) : 0;
        }
      }
    });
    solve(std::clamp(options_.newton_tolerance, 1e-14, 1e-2));
    m_.loop(n_, [x = m_.x.data(), v = m_.v.data(), dv = dv_.data(), h](size_t i) {
      v[i] += dv[i];
      x[i] += h * v[i];
    });
  }

  void converged() {
    std::copy(m_.v.begin(), m_.v.end(), v_.begin());
    double norm = residual(0);
    const double first = norm, scale = std::max(norm, momentum());
    const double target = options_.newton_tolerance * scale;
    for (int it = 0; norm > target; ++it) {
      if (!std::isfinite(norm)) fail("the forces became non-finite");
      if (it >= options_.max_newton_iterations) {
        fail("Newton's method did not converge in " + std::to_string(options_.max_newton_iterations) +
             " iterations");
      }
      m_.field.jacobian({end(), x_, v_, m_.state}, matrices_.dfdx, matrices_.dfdv, e_);
      // No more accuracy than this iterate deserves.
      const double accuracy = std::clamp(std::max(0.1 * target / norm, 0.1 * norm / first), 1e-14, 1e-2);
      if (solve(accuracy) == BlockSolver::Result::Sign::indefinite) {
        m_.field.definite_jacobian({end(), x_, v_, m_.state}, matrices_.dfdx, matrices_.dfdv, e_);
        solve(accuracy);
      }
      double share = 1, next = residual(share);
      while (!(next < norm) && share > 1e-3) {
        share *= 0.5;
        next = residual(-share);  // half of the way back
      }
      // At rest all forces cancel and only rounding is left: a step that moves nothing ends it.
      const bool at_rounding = m_.input.h * size(dv_) <= 1e-14 * size(m_.x);
      if (!(next < norm) && !at_rounding) fail("Newton's method found no better point");
      norm = next;
      if (at_rounding) break;
    }
    m_.loop(n_, [x = m_.x.data(), v = m_.v.data(), to = v_.data(), h = m_.input.h](size_t i) {
      v[i] = to[i];
      x[i] += h * v[i];
    });
  }

 private:
  double end() const { return m_.input.t + m_.input.h; }
  template <class Body>
  void each_row(Body body) const {
    m_.input.arena.for_blocks(w_.size(), kBlockRows, body);
  }
  // Sum over rows in fixed blocks.
  template <class Term>
  double sum(Term term) {
    each_row([&](size_t begin, size_t end) {
      double s = 0;
      for (size_t i = begin; i < end; ++i) s += term(i);
      partial_[begin / kBlockRows] = s;
    });
    double total = 0;
    for (const double p : partial_) total += p;
    return total;
  }

  // Moves v by share * dv, evaluates there, leaves -r in the right-hand side; the norm of r.
  double residual(double share) {
    const double h = m_.input.h;
    m_.loop(n_, [=, v = v_.data(), x = x_.data(), x0 = m_.x.data(), dv = dv_.data()](size_t i) {
      if (share != 0) v[i] += share * dv[i];
      x[i] = x0[i] + h * v[i];
    });
    m_.acceleration(end(), x_, v_, a_);
    const double total = sum([&](size_t i) {
      double s = 0;
      for (size_t k = i * width_; k < (i + 1) * width_; ++k) {
        const double per_mass = h * a_[k] - (v_[k] - m_.v[k]);
        b_[k] = w_[i] > 0 ? per_mass / w_[i] : 0;
        s += b_[k] * per_mass;
      }
      return s;
    });
    return std::sqrt(total);
  }
  // sqrt(sum m v^2)
  double momentum() {
    return std::sqrt(sum([&](size_t i) {
      double s = 0;
      for (size_t k = i * width_; k < (i + 1) * width_; ++k) s += m_.v[k] * m_.v[k];
      return w_[i] > 0 ? s / w_[i] : 0;
    }));
  }
  double size(std::span<const double> v) {
    return std::sqrt(sum([&](size_t i) {
      double s = 0;
      for (size_t k = i * width_; k < (i + 1) * width_; ++k) s += v[k] * v[k];
      return s;
    }));
  }

  BlockSolver::Result::Sign solve(double tolerance) {
    const double ratio = matrices_.assemble(w_, m_.input.h, m_.input.arena, partial_);
    const auto result =
        matrices_.solver.solve(matrices_.system, b_, dv_,
                               // Eigenvalues lie between the mass and twice the diagonal.
                               {.tolerance = tolerance,
                                .condition = 2 * ratio,
                                .symmetry = m_.field.symmetric_jacobian() ? BlockSolver::Symmetry::symmetric
                                                                          : BlockSolver::Symmetry::general},
                               m_.input.arena);
    if (!result.solved) fail("the system of an implicit step is singular");
    return result.sign;
  }

  [[noreturn]] void fail(const std::string& why) {
    size_t worst = 0;
    for (size_t k = 0; k < n_; ++k) {
      if (!(std::abs(b_[k]) <= std::abs(b_[worst]))) worst = k;
    }
    throw Instability("", "velocity", static_cast<long long>(worst / std::max<size_t>(width_, 1)),
                      why + "; a smaller dt would help");
  }

  Motion& m_;
  const IntegratorOptions& options_;
  std::span<const double> w_;
  size_t width_, n_;
  Evaluation e_;
  Matrices& matrices_;
  std::span<double> a_, b_, dv_, x_, v_, partial_;
};

}  // namespace

void implicit_euler_sparse(Motion& m, const IntegratorOptions& options, NewtonSteps steps) {
  if (m.v.empty()) return;
  SparseStep step(m, options);
  if (steps == NewtonSteps::one) {
    step.one();
  } else {
    step.converged();
  }
}

}  // namespace truestep
