// The cells of a box, equal and x fastest, periodic along any axis: the cell of a point, and the runs of
// consecutive cells around one. Where a run lies on the other side of a periodic box, the shift that brings
// its points next to the cell comes with it.
#pragma once
#include <algorithm>
#include <cstddef>

namespace truestep {

template <int D>
struct CellLattice {
  double low[3] = {}, width[3] = {}, per_metre[3] = {};
  int count[3] = {1, 1, 1};
  bool wraps[3] = {};

  /// As many cells as fit into the box between `from` and `to`, each at least `least` wide (all in m).
  void divide(const double* from, const double* to, double least) {
    for (int a = 0; a < D; ++a) {
      low[a] = from[a], width[a] = to[a] - from[a];
      count[a] = std::max(1, static_cast<int>(width[a] / least));
      per_metre[a] = count[a] / width[a];
    }
  }
  size_t cells() const {
    return static_cast<size_t>(count[0]) * static_cast<size_t>(count[1]) * static_cast<size_t>(count[2]);
  }
  /// Index along axis a of the cell at x, or of the cell nearest to it; 0 where x is not a number.
  int along(double x, int a) const {
    const double c = (x - low[a]) * per_metre[a];
    if (!(c > 0)) return 0;
    return c < count[a] ? static_cast<int>(c) : count[a] - 1;
  }
  size_t of(const int* c) const {
    return (static_cast<size_t>(c[2]) * static_cast<size_t>(count[1]) + static_cast<size_t>(c[1])) *
               static_cast<size_t>(count[0]) +
           static_cast<size_t>(c[0]);
  }
  /// visit(first cell, one past the last, shift (m)) for runs of cells: c and those that touch it, each once
  /// unless the box is less than three cells wide along a periodic axis.
  template <class Visit>
  void around(const int* c, const Visit& visit) const {
    double shift[3] = {};
    if (!(wraps[0] || wraps[1] || wraps[2])) {
      inside(c, [&](size_t first, size_t end) { visit(first, end, static_cast<const double*>(shift)); });
      return;
    }
    const int reach_z = D == 3 ? 1 : 0;
    for (int z = -reach_z; z <= reach_z; ++z) {
      int at[3] = {0, 0, c[2] + z};
      if (!fold(2, at, shift)) continue;
      for (int y = -1; y <= 1; ++y) {
        at[1] = c[1] + y;
        if (!fold(1, at, shift)) continue;
        shift[0] = 0;
        run(at, std::max(c[0] - 1, 0), std::min(c[0] + 1, count[0] - 1), shift, visit);
        if (!wraps[0]) continue;
        if (c[0] == 0) shift[0] = -width[0], run(at, count[0] - 1, count[0] - 1, shift, visit);
        if (c[0] == count[0] - 1) shift[0] = width[0], run(at, 0, 0, shift, visit);
      }
    }
  }

  /// visit(first cell, one past the last): the same without those beyond periodic sides.
  template <class Visit>
  void inside(const int* c, const Visit& visit) const {
    const int from = std::max(c[0] - 1, 0), to = std::min(c[0] + 1, count[0] - 1);
    const int last_y = std::min(c[1] + 1, count[1] - 1),
              last_z = D == 3 ? std::min(c[2] + 1, count[2] - 1) : 0;
    for (int z = D == 3 ? std::max(c[2] - 1, 0) : 0; z <= last_z; ++z) {
      for (int y = std::max(c[1] - 1, 0); y <= last_y; ++y) {
        const int at[3] = {0, y, z};
        const size_t row = of(at);
        visit(row + static_cast<size_t>(from), row + static_cast<size_t>(to) + 1);
      }
    }
  }

 private:
  /// Brings an index that is beyond a side back into the box, if the box is periodic there.
  bool fold(int a, int* at, double* shift) const {
    shift[a] = 0;
    if (a >= D || (at[a] >= 0 && at[a] < count[a])) return true;
    if (!wraps[a]) return false;
    const bool below = at[a] < 0;
    at[a] += below ? count[a] : -count[a];
    shift[a] = below ? -width[a] : width[a];
    return true;
  }
  template <class Visit>
  void run(int* at, int from, int to, const double* shift, const Visit& visit) const {
    at[0] = from;
    const size_t first = of(at);
    visit(first, first + static_cast<size_t>(to - from) + 1, shift);
  }
};

}  // namespace truestep
