#include "engine/geometry/make/stuffing.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/math/trig.h"

namespace truestep {

namespace {

// Fractions of an edge within which a cut moves the lattice point (their section 3.3, the safe ones for the
// ungraded mesh).
constexpr double kLong = 0.24999, kShort = 0.41189;

enum class Sign : int8_t { outside = -1, surface = 0, inside = 1 };

class Stuffer {
 public:
  Stuffer(const Region& region, double spacing) : region_(region), a_(spacing) {
    const Box b = region.bounds();
    low_ = b.low - Vec3{a_, a_, a_};
    const Vec3 size = b.high - b.low;
    const double along[3] = {size.x, size.y, size.z};
    for (size_t c = 0; c < 3; ++c) n_[c] = static_cast<uint32_t>(std::ceil(along[c] / a_)) + 3;
  }

  Stuffing run() {
    place();
    cut_edges();
    warp();
    fill();
    return compact();
  }

 private:
  // Corners first, then centres.
  uint32_t corner(uint32_t i, uint32_t j, uint32_t k) const { return (k * n_[1] + j) * n_[0] + i; }
  uint32_t center(uint32_t i, uint32_t j, uint32_t k) const {
    return n_[0] * n_[1] * n_[2] + (k * (n_[1] - 1) + j) * (n_[0] - 1) + i;
  }
  using Edge = std::array<uint32_t, 2>;
  static Edge edge(uint32_t p, uint32_t q) { return {std::min(p, q), std::max(p, q)}; }

  void place() {
    for (uint32_t k = 0; k < n_[2]; ++k) {
      for (uint32_t j = 0; j < n_[1]; ++j) {
        for (uint32_t i = 0; i < n_[0]; ++i) x_.push_back(low_ + Vec3{a_ * i, a_ * j, a_ * k});
      }
    }
    for (uint32_t k = 0; k + 1 < n_[2]; ++k) {
      for (uint32_t j = 0; j + 1 < n_[1]; ++j) {
        for (uint32_t i = 0; i + 1 < n_[0]; ++i)
          x_.push_back(low_ + Vec3{a_ * (i + 0.5), a_ * (j + 0.5), a_ * (k + 0.5)});
      }
    }
    for (const Vec3& p : x_) sign_.push_back(region_.inside(p) ? Sign::inside : Sign::outside);
  }

  // Four tetrahedra around every pair of neighbouring centres: both centres, and an edge of the square
  // between.
  template <class Visit>
  void each_tetrahedron(Visit visit) const {
    for (uint32_t k = 0; k + 1 < n_[2]; ++k) {
      for (uint32_t j = 0; j + 1 < n_[1]; ++j) {
        for (uint32_t i = 0; i + 1 < n_[0]; ++i) {
          const uint32_t here = center(i, j, k);
          const auto around = [&](uint32_t next, const std::array<uint32_t, 4>& ring) {
            for (size_t s = 0; s < 4; ++s) visit(std::array{here, next, ring[s], ring[(s + 1) % 4]});
          };
          if (i + 2 < n_[0])
            around(center(i + 1, j, k), {corner(i + 1, j, k), corner(i + 1, j + 1, k),
                                         corner(i + 1, j + 1, k + 1), corner(i + 1, j, k + 1)});
          if (j + 2 < n_[1])
            around(center(i, j + 1, k), {corner(i, j + 1, k), corner(i, j + 1, k + 1),
                                         corner(i + 1, j + 1, k + 1), corner(i + 1, j + 1, k)});
          if (k + 2 < n_[2])
            around(center(i, j, k + 1), {corner(i, j, k + 1), corner(i + 1, j, k + 1),
                                         corner(i + 1, j + 1, k + 1), corner(i, j + 1, k + 1)});
        }
      }
    }
  }

