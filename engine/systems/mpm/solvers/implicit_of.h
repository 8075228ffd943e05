// What the implicit substep does (implicit.h); compiled once for each dimension.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/systems/mpm/solvers/implicit.h"

namespace truestep::mpm {

template <int D, int Nodes>
void Implicit<D, Nodes>::reserve(const G& g, size_t slots) {
  for (Vector* v : {&v_, &anchor_, &gradient_, &step_, &r_, &p_, &q_, &z_}) v->reserve(g.nodes.capacity());
  inverse_.reserve(g.nodes.capacity() / 4 * kSix);
  tangents_.reserve(slots * kTangent);
  sums_.reserve(g.blocks.reserved()), stored_.reserve(g.blocks.reserved_owners());
  held_.reserve(g.blocks.reserved() * G::Size::kBlockNodes / 8);
}

template <int D, int Nodes>
auto Implicit<D, Nodes>::solve(G& g, const Setting& set, double t, double h, double pull,
                               const ThreadArena& arena) -> Report {
  h_ = h, set_ = &set;
  const size_t n = g.nodes.size();
  for (Vector* v : {&v_, &anchor_, &gradient_, &step_, &r_, &p_, &q_, &z_}) v->resize(n);
  inverse_.resize(n / 4 * kSix);
  tangents_.resize(g.now.slots() * kTangent);
  double mass = 0, squares = 0;
  for (size_t k = 0; k < n; ++k) {
    anchor_[k] = k % 4 == 0 ? 0 : g.nodes[k];
    if (k % 4 == 0) mass += g.nodes[k];
    squares += g.nodes[k - k % 4] * anchor_[k] * anchor_[k];
  }
  Report out{.converged = true};
  if (mass > 0) {
    held_.find(g, set, t, anchor_, v_);
    const double small =
        kTolerance * std::max({std::sqrt(squares / mass), pull * h, 1e-9 * set.def.cell / h});
    start(g, arena);
    invert_blocks(g, arena);
    out.converged = false;
    for (int round = 0; round < kRounds; ++round) {
      if (!newton(g, small * std::sqrt(mass), arena)) return out;
      out.converged = !held_.change(v_, gradient_, push_, speed_);
      if (out.converged) break;
    }
  }
  for (size_t k = 0; k < n; k += 4) {
    double speed2 = 0;
    for (size_t i = k + 1; i < k + 4; ++i) {
      if (!g.changes.empty()) g.changes[i] += v_[i] - g.nodes[i];
      g.nodes[i] = v_[i], speed2 += v_[i] * v_[i];
    }
    out.fastest = std::max(out.fastest, speed2);
  }
  out.fastest = std::sqrt(out.fastest);
  return out;
}

template <int D, int Nodes>
void Implicit<D, Nodes>::start(G& g, const ThreadArena& arena) {
  if (std::isfinite(energy(g, v_, arena))) return;
  held_.rest(v_);
}

template <int D, int Nodes>
auto Implicit<D, Nodes>::gradient_of(const Stencils<D, Nodes, double>& at, const double* tile,
                                     double per_second) -> M {
  alignas(64) double rows[G::kRowNumbers];
  for (int lane = 0; lane < W::kLanes; ++lane)
    gather<D, Nodes, G::Size::kReach, G::Size::kRow>(at, lane, tile, rows);
  M c;
  W moment[4];
  for (int q = 0; q < D; ++q) {
    from_rows(rows + (q + 1) * 4 * W::kLanes, moment);
    for (int i = 0; i < D; ++i) c(i, q) = moment[i + 1] * W(per_second);
  }
  return c;
}

template <int D, int Nodes>
void Implicit<D, Nodes>::for_groups(G& g, const Vector& nodes, const ThreadArena& arena, Visit visit) {
  const double dx = set_->def.cell, per_second = h_ / (Spline<Nodes, double>::kSecond * dx * dx);
  arena.for_blocks(g.blocks.owners.size(), 4, [&](size_t begin, size_t end) {
    alignas(64) double tile[G::kTileNumbers] = {};
    Stencils<D, Nodes, double> at;
    for (size_t k = begin; k < end; ++k) {
      const Block& b = g.blocks.blocks[g.blocks.owners[k]];
      Tiles<D, Nodes, double>::fill(b, nodes, tile);
      for (size_t r = b.first; r < b.last; ++r) {
        const Run& run = g.blocks.runs[r];
        for (size_t s = run.begin; s < run.end; s += W::kLanes) {
          g.locate(b, g.now.group(s), dx, at);
          const int many = static_cast<int>(std::min<size_t>(W::kLanes, run.end - s));
          visit(set_->pieces[run.body], s, many, at, gradient_of(at, tile, per_second), k);
        }
      }
    }
  });
}

template <int D, int Nodes>
void Implicit<D, Nodes>::impulses(G& g, const Vector& nodes, Vector& out, const ThreadArena& arena,
                                  StressOf stress_of) {
  const double dx = set_->def.cell, second = Spline<Nodes, double>::kSecond * dx * dx;
  g.tiles.resize(g.blocks.owners.size() * G::kTileNumbers);
  std::fill(g.tiles.begin(), g.tiles.end(), 0.0);
  for_groups(g, nodes, arena,
             [&](const Piece& piece, size_t s, int many, const Stencils<D, Nodes, double>& at, const M& c,
                 size_t k) {
               const M a = stress_of(piece, s, c);
               const W share(h_ * piece.volume / second), zero = W::zero();
               alignas(64) double rows[G::kRowNumbers] = {};
               for (int q = 0; q < D; ++q) {
                 W four[4] = {zero, zero, zero, zero};
                 for (int i = 0; i < D; ++i) four[i + 1] = share * a(i, q);
                 to_rows(four, rows + (q + 1) * 4 * W::kLanes);
               }
               double* tile = g.tiles.data() + k * G::kTileNumbers;
               for (int lane = 0; lane < many; ++lane)
                 scatter<D, Nodes, G::Size::kReach, G::Size::kRow>(at, lane, rows, tile);
             });
  arena.for_blocks(g.blocks.blocks.size(), 8, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k)
      Tiles<D, Nodes, double>::sum(g.blocks, g.blocks.blocks[k], g.tiles, out.data() + k * G::kBlockNumbers);
  });
}

