// Contact of velocity fields: nodes reached by the particles of two fields have a velocity for each, and the
// fields push each other there if their surfaces would pass through each other in the substep
// (kernels/mpm/field_contact.h). Three or more fields meet in pairs, in the order of fields. The impulses of
// a pair are equal and opposite at one point, so both momenta are conserved to rounding. Places are
// independent of each other: any number of threads gives the same bits.
#pragma once
#include "engine/kernels/mpm/field_contact.h"
#include "engine/systems/mpm/substep.h"

namespace truestep::mpm {

template <int D, int Nodes, class T>
class FieldContact {
  using G = Grid<D, Nodes, T>;
  using W = Wide<T>;
  using L = Layout<D>;
  using Size = Tiling<D, Nodes>;

 public:
  /// Reserves memory for so many particles near surfaces in contact.
  void reserve(size_t slots) {
    near_.reserve(slots);
    for (Aligned<float>* c : {&x_, &y_, &z_, &side_}) c->reserve(slots + 8);
    cloud_.reserve(slots), places_.reserve(slots / 64 + 64);
  }

  /// Changes the nodes' velocities. Returns the speed (m/s) of the fastest node that was touched.
  double act(G& g, const Setting& set, double t, double h, const ThreadArena& arena) {
    find_places(g);
    arena.for_blocks(places_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        Place& p = places_[k];
        p.shared = shared_nodes(g, p);
        p.many = 0;
        if (p.shared != 0) for_near(g, p, [&](const Near&) { ++p.many; });
      }
    });
    size_t total = 0;
    for (Place& p : places_) p.begin = total, total += (p.many + 7) / 8 * 8;
    near_.resize(total), cloud_.resize(total);
    for (Aligned<float>* c : {&x_, &y_, &z_, &side_}) c->resize(total);
    arena.for_blocks(places_.size(), 1, [&](size_t begin, size_t end) {
      for (size_t k = begin; k < end; ++k) {
        Place& p = places_[k];
        if (p.many == 0) continue;
        Near* to = near_.data() + p.begin;
        for_near(g, p, [&](const Near& n) { *to++ = n; });
        p.fastest = meet_at(g, set, p, t, h);
      }
    });
    double most = 0;
    for (const Place& p : places_) most = std::max(most, p.fastest);
    return std::sqrt(most);
  }

 private:
  static constexpr float kReach = Nodes == 3 ? 1.5F : 2.0F;  ///< cells, reach of a particle

  /// Blocks [first, last) of the fields at one place.
  struct Place {
    size_t first, last;
    uint64_t shared = 0;         ///< nodes at which two of them have mass, one bit each
    size_t begin = 0, many = 0;  ///< particles around those nodes
    double fastest = 0;          ///< (m/s)^2
  };
  struct Near {
    float x[3];      ///< cells, from the block's first node
    uint32_t block;  ///< of its field at this place
    uint32_t piece, slot;
  };

  void find_places(const G& g) {
    places_.clear();
    const auto& all = g.blocks.blocks;
    for (size_t k = 0, end; k < all.size(); k = end) {
      for (end = k + 1; end < all.size() && all[end].id / g.blocks.fields == all[k].id / g.blocks.fields;)
        ++end;
      if (end > k + 1) places_.push_back({.first = k, .last = end});
    }
  }
  static T* node_of(G& g, size_t block, size_t n) {
    return g.nodes.data() + block * G::kBlockNumbers + 4 * n;
  }
  static uint64_t shared_nodes(G& g, const Place& p) {
    uint64_t once = 0, twice = 0;
    for (size_t k = p.first; k < p.last; ++k) {
      uint64_t here = 0;
      for (size_t n = 0; n < Size::kBlockNodes; ++n) here |= uint64_t{node_of(g, k, n)[0] > 0} << n;
      twice |= once & here, once |= here;
    }
    return twice;
  }
  static void index_of(size_t n, int* at) {
    for (int a = D - 1; a >= 0; --a, n /= Size::kBlock) at[a] = static_cast<int>(n % Size::kBlock);
  }

  /// Visits the particles of a place's fields that reach the box of its shared nodes, in the order of fields,
  /// neighbours and slots.
  template <class Visit>
  void for_near(G& g, const Place& p, const Visit& visit) const {
    int low[3] = {Size::kBlock, Size::kBlock, Size::kBlock}, high[3] = {-1, -1, -1};
    for (size_t n = 0; n < Size::kBlockNodes; ++n) {
      if (!(p.shared >> n & 1)) continue;
      int at[3] = {};
      index_of(n, at);
      for (int a = 0; a < D; ++a) low[a] = std::min(low[a], at[a]), high[a] = std::max(high[a], at[a]);
    }
    for (size_t k = p.first; k < p.last; ++k) {
      const Block& here = g.blocks.blocks[k];
      for (int m = 0; m < Size::kNeighbours; ++m) {
        if (here.neighbours[m] < 0) continue;
        const Block& b = g.blocks.blocks[static_cast<size_t>(here.neighbours[m])];
        if (b.tile < 0) continue;
        for (size_t r = b.first; r < b.last; ++r) {
          const Run& run = g.blocks.runs[r];
          for (size_t s = run.begin; s < run.end; s += W::kLanes) {
            const T* group = g.now.group(s);
            W x[D];
            W inside = W::all(1);
            for (int a = 0; a < D; ++a) {
              x[a] = (load(group + (L::x + a) * W::kLanes) - W(g.blocks.low[a])) * W(g.blocks.inverse_dx) +
                     W(Size::kPad - here.at[a] * Size::kBlock);
              inside = min(inside, min(x[a] - W(low[a] - kReach), W(high[a] + kReach) - x[a]));
            }
            if (!any_below(W::zero(), inside)) continue;
            const int many = static_cast<int>(std::min<size_t>(W::kLanes, run.end - s));
            for (int lane = 0; lane < many; ++lane) {
              if (!(inside[lane] > 0)) continue;
              Near n{.x = {},
                     .block = static_cast<uint32_t>(k),
                     .piece = run.body,
                     .slot = static_cast<uint32_t>(s + static_cast<size_t>(lane))};
              for (int a = 0; a < D; ++a) n.x[a] = static_cast<float>(x[a][lane]);
              visit(n);
            }
          }
        }
      }
    }
  }

  /// m, from a particle's centre to its end in direction n: half of its initial particle spacing, deformed
  /// with F; for a fluid, only scaled with the volume.
  static double half_width(const G& g, const Piece& piece, size_t slot, const Vec3& n) {
    const Law law = piece.material.law;
    const double d[3] = {piece.spacing.x, piece.spacing.y, piece.spacing.z}, to[3] = {n.x, n.y, n.z};
    const bool solid = law == Law::corotated || law == Law::neo_hookean || law == Law::elastic;
    const double swell = std::clamp(1 + (double{g.now.at(slot, L::jacobian)} - 1) / D, 0.5, 2.0);
    double sum = 0;
    for (int a = 0; a < D; ++a) {
      double along = solid ? 0 : swell * to[a];
      for (int i = 0; solid && i < D; ++i) along += to[i] * double{g.now.at(slot, L::f + D * i + a)};
      sum += along * along * d[a] * d[a];
    }
    return 0.5 * std::sqrt(sum);
  }

  /// Resolves contact at the shared nodes of a place. Returns the square of the largest speed.
  double meet_at(G& g, const Setting& set, const Place& p, double t, double h) {
    double most = 0;
    for (size_t n = 0; n < Size::kBlockNodes; ++n) {
      if (!(p.shared >> n & 1)) continue;
      for (size_t a = p.first; a < p.last; ++a) {
        for (size_t b = a + 1; b < p.last; ++b) {
          if (node_of(g, a, n)[0] > 0 && node_of(g, b, n)[0] > 0)
            most = std::max(most, meet_pair(g, set, p, n, a, b, t, h));
        }
      }
    }
    return most;
  }

  /// Fills the cloud with the particles of blocks a and b that reach node n; returns their number.
  size_t gather_cloud(const Place& p, size_t n, size_t a, size_t b) {
    int at[3] = {};
    index_of(n, at);
    size_t many = 0;
    for (size_t i = p.begin; i < p.begin + p.many; ++i) {
      const Near& q = near_[i];
      if (q.block != a && q.block != b) continue;
      float x[3] = {};
      bool inside = true;
      for (int c = 0; c < D; ++c) {
        x[c] = q.x[c] - static_cast<float>(at[c]);
        inside = inside && std::abs(x[c]) < kReach;
      }
      if (!inside) continue;
      const size_t to = p.begin + many++;
      x_[to] = x[0], y_[to] = x[1], z_[to] = x[2], side_[to] = q.block == a ? -1.0F : 1.0F;
      cloud_[to] = static_cast<uint32_t>(i);
    }
    for (size_t i = p.begin + many; i % 8 != 0; ++i) x_[i] = y_[i] = z_[i] = side_[i] = 0;
    return many;
  }

  /// Whether b moves away from a within 30 degrees of the line between their particles' centres, and so from
  /// any surface between them within 60 degrees of perpendicular to that line.
  bool parts(const Place& p, size_t many, const Vec3& w) const {
    Vec3 sum[2];
    double count[2] = {};
    for (size_t i = p.begin; i < p.begin + many; ++i) {
      const size_t k = side_[i] > 0;
      sum[k] += Vec3{double{x_[i]}, double{y_[i]}, double{z_[i]}}, ++count[k];
    }
    if (count[0] == 0 || count[1] == 0) return true;
    const Vec3 line = sum[1] / count[1] - sum[0] / count[0];
    const double away = dot(w, line);
    return away > 0 && 4 * away * away > 3 * norm2(w) * norm2(line);
  }

  double meet_pair(G& g, const Setting& set, const Place& p, size_t n, size_t a, size_t b, double t,
                   double h) {
    T *one = node_of(g, a, n), *other = node_of(g, b, n);
    FieldNode of_a{double{one[0]}, {double{one[1]}, double{one[2]}, double{one[3]}}},
        of_b{double{other[0]}, {double{other[1]}, double{other[2]}, double{other[3]}}};
    if (norm2(of_a.velocity - of_b.velocity) == 0) return 0;
    const size_t many = gather_cloud(p, n, a, b), padded = (many + 7) / 8 * 8;
    if (parts(p, many, of_b.velocity - of_a.velocity)) return 0;
    const auto part = [&](const Aligned<float>& c) {
      return std::span<const float>(c.data() + p.begin, padded);
    };
    const Vec3 normal = normal_between({part(x_), part(y_), part(z_), part(side_)});
    // One body alone, or no separating direction.
    if (norm2(normal) == 0) return 0;
    double end = -HUGE_VAL, begin = HUGE_VAL;
    for (size_t i = p.begin; i < p.begin + many; ++i) {
      const Near& q = near_[cloud_[i]];
      const double along = set.def.cell * dot(normal, {double{x_[i]}, double{y_[i]}, double{z_[i]}});
      const double half = half_width(g, set.pieces[q.piece], q.slot, normal);
      if (side_[i] < 0) {
        end = std::max(end, along + half);
      } else {
        begin = std::min(begin, along - half);
      }
    }
    if (!meet(of_a, of_b, normal, std::max(0.0, begin - end) / h, set.def.field_friction)) return 0;
    return std::max(settle(g, set, a, n, of_a.velocity, t), settle(g, set, b, n, of_b.velocity, t));
  }

  /// Sets a node's velocity as far as walls allow. Returns the square of its speed.
  double settle(G& g, const Setting& set, size_t block, size_t n, const Vec3& to, double t) {
    T* node = node_of(g, block, n);
    const Vec3T<T> wish{static_cast<T>(to.x), static_cast<T>(to.y), static_cast<T>(to.z)};
    const Vec3T<T> v = g.held(set, g.place_of(set.def, g.blocks.blocks[block], n), t, wish);
    if (!g.changes.empty()) {
      T* c = g.changes.data() + (node - g.nodes.data());
      c[1] += v.x - node[1], c[2] += v.y - node[2], c[3] += v.z - node[3];
    }
    node[1] = v.x, node[2] = v.y, node[3] = v.z;
    return double{norm2(v)};
  }

  std::vector<Place> places_;
  std::vector<Near> near_;
  std::vector<uint32_t> cloud_;
  Aligned<float> x_, y_, z_, side_;
};

}  // namespace truestep::mpm
