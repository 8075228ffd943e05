#include "engine/geometry/particle_surface.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace truestep {
namespace {

using Triple = std::array<float, 3>;
constexpr float kReach = 2;             // spacings, within which neighbours shape a particle
constexpr float kSupport = 2.5f;        // spacings, radius of the kernel where G is 1
constexpr float kLeastStretch = 0.15f;  // e
constexpr float kWhole = 25;            // neighbours that determine a shape completely
constexpr float kLone = 0.5f;           // relative to the size in the bulk of the liquid
constexpr float kLevel = 0.5f;
constexpr float kShrink = 0.5f, kGrow = -0.53f;  // Taubin's steps

/// Particles sorted into cubes `size` wide.
struct Bins {
  Triple low{};
  float size = 1;
  std::array<int, 3> count{1, 1, 1};
  std::vector<uint32_t> start, order;

  int along(float x, size_t a) const {
    return static_cast<int>(std::clamp((x - low[a]) / size, 0.0f, static_cast<float>(count[a] - 1)));
  }
  size_t of(int i, int j, int k) const {
    return static_cast<size_t>(i) +
           static_cast<size_t>(count[0]) *
               (static_cast<size_t>(j) + static_cast<size_t>(count[1]) * static_cast<size_t>(k));
  }
};

/// A box of nodes `cell` apart, x fastest.
struct Nodes {
  Triple low{};
  float cell = 1;
  std::array<int, 3> count{1, 1, 1};
  size_t of(int i, int j, int k) const {
    return static_cast<size_t>(i) +
           static_cast<size_t>(count[0]) *
               (static_cast<size_t>(j) + static_cast<size_t>(count[1]) * static_cast<size_t>(k));
  }
  size_t size() const { return of(0, 0, count[2]); }
};

/// A symmetric matrix xx yy zz xy xz yz.
using Symmetric = std::array<float, 6>;

float determinant(const Symmetric& m) {
  return m[0] * (m[1] * m[2] - m[5] * m[5]) - m[3] * (m[3] * m[2] - m[5] * m[4]) +
         m[4] * (m[3] * m[5] - m[1] * m[4]);
}
Symmetric inverse(const Symmetric& m, float det) {
  const float d = 1 / det;
  return {(m[1] * m[2] - m[5] * m[5]) * d, (m[0] * m[2] - m[4] * m[4]) * d, (m[0] * m[1] - m[3] * m[3]) * d,
          (m[4] * m[5] - m[3] * m[2]) * d, (m[3] * m[5] - m[1] * m[4]) * d, (m[3] * m[4] - m[0] * m[5]) * d};
}

/// The cubic spline of support 1 in space.
float spline(float q) {
  constexpr float kNorm = 2.5464791f;  // 8 / pi
  if (q >= 1) return 0;
  const float r = 1 - q;
  return q < 0.5f ? kNorm * (6 * q * q * (q - 1) + 1) : kNorm * 2 * r * r * r;
}

Bins sorted(std::span<const Triple> x, const Triple& low, const Triple& high, float size) {
  constexpr double kMost = 4e6;
  Bins b;
  b.low = low, b.size = size;
  const auto cubes = [&] {
    double all = 1;
    for (size_t a = 0; a < 3; ++a) {
      const double along = std::floor((double{high[a]} - double{low[a]}) / double{b.size}) + 1;
      all *= along, b.count[a] = static_cast<int>(std::min(along, kMost));
    }
    return all;
  };
  while (!(cubes() <= kMost)) b.size *= 1.5f;
  b.start.assign(b.of(0, 0, b.count[2]) + 1, 0);
  std::vector<uint32_t> at(x.size());
  for (size_t i = 0; i < x.size(); ++i) {
    at[i] = static_cast<uint32_t>(b.of(b.along(x[i][0], 0), b.along(x[i][1], 1), b.along(x[i][2], 2)));
    ++b.start[at[i] + 1];
  }
  for (size_t k = 1; k < b.start.size(); ++k) b.start[k] += b.start[k - 1];
  b.order.resize(x.size());
  std::vector<uint32_t> next(b.start.begin(), b.start.end() - 1);
  for (size_t i = 0; i < x.size(); ++i) b.order[next[at[i]]++] = static_cast<uint32_t>(i);
  return b;
}

/// G^-1 of particle i; lengths of `unit` (m) are 1.
Symmetric stretch(std::span<const Triple> x, const Bins& bins, size_t i, float unit) {
  constexpr float kInside = 0.15f;  // covariance along an axis in the bulk, over the square of the reach
  const float reach = kReach * unit;
  float sum = 0, mean[3] = {}, second[6] = {};
  int count = 0, from[3], to[3];
  for (size_t a = 0; a < 3; ++a) {
    from[a] = bins.along(x[i][a] - reach, a), to[a] = bins.along(x[i][a] + reach, a);
  }
  for (int k = from[2]; k <= to[2]; ++k) {
    for (int j = from[1]; j <= to[1]; ++j) {
      const uint32_t end = bins.start[bins.of(to[0], j, k) + 1];
      for (uint32_t at = bins.start[bins.of(from[0], j, k)]; at < end; ++at) {
        const Triple& y = x[bins.order[at]];
        const float d[3] = {y[0] - x[i][0], y[1] - x[i][1], y[2] - x[i][2]};
        const float q = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / reach;
        if (q >= 1) continue;
        const float w = 1 - q * q * q;
        sum += w, ++count;
        for (size_t a = 0; a < 3; ++a) mean[a] += w * d[a], second[a] += w * d[a] * d[a];
        second[3] += w * d[0] * d[1], second[4] += w * d[0] * d[2], second[5] += w * d[1] * d[2];
      }
    }
  }
  for (float& m : mean) m /= sum;
  const float scale = 1 / (kInside * reach * reach),
              trust = std::min(static_cast<float>(count - 1) / kWhole, 1.0f);
  const auto of = [&](size_t at, size_t a, size_t b) {
    return (second[at] / sum - mean[a] * mean[b]) * scale;
  };
  Symmetric m{of(0, 0, 0), of(1, 1, 1), of(2, 2, 2), of(3, 0, 1), of(4, 0, 2), of(5, 1, 2)};
  for (size_t a = 0; a < 6; ++a) {
    m[a] = trust * (m[a] + (a < 3 ? kLeastStretch : 0)) + (1 - trust) * (a < 3 ? kLone : 0);
  }
  return m;
}

/// Adds one particle's contribution to the field, and its value weighted by that.
void spread(const Triple& x, const Symmetric& m, float unit, const Nodes& nodes, float value,
            std::vector<float>& field, std::vector<float>& values) {
  const float radius = kSupport * unit, det = determinant(m);
  if (!(det > 1e-6f)) return;
  const Symmetric g = inverse(m, det);
  const float share = 1 / (kSupport * kSupport * kSupport * det);
  const float rows[3] = {std::sqrt(m[0] * m[0] + m[3] * m[3] + m[4] * m[4]),
                         std::sqrt(m[3] * m[3] + m[1] * m[1] + m[5] * m[5]),
                         std::sqrt(m[4] * m[4] + m[5] * m[5] + m[2] * m[2])};
  int from[3], to[3];
  for (size_t a = 0; a < 3; ++a) {
    const float at = (x[a] - nodes.low[a]) / nodes.cell, reach = radius * rows[a] / nodes.cell;
    const auto last = static_cast<float>(nodes.count[a] - 1);
    from[a] = static_cast<int>(std::clamp(std::ceil(at - reach), 0.0f, last));
    to[a] = static_cast<int>(std::clamp(std::floor(at + reach), 0.0f, last));
  }
  const float per = 1 / radius;
  for (int k = from[2]; k <= to[2]; ++k) {
    const float z = (nodes.low[2] + static_cast<float>(k) * nodes.cell - x[2]) * per;
    for (int j = from[1]; j <= to[1]; ++j) {
      const float y = (nodes.low[1] + static_cast<float>(j) * nodes.cell - x[1]) * per;
      const float u = g[3] * y + g[4] * z, v = g[1] * y + g[5] * z, w = g[5] * y + g[2] * z;
      for (int i = from[0]; i <= to[0]; ++i) {
        const float s = (nodes.low[0] + static_cast<float>(i) * nodes.cell - x[0]) * per;
        const float a = g[0] * s + u, b = g[3] * s + v, c = g[4] * s + w, square = a * a + b * b + c * c;
        if (square >= 1) continue;
        const float phi = share * spline(std::sqrt(square));
        field[nodes.of(i, j, k)] += phi;
        if (!values.empty()) values[nodes.of(i, j, k)] += phi * value;
      }
    }
  }
}

/// A vertex in every cell crossed by the level, a quad around every edge crossed by it.
ParticleSurface surface_nets(const Nodes& nodes, const std::vector<float>& field,
                             const std::vector<float>& values) {
  ParticleSurface out;
  constexpr uint32_t kNone = ~0u;
  const auto layer = static_cast<size_t>(nodes.count[0]) * static_cast<size_t>(nodes.count[1]);
  // Vertices of the cells of this layer of nodes and of the one before.
  std::vector<uint32_t> here(layer, kNone), before(layer, kNone);
  const size_t steps[3] = {1, static_cast<size_t>(nodes.count[0]), layer};
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d, bool outward) {
    if (!outward) std::swap(b, d);
    out.triangles.insert(out.triangles.end(), {a, b, c, a, c, d});
  };
  for (int k = 0; k + 1 < nodes.count[2]; ++k) {
    std::swap(here, before);
    std::fill(here.begin(), here.end(), kNone);
    for (int j = 0; j + 1 < nodes.count[1]; ++j) {
      for (int i = 0; i + 1 < nodes.count[0]; ++i) {
        const size_t node = nodes.of(i, j, k), flat = node - layer * static_cast<size_t>(k);
        float corner[8];
        int inside = 0;
        for (size_t c = 0; c < 8; ++c) {
          corner[c] =
              field[node + (c & 1 ? steps[0] : 0) + (c & 2 ? steps[1] : 0) + (c & 4 ? steps[2] : 0)] - kLevel;
          inside += corner[c] > 0;
        }
        if (inside == 0 || inside == 8) continue;
        float sum[3] = {}, crossings = 0, value = 0, weight = 0;
        for (size_t c = 0; c < 8; ++c) {
          for (size_t a = 0; a < 3; ++a) {
            const size_t d = c | (size_t{1} << a);
            if (d == c || (corner[c] > 0) == (corner[d] > 0)) continue;
            const float t = corner[c] / (corner[c] - corner[d]);
            for (size_t b = 0; b < 3; ++b) sum[b] += b == a ? t : static_cast<float>((c >> b) & 1);
            crossings += 1;
          }
          if (values.empty()) continue;
          const size_t at = node + (c & 1 ? steps[0] : 0) + (c & 2 ? steps[1] : 0) + (c & 4 ? steps[2] : 0);
          value += values[at], weight += field[at];
        }
        here[flat] = static_cast<uint32_t>(out.positions.size() / 3);
        const int cell[3] = {i, j, k};
        for (size_t a = 0; a < 3; ++a) {
          out.positions.push_back(nodes.low[a] +
                                  nodes.cell * (static_cast<float>(cell[a]) + sum[a] / crossings));
        }
        if (!values.empty()) out.values.push_back(value / weight);
        // The three edges that meet at the cell's lowest corner; the field is 0 on the box's sides.
        const bool in = corner[0] > 0;
        if (j > 0 && k > 0 && in != (corner[1] > 0)) {
          quad(here[flat], here[flat - steps[1]], before[flat - steps[1]], before[flat], in);
        }
        if (i > 0 && k > 0 && in != (corner[2] > 0)) {
          quad(here[flat], before[flat], before[flat - 1], here[flat - 1], in);
        }
        if (i > 0 && j > 0 && in != (corner[4] > 0)) {
          quad(here[flat], here[flat - 1], here[flat - 1 - steps[1]], here[flat - steps[1]], in);
        }
      }
    }
  }
  return out;
}

