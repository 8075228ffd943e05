#include "engine/sinks/picture/draw/draw_liquid.h"

#include <utility>

#include "engine/geometry/particle_surface.h"
#include "engine/sinks/picture/geometry.h"

namespace truestep {

void wrap_liquid(DrawPoints& points, PartDrawing::Space space) {
  constexpr double kCell = 0.5;  // spacings
  if (!(points.radius > 0) || space == PartDrawing::Space::plane) return;
  if (!points.lines.empty() || !points.triangles.empty()) return;
  const double spacing = 2 * double{points.radius};
  ParticleSurface s = particle_surface(points.positions, points.scalar, {spacing, kCell * spacing});
  // Colours keep the meaning that they have for the particles.
  if (!points.scalar.empty()) {
    const auto [low, high] = picture::scalar_range(points);
    points.scalar_min = low, points.scalar_max = high;
  }
  points.positions = std::move(s.positions), points.scalar = std::move(s.values);
  points.triangles = std::move(s.triangles);
  points.radius = 0, points.point_pixels = 0;
}

}  // namespace truestep
