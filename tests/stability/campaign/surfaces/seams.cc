// Floors of several flush pieces: meshes, height fields, boxes and compounds that meet along lines. What
// slides across without friction keeps its speed, its height and its orientation.
#include <algorithm>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

/// One piece of floor with its top at y = 0 over [x0, x1] x [z0, z1].
json::object piece(Dice& d, const std::string& kind, double x0, double x1, double z0, double z1) {
  const double x = 0.5 * (x0 + x1), z = 0.5 * (z0 + z1), hx = 0.5 * (x1 - x0), hz = 0.5 * (z1 - z0);
  if (kind == "box") {
    return {{"type", "box"}, {"position", vec(x, -0.5, z)}, {"half_extents", vec(hx, 0.5, hz)}};
  }
  if (kind == "compound") {
    const auto half = [&](double at) {
      return json::object{
          {"type", "box"}, {"position", vec(at, 0, 0)}, {"half_extents", vec(0.5 * hx, 0.5, hz)}};
    };
    return {{"type", "compound"},
            {"position", vec(x, -0.5, z)},
            {"parts", json::array{half(-0.5 * hx), half(0.5 * hx)}}};
  }
  if (kind == "height_field") {
    // Square cells: as many as fit.
    const double spacing = std::min(2 * hx, 2 * hz) / (hx == hz ? d.whole(1, 3) : 1);
    const int nx = static_cast<int>(std::lround(2 * hx / spacing)) + 1,
              nz = static_cast<int>(std::lround(2 * hz / spacing)) + 1;
    return {{"type", "height_field"},
            {"position", vec(x, 0, z)},
            {"count", json::array{nx, nz}},
            {"spacing", spacing},
            {"heights", json::array(static_cast<size_t>(nx * nz), 0.0)}};
  }
  json::array vertices, triangles;
  const int n = d.whole(1, 3);
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k <= n; ++k) vertices.push_back(vec(x0 + (x1 - x0) * i / n, 0, z0 + (z1 - z0) * k / n));
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const int a = i * (n + 1) + k, b = a + n + 1;
      for (const int v : {a, a + 1, b, b, a + 1, b + 1}) triangles.push_back(v);
    }
  }
  return {{"type", "mesh"}, {"vertices", vertices}, {"triangles", triangles}};
}

}  // namespace

void seam_3d(Dice& d, Trial& t) {
  const double size = d.between(0.1, 0.5), speed = d.spread(1, 10), dt = usual_dt(d),
               way = d.between(-0.6, 0.6);
  const double start = -d.between(1.5, 3);
  const std::string kind = d.of({"sphere", "box", "cylinder", "capsule", "hull"});
  json::object body{{"type", kind}, {"velocity", vec(speed * std::cos(way), 0, speed * std::sin(way))}};
  double height = size;
  if (kind == "box") {
    height = size * d.between(0.3, 1);
    body["half_extents"] = vec(size, height, size * d.between(0.5, 1));
    body["axis"] = vec(0, 1, 0), body["angle"] = d.between(0, 3);
  } else if (kind == "hull") {
    json::array points;
    for (const double y : {-size, size}) {
      for (int k = 0; k < 6; ++k)
        points.push_back(vec(size * std::cos(k * 1.0472), y, size * std::sin(k * 1.0472)));
    }
    body["points"] = points;
  } else {
    body["radius"] = size;
    if (kind != "sphere") body["half_length"] = size * d.between(0.5, 1.5);
    if (kind == "capsule" || d.chance(0.5)) {
      body["axis"] = vec(1, 0, 0), body["angle"] = std::numbers::pi / 2;
    } else if (kind == "cylinder") {
      height = body["half_length"].as_double();
    }
  }
  body["position"] = vec(start, height, d.between(-0.5, 0.5));
  json::array bodies;
  const auto add = [&](double x0, double x1, double z0, double z1) {
    json::object p = piece(d, d.of({"mesh", "mesh", "height_field", "box", "compound"}), x0, x1, z0, z1);
    p["motion"] = "fixed";
    bodies.push_back(p);
  };
  add(-8, 0, -8, 8);
  if (d.chance(0.3)) {
    add(0, 8, -8, 0), add(0, 8, 0, 8);
  } else {
    const double next = d.chance(0.5) ? 0.5 : 8;
    add(0, next, -8, 8), add(next, 16, -8, 8);
  }
  bodies.push_back(body);
  const double seconds = std::min(6.0 / speed, 3.0);
  set_scene(t, dt, seconds, {0, -9.81, 0}, {{{"type", "rigid3d"}, {"friction", 0}, {"bodies", bodies}}});
  if (d.chance(0.2)) system_of(t)["precision"] = "f64";
  probe(t, "slides", static_cast<int>(bodies.size()) - 1, {"position", "velocity", "angular_velocity"});
  expect_near(t, "slides.velocity.x", speed * std::cos(way), 1e-3 * speed, "nothing slows it");
  expect_near(t, "slides.velocity.z", speed * std::sin(way), 1e-3 * speed, "nothing turns it aside");
  expect_range(t, "max(slides.position.y)", 0, height + 1e-3 * size, "nor throws it up");
  expect_range(t, "min(slides.position.y)", height - 5e-3 * size, 1e9, "nor lets it in");
  expect_range(t,
               "largest(slides.angular_velocity.x) + largest(slides.angular_velocity.y) + "
               "largest(slides.angular_velocity.z)",
               0, 0.01 * speed / size, "nor turns it");
}

}  // namespace truestep::campaign
