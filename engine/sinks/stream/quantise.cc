#include "engine/sinks/stream/quantise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace truestep {

namespace {

constexpr double kLast = 65535;
constexpr uint32_t kInfinity = 0x7f800000;  // bits of a float; anything above is NaN

uint32_t magnitude_bits(float v) {
  return std::bit_cast<uint32_t>(v) & 0x7fffffff;
}

// Rows are processed in tiles: kTileRows rows are whole vectors for any width, and the inner loops know their
// length. The rest uses the same arithmetic one value at a time.
constexpr size_t kTileRows = 8;

template <uint32_t W>
size_t bounds_of_tiles(const float* v, size_t rows, ColumnBounds& bounds, uint32_t& greatest) {
  constexpr size_t n = kTileRows * W;
  const size_t tiles = rows / kTileRows;
  if (tiles == 0) return 0;
  std::array<float, n> low, high;
  std::array<uint32_t, n> bits{};
  std::copy_n(v, n, low.begin());
  high = low;
  for (size_t t = 0; t < tiles; ++t, v += n) {
    for (size_t k = 0; k < n; ++k) {
      low[k] = v[k] < low[k] ? v[k] : low[k];
      high[k] = v[k] > high[k] ? v[k] : high[k];
      bits[k] = std::max(bits[k], magnitude_bits(v[k]));
    }
  }
  for (size_t k = 0; k < n; ++k) {
    bounds.low[k % W] = std::min(bounds.low[k % W], low[k]);
    bounds.high[k % W] = std::max(bounds.high[k % W], high[k]);
    greatest = std::max(greatest, bits[k]);
  }
  return tiles * kTileRows;
}

// Shifted up by one so that values below the box do not round to 0; `strays` collects bits above the 16th.
int32_t shifted_quantum(float v, double offset, double inverse) {
  const double s = (v - offset) * inverse + 1.5;
  const double above = s > 0 ? s : 0;  // also for NaN
  return static_cast<int32_t>(above < kLast + 3 ? above : kLast + 3);
}

template <uint32_t W>
size_t quantise_tiles(const float* v, size_t rows, const double* offset, const double* inverse, uint16_t* out,
                      uint32_t& strays) {
  constexpr size_t n = kTileRows * W;
  const size_t tiles = rows / kTileRows;
  std::array<double, n> o, f;
  for (size_t k = 0; k < n; ++k) o[k] = offset[k % W], f[k] = inverse[k % W];
  std::array<uint32_t, n> bits{};
  for (size_t t = 0; t < tiles; ++t, v += n, out += n) {
    std::array<int32_t, n> q;
    for (size_t k = 0; k < n; ++k) q[k] = shifted_quantum(v[k], o[k], f[k]) - 1;
    for (size_t k = 0; k < n; ++k) bits[k] |= static_cast<uint32_t>(q[k]);
    for (size_t k = 0; k < n; ++k) out[k] = static_cast<uint16_t>(q[k]);
  }
  for (const uint32_t b : bits) strays |= b;
  return tiles * kTileRows;
}

// Calls f<W> for the widths that fields have; 0 rows done for any other.
template <class F>
size_t for_width(uint32_t width, F f) {
  switch (width) {
    case 1:
      return f.template operator()<1>();
    case 2:
      return f.template operator()<2>();
    case 3:
      return f.template operator()<3>();
    case 4:
      return f.template operator()<4>();
    default:
      return 0;
  }
}

}  // namespace

bool column_bounds(const float* values, size_t rows, uint32_t width, ColumnBounds& bounds) {
  bounds.low.assign(width, 0);
  bounds.high.assign(width, 0);
  if (rows == 0) return true;
  std::copy_n(values, width, bounds.low.begin());
  bounds.high = bounds.low;
  uint32_t greatest = 0;
  const size_t done =
      for_width(width, [&]<uint32_t W>() { return bounds_of_tiles<W>(values, rows, bounds, greatest); });
  for (size_t i = done; i < rows; ++i) {
    for (uint32_t c = 0; c < width; ++c) {
      const float v = values[i * width + c];
      bounds.low[c] = std::min(bounds.low[c], v);
      bounds.high[c] = std::max(bounds.high[c], v);
      greatest = std::max(greatest, magnitude_bits(v));
    }
  }
  return greatest < kInfinity;
}

QuantumBox tight_box(const ColumnBounds& bounds) {
  QuantumBox box;
  for (size_t c = 0; c < bounds.low.size(); ++c) {
    box.offset.push_back(bounds.low[c]);
    box.scale.push_back((static_cast<double>(bounds.high[c]) - bounds.low[c]) / kLast);
  }
  return box;
}

QuantumBox roomy_box(const ColumnBounds& bounds) {
  double widest = 0, farthest = 0;
  for (size_t c = 0; c < bounds.low.size(); ++c) {
    widest = std::max(widest, static_cast<double>(bounds.high[c]) - bounds.low[c]);
    farthest = std::max({farthest, std::abs(static_cast<double>(bounds.low[c])),
                         std::abs(static_cast<double>(bounds.high[c]))});
  }
  // A constant component gets a thousandth of the others' extent, and never less than floats resolve.
  const double least = std::max({1e-3 * widest, 0x1p-10 * farthest, 0x1p-100});
  QuantumBox box;
  for (size_t c = 0; c < bounds.low.size(); ++c) {
    const double extent = std::max(static_cast<double>(bounds.high[c]) - bounds.low[c], least);
    const double middle = 0.5 * (static_cast<double>(bounds.high[c]) + bounds.low[c]);
    box.offset.push_back(middle - 0.625 * extent);
    box.scale.push_back(1.25 * extent / kLast);
  }
  return box;
}

bool quantise(const float* values, size_t rows, uint32_t width, const QuantumBox& box, uint16_t* out) {
  std::vector<double> inverse(width);
  for (uint32_t c = 0; c < width; ++c) inverse[c] = box.scale[c] > 0 ? 1 / box.scale[c] : 0;
  uint32_t strays = 0;
  const size_t done = for_width(width, [&]<uint32_t W>() {
    return quantise_tiles<W>(values, rows, box.offset.data(), inverse.data(), out, strays);
  });
  for (size_t i = done; i < rows; ++i) {
    for (uint32_t c = 0; c < width; ++c) {
      const int32_t q = shifted_quantum(values[i * width + c], box.offset[c], inverse[c]) - 1;
      strays |= static_cast<uint32_t>(q);
      out[i * width + c] = static_cast<uint16_t>(q);
    }
  }
  return strays >> 16 == 0;
}

}  // namespace truestep
