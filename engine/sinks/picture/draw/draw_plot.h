// Plots: a frame with ticks, names and units around the curves, which get colours of their own.
#pragma once
#include <cmath>
#include <span>

#include "engine/sinks/picture/draw/draw_list.h"

namespace truestep {

/// The extent of a plot, m; grows with what is added.
struct PlotBox {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  void add(const Vec3& p);
  /// Adds every finite point.
  void add(const std::vector<float>& positions);
  /// Adds t = 0 to `duration` along time axes.
  void add_time(std::span<const PlotAxis> axes, double duration);
  /// What has hardly changed yet is no line on the edge of the paper: the box is at least a third as high as
  /// wide.
  void open_up();
  bool empty() const { return !(low.x <= high.x); }
};

/// Appends the frame, its ticks and the axes' names; the picture makes room for them and has no ground.
void add_axes(DrawList& list, std::span<const PlotAxis> axes, const PlotBox& box);

/// Appends the lines of `points` as one set per curve, in the palette's colours from `first` on unless the
/// set has a colour; named curves enter the legend.
void add_curves(DrawList& list, const DrawPoints& points, std::span<const std::string> names, size_t first);

/// An automatic camera that looks from the side of the scene's own camera and keeps most of what that one
/// frames.
void frame_as(DrawList& list, const DrawCamera& camera);

}  // namespace truestep
