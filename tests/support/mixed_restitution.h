// Seeded scenes of bodies with individual restitutions, and the energy that they gain from nothing.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>

#include "engine/base/random.h"
#include "engine/session/world/world.h"

namespace truestep::testing {

enum class Space : uint8_t { plane, space };

struct MixedScene {
  Space space = Space::plane;
  std::string precision;  ///< empty: the default
  uint64_t seed = 0;
};

/// The energy of a run compared with the start: J above the state of everything lying on the floor, and the
/// largest gain as a fraction of that.
struct MixedEnergy {
  double start = 0, most = 0;
};

/// The system's JSON: a floor and up to seven bodies above it, restitution 0, 0.2 .. 1 each, sizes 5 to 50
/// cm, densities 30 to 10,000 kg/m^3.
inline std::string mixed_scene(const MixedScene& m) {
  const bool flat = m.space == Space::plane;
  uint64_t draw = 0;
  const auto u = [&] { return uniform4(m.seed, flat ? 2 : 3, draw++)[0]; };
  const auto number = [](double x) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", x);
    return std::string(text);
  };
  const auto triple = [&](double x, double y, double z) {
    return "[" + number(x) + ", " + number(y) + ", " + number(z) + "]";
  };
  const auto restitution = [&] { return number(0.2 * std::floor(6 * u())); };
  const auto friction = [&] { return number(u() < 0.3 ? 0 : u()); };
  const auto body = [&](const std::string& shape, const std::string& size, const std::string& at,
                        const std::string& more) {
    const std::string density = "\"density\": " + number(std::pow(10, 1.5 + 2.5 * u()));
    const std::string own = "\"position\": " + at + ", \"restitution\": " + restitution() +
                            ", \"friction\": " + friction() + more;
    if (flat) {
      return "{" + own + ", \"shapes\": [{\"type\": \"" + (shape == "ball" ? "circle" : "box") + "\", " +
             size + "}], " + density + "}";
    }
    return "{\"type\": \"" + std::string(shape == "ball" ? "sphere" : "box") + "\", " + own + ", " + size +
           ", " + density + "}";
  };
  std::string bodies = body("box", "\"half_extents\": [20, 1, 20]", "[0, -1, 0]", R"(, "motion": "fixed")");
  const auto width = [&] { return 0.05 * std::pow(10, u()); };
  const auto add_ball = [&](double r, double x, double y, double speed) {
    bodies += ", " + body("ball", "\"radius\": " + number(r), triple(x, y, 0),
                          ", \"velocity\": " + triple(0, -speed, 0));
  };
  const auto add_box = [&](double a, double b, double x, double y) {
    bodies += ", " + body("box", "\"half_extents\": " + triple(a, b, flat ? 0 : a * (0.5 + u())),
                          triple(x, y, 0), "");
  };
  switch (m.seed % 4) {
    case 0: {  // a ball falls on a block at rest
      const double a = width(), b = width(), r = width();
      add_box(a, b, 0, b);
      add_ball(r, (u() - 0.5) * a, 2 * b + r + 0.7, 0);
      break;
    }
    case 1: {  // a ball falls on a small tower
      double top = 0, a = 0;
      for (int k = 0; k < 3; ++k) {
        const double b = width();
        a = std::max(0.15, width());
        add_box(a, b, 0, top + b);
        top += 2 * b;
      }
      const double r = width();
      add_ball(r, (u() - 0.5) * a, top + r + 0.2 + u(), 0);
      break;
    }
    case 2: {  // a shower of balls and boxes
      double top = 0;
      for (int k = 0; k < 7; ++k) {
        const double a = width(), b = k % 2 ? a : width();
        top += b + 0.3 * u();
        if (k % 2) {
          add_ball(a, 0.2 * (u() - 0.5), top, 2 * u());
        } else {
          add_box(a, b, 0.2 * (u() - 0.5), top);
        }
        top += b;
      }
      break;
    }
    default: {  // a plank with bodies on it, hit at one end
      const double a = 0.3 + 0.5 * u(), b = 0.02 + 0.05 * u(), support = 0.05 + 0.1 * u();
      add_ball(support, 0, support, 0);
      add_box(a, b, 0, 2 * support + b);
      const double left = width(), right = width(), top = 2 * support + 2 * b;
      add_ball(left, -0.8 * a, top + left, 0);
      add_ball(right, 0.8 * a, top + right + 0.5 + u(), 2 * u());
      break;
    }
  }
  return std::string("\"type\": \"") + (flat ? "rigid2d" : "rigid3d") + "\", \"id\": \"r\", " +
         (m.precision.empty() ? "" : "\"precision\": \"" + m.precision + "\", ") + "\"bodies\": [" + bodies +
         "]";
}

/// Runs a system's JSON for `seconds` at 60 Hz.
inline MixedEnergy run_mixed(const std::string& system, double seconds) {
  World world(parse_scene(R"({"time": {"dt": 0.016666666666666666}, "systems": [{)" + system + "}]}"));
  WorldState state = world.initial_state();
  Workspace workspace;
  ThreadArena arena{1};
  const auto energy = [&] { return world.observe(state).find("r.energy.total").value_or(NAN); };
  MixedEnergy e;
  e.start = energy();
  const int steps = static_cast<int>(seconds * 60 + 0.5);
  for (int k = 0; k < steps; ++k) {
    world.step(state, workspace, arena, {});
    e.most = std::max(e.most, energy() / e.start - 1);
  }
  return e;
}

}  // namespace truestep::testing
