// Ropes and hair: chains of structural springs, skip-one springs against bending.
#include <algorithm>
#include <cmath>

#include "engine/systems/mass_spring/network.h"

namespace truestep::mass_spring {

namespace {

void add_chain(size_t first, size_t points, const MassSpringDef& def, double link, Network& out) {
  const double rest = def.rest_scale * link, skip_rest = def.rest_scale * 2 * link;
  for (size_t i = first; i + 1 < first + points; ++i) {
    out.springs.push_back(
        {static_cast<uint32_t>(i), static_cast<uint32_t>(i + 1), SpringFamily::structural, rest, 1});
  }
  for (size_t i = first; def.bending_rigidity > 0 && i + 2 < first + points; ++i) {
    const auto k = static_cast<uint32_t>(i);
    out.bends.push_back({{k, k + 1, k + 2}, def.bending_rigidity / link});
  }
  if (!(def.bending_stiffness > 0)) return;
  for (size_t i = first; i + 2 < first + points; ++i) {
    out.springs.push_back(
        {static_cast<uint32_t>(i), static_cast<uint32_t>(i + 2), SpringFamily::bending, skip_rest, 1});
  }
}

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

void build_rope(const RopeShape& shape, const MassSpringDef& def, const Vec3& down, Network& out) {
  const auto links = static_cast<size_t>(shape.links);
  const Vec3 chord = shape.to - shape.from;
  const double distance = norm(chord), length = shape.length.value_or(distance);
  const double link = length / shape.links;

  // A slack rope begins as a parabola of its length, which is close to the catenary it will become. The sag
  // lies across the chord, downwards where there is a choice.
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
  out.x.push_back(shape.from);
  double walked = 0, next = step;
  Vec3 last = shape.from;
  for (int i = 1; i <= fine && out.x.size() < links; ++i) {
    const Vec3 p = on_parabola(shape.from, shape.to, side, sag, static_cast<double>(i) / fine);
    const double piece = norm(p - last);
    while (out.x.size() < links && walked + piece >= next && piece > 0) {
      out.x.push_back(last + ((next - walked) / piece) * (p - last));
      next += step;
    }
    walked += piece;
    last = p;
  }
  while (out.x.size() <= links) out.x.push_back(shape.to);

  out.share.assign(links + 1, link);
  out.share.front() = out.share.back() = 0.5 * link;
  add_chain(0, links + 1, def, link, out);
}

void build_hair(const HairShape& shape, const MassSpringDef& def, Network& out) {
  const auto points = static_cast<size_t>(shape.links) + 1;
  const Vec3 direction = normalized(shape.direction);
  const Vec3 other = std::abs(direction.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(direction, other)), w = cross(direction, u);
  const double link = shape.length / shape.links;

  // Sunflower: root s is turned by s golden angles (cosine and sine of 2.39996... rad) at radius sqrt(s).
  constexpr double kCos = -0.73736887807831963, kSin = 0.67549029426152396;
  double c = 1, s = 0;
  for (int strand = 0; strand < shape.strands; ++strand) {
    const double r = shape.radius * std::sqrt((strand + 0.5) / shape.strands);
    const Vec3 root = shape.root + (r * c) * u + (r * s) * w;
    const size_t first = out.x.size();
    for (size_t i = 0; i < points; ++i) {
      out.x.push_back(root + (link * static_cast<double>(i)) * direction);
      out.share.push_back(i + 1 == points ? 0.5 * link : link);
    }
    // Two held points give the root its direction.
    out.pins.push_back(static_cast<uint32_t>(first));
    out.pins.push_back(static_cast<uint32_t>(first + 1));
    add_chain(first, points, def, link, out);
    const double turned = c * kCos - s * kSin;
    s = s * kCos + c * kSin, c = turned;
  }
}

}  // namespace truestep::mass_spring