template <int D, int Nodes>
double Implicit<D, Nodes>::size_of(const G& g, const Vector& r, const ThreadArena& arena) {
  return sum(g, arena, [&](size_t i) {
    const double m = g.nodes[i - i % 4];
    return m > 0 ? r[i] * r[i] / m : 0.0;
  });
}

template <int D, int Nodes>
double Implicit<D, Nodes>::energy(G& g, const Vector& v, const ThreadArena& arena) {
  stored_.assign(g.blocks.owners.size(), 0);
  for_groups(
      g, v, arena,
      [&](const Piece& piece, size_t s, int many, const Stencils<D, Nodes, double>&, const M& c, size_t k) {
        const M f = moved(g.now.group(s), c);
        const W psi = response<D, double>(piece.material, f, W(1), W(1)).energy, j = determinant(f);
        for (int lane = 0; lane < many; ++lane) {
          const bool out = piece.material.law == Law::neo_hookean && !(j[lane] > kLeastVolume);
          stored_[k] += out ? HUGE_VAL : piece.volume * psi[lane];
        }
      });
  double total = sum(g, arena, [&](size_t i) {
    const double d = v[i] - anchor_[i];
    return i % 4 == 0 ? 0 : 0.5 * g.nodes[i - i % 4] * d * d;
  });
  for (const double e : stored_) total += e;
  return total;
}

template <int D, int Nodes>
void Implicit<D, Nodes>::linearise(G& g, const ThreadArena& arena) {
  impulses(g, v_, gradient_, arena, [&](const Piece& piece, size_t s, const M& c) {
    Stiffness<D, double> k;
    const double* group = g.now.group(s);
    const M p = stress_and_stiffness(piece.material, moved(group, c), k);
    double* to = tangents_.data() + s * kTangent;
    for (const M* m : {&k.u, &k.v, &k.stretch}) {
      for (int i = 0; i < D * D; ++i, to += W::kLanes) store(to, m->m[i]);
    }
    for (int i = 0; i < Stiffness<D, double>::kPairs; ++i, to += 2 * W::kLanes)
      store(to, k.shear[i]), store(to + W::kLanes, k.turn[i]);
    return p * transposed(G::load_square(group, L::f));
  });
  push_ = speed_ = 0;
  for (size_t i = 0; i < gradient_.size(); ++i) {
    push_ = std::max(push_, std::abs(gradient_[i])), speed_ = std::max(speed_, std::abs(v_[i]));
    if (i % 4 != 0) gradient_[i] += g.nodes[i - i % 4] * (v_[i] - anchor_[i]);
  }
}

