// Numbers in 16 bits: value = offset[c] + scale[c] * k, k = 0 ... 65535, per component c of a row.
//   k = round((value - offset[c]) / scale[c]), so |decoded - value| <= scale[c] / 2
// and whoever writes the decoded value as a float rounds it once more. Pure functions of arrays.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace truestep {

/// Offsets and quanta of a row's components; a scale of 0 means that the component is always its offset.
struct QuantumBox {
  std::vector<double> offset, scale;
  friend bool operator==(const QuantumBox&, const QuantumBox&) = default;
};

/// Least and greatest value of each component.
struct ColumnBounds {
  std::vector<float> low, high;
};

/// Bounds of rows x width values into `bounds` (zeros if there are no rows); false when one is not finite.
bool column_bounds(const float* values, size_t rows, uint32_t width, ColumnBounds& bounds);

/// The box whose first and last quantum are the bounds.
QuantumBox tight_box(const ColumnBounds& bounds);
/// A box with an eighth of the extent to spare on every side, for moving values.
QuantumBox roomy_box(const ColumnBounds& bounds);

/// Writes rows x width 16-bit values to `out`; false when a value is outside the box or not finite, and then
/// `out` is meaningless.
bool quantise(const float* values, size_t rows, uint32_t width, const QuantumBox& box, uint16_t* out);

}  // namespace truestep
