// Plots: a frame with ticks, names and units around what is drawn along axes, and the curves in colours of
// their own.
#pragma once
#include <cmath>
#include <span>

#include "engine/sinks/picture/draw_list.h"

namespace truestep {

/// What a plot shows, m; grows with what is added.
struct PlotBox {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  void add(const Vec3& p);
  /// Every point that is finite.
  void add(const std::vector<float>& positions);
  /// From t = 0 to `duration` along axes of time.
  void add_time(std::span<const PlotAxis> axes, double duration);
  bool empty() const { return !(low.x <= high.x); }
};

/// Appends the frame, its ticks and the axes' names; the picture has room for them and no ground.
void add_axes(DrawList& list, std::span<const PlotAxis> axes, const PlotBox& box);

/// The lines of `points` as one set for each curve, in the palette's colours from `first` on unless the set
/// has a colour; named curves enter the legend.
void add_curves(DrawList& list, const DrawPoints& points, std::span<const std::string> names, size_t first);

/// A chosen camera looks from the side of the scene's own camera and keeps most of what that one frames.
void frame_as(DrawList& list, const DrawCamera& camera);

}  // namespace truestep
