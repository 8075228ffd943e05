#include "tests/unit/pictures/picture_lists.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace truestep::test {
namespace {

void push(std::vector<float>& positions, double x, double y, double z) {
  for (double c : {x, y, z}) positions.push_back(static_cast<float>(c));
}

// In [0, 1); the standard's distributions differ between libraries, its generators do not.
struct Uniform {
  std::mt19937 generator{7};
  double operator()() { return generator() / 4294967296.0; }
};

}  // namespace

DrawList draped_cloth(int side) {
  DrawList list;
  DrawPoints cloth;
  const double radius = 0.5, drop = 0.62;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double x = 2.2 * i / (side - 1) - 1.1, z = 2.2 * j / (side - 1) - 1.1;
      const double r = std::hypot(x, z), angle = std::atan2(z, x);
      // On the ball up to 50 degrees, then hanging in folds that deepen towards the hem.
      const double arc = std::min(r, radius * 0.9), over = std::max(0.0, r - radius * 0.9);
      const double fold = 0.16 * std::min(over * 1.6, 1.0) * std::cos(7 * angle + 0.6 * std::sin(2 * angle));
      const double out = radius * std::sin(arc / radius) + 0.62 * over * (1 - 0.35 * over) + fold;
      const double y = 0.5 + radius * std::cos(arc / radius) - over * drop * (1 + 0.25 * over);
      push(cloth.positions, out * std::cos(angle), std::max(y, 0.02), out * std::sin(angle));
    }
  for (uint32_t i = 0; i + 1 < static_cast<uint32_t>(side); ++i)
    for (uint32_t j = 0; j + 1 < static_cast<uint32_t>(side); ++j) {
      const uint32_t n = static_cast<uint32_t>(side), a = i * n + j;
      cloth.triangles.insert(cloth.triangles.end(), {a, a + n, a + 1, a + 1, a + n, a + n + 1});
    }
  list.points.push_back(std::move(cloth));
  list.shapes.push_back({DrawShape::Kind::sphere, {0, 0.5, 0}, {1, 0, 0, 0}, {0.45, 0, 0}, false, {}});
  list.ground_height = 0;
  list.caption = "Cloth over a ball   t = 1.250 s";
  return list;
}

DrawList fountain(int count) {
  DrawList list;
  DrawPoints drops;
  Uniform u;
  drops.radius = static_cast<float>(0.025 * std::cbrt(5000.0 / count));
  drops.color_map = ColorMap::water;
  drops.scalar_label = "speed m/s";
  for (int i = 0; i < count; ++i) {
    const double t = 1.25 * u(), angle = 6.283185307179586 * u(), spread = 0.9 * std::sqrt(u());
    const double up = 5.6 + 0.5 * u();
    double y = up * t - 4.905 * t * t, out = spread * t, vy = up - 9.81 * t;
    if (y < 0) y = 0.02 * u(), vy *= -0.2, out *= 1.0 + 0.4 * u();
    push(drops.positions, out * std::cos(angle), y + drops.radius, out * std::sin(angle));
    drops.scalar.push_back(static_cast<float>(std::hypot(vy, spread)));
  }
  list.points.push_back(std::move(drops));
  list.ground_height = 0;
  list.caption = "Fountain   t = 4.000 s";
  return list;
}

DrawList spring_net(int side) {
  DrawList list;
  DrawPoints net;
  const auto n = static_cast<uint32_t>(side);
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const double s = static_cast<double>(i) / (side - 1), t = static_cast<double>(j) / (side - 1);
      const double sag = 0.55 * (4 * s * (1 - s)) * (0.35 + 0.65 * t);
      push(net.positions, 2 * s - 1, 1.5 - 0.9 * t - 0.3 * sag,
           0.7 * t - sag + 0.05 * std::sin(9 * s + 4 * t));
    }
  net.radius = 0.016f;
  net.line_radius = 0.004f;
  net.color = Color{0.85f, 0.45f, 0.20f};
  net.line_color = Color{0.18f, 0.36f, 0.62f};
  const auto connect = [&](uint32_t a, uint32_t b, LineKind kind) {
    net.lines.insert(net.lines.end(), {a, b});
    net.line_kinds.push_back(static_cast<uint8_t>(kind));
  };
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      const uint32_t a = i * n + j;
      if (i + 1 < n) connect(a, a + n, LineKind::structural);
      if (j + 1 < n) connect(a, a + 1, LineKind::structural);
      if (i + 1 < n && j + 1 < n)
        connect(a, a + n + 1, LineKind::shear), connect(a + 1, a + n, LineKind::shear);
    }
  list.points.push_back(std::move(net));
  for (double x : {-1.05, 1.05})
    list.shapes.push_back({DrawShape::Kind::capsule, {x, 0.8, 0}, {1, 0, 0, 0}, {0.04, 0.78, 0}, false, {}});
  list.ground_height = 0;
  list.caption = "Spring net   t = 0.500 s";
  return list;
}

DrawList balls_in_box(int count) {
  DrawList list;
  Uniform u;
  for (int kind = 0; kind < 3; ++kind) {
    DrawPoints balls;
    for (int i = kind; i < count; i += 3) {
      const double r = 0.05 + 0.03 * kind;
      // Piled up towards one corner.
      const double x = (1 - r) * (2 * u() - 1), z = (1 - r) * (2 * u() - 1);
      const double depth = 0.25 + 0.2 * (x + 1) * (z + 1) / 2;
      push(balls.positions, x, r + depth * u(), z);
      balls.radii.push_back(static_cast<float>(r));
    }
    list.points.push_back(std::move(balls));
  }
  list.shapes.push_back({DrawShape::Kind::box, {0, 0.75, 0}, {1, 0, 0, 0}, {1, 0.75, 1}, true, {}});
  list.shapes.push_back(
      {DrawShape::Kind::box, {0.3, 0.95, 0.1}, {0.924, 0, 0.2, 0.33}, {0.3, 0.06, 0.4}, false, {}});
  list.shapes.push_back(
      {DrawShape::Kind::sphere, {-0.45, 0.95, -0.3}, {1, 0, 0, 0}, {0.22, 0, 0}, false, {}});
  list.ground_height = 0;
  list.caption = "Balls in a box   t = 2.000 s";
  return list;
}

}  // namespace truestep::test