  // Where the surface crosses edges of tetrahedra.
  void cut_edges() {
    each_tetrahedron([&](const std::array<uint32_t, 4>& t) {
      for (size_t a = 0; a < 4; ++a) {
        for (size_t b = a + 1; b < 4; ++b) {
          if (sign_[t[a]] == sign_[t[b]]) continue;
          const Edge e = edge(t[a], t[b]);
          if (cuts_.count(e)) continue;
          const bool first = sign_[e[0]] == Sign::inside;
          const double share = region_.leaves(x_[e[first ? 0 : 1]], x_[e[first ? 1 : 0]]);
          cuts_[e] = first ? share : 1 - share;
        }
      }
    });
  }

  // Points close to a cut move onto the nearest one; neighbouring cuts are dropped.
  void warp() {
    std::vector<std::vector<Edge>> around(x_.size());
    for (const auto& [e, share] : cuts_) around[e[0]].push_back(e), around[e[1]].push_back(e);
    const std::vector<Vec3> lattice = x_;
    for (uint32_t p = 0; p < x_.size(); ++p) {
      const Edge* nearest = nullptr;
      double least = HUGE_VAL;
      for (const Edge& e : around[p]) {
        const auto cut = cuts_.find(e);
        if (cut == cuts_.end()) continue;
        const double share = e[0] == p ? cut->second : 1 - cut->second;
        const uint32_t corners = n_[0] * n_[1] * n_[2];
        const bool is_long = (e[0] < corners) == (e[1] < corners);
        if (share >= (is_long ? kLong : kShort)) continue;
        const double way = share * norm(lattice[e[1]] - lattice[e[0]]);
        if (way < least) least = way, nearest = &e;
      }
      if (!nearest) continue;
      x_[p] = lattice[(*nearest)[0]] + cuts_[*nearest] * (lattice[(*nearest)[1]] - lattice[(*nearest)[0]]);
      sign_[p] = Sign::surface;
      for (const Edge& e : around[p]) cuts_.erase(e);
    }
    for (const auto& [e, share] : cuts_) {
      cut_point_[e] = static_cast<uint32_t>(x_.size());
      // Between the present positions: neither end of a remaining cut has moved.
      x_.push_back(lattice[e[0]] + share * (lattice[e[1]] - lattice[e[0]]));
    }
  }

  void add(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const double volume = dot(cross(x_[b] - x_[a], x_[c] - x_[a]), x_[d] - x_[a]);
    if (volume < 0) std::swap(c, d);
    out_.push_back({a, b, c, d});
  }
  // A quadrilateral is split by its shorter diagonal, in a tie by the one with the lowest point number, so
  // that both elements sharing it do the same. True: the diagonal a c.
  bool by_first(uint32_t a, uint32_t b, uint32_t c, uint32_t d) const {
    const double one = norm2(x_[c] - x_[a]), other = norm2(x_[d] - x_[b]);
    if (std::abs(one - other) > 1e-9 * (one + other)) return one < other;
    return std::min(a, c) < std::min(b, d);
  }
  void pyramid(uint32_t apex, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    if (by_first(a, b, c, d)) {
      add(apex, a, b, c), add(apex, a, c, d);
    } else {
      add(apex, a, b, d), add(apex, b, c, d);
    }
  }
  // Between triangles a and b with sides a_i b_i.
  void wedge(const std::array<uint32_t, 3>& a, const std::array<uint32_t, 3>& b) {
    // For every side k, k + 1: whether the diagonal starts at a_k.
    std::array<bool, 3> from_first{};
    for (size_t k = 0; k < 3; ++k) from_first[k] = by_first(a[k], a[(k + 1) % 3], b[(k + 1) % 3], b[k]);
    for (size_t k = 0; k < 3; ++k) {
      // Both sides at a_k have their diagonals there: three elements that all contain it.
      const size_t next = (k + 1) % 3, before = (k + 2) % 3;
      if (from_first[k] && !from_first[before]) {
        add(a[k], b[0], b[1], b[2]);
        return pyramid(a[k], a[next], a[before], b[before], b[next]);
      }
      if (!from_first[k] && from_first[before]) {
        add(b[k], a[0], a[1], a[2]);
        return pyramid(b[k], a[next], a[before], b[before], b[next]);
      }
    }
    // Cyclic diagonals: a point inside sees all faces.
    const auto middle = static_cast<uint32_t>(x_.size());
    Vec3 sum;
    for (size_t k = 0; k < 3; ++k) sum += x_[a[k]] + x_[b[k]];
    x_.push_back(sum / 6);
    add(middle, a[0], a[1], a[2]), add(middle, b[0], b[1], b[2]);
    for (size_t k = 0; k < 3; ++k) pyramid(middle, a[k], a[(k + 1) % 3], b[(k + 1) % 3], b[k]);
  }

