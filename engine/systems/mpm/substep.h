// One substep on sorted particles: the parts of solver.h.
#pragma once
#include <cmath>

#include "engine/systems/mpm/blocks.h"
#include "engine/systems/mpm/solver.h"
#include "engine/systems/mpm/transfer.h"

namespace truestep::mpm {

/// Velocity of a node at a boundary with unit normal n into the free side that moves with `of`.
template <class T>
Vec3T<T> bounded(const Vec3T<T>& v, const Vec3T<T>& n, const Vec3T<T>& of, Contact kind, T friction) {
  if (kind == Contact::sticky) return of;
  const Vec3T<T> relative = v - of;
  const T into = dot(relative, n);
  if (kind == Contact::separate && into >= 0) return v;
  const Vec3T<T> along = relative - n * into;
  if (kind == Contact::slip) return of + along;
  // Coulomb's bound on the impulse along the boundary.
  const T speed = norm(along);
  return speed > -friction * into ? of + along * (1 + friction * into / speed) : of;
}

template <int D, int Nodes, class T>
struct Grid {
  using Size = Tiling<D, Nodes>;
  using L = Layout<D>;
  using W = Wide<T>;
  static constexpr size_t kBlockNumbers = 4 * Size::kBlockNodes, kTileNumbers = 4 * Size::kTileNodes;

  Blocks<D, Nodes, T> blocks;
  Sorted<D, T> now, next;
  Aligned<T> tiles, nodes;
  Aligned<T> impulses,
      changes;  ///< of FLIP: tiles of stress alone; of nodes, what the substep adds to velocities
  std::vector<double> fastest, modulus;

  /// Largest of a list of non-negative numbers.
  static double largest(const std::vector<double>& v) {
    double most = 0;
    for (const double x : v) most = std::max(most, x);
    return most;
  }

  static Square<D, T> load_square(const T* group, int component) {
    Square<D, T> out;
    for (int k = 0; k < D * D; ++k) out.m[k] = load(group + (component + k) * W::kLanes);
    return out;
  }
  static void store_square(T* group, int component, const Square<D, T>& a) {
    for (int k = 0; k < D * D; ++k) store(group + (component + k) * W::kLanes, a.m[k]);
  }

  /// Stress of a group; `flows` says whether its deformation goes back to what the law allows. Returns the
  /// largest modulus.
  static T respond(const Piece& piece, T* group, bool flows) {
    const Material& mat = piece.material;
    const W j = load(group + L::jacobian * W::kLanes);
    W plastic = load(group + L::plastic * W::kLanes);
    const Square<D, T> f = load_square(group, L::f);
    Response<D, T> r;
    if (flows && (mat.law == Law::snow || mat.law == Law::sand || mat.law == Law::foam)) {
      Svd<D, T> d = svd(f);
      return_map(mat, d, plastic);
      store_square(group, L::f, compose(d.u, d.s, d.v));
      store(group + L::plastic * W::kLanes, plastic);
      r = solid_response(mat, d, plastic);
    } else {
      r = response(mat, f, j, plastic);
    }
    int c = L::tau;
    for (int i = 0; i < D; ++i) {
      for (int k = i; k < D; ++k) store(group + c++ * W::kLanes, r.tau(i, k));
    }
    T most = 0;
    for (int i = 0; i < W::kLanes; ++i) most = std::max(most, r.modulus[i]);
    return most;
  }

