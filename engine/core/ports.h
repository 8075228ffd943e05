// Ports: where couplings reach into a state without knowing its system. Views all of them: what a coupling
// writes through a port (impulses into the velocity column, corrections into the position column) is the
// system's state itself.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>

#include "engine/core/state.h"
#include "engine/math/vec3.h"

namespace truestep {

/// Columns of a state that hold its points. Exactly one of `mass` and `inverse_mass` is given.
struct PointPort {
  State::Column position = 0, velocity = 1;   ///< rows x 3, m and m/s
  std::optional<State::Column> mass;          ///< kg
  std::optional<State::Column> inverse_mass;  ///< 1/kg, 0: held
  /// u64, ascending and never used twice, where rows move when points go; otherwise a row is its own id.
  std::optional<State::Column> id;
  double radius = 0;  ///< m, of every point
};

/// The points of one state; Real is double or const double. Valid until rows are added or removed.
template <class Real>
class PointsOf {
 public:
  using StateRef = std::conditional_t<std::is_const_v<Real>, const State&, State&>;

  PointsOf(StateRef s, const PointPort& c)
      : x(s.f64(c.position).data()), v(s.f64(c.velocity).data()), count(s.rows(c.position)) {
    if (c.mass) mass_ = s.f64(*c.mass).data();
    if (c.inverse_mass) inverse_mass_ = s.f64(*c.inverse_mass).data();
    if (c.id) ids = std::as_const(s).template span<uint64_t>(*c.id);
  }
  /// 1/kg; 0: held.
  double inverse_mass(size_t row) const { return inverse_mass_ ? inverse_mass_[row] : 1 / mass_[row]; }
  /// The row of a point, or nothing when it is gone.
  std::optional<size_t> row_of(uint64_t id) const {
    if (ids.empty()) return id < count ? std::optional<size_t>(id) : std::nullopt;
    const auto at = std::lower_bound(ids.begin(), ids.end(), id);
    if (at == ids.end() || *at != id) return std::nullopt;
    return static_cast<size_t>(at - ids.begin());
  }

  Real *x, *v;
  size_t count;
  std::span<const uint64_t> ids;  ///< empty where a row is its own id

 private:
  const double *mass_ = nullptr, *inverse_mass_ = nullptr;
};
using Points = PointsOf<double>;
using ConstPoints = PointsOf<const double>;

/// Solids that a system publishes: the convex hulls of its points, thickened by their radius. An impulse on a
/// solid goes to its corners by the barycentric weights of the place that it acts on.
struct PublishedSolids {
  std::span<const std::array<uint32_t, 3>> triangles;
  std::span<const std::array<uint32_t, 2>> segments;  ///< capsules; the same row twice: a ball
  enum class Balls : uint8_t { none, every_point } balls = Balls::none;

  bool empty() const { return triangles.empty() && segments.empty() && balls == Balls::none; }
};

class AnswersImpulses;  // core/impulse_answer.h

/// Corners of `solids` are rows of `points`.
struct Ports {
  std::optional<PointPort> points;
  PublishedSolids solids;  ///< with which points of other systems collide
  /// How all points answer impulses on some; null: each by its own mass.
  const AnswersImpulses* answers = nullptr;
};

}  // namespace truestep
