// Solids whose triangles change corners over time: cloth that tears.
#pragma once
#include "engine/core/ports/ports.h"
#include "engine/core/system.h"

namespace truestep {

/// Implemented by a system whose port lists only the triangles at t = 0.
class ChangingTriangles {
 public:
  /// As many triangles as the port has, with their corners in this state; valid as long as its columns.
  virtual std::span<const std::array<uint32_t, 3>> triangles(const State& state) const = 0;

 protected:
  ~ChangingTriangles() = default;
};

/// The solids that a system publishes, for any of its states.
class SolidsOf {
 public:
  SolidsOf() = default;
  explicit SolidsOf(const System& system)
      : start(system.ports().solids), changing_(system.ports().changing) {}
  PublishedSolids in(const State& state) const {
    PublishedSolids now = start;
    if (changing_ && !start.triangles.empty()) now.triangles = changing_->triangles(state);
    return now;
  }

  PublishedSolids start;  ///< at t = 0

 private:
  const ChangingTriangles* changing_ = nullptr;
};

}  // namespace truestep