  /// Stress of all particles from their deformation, and what limits the first substep.
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
            const T most = respond(piece, group, false);
            modulus[k] = std::max(modulus[k], double{most} / piece.density);
            fastest[k] = std::max(fastest[k], speed2(group));
          }
        }
      }
    });
  }
  static double speed2(const T* group) {
    W sum = W::zero();
    for (int a = 0; a < D; ++a) {
      const W v = load(group + (L::v + a) * W::kLanes);
      sum = madd(v, v, sum);
    }
    T most = 0;
    for (int i = 0; i < W::kLanes; ++i) most = std::max(most, sum[i]);
    return double{most};
  }

  Stencil<D, Nodes, T> stencil(const Block& b, const T* group, size_t lane, T dx) const {
    T place[D];
    for (int a = 0; a < D; ++a) {
      place[a] =
          blocks.place(group[(L::x + a) * W::kLanes + lane], a) - static_cast<T>(b.at[a] * Size::kBlock - 1);
    }
    Stencil<D, Nodes, T> s;
    s.template set<Size::kReach, Size::kRow>(place, dx);
    return s;
  }

  void scatter_all(const Setting& set, T h, const ThreadArena& arena) {
    const T dx = static_cast<T>(set.def.cell);
    tiles.resize(blocks.owners.size() * kTileNumbers);
    const bool affine = set.def.transfer == Transfer::apic;
    if (!affine) impulses.resize(tiles.size());
    const T second = Spline<Nodes, T>::kSecond * dx * dx;
    arena.for_blocks(blocks.owners.size(), 4, [&](size_t begin, size_t end) {
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
          const T push = -h * static_cast<T>(piece.volume) / second;
          for (size_t s = run.begin; s < run.end; ++s) {
            const T* group = now.group(s);
            const size_t lane = s % W::kLanes;
            const auto number = [&](int c) { return group[static_cast<size_t>(c) * W::kLanes + lane]; };
            T p[4] = {mass, 0, 0, 0}, a[D][4] = {};
            for (int i = 0; i < D; ++i) p[i + 1] = mass * number(L::v + i);
            int c = L::tau;
            for (int i = 0; i < D; ++i) {
              for (int q = i; q < D; ++q) a[q][i + 1] = a[i][q + 1] = push * number(c++);
            }
            for (int i = 0; i < D; ++i) {
              for (int q = 0; q < D; ++q) a[q][i + 1] += keep * number(L::c + D * i + q);
            }
            const auto at = stencil(b, group, lane, dx);
            if (affine) {
              scatter<D, Nodes, Size::kReach, Size::kRow>(at, p, a, tile);
            } else {
              const T none[D][4] = {}, nothing[4] = {};
              scatter<D, Nodes, Size::kReach, Size::kRow>(at, p, none, tile);
              scatter<D, Nodes, Size::kReach, Size::kRow>(at, nothing, a, impulse);
            }
          }
        }
      }
    });
  }

  /// Rows of nodes that a block and its neighbour's tile share: visit(first number in the block, first number
  /// in the tile, numbers). `k` is the neighbour's place among the block's.
  template <class Visit>
  static void shared_rows(int k, const Visit& visit) {
    int from[3] = {}, to[3] = {1, 1, 1}, shift[3] = {};
    for (int a = D - 1; a >= 0; --a, k /= 3) {
      shift[a] = 1 - (k % 3 - 1) * Size::kBlock;
      from[a] = std::max(0, -shift[a]);
      to[a] = std::min(Size::kBlock, Size::kReach - shift[a]);
      if (from[a] >= to[a]) return;
    }
    const auto many = static_cast<size_t>(4 * (to[D - 1] - from[D - 1]));
    for (int i = from[0]; i < to[0]; ++i) {
      if constexpr (D == 2) {
        visit(static_cast<size_t>(4 * (i * Size::kBlock + from[1])),
              static_cast<size_t>(4 * ((i + shift[0]) * Size::kRow + from[1] + shift[1])), many);
      } else {
        for (int j = from[1]; j < to[1]; ++j) {
          visit(static_cast<size_t>(4 * ((i * Size::kBlock + j) * Size::kBlock + from[2])),
                static_cast<size_t>(
                    4 * (((i + shift[0]) * Size::kReach + j + shift[1]) * Size::kRow + from[2] + shift[2])),
                many);
        }
      }
    }
  }

  /// Sums tiles into blocks and moves on the nodes' velocities. Returns the fastest node's speed.
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
        std::fill(own, own + kBlockNumbers, T{0});
        if (flip) std::fill(change, change + kBlockNumbers, T{0});
        for (int m = 0; m < Size::kNeighbours; ++m) {
          if (b.neighbours[m] < 0) continue;
          const Block& other = blocks.blocks[static_cast<size_t>(b.neighbours[m])];
          if (other.tile < 0) continue;
          const T* tile = tiles.data() + static_cast<size_t>(other.tile) * kTileNumbers;
          shared_rows(m, [&](size_t to, size_t from, size_t many) {
            for (size_t i = 0; i < many; ++i) own[to + i] += tile[from + i];
            if (!flip) return;
            const T* impulse = impulses.data() + static_cast<size_t>(other.tile) * kTileNumbers;
            for (size_t i = 0; i < many; ++i) change[to + i] += impulse[from + i];
          });
        }
        fastest[k] = move_block(set, b, gravity, t, h, own, change);
      }
    });
    return std::sqrt(largest(fastest));
  }

  double move_block(const Setting& set, const Block& b, const Vec3& gravity, double t, T h, T* own,
                    T* change) const {
    const MpmDef& def = set.def;
    const T g[3] = {static_cast<T>(gravity.x), static_cast<T>(gravity.y), static_cast<T>(gravity.z)};
    const double far[3] = {def.high.x, def.high.y, def.high.z};
    const Contact floor = def.floor == MpmDef::Floor::as_walls ? def.walls : static_cast<Contact>(def.floor);
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
      double x[3] = {};
      size_t rest = n;
      for (int a = D - 1; a >= 0; --a, rest /= Size::kBlock) {
        const int at = b.at[a] * Size::kBlock + static_cast<int>(rest % Size::kBlock) - Size::kPad;
        x[a] = blocks.low[a] + at * def.cell;
      }
      if (!set.colliders.empty()) {
        const NearSurface near = set.colliders.nearest({x[0], x[1], x[2]}, t);
        if (near.collider != NearSurface::kNone && near.distance < 0) {
          const auto single = [](const Vec3& a) {
            return Vec3T<T>{static_cast<T>(a.x), static_cast<T>(a.y), D == 3 ? static_cast<T>(a.z) : T{0}};
          };
          const double mu = set.colliders.colliders()[near.collider].surface.friction;
          v = bounded(v, single(near.normal), single(near.velocity), def.contact, static_cast<T>(mu));
        }
      }
      const T slack = static_cast<T>(1e-6 * def.cell), mu = static_cast<T>(def.wall_friction);
      for (int a = 0; a < D; ++a) {
        const bool below = x[a] <= blocks.low[a] + slack, above = x[a] >= far[a] - slack;
        if (!below && !above) continue;
        const T side = below ? T{1} : T{-1};
        const Vec3T<T> n_wall{a == 0 ? side : 0, a == 1 ? side : 0, a == 2 ? side : 0};
        v = bounded(v, n_wall, {}, below && a == 1 ? floor : def.walls, mu);
      }
      if (change) {
        T* c = change + 4 * n;
        c[0] = 0, c[1] = v.x - before.x, c[2] = v.y - before.y, c[3] = v.z - before.z;
      }
      node[0] = 0, node[1] = v.x, node[2] = v.y, node[3] = v.z;
      const double speed = double{norm2(v)};
      if (!(speed <= most)) most = speed;
    }
    return most;
  }

  /// Velocities of the nodes around a block as its particles see them.
  void fill_tile(const Block& b, const Aligned<T>& from, T* tile) const {
    std::fill(tile, tile + kTileNumbers, T{0});
    for (int m = 0; m < Size::kNeighbours; ++m) {
      if (b.neighbours[m] < 0) continue;
      const T* other = from.data() + static_cast<size_t>(b.neighbours[m]) * kBlockNumbers;
      // Seen from the neighbour, this block is on the opposite side.
      shared_rows(Size::kNeighbours - 1 - m, [&](size_t at, size_t to, size_t many) {
        std::copy(other + at, other + at + many, tile + to);
      });
    }
  }

  /// Velocities, places, deformations and stresses of all particles from the nodes.
  void gather_all(const Setting& set, T h, const ThreadArena& arena) {
    const MpmDef& def = set.def;
    const T dx = static_cast<T>(def.cell), per_second = 1 / (Spline<Nodes, T>::kSecond * dx * dx);
    const bool flip = def.transfer == Transfer::flip;
    fastest.assign(blocks.owners.size(), 0), modulus.assign(blocks.owners.size(), 0);
    const double lows[3] = {def.low.x, def.low.y, def.low.z}, highs[3] = {def.high.x, def.high.y, def.high.z};
    arena.for_blocks(blocks.owners.size(), 4, [&](size_t begin, size_t end) {
      alignas(64) T tile[kTileNumbers];
      alignas(64) T change[kTileNumbers];
      for (size_t k = begin; k < end; ++k) {
        const Block& b = blocks.blocks[blocks.owners[k]];
        fill_tile(b, nodes, tile);
        if (flip) fill_tile(b, changes, change);
        for (size_t r = b.first; r < b.last; ++r) {
          const Run& run = blocks.runs[r];
          const Piece& piece = set.pieces[run.body];
          for (size_t s = run.begin; s < run.end; s += W::kLanes) {
            T* group = now.group(s);
            for (size_t lane = 0; lane < static_cast<size_t>(W::kLanes); ++lane) {
              const auto at = stencil(b, group, lane, dx);
              T v[4], moment[D][4];
              gather<D, Nodes, Size::kReach, Size::kRow>(at, tile, v, moment);
              for (int i = 0; i < D; ++i) {
                for (int q = 0; q < D; ++q) {
                  group[(L::c + D * i + q) * W::kLanes + static_cast<int>(lane)] =
                      moment[q][i + 1] * per_second;
                }
                T& x = group[(L::x + i) * W::kLanes + static_cast<int>(lane)];
                T& u = group[(L::v + i) * W::kLanes + static_cast<int>(lane)];
                // A hundredth of a cell off the sides.
                const T low = static_cast<T>(lows[i] + 0.01 * def.cell),
                        high = static_cast<T>(highs[i] - 0.01 * def.cell);
                x = std::min(std::max(x + h * v[i + 1], low), high);
                if (!flip) u = v[i + 1];
              }
              if (flip) {
                const T share = static_cast<T>(def.flip);
                T dv[4], unused[D][4];
                gather<D, Nodes, Size::kReach, Size::kRow>(at, change, dv, unused);
                for (int i = 0; i < D; ++i) {
                  T& u = group[(L::v + i) * W::kLanes + static_cast<int>(lane)];
                  u = share * (u + dv[i + 1]) + (1 - share) * v[i + 1];
                }
              }
            }
            deform(group, h);
            modulus[k] = std::max(modulus[k], double{respond(piece, group, true)} / piece.density);
            fastest[k] = std::max(fastest[k], speed2(group));
          }
        }
      }
    });
  }

  /// F and the volume ratio follow the gradient of the velocity.
  static void deform(T* group, T h) {
    Square<D, T> c = load_square(group, L::c);
    const W hh(h);
    for (int k = 0; k < D * D; ++k) {
      c.m[k] = madd(hh, c.m[k], W(k % (D + 1) == 0 ? T{1} : T{0}));
    }
    store_square(group, L::f, c * load_square(group, L::f));
    const W j = load(group + L::jacobian * W::kLanes) * determinant(c);
    store(group + L::jacobian * W::kLanes, max(j, W(kLeastVolume)));
  }
};

}  // namespace truestep::mpm
