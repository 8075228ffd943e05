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
  void reserve(size_t slots);

  /// Changes the nodes' velocities. Returns the speed (m/s) of the fastest node that was touched.
  double act(G& g, const Setting& set, double t, double h, const ThreadArena& arena);

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

  void find_places(const G& g);
  static T* node_of(G& g, size_t block, size_t n) {
    return g.nodes.data() + block * G::kBlockNumbers + 4 * n;
  }
  static uint64_t shared_nodes(G& g, const Place& p);
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
  static double half_width(const G& g, const Piece& piece, size_t slot, const Vec3& n);

  /// Resolves contact at the shared nodes of a place. Returns the square of the largest speed.
  double meet_at(G& g, const Setting& set, const Place& p, double t, double h);

  /// Fills the cloud with the particles of blocks a and b that reach node n; returns their number.
  size_t gather_cloud(const Place& p, size_t n, size_t a, size_t b);

  /// Whether b moves away from a within 30 degrees of the line between their particles' centres, and so from
  /// any surface between them within 60 degrees of perpendicular to that line.
  bool parts(const Place& p, size_t many, const Vec3& w) const;

  double meet_pair(G& g, const Setting& set, const Place& p, size_t n, size_t a, size_t b, double t,
                   double h);

  /// Sets a node's velocity as far as walls allow. Returns the square of its speed.
  double settle(G& g, const Setting& set, size_t block, size_t n, const Vec3& to, double t);

  std::vector<Place> places_;
  std::vector<Near> near_;
  std::vector<uint32_t> cloud_;
  Aligned<float> x_, y_, z_, side_;
};

}  // namespace truestep::mpm
