// One substep on sorted particles: particles to tiles, tiles to nodes, nodes to particles. Rigid bodies and
// other velocity fields act on nodes in between (solver.cc).
#pragma once
#include <cmath>

#include "engine/systems/mpm/bodies_in.h"
#include "engine/systems/mpm/boundaries.h"
#include "engine/systems/mpm/groups.h"
#include "engine/systems/mpm/tiles.h"

namespace truestep::mpm {

template <int D, int Nodes, class T>
struct Grid : Boundaries<D, Nodes, T>, Group<D, T> {
  using Size = Tiling<D, Nodes>;
  using L = Layout<D>;
  using W = Wide<T>;
  using Own = Group<D, T>;
  using Edges = Boundaries<D, Nodes, T>;
  using Edges::blocks, Edges::place_of, Edges::held, Edges::is_free;
  using Own::kRowNumbers, Own::largest_lane, Own::respond, Own::speed2, Own::contributions, Own::deform;
  static constexpr size_t kBlockNumbers = Tiles<D, Nodes, T>::kBlockNumbers,
                          kTileNumbers = Tiles<D, Nodes, T>::kTileNumbers;

  Sorted<D, T> now, next;
  BodiesIn bodies;
  Aligned<T> tiles, nodes;
  Aligned<T> impulses,
      changes;  ///< for FLIP: tiles of stress alone; for nodes, what the substep adds to velocities
  std::vector<double> fastest, modulus;
  std::span<const uint32_t> piece_of_row;  ///< of the state, if particles are emitted or removed

  /// Largest of a list of non-negative numbers.
  static double largest(const std::vector<double>& v) {
    double most = 0;
    for (const double x : v) most = std::max(most, x);
    return most;
  }

  /// Reserves memory for the whole run, after particles were first sorted.
  void reserve(const Setting& set) {
    const double expected =
        set.def.changes() ? expected_blocks(set.def, static_cast<double>(set.capacity)) : 0;
    blocks.reserve(set.capacity, set.pieces.size(), expected, now, next);
    const bool flip = set.def.transfer == Transfer::flip;
    tiles.reserve(blocks.reserved_owners() * kTileNumbers);
    nodes.reserve(blocks.reserved() * kBlockNumbers);
    if (flip) impulses.reserve(tiles.capacity()), changes.reserve(nodes.capacity());
    fastest.reserve(blocks.reserved()), modulus.reserve(blocks.reserved());
  }

