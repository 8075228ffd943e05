// Which parts of a cloth may tear, and how. Vertices split (Mueller, Heidelberger, Hennix, Ratcliff 2007,
// section 3.6): where a link between neighbours is beyond its limit, the more heavily loaded end is cut by
// the plane through it across the link, the triangles on the link's side get a row of their own, and the mass
// is divided by their rest areas. The new row has the position and velocity of the old one, so mass and
// momenta are conserved. The state holds the row of every triangle corner; all else follows from it: an edge
// between two triangles whose rows now differ becomes a strand of each of them, with half of its stiffness; a
// bend with a split point is removed.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/core/state/state.h"
#include "engine/systems/xpbd/body.h"
#include "engine/systems/xpbd/columns.h"

namespace truestep::xpbd {

/// What is left of a link at one of its triangles.
struct Strand {
  uint32_t a = 0, b = 0;  ///< rows
  double share = 0;       ///< of the link's stiffness; 0: gone, or already the strand of an earlier side
};

class TearSurface {
 public:
  /// Columns of the state: mass in kg, the row that a row came from, rows of the triangle corners.
  struct Columns {
    State::Column mass = 0, origin = 0, corner = 0;
  };
  explicit TearSurface(const Body& body);

  Columns columns;

  size_t sides(size_t link) const { return first_side_[link + 1] - first_side_[link]; }
  /// Index of a link's first side among all sides.
  size_t first_side(size_t link) const { return first_side_[link]; }
  Strand strand(std::span<const uint32_t> corners, size_t link, size_t side) const;
  /// Whether the link is as it was at the start.
  bool whole(std::span<const uint32_t> corners, size_t link) const;
  /// Whether an original row has been split.
  bool split(std::span<const uint32_t> corners, uint32_t row) const;
  /// Cuts `row` by the plane through it across `along`. Returns false and does nothing if one side has no
  /// triangle or no row is left.
  bool cut(State& state, uint32_t row, const Vec3& along, size_t capacity) const;
  std::span<const std::array<uint32_t, 3>> triangles() const { return triangles_; }

 private:
  /// Triangle corners (3 t + k) at the ends of a link. A diagonal that is no triangle's edge lies across two
  /// triangles and holds as long as they share the edge p q.
  struct Side {
    uint32_t a, b;
    std::array<uint32_t, 4> across;  ///< p, q of one, p, q of the other; kNone if the link is an edge
  };
  static constexpr uint32_t kNone = UINT32_MAX;
  std::span<const uint32_t> around(uint32_t point) const {
    return {at_.data() + begin_[point], begin_[point + 1] - begin_[point]};
  }
  void find_sides(const Link& link);

  std::vector<std::array<uint32_t, 3>> triangles_;
  std::vector<double> areas_;         // m^2, at rest
  std::vector<uint32_t> begin_, at_;  // corners of every original row
  std::vector<size_t> first_side_;
  std::vector<Side> sides_;
};

/// Limits of a link; HUGE_VAL: none.
struct TearLimits {
  double strain = 0, force = 0;  ///< 1, N
};

/// Splits rows at overloaded links at the end of a step, the most overloaded first; a row splits at most once
/// a step, and its neighbours then wait for the next step.
class Tearing {
 public:
  void run(const TearSurface& surface, const Body& body, const TearLimits& limits, State& state,
           std::span<const double> stiffness);

 private:
  struct Overload {
    double ratio;
    uint32_t link, side;
  };
  std::vector<Overload> overloads_;
  std::vector<double> borne_;  // per row: load of its strands over their limits
  std::vector<uint8_t> touched_;
};

}  // namespace truestep::xpbd
