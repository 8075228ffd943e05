// The solids that points of a system collide with, and the contact of moving points with them. A point's path
// over a step is x_old -> x; contacts are found on the chord in the solid's moving frame (nothing is missed,
// kernels/contact/first_contact.h), timed on the parabola through both ends, answered with restitution and
// friction (kernels/contact/contact_response.h), and the rest of the step continues from there, up to
// kMaxContacts times. Bounces that would return within the step count as resting, so nothing jitters.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "engine/base/parallel.h"
#include "engine/collision/points/collider.h"
#include "engine/core/drawing.h"
#include "engine/core/state/workspace.h"

namespace truestep {

inline constexpr size_t kMaxColliders = 256;
inline constexpr int kMaxContacts = 8;
/// Points are kept this far (m) off every surface, so that rounding never puts one inside.
inline constexpr double kContactSlop = 1e-9;

/// Points before and after a step of length h that began at time t (s). All arrays are n x 3.
struct ContactSweep {
  double t = 0, h = 0;
  std::span<const double> x_old, v_old;
  std::span<double> x, v;                  ///< corrected in place
  std::span<const double> inverse_mass{};  ///< n or empty; points with 0 are left alone
  double radius = 0;                       ///< m, of every point
  std::span<const Surface> surfaces{};     ///< one per collider, or empty: the colliders' own
};

/// The surface that a point is nearest to, or deepest in.
struct NearSurface {
  static constexpr size_t kNone = SIZE_MAX;
  size_t collider = kNone;
  double distance = 0;  ///< m, negative where points are not allowed
  Vec3 normal;          ///< towards the side where points stay
  Vec3 velocity;        ///< m/s, of the surface there
  Vec3 shift = {};      ///< m, of the image that has it (images.h)
};

class ColliderSet {
 public:
  /// Error "too_many_colliders" beyond kMaxColliders.
  void add(Collider c);
  bool empty() const { return colliders_.empty(); }
  const std::vector<Collider>& colliders() const { return colliders_; }

  /// Keeps the points of a sweep outside the solids and inside the containers. Points may be processed
  /// concurrently.
  void resolve(const ContactSweep& sweep, Workspace& workspace, const ThreadArena& arena) const;

  /// Distance (m) from a point to the nearest surface at time t; negative where points are not allowed.
  double clearance(const Vec3& x, double t) const;
  /// The surface of collider k that is nearest to x at time t; empty where that is `limit` (m) or more away.
  std::optional<NearSurface> surface_of(size_t k, const Vec3& x, double t, double limit) const;
  /// The nearest of all surfaces at time t; empty for an empty set.
  NearSurface nearest(const Vec3& x, double t) const;
  /// For drawing, at time t.
  std::vector<DrawnShape> drawn(double t) const;

 private:
  std::vector<Collider> colliders_;
};

}  // namespace truestep