  /// Computes the stress of all particles from their deformation, and the limits of the first substep.
  void stresses(const Setting& set, const ThreadArena& arena) {
    fastest.assign(blocks.owners.size(), 0), modulus.assign(blocks.owners.size(), 0);
    arena.for_blocks(blocks.owners.size(), 4, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const Block& b = blocks.blocks[blocks.owners[k]];
        for (size_t r = b.first; r < b.last; ++r) {
          const Run& run = blocks.runs[r];
          const Piece& piece = set.pieces[run.body];
          for (size_t s = run.begin; s < run.end; s += W::kLanes) {
            T* group = now.group(s);
            const T most = respond(piece, group, Then::stress);
            modulus[k] = std::max(modulus[k], double{most} / piece.density);
            fastest[k] = std::max(fastest[k], speed2(group));
          }
        }
      }
    });
  }
  /// Positions of a group's particles in the tile of their block.
  void locate(const Block& b, const T* group, T dx, Stencils<D, Nodes, T>& out) const {
    W place[D];
    for (int a = 0; a < D; ++a) {
      const T first = static_cast<T>(Size::kPad - b.at[a] * Size::kBlock + 1);
      place[a] = (load(group + (L::x + a) * W::kLanes) - W(blocks.low[a])) * W(blocks.inverse_dx) + W(first);
    }
    out.template set<Size::kReach, Size::kRow>(place, dx);
  }

  /// m/s^2, of the particles in slots [s, end), at most as many as texts take at once: all of one component,
  /// then all of the next.
  void accelerations(const Setting& set, double t, size_t s, size_t end, double* out) const {
    alignas(64) double x[3][PlaceTexts::kMost] = {};
    const size_t many = std::min(end - s + W::kLanes - 1, PlaceTexts::kMost) / W::kLanes * W::kLanes;
    for (size_t k = 0; k < many; k += W::kLanes) {
      for (int i = 0; i < D; ++i) {
        const W at = load(now.group(s + k) + (L::x + i) * W::kLanes);
        for (size_t lane = 0; lane < W::kLanes; ++lane) x[i][k + lane] = double{at[static_cast<int>(lane)]};
      }
    }
    set.force.run(t, x[0], x[1], x[2], many, out, PlaceTexts::kMost);
  }

  void scatter_all(const Setting& set, double t, T h, const ThreadArena& arena) {
    const T dx = static_cast<T>(set.def.cell);
    tiles.resize(blocks.owners.size() * kTileNumbers);
    const bool affine = set.def.transfer == Transfer::apic;
    if (!affine) impulses.resize(tiles.size());
    const T second = Spline<Nodes, T>::kSecond * dx * dx;
    arena.for_blocks(blocks.owners.size(), 4, [&](size_t begin, size_t end) {
      Stencils<D, Nodes, T> at;
      alignas(64) T rows[kRowNumbers];
      alignas(64) T still[kRowNumbers] = {};
      alignas(64) double pull[3 * PlaceTexts::kMost];
      for (size_t k = begin; k < end; ++k) {
        T* tile = tiles.data() + k * kTileNumbers;
        std::fill(tile, tile + kTileNumbers, T{0});
        T* impulse = affine ? nullptr : impulses.data() + k * kTileNumbers;
        if (impulse) std::fill(impulse, impulse + kTileNumbers, T{0});
        const Block& b = blocks.blocks[blocks.owners[k]];
        for (size_t r = b.first; r < b.last; ++r) {
          const Run& run = blocks.runs[r];
          const Piece& piece = set.pieces[run.body];
          const T mass = static_cast<T>(piece.mass), keep = affine ? mass : T{0};
          // An implicit step adds the stress afterwards.
          const T push = set.def.is_implicit() ? T{0} : -h * static_cast<T>(piece.volume) / second;
          for (size_t s = run.begin; s < run.end; s += W::kLanes) {
            const int many = static_cast<int>(std::min<size_t>(W::kLanes, run.end - s));
            locate(b, now.group(s), dx, at);
            contributions(now.group(s), mass, keep, push, rows);
            if (impulse) {
              // Momentum and its change go to separate nodes.
              std::copy(rows, rows + 4 * W::kLanes, still);
              std::fill(rows, rows + 4 * W::kLanes, T{0});
            }
            if (!set.force.empty()) {
              const size_t from = (s - run.begin) % PlaceTexts::kMost;
              if (from == 0) accelerations(set, t, s, run.end, pull);
              for (size_t i = 0; i < D; ++i) {
                for (size_t lane = 0; lane < W::kLanes; ++lane)
                  rows[4 * lane + i + 1] +=
                      mass * h * static_cast<T>(pull[i * PlaceTexts::kMost + from + lane]);
              }
            }
            T* first = impulse ? impulse : tile;
            for (int lane = 0; lane < many; ++lane) {
              scatter<D, Nodes, Size::kReach, Size::kRow>(at, lane, rows, first);
              if (impulse) scatter<D, Nodes, Size::kReach, Size::kRow>(at, lane, still, tile);
            }
          }
        }
      }
    });
  }

  /// Sums tiles into blocks and updates the node velocities. Returns the fastest node's speed.
  double move_nodes(const Setting& set, const Vec3& gravity, double t, T h, const ThreadArena& arena) {
    nodes.resize(blocks.blocks.size() * kBlockNumbers);
    const bool flip = set.def.transfer == Transfer::flip;
    if (flip) changes.resize(nodes.size());
    fastest.assign(blocks.blocks.size(), 0);
    arena.for_blocks(blocks.blocks.size(), 8, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        const Block& b = blocks.blocks[k];
        T* own = nodes.data() + k * kBlockNumbers;
        T* change = flip ? changes.data() + k * kBlockNumbers : nullptr;
        Tiles<D, Nodes, T>::sum(blocks, b, tiles, own);
        if (flip) Tiles<D, Nodes, T>::sum(blocks, b, impulses, change);
        fastest[k] = move_block(set, b, gravity, t, h, own, change);
      }
    });
    return std::sqrt(largest(fastest));
  }

  /// Velocities from momenta where no boundary acts. Returns the square of the largest.
  static double move_free(const T* g, T h, T* own) {
    const W zero = W::zero();
    W gain = zero, mask = zero, most = zero;
    for (int i = 0; i < W::kLanes; ++i) {
      const int c = i & 3;
      mask.set(i, c > 0 && c <= D ? T{1} : T{0});
      gain.set(i, c > 0 && c <= D ? g[c - 1] * h : T{0});
    }
    for (size_t n = 0; n < kBlockNumbers; n += W::kLanes) {
      const W node = load(own + n), mass = first_of_four(node);
      const auto there = mass > zero;
      const W v = select(there, madd(node * mask, W(1) / select(there, mass, W(1)), gain), zero);
      // The mass stays next to the velocity.
      store(own + n, select(mask > zero, v, node));
      most = max(most, sums_of_four(v * v));
    }
    return double{largest_lane(most)};
  }
  static W first_of_four(W a) {
    if constexpr (W::kLanes == 8) {
      return {__builtin_shufflevector(a.v, a.v, 0, 0, 0, 0, 4, 4, 4, 4)};
    } else {
      return {__builtin_shufflevector(a.v, a.v, 0, 0, 0, 0)};
    }
  }
  static W sums_of_four(W a) {
    if constexpr (W::kLanes == 8) {
      a += W(__builtin_shufflevector(a.v, a.v, 1, 0, 3, 2, 5, 4, 7, 6));
      return a + W(__builtin_shufflevector(a.v, a.v, 2, 3, 0, 1, 6, 7, 4, 5));
    } else {
      a += W(__builtin_shufflevector(a.v, a.v, 1, 0, 3, 2));
      return a + W(__builtin_shufflevector(a.v, a.v, 2, 3, 0, 1));
    }
  }

  double move_block(const Setting& set, const Block& b, const Vec3& gravity, double t, T h, T* own,
                    T* change) const {
    const MpmDef& def = set.def;
    const T g[3] = {static_cast<T>(gravity.x), static_cast<T>(gravity.y), static_cast<T>(gravity.z)};
    const bool free = is_free(set, b, t);
    if (!change && free && set.colliders.empty()) return move_free(g, h, own);
    double most = 0;
    for (size_t n = 0; n < Size::kBlockNodes; ++n) {
      T* node = own + 4 * n;
      if (!(node[0] > 0)) continue;
      const T inverse = 1 / node[0];
      const Vec3T<T> before{node[1] * inverse, node[2] * inverse, D == 3 ? node[3] * inverse : T{0}};
      Vec3T<T> v = before + Vec3T<T>{g[0], g[1], D == 3 ? g[2] : T{0}} * h;
      if (change) {
        const T* impulse = change + 4 * n;
        v += Vec3T<T>{impulse[1], impulse[2], D == 3 ? impulse[3] : T{0}} * inverse;
      }
      // An implicit step handles boundaries in its solve.
      if (!free && !def.is_implicit()) v = held(set, place_of(def, b, n), t, v);
      if (change) {
        T* c = change + 4 * n;
        c[0] = 0, c[1] = v.x - before.x, c[2] = v.y - before.y, c[3] = v.z - before.z;
      }
      node[1] = v.x, node[2] = v.y, node[3] = v.z;
      const double speed = double{norm2(v)};
      if (!(speed <= most)) most = speed;
    }
    return most;
  }

  /// Contact of nodes with the bodies among them, before the substep is accepted. Returns the speed of the
  /// fastest such node.
  double touch_bodies(const Setting& set, const Vec3& gravity, double t, T h) {
    const MpmDef& def = set.def;
    const bool flip = def.transfer == Transfer::flip;
    const auto visit = [&](const Box& box, BodiesIn::See see) {
      const double lows[3] = {box.low.x, box.low.y, box.low.z},
                   highs[3] = {box.high.x, box.high.y, box.high.z};
      int first[3] = {}, last[3] = {};
      for (int a = 0; a < D; ++a) {
        const auto node = [&](double x) {
          return std::clamp((x - blocks.low[a]) * blocks.inverse_dx + Size::kPad, 0.0,
                            static_cast<double>(blocks.extent[a]) * Size::kBlock);
        };
        first[a] = static_cast<int>(node(lows[a])) / Size::kBlock;
        last[a] = static_cast<int>(node(highs[a])) / Size::kBlock;
      }
      for (size_t k = 0; k < blocks.blocks.size(); ++k) {
        const Block& b = blocks.blocks[k];
        bool near = true;
        for (int a = 0; a < D; ++a) near = near && b.at[a] >= first[a] && b.at[a] <= last[a];
        if (!near) continue;
        for (size_t n = 0; n < Size::kBlockNodes; ++n) {
          const size_t handle = k * kBlockNumbers + 4 * n;
          const T* node = nodes.data() + handle;
          if (!(node[0] > 0)) continue;
          const Vec3 x = place_of(def, b, n);
          if (!box.contains({x, x})) continue;
          see(x, double{node[0]}, Vec3{double{node[1]}, double{node[2]}, double{node[3]}}, handle);
        }
      }
    };
    // Walls are applied last; their impulse is not passed to the body.
    const auto settle = [&](size_t handle, const Vec3& to) {
      T* node = nodes.data() + handle;
      const Vec3 before{double{node[1]}, double{node[2]}, double{node[3]}};
      const Vec3T<T> v{static_cast<T>(to.x), static_cast<T>(to.y), static_cast<T>(to.z)};
      const Vec3 got = Vec3{double{v.x}, double{v.y}, double{v.z}} - before;
      const Block& b = blocks.blocks[handle / kBlockNumbers];
      const Vec3T<T> end = held(set, place_of(def, b, handle % kBlockNumbers / 4), t, v);
      if (flip) {
        T* c = changes.data() + handle;
        c[1] += end.x - node[1], c[2] += end.y - node[2], c[3] += end.z - node[3];
      }
      node[1] = end.x, node[2] = end.y, node[3] = end.z;
      return got;
    };
    return bodies.push(def, gravity, double{h}, visit, settle);
  }

  /// Updates velocities, positions and deformations of all particles from the nodes.
  void gather_all(const Setting& set, T h, Then then, const ThreadArena& arena) {
    const MpmDef& def = set.def;
    const T dx = static_cast<T>(def.cell);
    const W per_second(1 / (Spline<Nodes, T>::kSecond * dx * dx)), hh(h), share(def.flip);
    const bool flip = def.transfer == Transfer::flip;
    fastest.assign(blocks.owners.size(), 0), modulus.assign(blocks.owners.size(), 0);
    const double lows[3] = {def.low.x, def.low.y, def.low.z}, highs[3] = {def.high.x, def.high.y, def.high.z};
    double nearest[3], farthest[3];
    // A hundredth of a cell off the sides.
    for (int i = 0; i < 3; ++i)
      nearest[i] = lows[i] + 0.01 * def.cell, farthest[i] = highs[i] - 0.01 * def.cell;
    arena.for_blocks(blocks.owners.size(), 4, [&](size_t begin, size_t end) {
      alignas(64) T tile[kTileNumbers] = {};
      alignas(64) T change[kTileNumbers];
      if (flip) std::fill(change, change + kTileNumbers, T{0});
      alignas(64) T rows[kRowNumbers], more[kRowNumbers];
      Stencils<D, Nodes, T> at;
      for (size_t k = begin; k < end; ++k) {
        const Block& b = blocks.blocks[blocks.owners[k]];
        Tiles<D, Nodes, T>::fill(b, nodes, tile);
        if (flip) Tiles<D, Nodes, T>::fill(b, changes, change);
        for (size_t r = b.first; r < b.last; ++r) {
          const Run& run = blocks.runs[r];
          const Piece& piece = set.pieces[run.body];
          for (size_t s = run.begin; s < run.end; s += W::kLanes) {
            T* group = now.group(s);
            locate(b, group, dx, at);
            for (int lane = 0; lane < W::kLanes; ++lane) {
              gather<D, Nodes, Size::kReach, Size::kRow>(at, lane, tile, rows);
              if (flip) gather<D, Nodes, Size::kReach, Size::kRow>(at, lane, change, more);
            }
            W v[4], dv[4], moment[4];
            from_rows(rows, v);
            if (flip) from_rows(more, dv);
            for (int i = 0; i < D; ++i) {
              T *x = group + (L::x + i) * W::kLanes, *u = group + (L::v + i) * W::kLanes;
              store(x, min(max(madd(hh, v[i + 1], load(x)), W(nearest[i])), W(farthest[i])));
              // FLIP keeps its share of the particle's own velocity and adds the nodes' gain.
              store(u, flip ? madd(share, load(u) + dv[i + 1], (W(1) - share) * v[i + 1]) : v[i + 1]);
            }
            for (int q = 0; q < D; ++q) {
              from_rows(rows + (q + 1) * 4 * W::kLanes, moment);
              for (int i = 0; i < D; ++i) {
                store(group + (L::c + D * i + q) * W::kLanes, moment[i + 1] * per_second);
              }
            }
            deform(piece, group, h);
            modulus[k] = std::max(modulus[k], double{respond(piece, group, then)} / piece.density);
            fastest[k] = std::max(fastest[k], speed2(group));
          }
        }
      }
    });
  }
};

}  // namespace truestep::mpm
