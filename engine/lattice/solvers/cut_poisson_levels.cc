// The matrix of partly open faces and its coarser levels.
#include "engine/lattice/solvers/cut_poisson.h"

#include <algorithm>
#include <cmath>

#include "engine/base/largest_block.h"

namespace truestep::lattice {

using mac::Mirror;

void CutPoisson::shape(Level& l) const {
  l.base = 0;
  for (size_t a = 0; a < grid_.dimensions; ++a) {
    l.padded[a] = l.n[a] + 2;
    l.base += l.stride(a);
  }
  for (size_t a = 0; a < grid_.dimensions; ++a) l.k[a].assign(l.size(), 0);
  for (Vector* v : {&l.inverse, &l.x, &l.b, &l.r}) v->assign(l.size(), 0);
}

void CutPoisson::invert(Level& l, const ThreadArena& arena) const {
  rows(l, arena, [&](size_t at, size_t, size_t) {
    for (size_t i = at; i < at + l.n[0]; ++i) {
      double sum = 0;
      for (size_t a = 0; a < grid_.dimensions; ++a) sum += l.k[a][i] + l.k[a][i - l.stride(a)];
      l.inverse[i] = sum > 0 && !(surface_ && l.held[i]) ? 1 / sum : 0;
    }
  });
}

CutPoisson::CutPoisson(const mac::MacGrid& grid, const std::array<std::array<Mirror, 2>, 3>& mirrors)
    : grid_(grid), mirrors_(mirrors) {
  Level& l = levels_.emplace_back();
  l.n = grid.cells;
  shape(l);
  for (size_t a = 0; a < grid.dimensions; ++a) l.width[a].assign(l.n[a], grid.spacing[a]);
  levels_.reserve(24);
  while (coarsen()) {
  }
  for (Vector* v : {&b_, &r_, &z_, &p_, &q_}) v->assign(levels_[0].size(), 0);
}

CutPoisson::CutPoisson(const mac::MacGrid& grid, const std::array<std::array<Mirror, 2>, 3>& mirrors,
                       const std::array<Vector, 3>& open)
    : CutPoisson(grid, mirrors) {
  static const ThreadArena kSerial(1);
  set({open[0].data(), open[1].data(), open[2].data()}, nullptr, kSerial);
}

void CutPoisson::set(const std::array<const double*, 3>& open, const uint8_t* liquid,
                     const ThreadArena& arena) {
  Level& l = levels_[0];
  singular_ = true, surface_ = liquid != nullptr;
  if (surface_) {
    for (Level& level : levels_) level.held.resize(level.size());
  }
  for (size_t a = 0; a < grid_.dimensions; ++a) {
    for (size_t end = 0; end < 2; ++end) {
      if (!grid_.periodic[a] && mirrors_[a][end] == Mirror::odd) singular_ = false;
    }
  }
  rows(l, arena, [&](size_t at, size_t j, size_t q) {
    for (size_t a = 0; a < grid_.dimensions; ++a) {
      const double full = grid_.cell_volume() / (grid_.spacing[a] * grid_.spacing[a]);
      const double* share = open[a] + grid_.at(0, j, q);
      for (size_t i = 0; i < l.n[0]; ++i) {
        const size_t place = a == 0 ? i : a == 1 ? j : q;
        const auto face = [&](size_t end) {
          const bool side = end == 0 ? place == 0 : place + 1 == l.n[a];
          const double k = full * share[i + end * grid_.stride(a)];
          if (!side || grid_.periodic[a]) return k;
          return mirrors_[a][end] == Mirror::odd ? 2 * k : 0.0;
        };
        l.k[a][at + i] = face(1);
        if (place == 0) l.k[a][at + i - l.stride(a)] = face(0);
      }
    }
  });
  if (surface_) {
    rows(l, arena, [&](size_t at, size_t j, size_t q) {
      const uint8_t* wet = liquid + grid_.at(0, j, q);
      for (size_t i = 0; i < l.n[0]; ++i) {
        double sum = 0;
        for (size_t a = 0; a < grid_.dimensions; ++a) sum += l.k[a][at + i] + l.k[a][at + i - l.stride(a)];
        l.held[at + i] = !wet[i] && sum > 0;
      }
    });
    const double held = largest_block(arena, l.held.size(), kBlockRows, [&](size_t begin, size_t end) {
      return *std::max_element(l.held.data() + begin, l.held.data() + end);
    });
    singular_ = singular_ && held == 0;
  }
  invert(l, arena);
  for (size_t k = 1; k < levels_.size(); ++k) {
    fill_coarser(levels_[k - 1], levels_[k], arena);
    invert(levels_[k], arena);
  }
  fluid_cells_ = total(l.size(), arena, [&](size_t begin, size_t end) {
    double cells = 0;
    for (size_t i = begin; i < end; ++i) cells += l.inverse[i] > 0;
    return cells;
  });
}

void CutPoisson::set_coefficients(const std::array<const double*, 3>& factors, const ThreadArena& arena) {
  coarse_ = Coarse::series;
  set(factors, nullptr, arena);
}

bool CutPoisson::coarsen() {
  Level& fine = levels_.back();
  constexpr size_t kFewest = 4;
  double finest = 1e300;
  for (size_t a = 0; a < grid_.dimensions; ++a) {
    if (fine.n[a] >= kFewest) finest = std::min(finest, fine.width[a][0]);
  }
  bool any = false;
  Level coarse;
  for (size_t a = 0; a < grid_.dimensions; ++a) {
    // An axis with much longer cells is not coarsened until the others have caught up.
    fine.halved[a] =
        fine.n[a] >= kFewest && fine.width[a][0] < 1.5 * finest && !(grid_.periodic[a] && fine.n[a] % 2);
    any = any || fine.halved[a];
    coarse.n[a] = fine.halved[a] ? (fine.n[a] + 1) / 2 : fine.n[a];
    coarse.width[a].assign(coarse.n[a], 0);
    for (size_t i = 0; i < fine.n[a]; ++i) coarse.width[a][fine.halved[a] ? i / 2 : i] += fine.width[a][i];
  }
  if (!any) return false;
  shape(coarse);
  for (size_t a = 0; a < 3; ++a) {
    Axis& axis = fine.to_coarser[a];
    const size_t n = fine.n[a], m = coarse.n[a];
    axis.down.resize(m);
    for (size_t i = 0; i < n; ++i) {
      Between b{static_cast<uint32_t>(i), static_cast<uint32_t>(i), 0};
      if (fine.halved[a]) {
        const size_t own = i / 2, wrapped = grid_.periodic[a] ? m : 0;
        const bool up = i % 2 == 1;
        const bool exists = wrapped > 0 || (up ? own + 1 < m : own > 0);
        const size_t other = !exists ? own : up ? (own + 1) % m : (own + m - 1) % m;
        b = {static_cast<uint32_t>(own), static_cast<uint32_t>(other), exists ? 0.25 : 0};
      }
      axis.up.push_back(b);
      axis.down[b.low].emplace_back(i, 1 - b.part);
      if (b.part > 0) axis.down[b.high].emplace_back(i, b.part);
    }
  }
  levels_.push_back(std::move(coarse));
  return true;
}

void CutPoisson::fill_coarser(const Level& fine, Level& coarse, const ThreadArena& arena) const {
  // Distance between the centres of a cell and the next one, or from the centre to the side.
  const auto distance = [&](const Level& l, size_t a, ptrdiff_t i) {
    const auto n = static_cast<ptrdiff_t>(l.n[a]);
    const auto half = [&](ptrdiff_t c) {
      if (c < 0 || c >= n)
        return grid_.periodic[a] ? 0.5 * l.width[a][static_cast<size_t>((c + n) % n)] : 0.0;
      return 0.5 * l.width[a][static_cast<size_t>(c)];
    };
    return half(i) + half(i + 1);
  };
  // Number of fine cells inside a coarse one along an axis.
  const auto children = [&](size_t a, size_t i) {
    const size_t first = fine.halved[a] ? 2 * i : i;
    return std::array<size_t, 2>{first, std::min(first + (fine.halved[a] ? 2 : 1), fine.n[a])};
  };
  rows(coarse, arena, kFineRows, [&](size_t at, size_t j, size_t q) {
    for (size_t i = 0; i < coarse.n[0]; ++i) {
      const std::array<size_t, 3> p{i, j, q};
      const std::array<std::array<size_t, 2>, 3> span{children(0, i), children(1, j), children(2, q)};
      for (size_t a = 0; a < grid_.dimensions; ++a) {
        // The faces of a coarse cell are those after its last fine cell and, on the lower side, before its
        // first.
        const auto sum = [&](ptrdiff_t fine_place, ptrdiff_t place) {
          std::array<std::array<size_t, 2>, 3> over = span;
          over[a] = {0, 1};
          const double width = distance(fine, a, fine_place), coarse_width = distance(coarse, a, place);
          // Two coarse cells and the fine ones in them.
          const auto n = static_cast<ptrdiff_t>(fine.n[a]), m = static_cast<ptrdiff_t>(coarse.n[a]);
          const bool at_side = !grid_.periodic[a] && (place < 0 || place + 1 == m);
          const bool in_series = coarse_ == Coarse::series && fine.halved[a] && !at_side;
          const auto pair = [&](ptrdiff_t c) {
            const auto own = children(a, static_cast<size_t>((c + m) % m));
            return own[1] - own[0] == 2;
          };
          const std::array<bool, 2> pairs{in_series && pair(place), in_series && pair((place + 1) % m)};
          double total = 0;
          for (size_t fq = over[2][0]; fq < over[2][1]; ++fq) {
            for (size_t fj = over[1][0]; fj < over[1][1]; ++fj) {
              for (size_t fi = over[0][0]; fi < over[0][1]; ++fi) {
                const size_t from = fine.at(fi, fj, fq) +
                                    fine.stride(a) * static_cast<size_t>(fine_place + 1) - fine.stride(a);
                if (!in_series) {
                  total += fine.k[a][from] * width / coarse_width;
                  continue;
                }
                // Half of the face inside either coarse cell, where it has one.
                double resistance = 1 / fine.k[a][from];
                for (const ptrdiff_t side : {ptrdiff_t{-1}, ptrdiff_t{1}}) {
                  if (!pairs[side > 0]) continue;
                  const ptrdiff_t face = (fine_place + side + n) % n;
                  const size_t inner = fine.at(fi, fj, fq) + fine.stride(a) * static_cast<size_t>(face);
                  resistance += 0.5 / fine.k[a][inner];
                }
                total += 1 / resistance;
              }
            }
          }
          return total;
        };
        // Interpolation does not know which faces are closed: with plain sums, corrections beside solids
        // overshoot, more so on coarser levels. The geometric mean of the sum and the value of an open face
        // prevents this (64^3 cells around a sphere take 6 iterations instead of 10, 192^3 take 6 instead of
        // 19).
        const size_t u = a == 0 ? 1 : 0, w = a == 2 ? 1 : 2;
        const double area = coarse.width[u][p[u]] * (w < grid_.dimensions ? coarse.width[w][p[w]] : 1);
        const auto lifted = [&](double k, ptrdiff_t place) {
          return k > 0 && coarse_ == Coarse::shares
                     ? std::max(k, std::sqrt(k * area / distance(coarse, a, place)))
                     : k;
        };
        const auto here = static_cast<ptrdiff_t>(p[a]);
        if (here == 0) coarse.k[a][at + i - coarse.stride(a)] = lifted(sum(-1, -1), -1);
        coarse.k[a][at + i] = lifted(sum(static_cast<ptrdiff_t>(span[a][1]) - 1, here), here);
      }
      if (!surface_) continue;
      uint8_t held = 0;
      for (size_t fq = span[2][0]; fq < span[2][1]; ++fq) {
        for (size_t fj = span[1][0]; fj < span[1][1]; ++fj) {
          for (size_t fi = span[0][0]; fi < span[0][1]; ++fi) held |= fine.held[fine.at(fi, fj, fq)];
        }
      }
      coarse.held[at + i] = held;
    }
  });
}

}  // namespace truestep::lattice