template <int D, int Nodes>
void Implicit<D, Nodes>::product(G& g, const ThreadArena& arena) {
  impulses(g, p_, q_, arena, [&](const Piece&, size_t s, const M& c) {
    Stiffness<D, double> k;
    const double* from = tangents_.data() + s * kTangent;
    for (M* m : {&k.u, &k.v, &k.stretch}) {
      for (int i = 0; i < D * D; ++i, from += W::kLanes) m->m[i] = load(from);
    }
    for (int i = 0; i < Stiffness<D, double>::kPairs; ++i, from += 2 * W::kLanes)
      k.shear[i] = load(from), k.turn[i] = load(from + W::kLanes);
    const M f = G::load_square(g.now.group(s), L::f);
    return k.apply(c * f) * transposed(f);
  });
  for (size_t i = 0; i < q_.size(); ++i) q_[i] += g.nodes[i - i % 4] * p_[i];
  held_.project(q_);
}

template <int D, int Nodes>
void Implicit<D, Nodes>::invert_blocks(G& g, const ThreadArena& arena) {
  const double dx = set_->def.cell, per_second = h_ / (Spline<Nodes, double>::kSecond * dx * dx);
  g.tiles.resize(g.blocks.owners.size() * G::kTileNumbers);
  for (const Entries entries : {Entries::diagonal, Entries::others}) {
    std::fill(g.tiles.begin(), g.tiles.end(), 0.0);
    for_groups(
        g, v_, arena,
        [&](const Piece& piece, size_t, int many, const Stencils<D, Nodes, double>& at, const M&, size_t k) {
          double* tile = g.tiles.data() + k * G::kTileNumbers;
          const double both = piece.volume * (piece.material.lambda + piece.material.mu),
                       own = piece.volume * piece.material.mu;
          for (int lane = 0; lane < many; ++lane)
            add_node_blocks<D, Nodes, G::Size::kReach, G::Size::kRow>(at, lane, per_second, both, own,
                                                                      entries, tile);
        });
    Vector& out = entries == Entries::diagonal ? q_ : p_;
    arena.for_blocks(g.blocks.blocks.size(), 8, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k)
        Tiles<D, Nodes, double>::sum(g.blocks, g.blocks.blocks[k], g.tiles,
                                     out.data() + k * G::kBlockNumbers);
    });
  }
  for (size_t node = 0; node < q_.size(); node += 4)
    inverse_of_block<D>(g.nodes[node], &q_[node + 1], &p_[node + 1], &inverse_[node / 4 * kSix]);
}

template <int D, int Nodes>
void Implicit<D, Nodes>::precondition() {
  for (size_t node = 0; node < r_.size(); node += 4)
    apply_block(&inverse_[node / 4 * kSix], &r_[node], &z_[node]);
  held_.project(z_);
}

template <int D, int Nodes>
void Implicit<D, Nodes>::direction(G& g, double tolerance, const ThreadArena& arena) {
  const size_t n = gradient_.size();
  std::fill(step_.begin(), step_.end(), 0.0);
  for (size_t i = 0; i < n; ++i) r_[i] = -gradient_[i];
  held_.project(r_);
  precondition();
  p_ = z_;
  double now = dot_of(g, r_, z_, arena);
  const double enough = tolerance * tolerance * now;
  for (int k = 0; k < kMostProducts && now > enough; ++k) {
    product(g, arena);
    const double curvature = dot_of(g, p_, q_, arena);
    if (!(curvature > 0)) break;
    const double alpha = now / curvature;
    for (size_t i = 0; i < n; ++i) step_[i] += alpha * p_[i], r_[i] -= alpha * q_[i];
    precondition();
    const double next = dot_of(g, r_, z_, arena), beta = next / now;
    for (size_t i = 0; i < n; ++i) p_[i] = z_[i] + beta * p_[i];
    now = next;
  }
}

template <int D, int Nodes>
bool Implicit<D, Nodes>::newton(G& g, double small, const ThreadArena& arena) {
  double before = energy(g, v_, arena);
  for (int k = 0; k < kNewton; ++k) {
    linearise(g, arena);
    r_ = gradient_;
    held_.project(r_);
    const double size = std::sqrt(size_of(g, r_, arena));
    if (!std::isfinite(size)) return false;
    if (size <= small) return true;
    direction(g, std::clamp(0.3 * small / size, 1e-8, 0.1), arena);
    const double slope = dot_of(g, step_, gradient_, arena);
    double share = 1, after = HUGE_VAL;
    p_ = v_;
    bool falls = false;
    for (int tries = 0; tries < kHalvings && !falls; ++tries, share *= 0.5) {
      for (size_t i = 0; i < v_.size(); ++i) v_[i] = p_[i] + share * step_[i];
      after = energy(g, v_, arena);
      // Armijo's condition, to rounding of the energy.
      falls = after <= before + 1e-4 * share * slope + kRound * std::abs(before);
    }
    // As close as rounding of the energy allows.
    if (!falls) return size <= kNear * small;
    before = after;
  }
  return false;
}

}  // namespace truestep::mpm
