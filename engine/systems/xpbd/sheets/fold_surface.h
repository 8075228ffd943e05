// The parts of a body that may collide with each other: facets, which are triangles or, for ropes and hair,
// links. Every point and every edge belongs to one facet (Curtis, Tamstorf, Manocha 2008, "Fast collision
// detection for deformable models using representative-triangles"), so a pair of facets stands for all its
// pairs of features and none is tested twice. Facets within two rings of each other come close only where the
// surface folds between them: a strip of two edges that closes on itself turns by half a circle over at most
// three hinges.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/systems/xpbd/body.h"

namespace truestep::xpbd {

struct Facet {
  std::array<uint32_t, 3> points;  ///< the last one twice for a link
  uint8_t corners;                 ///< 3; 2 for a link
  uint8_t own_points, own_edges;   ///< bits: corner k; edge from corner k to the next
  /// Corner of another triangle across edge k; UINT32_MAX where there is none.
  std::array<uint32_t, 3> across{UINT32_MAX, UINT32_MAX, UINT32_MAX};
};

class FoldSurface {
 public:
  explicit FoldSurface(const Body& body);
  /// Follows tearing: `corners` of the triangles, rows, and `origin`, the row each row came from. Every point
  /// and edge that tearing has created gets a facet of its own. Kinship is inherited, so the two lips of a
  /// tear, which coincide at rest, are ignored next to its tip.
  void follow_tears(std::span<const uint32_t> corners, std::span<const uint32_t> origin);

  std::span<const Facet> facets() const { return facets_; }
  /// Facets after this one within two rings of it, ascending.
  std::span<const uint32_t> near(size_t facet) const {
    return {near_.data() + begin_[facet], begin_[facet + 1] - begin_[facet]};
  }
  /// Two triangles: the ends of their common edge, then the opposite corners.
  std::span<const std::array<uint32_t, 4>> hinges() const { return hinges_; }
  std::span<const Vec3> rest() const { return rest_; }
  double mean_edge() const { return mean_edge_; }

 private:
  void own();
  void find_near();
  void find_hinges();

  std::vector<Facet> facets_;
  std::vector<size_t> begin_;
  std::vector<uint32_t> near_;
  std::vector<std::array<uint32_t, 4>> hinges_;
  std::vector<Vec3> rest_;  // m
  double mean_edge_ = 0;    // m
};

}  // namespace truestep::xpbd