/// Moves vertices towards the mean of their neighbours, and then farther back.
void smooth(ParticleSurface& s, int rounds) {
  const size_t n = s.positions.size() / 3;
  std::vector<float> mean(3 * n), count(n);
  for (int round = 0; round < 2 * rounds; ++round) {
    std::fill(mean.begin(), mean.end(), 0.0f), std::fill(count.begin(), count.end(), 0.0f);
    for (size_t t = 0; t < s.triangles.size(); t += 3) {
      for (size_t e = 0; e < 3; ++e) {
        const size_t a = s.triangles[t + e], b = s.triangles[t + (e + 1) % 3];
        for (size_t c = 0; c < 3; ++c) mean[3 * a + c] += s.positions[3 * b + c];
        count[a] += 1;
      }
    }
    const float step = round % 2 == 0 ? kShrink : kGrow;
    for (size_t i = 0; i < 3 * n; ++i) {
      if (count[i / 3] > 0) s.positions[i] += step * (mean[i] / count[i / 3] - s.positions[i]);
    }
  }
}

}  // namespace

ParticleSurface particle_surface(std::span<const float> places, std::span<const float> values,
                                 const SurfaceOf& of) {
  std::vector<Triple> x;
  std::vector<float> own;
  Triple low{HUGE_VALF, HUGE_VALF, HUGE_VALF}, high{-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
  for (size_t i = 0; 3 * i + 2 < places.size(); ++i) {
    const Triple p{places[3 * i], places[3 * i + 1], places[3 * i + 2]};
    if (!std::isfinite(p[0] + p[1] + p[2])) continue;
    x.push_back(p);
    if (i < values.size()) own.push_back(std::isfinite(values[i]) ? values[i] : 0.0f);
    for (size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
  }
  if (x.empty() || !(of.spacing > 0) || !(of.cell > 0)) return {};
  if (own.size() != x.size()) own.clear();
  const auto unit = static_cast<float>(of.spacing);
  const Bins bins = sorted(x, low, high, kReach * unit);
  // A surrounding layer of nodes that no kernel reaches: stretched kernels reach farthest.
  Nodes nodes;
  nodes.cell = static_cast<float>(of.cell);
  const float margin = 1.5f * kSupport * unit;
  const auto fits = [&] {
    double all = 1;
    for (size_t a = 0; a < 3; ++a) {
      nodes.low[a] = low[a] - margin - nodes.cell;
      const double along =
          std::ceil((double{high[a]} - double{low[a]} + 2 * double{margin}) / double{nodes.cell}) + 3;
      all *= along, nodes.count[a] = static_cast<int>(std::min(along, 1e9));
    }
    return all <= static_cast<double>(of.most_nodes);
  };
  while (!fits()) nodes.cell *= 1.25f;
  std::vector<float> field(nodes.size(), 0.0f), tints(own.empty() ? 0 : nodes.size(), 0.0f);
  for (const uint32_t i : bins.order) {
    spread(x[i], stretch(x, bins, i, unit), unit, nodes, own.empty() ? 0 : own[i], field, tints);
  }
  ParticleSurface out = surface_nets(nodes, field, tints);
  smooth(out, of.smoothing);
  return out;
}

}  // namespace truestep
