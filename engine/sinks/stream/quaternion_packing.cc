#include "engine/sinks/stream/quaternion_packing.h"

#include <array>
#include <cmath>

namespace truestep {

namespace {

constexpr double kQuantaPerUnit = 722.6631303101366;  // 511 sqrt(2)

// The three factors are at most 1 / sqrt(2) in magnitude, so the sum is from 0 to 1022 (1/2 more for
// rounding); 0 for the result of a quaternion that is not finite.
uint32_t quantum(double v) {
  const double sum = v * kQuantaPerUnit + 511.5;
  return static_cast<uint32_t>(sum > 0 ? sum : 0);
}

}  // namespace

bool pack_quaternions(const float* wxyz, size_t count, uint32_t* out) {
  bool good = true;
  for (size_t i = 0; i < count; ++i) {
    const double w = wxyz[4 * i], x = wxyz[4 * i + 1], y = wxyz[4 * i + 2], z = wxyz[4 * i + 3];
    const double norm2 = w * w + x * x + y * y + z * z;
    const bool valid = norm2 > 0 && norm2 < HUGE_VAL;
    good &= valid;
    const double ww = w * w, xx = x * x, yy = y * y, zz = z * z;
    const double wx = ww >= xx ? ww : xx, yz = yy >= zz ? yy : zz;
    const uint32_t first = ww >= xx ? 0 : 1, second = yy >= zz ? 2 : 3;
    const uint32_t left_out = wx >= yz ? first : second;
    // The others in order, each picked by a comparison that compiles to a select.
    const double largest = left_out == 0 ? w : left_out == 1 ? x : left_out == 2 ? y : z;
    const double a = left_out == 0 ? x : w, b = left_out <= 1 ? y : x, c = left_out <= 2 ? z : y;
    const double scale = valid ? (largest < 0 ? -1 : 1) / std::sqrt(norm2) : 0;
    out[i] = left_out << 30 | quantum(a * scale) << 20 | quantum(b * scale) << 10 | quantum(c * scale);
  }
  return good;
}

}  // namespace truestep
