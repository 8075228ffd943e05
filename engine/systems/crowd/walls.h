// Walls as straight pieces, with doors cut out, and a table of the pieces near a place.
#pragma once
#include <span>
#include <vector>

#include "engine/systems/crowd/crowd_def.h"

namespace truestep::crowd {

class Walls {
 public:
  /// `near` finds pieces within `reach` (m) of a place.
  Walls(const CrowdDef& def, double reach);

  std::span<const Segment> pieces() const { return pieces_; }
  /// Indices of all pieces within reach of x, and possibly others.
  std::span<const uint32_t> near(const Vec3& x) const;

  /// visit(normal, distance) for every piece near x that faces it: unit normal from the wall to x, distance
  /// in m. A corner where two pieces meet counts once, and not at all if the inside of one of them is nearer.
  /// On a wall the normal is its left one.
  template <class Visit>
  void faces(const Vec3& x, Visit&& visit) const {
    for (const uint32_t k : near(x)) {
      const Segment& s = pieces_[k];
      const double share = nearest_share(s, x);
      if (share <= 0 && hidden(before_[k], s.a, x, k)) continue;
      if (share >= 1 && hidden(after_[k], s.b, x, k)) continue;
      const Vec3 d = x - (s.a + (s.b - s.a) * share);
      const double distance = norm(d);
      visit(distance > 0 ? d / distance : left_[k], distance);
    }
  }

  /// m, to the nearest piece; at most the reach.
  double distance(const Vec3& x) const;
  /// Whether the straight path from a to b crosses a wall, or comes nearer to one than `clearance` (m, below
  /// the reach) and than its ends are.
  bool blocked(const Vec3& a, const Vec3& b, double clearance) const;
  /// A piece hit by the straight path from a to b, or null.
  const Segment* crossed(const Vec3& a, const Vec3& b) const;

 private:
  /// Calls visit(piece) until it returns true, for all pieces within `clearance` of the path, and possibly
  /// others; returns whether it did.
  template <class Visit>
  bool along(const Vec3& a, const Vec3& b, double clearance, Visit&& visit) const {
    // Lookups at these intervals together cover everything closer to the path than the clearance.
    const double step = 2 * (reach_ - clearance);
    const long looks = static_cast<long>(norm(b - a) / step) + 1;
    for (long i = 0; i < looks; ++i) {
      const Vec3 at = a + (b - a) * ((static_cast<double>(i) + 0.5) / static_cast<double>(looks));
      for (const uint32_t k : near(at)) {
        if (visit(pieces_[k])) return true;
      }
    }
    return false;
  }

  static constexpr uint32_t kNone = ~0u;
  /// Whether the piece `other`, which shares `corner` with piece k, already accounts for what x sees there.
  bool hidden(uint32_t other, const Vec3& corner, const Vec3& x, uint32_t k) const;
  void add(const Vec3& a, const Vec3& b, std::span<const DoorDef> doors);
  void join();

  std::vector<Segment> pieces_;
  std::vector<Vec3> left_;
  std::vector<uint32_t> before_, after_;
  double reach_;
  Vec3 low_;
  double size_ = 1;
  long nx_ = 0, ny_ = 0;
  std::vector<uint32_t> start_, list_;
};

}  // namespace truestep::crowd
