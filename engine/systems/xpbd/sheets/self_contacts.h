// Keeps a body from passing through itself: after the constraints have moved its points from x0 to x1 in a
// substep, facets that would come within the thickness are held apart, with friction, where they first do so
// along their straight paths (kernels/contact/proximity.h). Facets already closer than the thickness at x0
// are pushed apart gradually. Corrections are impulses between four points; new contacts that they cause are
// handled in the next round. Contacts left after the last round form rigid zones: all points of a zone move
// by their mean displacement (after Harmon, Vouga, Tamstorf, Grinspun 2008, "Robust treatment of simultaneous
// collisions", translations only), which preserves their distances, so that facets which start apart never
// end up inside one another.
// Candidate pairs come from a tree of boxes around each facet's path plus some slack; they stay valid until a
// point leaves its box.
// Facets within two rings of each other are kept at half their rest distance where that is less than the
// thickness; facets that touch at rest are ignored.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/geometry/static_tree.h"
#include "engine/kernels/contact/proximity.h"
#include "engine/systems/xpbd/sheets/fold_surface.h"

namespace truestep::xpbd {

struct SelfOptions {
  double thickness = 0.01;  ///< m, between middle surfaces
  double friction = 0;
};

/// Positions of the points in a substep, three numbers each; x1 is corrected.
struct SelfSweep {
  std::span<const double> x0;
  std::span<double> x1;
  std::span<const double> inverse_mass;
  double h;  ///< s
};

class SelfContacts {
 public:
  /// Forgets earlier substeps: what follows depends on its arguments alone.
  void begin_step(const FoldSurface& surface);
  /// Whether anything was corrected.
  bool resolve(const FoldSurface& surface, const SelfOptions& options, const SelfSweep& sweep,
               const ThreadArena& arena);
  /// Whether the last resolve moved the point.
  bool moved(size_t point) const { return moved_[point] != 0; }

 private:
  struct Contact {
    std::array<uint32_t, 4> points;
    std::array<double, 4> c;
    Vec3 normal;
    double gap;  // m, to be kept along the normal; kWatched: only checked again
  };
  /// What one block of facets or pairs contributes when searched in parallel.
  struct Found {
    std::vector<std::array<uint32_t, 2>> pairs;
    std::vector<Contact> contacts;
  };
  enum class Round : uint8_t { first, check };
  static constexpr double kWatched = -1;
  enum class Kinship : uint8_t { near, far };
  struct Search {
    const FoldSurface& surface;
    const SelfOptions& options;
    const SelfSweep& sweep;
    Round round;
    /// m, search distance: the thickness in the first round, a small share of it when results are checked.
    double reach() const;
  };

  void follow(const FoldSurface& surface, const SelfOptions& options, const SelfSweep& sweep,
              const ThreadArena& arena);
  void find_pairs(const FoldSurface& surface, double grow, const ThreadArena& arena);
  void mark_folds(const FoldSurface& surface, const SelfSweep& sweep);
  /// Whether any contact was found.
  bool search(const Search& what, const ThreadArena& arena);
  void update_boxes(const Search& search, const ThreadArena& arena);
  void find_contacts(const Search& search, const ThreadArena& arena);
  /// Whether one facet's normal separates their whole paths by more than the reach.
  bool apart(const Search& search, const Facet& f, const Facet& g, const Vec3& normal) const;
  void meet_facets(const Search& search, uint32_t a, uint32_t b, Kinship kinship,
                   std::vector<Contact>& out) const;
  /// `across`: the opposite corners of the triangles at both edges, UINT32_MAX if none.
  template <class Kind>
  void meet(const Search& search, const std::array<uint32_t, 4>& points,
            const std::array<uint32_t, 4>& across, Kinship kinship, std::vector<Contact>& out) const;
  void solve(const SelfOptions& options, const SelfSweep& sweep);
  void join_zones(const SelfSweep& sweep);
  uint32_t zone(uint32_t point);

  std::vector<Box> reach_;     // per point, in the frame that drifts with the mean
  std::vector<Box> boxes_;     // per facet
  std::vector<Vec3> normals_;  // per facet, at x0; zero for a link
  StaticTree tree_;            // over the facets at rest, with the current boxes
  const FoldSurface* tree_of_ = nullptr;
  Vec3 drift_, next_drift_;  // m, at x0 and x1
  bool known_ = false;
  std::vector<std::array<uint32_t, 2>> pairs_;
  std::vector<Found> found_;
  std::vector<Contact> contacts_;
  size_t fresh_ = 0;  // contacts from here on come from the last search
  std::vector<uint8_t> folded_, moved_;
  std::vector<uint32_t> zone_;
  std::vector<double> sums_;  // for each zone: mass, displacement times mass
};

}  // namespace truestep::xpbd
