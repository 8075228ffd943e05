// Round values along an axis, and how they are written.
#pragma once
#include <string>
#include <vector>

#include "engine/core/drawing.h"

namespace truestep {

struct Tick {
  double at = 0;  ///< m, along the drawing's axis
  std::string text;
};

/// A number as written on an axis: six digits, powers of ten beyond 1e5 and below 1e-3.
std::string tick_text(double value);

/// Multiples of 1, 2 or 5 times a power of ten in [low, high], about `wanted` of them.
std::vector<double> round_values(double low, double high, int wanted);

/// Where an axis draws a value, m; between its powers of ten, by the value's logarithm.
double place_of(const PlotAxis& axis, double value);

/// Ticks of an axis drawn from `low` to `high` (m): round values, or decades.
std::vector<Tick> ticks_of(const PlotAxis& axis, double low, double high, int wanted);

}  // namespace truestep
