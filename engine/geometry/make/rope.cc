#include "engine/geometry/make/rope.h"

#include <algorithm>
#include <cmath>

namespace truestep {

namespace {

// Parabola from a to b with the given sag along `side`, at parameter u.
Vec3 on_parabola(const Vec3& a, const Vec3& b, const Vec3& side, double sag, double u) {
  return a + u * (b - a) + (4 * sag * u * (1 - u)) * side;
}

double parabola_length(const Vec3& a, const Vec3& b, const Vec3& side, double sag, int pieces) {
  double length = 0;
  Vec3 last = a;
  for (int i = 1; i <= pieces; ++i) {
    const Vec3 p = on_parabola(a, b, side, sag, static_cast<double>(i) / pieces);
    length += norm(p - last);
    last = p;
  }
  return length;
}

}  // namespace

double rope_link(const RopeShape& shape) {
  return shape.length.value_or(norm(shape.to - shape.from)) / shape.links;
}

std::vector<Vec3> rope_points(const RopeShape& shape, const Vec3& down) {
  const auto links = static_cast<size_t>(shape.links);
  const Vec3 chord = shape.to - shape.from;
  const double distance = norm(chord), length = shape.length.value_or(distance);

  Vec3 side = distance > 0 ? down - chord * (dot(down, chord) / norm2(chord)) : down;
  if (norm(side) < 1e-6 * norm(down)) {
    const Vec3 other = std::abs(chord.x) < std::abs(chord.y) ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    side = cross(chord, other);
  }
  side = normalized(side, {0, -1, 0});
  double sag = 0;
  if (length > distance) {
    double low = 0, high = length;
    for (int i = 0; i < 60; ++i) {
      sag = 0.5 * (low + high);
      (parabola_length(shape.from, shape.to, side, sag, 1000) > length ? high : low) = sag;
    }
  }

  // Points at equal distances along the curve, by walking a fine polyline.
  const int fine = std::max(1000, 20 * shape.links);
  const double step = parabola_length(shape.from, shape.to, side, sag, fine) / shape.links;
  std::vector<Vec3> x{shape.from};
  double walked = 0, next = step;
  Vec3 last = shape.from;
  for (int i = 1; i <= fine && x.size() < links; ++i) {
    const Vec3 p = on_parabola(shape.from, shape.to, side, sag, static_cast<double>(i) / fine);
    const double piece = norm(p - last);
    while (x.size() < links && walked + piece >= next && piece > 0) {
      x.push_back(last + ((next - walked) / piece) * (p - last));
      next += step;
    }
    walked += piece;
    last = p;
  }
  while (x.size() <= links) x.push_back(shape.to);
  return x;
}

}  // namespace truestep
