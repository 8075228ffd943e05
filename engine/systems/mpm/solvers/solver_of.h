// A step of the material point method for one dimension, one kind of splines and one precision.
#pragma once
#include <cmath>
#include <string>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/systems/mpm/field_contact.h"
#include "engine/systems/mpm/rows.h"
#include "engine/systems/mpm/solvers/implicit.h"

namespace truestep::mpm {

inline constexpr double kMostDrift = 0.98;  // cells, since particles were sorted

template <int D, int Nodes, class T>
class SolverOf final : public Solver {
 public:
  explicit SolverOf(const Setting& setting) : set_(setting) {}

  void step(State& s, const StepInput& in) const override {
    auto& grid = in.workspace.object<Grid<D, Nodes, T>>("mpm.grid");
    const bool first = grid.blocks.table.empty();
    if (first) grid.blocks.set(set_.def.low, set_.def.high, set_.def.cell, set_.fields);
    grid.piece_of_row = set_.pieces_of(s);
    const Rows<D, T> rows(s);
    load_rows(rows, grid, in);
    if (first) {
      grid.reserve(set_);
      if (set_.fields > 1)
        in.workspace.object<FieldContact<D, Nodes, T>>("mpm.field_contact").reserve(grid.now.row.capacity());
      if constexpr (sizeof(T) == 8) {
        if (set_.def.is_implicit())
          in.workspace.object<Implicit<D, Nodes>>("mpm.implicit").reserve(grid, grid.blocks.keys.capacity());
      }
    }
    {
      const ProfileScope scope(in.profile, "mpm stresses");
      grid.stresses(set_, in.arena);
    }
    grid.bodies.begin(in.bodies, set_.def.cell);
    const Vec3 gravity = load3(std::as_const(s).f64(columns::gravity).data(), 0);
    double left = in.h, drift = 0;
    for (int64_t k = 0; left > 0; ++k) {
      const double allowed = limit(grid);
      const double parts = std::ceil(left / allowed);
      if (!(parts + static_cast<double>(k) <= set_.def.max_substeps)) refuse(allowed);
      drift = substep(grid, gravity, in, parts > 1 ? left / parts : left, drift, left);
    }
    grid.bodies.end(in.bodies);
    const ProfileScope scope(in.profile, "mpm sort");
    rows.save(grid.now, in.arena);
  }

 private:
  /// s, longest substep for the fastest particle or wave.
  double limit(const Grid<D, Nodes, T>& grid) const {
    // Waves do not limit an implicit step.
    const double waves = set_.def.is_implicit() ? 0 : grid.largest(grid.modulus);
    const double own = std::sqrt(std::max(grid.largest(grid.fastest), waves));
    const double speed = std::max(own, grid.bodies.fastest());
    return speed > 0 ? set_.def.courant * set_.def.cell / speed : HUGE_VAL;
  }

  /// Takes one substep, at most `left` long; returns the drift after it.
  double substep(Grid<D, Nodes, T>& grid, const Vec3& gravity, const StepInput& in, double h, double drift,
                 double& left) const {
    constexpr int kTries = 40;
    const double cell = set_.def.cell;
    for (int tries = 0; tries < kTries; ++tries) {
      if (drift > kMostDrift - set_.def.courant) {
        std::swap(grid.now, grid.next);
        sort(grid, in);
        drift = 0;
      }
      const T length = static_cast<T>(h);
      {
        const ProfileScope scope(in.profile, "mpm scatter");
        grid.scatter_all(set_, in.t + in.h - left, length, in.arena);
      }
      double speed;
      {
        const ProfileScope scope(in.profile, "mpm nodes");
        const double t = in.t + in.h - left;
        speed = grid.move_nodes(set_, gravity, t, length, in.arena);
        if constexpr (sizeof(T) == 8) {
          if (set_.def.is_implicit()) {
            auto& implicit = in.workspace.object<Implicit<D, Nodes>>("mpm.implicit");
            const auto found = implicit.solve(grid, set_, t, h, norm(gravity), in.arena);
            if (!found.converged) {
              h *= 0.5;
              continue;
            }
            speed = found.fastest;
          }
        }
        if (set_.fields > 1) {
          auto& contact = in.workspace.object<FieldContact<D, Nodes, T>>("mpm.field_contact");
          speed = std::max(speed, contact.act(grid, set_, t, h, in.arena));
        }
        if (grid.bodies.any()) speed = std::max(speed, grid.touch_bodies(set_, gravity, t, length));
      }
      // A node may be faster than any particle was, and tiles have room for one cell of drift.
      if (!(drift + speed * h / cell <= kMostDrift)) {
        if (drift > 0) {
          drift = 1;
        } else {
          h *= 0.5;
        }
        continue;
      }
      {
        const ProfileScope scope(in.profile, "mpm gather");
        // The stress after a step's last substep is not used.
        const bool last = !(h < left);
        grid.gather_all(set_, length, last ? Then::flow : Then::both, in.arena);
      }
      grid.bodies.accept(h);
      left = h < left ? left - h : 0;
      return drift + speed * h / cell;
    }
    throw Instability(set_.id, "velocity", -1,
                      "no substep is short enough: nodes cross a cell or the solver does not converge");
  }

  size_t field_of(const Grid<D, Nodes, T>& grid, size_t row) const {
    return set_.fields == 1 ? 0 : set_.pieces[set_.piece_of(row, grid.piece_of_row)].field;
  }
  /// From grid.next to grid.now.
  void sort(Grid<D, Nodes, T>& grid, const StepInput& in) const {
    const ProfileScope scope(in.profile, "mpm sort");
    grid.blocks.sort(
        grid.next, grid.now, set_.pieces.size(),
        [&](uint32_t row) { return set_.piece_of(row, grid.piece_of_row); },
        [&](uint32_t row) { return field_of(grid, row); }, in.arena);
  }

  [[noreturn]] void refuse(double allowed) const {
    Instability failure(set_.id, "velocity", -1,
                        "material point method: particles and waves allow substeps of " +
                            short_number(allowed, 3) + " s, more than max_substeps (" +
                            std::to_string(set_.def.max_substeps) + ") a step");
    if (allowed > 0) failure.suggested_dt = allowed * set_.def.max_substeps;
    throw failure;
  }

  /// Loads particles in the order of blocks, bodies and rows.
  void load_rows(const Rows<D, T>& rows, Grid<D, Nodes, T>& grid, const StepInput& in) const {
    const ProfileScope scope(in.profile, "mpm sort");
    const size_t n = rows.count();
    auto& blocks = grid.blocks;
    blocks.keys.resize(n);
    in.arena.for_blocks(n, kBlockRows, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) blocks.keys[i] = blocks.block_of(rows.place(i), field_of(grid, i));
    });
    blocks.arrange(
        n, set_.pieces.size(), [&](size_t i) { return set_.piece_of(i, grid.piece_of_row); },
        [](size_t i) { return static_cast<uint32_t>(i); }, grid.now);
    rows.load(grid.now, in.arena);
  }

  const Setting& set_;
};

template <int D, class T>
std::unique_ptr<const Solver> solver_with_splines(const Setting& s) {
  if (s.def.splines == Splines::quadratic) return std::make_unique<SolverOf<D, 3, T>>(s);
  return std::make_unique<SolverOf<D, 4, T>>(s);
}

}  // namespace truestep::mpm
