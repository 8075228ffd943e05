// Keeps points on their side of the triangles, whatever a substep's answers did to both. The path that counts
// is the straight one from the substep's start, where every point is on its side, to its end: if no point
// meets a triangle on it, none has passed one. Pairs that do meet are stopped without restitution and checked
// again on the changed paths, round after round (Bridson, Fedkiw, Anderson 2002, "Robust treatment of
// collisions, contact and friction for cloth animation", section 7.4); pairs that still meet after the last
// round form impact zones (section 7.5), which move as one body. Zones only grow, and nothing moves relative
// to its zone, so this ends. Unlike in the source, zones are translated, not rotated, which conserves
// momentum to rounding but gives up their spin.
#pragma once
#include <vector>

#include "engine/couplings/contact/contact_def.h"
#include "engine/couplings/contact/contact_pair.h"
#include "engine/couplings/contact/contact_search.h"
#include "engine/couplings/contact/near_pairs.h"
#include "engine/couplings/exchange.h"

namespace truestep::contact {

/// Both sides of a contact at the substep's start and end.
struct GuardedPoints {
  const double *start, *other_start;  ///< n x 3, m
  Points &points, &other;
  const SolidList& solids;
  double reach, h;  ///< m, s
};

class PassGuard {
 public:
  /// Returns whether anything was changed; what the points gave to the solids is added to `exchange`. `near`
  /// holds the pairs found by this substep's search.
  bool run(const GuardedPoints& g, const ContactDef& law, NearPairs& near, Exchange& exchange,
           const ThreadArena& arena);

 private:
  enum class Look : uint8_t { all, changed };
  void detect(const GuardedPoints& g, NearPairs& near, Look look, const ThreadArena& arena);
  bool update_boxes(const GuardedPoints& g, NearPairs& near, Look look, const ThreadArena& arena);
  bool stop(const GuardedPoints& g, const ContactDef& law, const Touch& t, Exchange& exchange);
  /// Returns false when nothing is left to join.
  bool join(const GuardedPoints& g, Exchange& exchange);
  uint32_t zone_of(uint32_t row);

  std::vector<std::vector<Touch>> found_;  // per block of points
  std::vector<Touch> hits_;
  std::vector<uint8_t> moved_points_, moved_rows_, moved_solids_;
  std::vector<uint32_t> zone_, members_;
  struct Zone {
    double mass = 0;
    Vec3 shift, momentum;
    bool held = false;
  };
  std::vector<Zone> zones_;
};

}  // namespace truestep::contact
