// Ports: where couplings reach into a state without knowing its system. All of them are views: what a
// coupling writes through a port (impulses into the velocity column, corrections into the position column)
// changes the system's state itself.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/core/ports/body_port.h"
#include "engine/core/state/real_column.h"

namespace truestep {

/// Columns of a state that hold its points, all f64 or f32. Exactly one of `mass` and `inverse_mass` is
/// given.
struct PointPort {
  State::Column position = 0, velocity = 1;   ///< rows x 3, m and m/s
  std::optional<State::Column> mass;          ///< kg
  std::optional<State::Column> inverse_mass;  ///< 1/kg, 0: held
  /// u64, ascending and never reused, when rows move as points are removed; otherwise a row is its own id.
  std::optional<State::Column> id;
  double radius = 0;  ///< m, of every point
};

/// The points of one state; Real is double or const double. Valid until rows are added or removed.
template <class Real>
class PointsOf {
 public:
  using StateRef = typename RealColumn<Real>::StateRef;

  PointsOf(StateRef s, const PointPort& c)
      : places_(s, c.position), velocities_(s, c.velocity), count(s.rows(c.position)) {
    x = places_.doubles(), v = velocities_.doubles();
    if (c.mass) mass_ = RealColumn<const double>(s, *c.mass);
    if (c.inverse_mass) inverse_mass_ = RealColumn<const double>(s, *c.inverse_mass);
    if (c.id) ids = std::as_const(s).template span<uint64_t>(*c.id);
  }
  Vec3 place(size_t row) const { return places_.vector(row); }
  Vec3 velocity(size_t row) const { return velocities_.vector(row); }
  void set_place(size_t row, const Vec3& to) { places_.set_vector(row, to); }
  void set_velocity(size_t row, const Vec3& to) { velocities_.set_vector(row, to); }
  void shift(size_t row, const Vec3& by) { set_place(row, place(row) + by); }
  void accelerate(size_t row, const Vec3& by) { set_velocity(row, velocity(row) + by); }
  /// 1/kg; 0: held.
  double inverse_mass(size_t row) const { return inverse_mass_ ? inverse_mass_.at(row) : 1 / mass_.at(row); }
  /// The row of a point, or empty when it is gone.
  std::optional<size_t> row_of(uint64_t id) const {
    if (ids.empty()) return id < count ? std::optional<size_t>(id) : std::nullopt;
    const auto at = std::lower_bound(ids.begin(), ids.end(), id);
    if (at == ids.end() || *at != id) return std::nullopt;
    return static_cast<size_t>(at - ids.begin());
  }
  uint64_t id_of(size_t row) const { return ids.empty() ? row : ids[row]; }

  /// Makes `x` and `v` readable for f32 columns: copies, kept in `memory`.
  void copy_singles(std::vector<double>& memory) {
    if (x) return;
    memory.resize(6 * count);
    for (size_t k = 0; k < 3 * count; ++k)
      memory[k] = places_.at(k), memory[3 * count + k] = velocities_.at(k);
    x = memory.data(), v = memory.data() + 3 * count;
  }
  /// Writes the copies back into the columns.
  void write_back() {
    if (places_.doubles()) return;
    for (size_t k = 0; k < 3 * count; ++k) places_.set(k, x[k]), velocities_.set(k, v[k]);
  }

 private:
  RealColumn<Real> places_, velocities_;
  RealColumn<const double> mass_, inverse_mass_;

 public:
  Real *x, *v;  ///< rows x 3; null when the columns are f32 and were not copied
  size_t count;
  std::span<const uint64_t> ids;  ///< empty when a row is its own id
};
using Points = PointsOf<double>;
using ConstPoints = PointsOf<const double>;

/// Solids that a system publishes: convex hulls of its points, thickened by their radius. An impulse on a
/// solid is distributed to its corners by the barycentric weights of the point of application.
struct PublishedSolids {
  std::span<const std::array<uint32_t, 3>> triangles;
  std::span<const std::array<uint32_t, 2>> segments;  ///< capsules; the same row twice: a ball
  enum class Balls : uint8_t { none, every_point } balls = Balls::none;

  bool empty() const { return triangles.empty() && segments.empty() && balls == Balls::none; }
};

class AnswersImpulses;    // core/equations/impulse_answer.h
class ChangingTriangles;  // core/ports/changing_triangles.h
class Morphed;            // core/ports/morph_port.h
class PressedPoints;      // core/ports/pressed_points.h
class Rigged;             // core/ports/rig_port.h
namespace animation {
class Driver;  // animation/driver.h
}

/// A medium that fills space and takes bodies (core/ports/medium.h).
struct MediumPort {
  int dimension = 3;
  State::Column place = 0;    ///< rows x 3, m, positions of its parcels, f64 or f32
  double spacing = 0;         ///< m, between them
  State::Column gravity = 0;  ///< three numbers, m/s^2, f64
};

/// What a system offers to couplings and file writers; corners of `solids` are rows of `points`. What it does
/// not have is empty or null.
struct Ports {
  std::optional<PointPort> points;
  PublishedSolids solids;  ///< with which points of other systems collide
  std::optional<BodyPort> bodies;
  std::optional<MediumPort> medium;
  /// How all points respond to impulses on some; null: each by its own mass.
  const AnswersImpulses* answers = nullptr;
  const ChangingTriangles* changing = nullptr;  ///< `solids` lists the triangles at t = 0; null: of any time
  const PressedPoints* pressed = nullptr;       ///< what its points take when bodies press on them
  const Rigged* rig = nullptr;                  ///< a skeleton
  const Morphed* morph = nullptr;               ///< blended shapes
  const animation::Driver* driver = nullptr;    ///< channels that move it and that others may follow
};

}  // namespace truestep