  void fill() {
    each_tetrahedron([&](const std::array<uint32_t, 4>& t) {
      std::vector<uint32_t> in, on, out;
      for (const uint32_t p : t) {
        (sign_[p] == Sign::inside ? in : sign_[p] == Sign::surface ? on : out).push_back(p);
      }
      const auto cut = [&](uint32_t p, uint32_t q) { return cut_point_.at(edge(p, q)); };
      if (in.empty()) return;
      if (out.empty()) return add(t[0], t[1], t[2], t[3]);
      if (in.size() == 1) {
        std::vector<uint32_t> base = on;
        for (const uint32_t q : out) base.push_back(cut(in[0], q));
        return add(in[0], base[0], base[1], base[2]);
      }
      if (in.size() == 3)
        return wedge({in[0], in[1], in[2]}, {cut(in[0], out[0]), cut(in[1], out[0]), cut(in[2], out[0])});
      if (on.size() == 1) return pyramid(on[0], in[0], in[1], cut(in[1], out[0]), cut(in[0], out[0]));
      wedge({in[0], cut(in[0], out[0]), cut(in[0], out[1])}, {in[1], cut(in[1], out[0]), cut(in[1], out[1])});
    });
  }

  Stuffing compact() {
    Stuffing out;
    std::vector<uint32_t> number(x_.size(), UINT32_MAX);
    for (auto& t : out_) {
      for (uint32_t& p : t) {
        if (number[p] == UINT32_MAX) {
          number[p] = static_cast<uint32_t>(out.x.size());
          out.x.push_back(x_[p]);
        }
        p = number[p];
      }
    }
    out.tetrahedra = std::move(out_);
    const auto [least, largest] = dihedral_angles(out.x, out.tetrahedra);
    out.least_angle = least, out.largest_angle = largest;
    return out;
  }

  const Region& region_;
  double a_;
  Vec3 low_;
  uint32_t n_[3];
  std::vector<Vec3> x_;
  std::vector<Sign> sign_;
  std::map<Edge, double> cuts_;  // fraction of the edge, from its first end
  std::map<Edge, uint32_t> cut_point_;
  std::vector<std::array<uint32_t, 4>> out_;
};

}  // namespace

Stuffing stuff(const Region& region, double spacing) {
  return Stuffer(region, spacing).run();
}

// Twelve tetrahedra and two nodes per cell, somewhat more where the surface cuts.
StuffingSize stuffing_size(double volume, double spacing) {
  const double cells = volume / (spacing * spacing * spacing), surface = 6 * trig::pow(cells, 2.0 / 3);
  return {2 * cells + 3 * surface + 10, 12 * cells + 12 * surface};
}

std::array<double, 2> dihedral_angles(std::span<const Vec3> x,
                                      std::span<const std::array<uint32_t, 4>> tetrahedra) {
  double least = HUGE_VAL, largest = 0;
  for (const auto& t : tetrahedra) {
    for (size_t a = 0; a < 4; ++a) {
      for (size_t b = a + 1; b < 4; ++b) {
        size_t c = 0;
        while (c == a || c == b) ++c;
        const size_t d = 6 - a - b - c;
        const Vec3 along = x[t[b]] - x[t[a]];
        const Vec3 n1 = cross(along, x[t[c]] - x[t[a]]), n2 = cross(along, x[t[d]] - x[t[a]]);
        const double angle = trig::atan2(norm(cross(n1, n2)), dot(n1, n2));
        least = std::min(least, angle), largest = std::max(largest, angle);
      }
    }
  }
  return {least, largest};
}

}  // namespace truestep
