#include "engine/systems/sph/setting.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/base/text/short_number.h"
#include "engine/kernels/sph/cohesion.h"
#include "engine/math/trig.h"
#include "engine/systems/sph/speeds.h"

namespace truestep::sph {

namespace {

/// Sums over a lattice of unit volume about one of its points: of the kernel, and of the derivative that its
/// slopes give for a field with slope 1 along an axis. Both are nearly 1.
struct LatticeSums {
  double values, slopes;
};
LatticeSums lattice_sums(Smoothing kind, int dimension, double support) {
  const int reach = static_cast<int>(support) + 1;
  double values = 0, slopes = 0;
  for (int z = dimension == 3 ? -reach : 0; z <= (dimension == 3 ? reach : 0); ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const double r = std::sqrt(static_cast<double>(x * x + y * y + z * z));
        const SmoothingValue<double> v = smoothing_at(kind, r / support);
        values += v.w[0], slopes -= v.s[0] * (r / support) * (r / support) / dimension;
      }
    }
  }
  const double power = dimension == 3 ? support * support * support : support * support;
  return {values * smoothing_sigma(kind, dimension) / power, slopes * slope_sigma(kind, dimension) / power};
}

/// Largest eigenvalue of the pressure equation over its diagonal on a lattice: its symbol is the square of
/// the gradient's, sum of g sin(k x), over wave vectors along the axes and diagonals.
double largest_symbol(Smoothing kind, int dimension, double support) {
  constexpr double kPi = 3.14159265358979323846;
  constexpr int kWaves = 64;
  const int reach = static_cast<int>(support) + 1, reach_z = dimension == 3 ? reach : 0;
  double most = 0;
  for (int direction = 1; direction <= dimension; ++direction) {
    for (int m = 1; m < kWaves; ++m) {
      const double k = kPi * m / kWaves;
      double squares = 0, total[3] = {};
      for (int z = -reach_z; z <= reach_z; ++z) {
        for (int y = -reach; y <= reach; ++y) {
          for (int x = -reach; x <= reach; ++x) {
            const double r2 = static_cast<double>(x * x + y * y + z * z);
            const double s = smoothing_at(kind, std::sqrt(r2) / support).s[0];
            const double phase = k * (x + (direction > 1 ? y : 0) + (direction > 2 ? z : 0));
            const double wave = trig::sin(phase);
            squares += s * s * r2;
            total[0] += s * x * wave, total[1] += s * y * wave, total[2] += s * z * wave;
          }
        }
      }
      const double symbol = total[0] * total[0] + total[1] * total[1] + total[2] * total[2];
      most = std::max(most, symbol / squares);
    }
  }
  return most;
}

[[noreturn]] void refuse_initial(const Vec3& x) {
  const std::string message = "is not finite at the particle at (" + short_number(x.x, 4) + ", " +
                              short_number(x.y, 4) + ", " + short_number(x.z, 4) + ") m";
  throw Error("scene_invalid", "/initial " + message, {"/initial", "out_of_range", message, "", "", "", ""});
}

}  // namespace

double Setting::sound_for(const Vec3& gravity) const {
  // Compression is the same function of pressure whatever the density, and pressure grows with density.
  double heaviest = 1;
  for (const BodyDef& b : def.bodies)
    heaviest = std::max(heaviest, b.density.value_or(def.density) / def.density);
  for (const InletDef& e : def.emitters) {
    heaviest = std::max(heaviest, e.density.value_or(def.density) / def.density);
  }
  return 10 * expected_speed(def, colliders, meshes, gravity, fastest_initial) * std::sqrt(heaviest);
}

Vec3 Setting::initial_at(const Vec3& place) const {
  if (initial.empty()) return {};
  double out[3] = {};
  initial.run(0, &place.x, &place.y, &place.z, 1, out, 1);
  return {out[0], out[1], out[2]};
}

std::vector<Vec3> wet_places(const Setting& set, const BodyDef& body) {
  std::vector<Vec3> out = places_of(set.def, body);
  leave_dry(set.def, set.meshes, out);
  return out;
}

std::unique_ptr<const Setting> settle(const SphDef& given, const std::string& id, const Vec3& gravity) {
  const SphDef def = given.with_common_density();
  auto out =
      std::make_unique<Setting>(Setting{.def = def, .id = id, .interface = {}, .wall = {}, .colliders = {}});
  out->meshes = build_mesh_walls(def);
  out->initial = PlaceTexts(def.initial, def.dimension, "/initial");
  for (const BodyDef& b : def.bodies) {
    const std::vector<Vec3> places = wet_places(*out, b);
    out->rows += places.size();
    for (const Vec3& x : places) {
      const double speed = norm(out->initial_at(x));
      if (!std::isfinite(speed)) refuse_initial(x);
      out->fastest_initial = std::max(out->fastest_initial, speed);
    }
  }
  const double s = def.spacing, h = def.support * s;
  out->volume = def.dimension == 2 ? s * s : s * s * s;
  out->mass = out->volume * def.density;
  out->support = h;
  const LatticeSums whole = lattice_sums(def.kernel, def.dimension, def.support);
  const double share = out->volume / (def.dimension == 2 ? h * h : h * h * h);
  out->kernel_w = smoothing_sigma(def.kernel, def.dimension) * share / whole.values;
  out->kernel_s = out->kernel_w / (h * h);
  if (!slopes_of_values(def.kernel)) {
    out->kernel_s = slope_sigma(def.kernel, def.dimension) * share / whole.slopes / (h * h);
  }
  out->relaxation = 0.75 / largest_symbol(def.kernel, def.dimension, def.support);
  out->wall.set(def.kernel, def.dimension, h, s);
  if (def.surface_tension > 0) {
    if (def.surface_tension_model == Tension::cohesion) {
      out->cohesion = cohesion_strength(def.surface_tension, def.density, def.dimension, s, h);
    } else {
      out->interface.emplace(def.dimension, s, h);
      out->cohesion = def.surface_tension / (out->interface->energy * h * out->mass);
    }
  }
  out->colliders = build_colliders_but_solids(def.colliders);
  for (const Collider& c : out->colliders.colliders()) out->images.push_back(images_of(def, c));
  const Vec3 size = def.high - def.low;
  const double room = size.x * size.y * (def.dimension == 2 ? 1 : size.z);
  out->closed = def.without_sides() && !def.changes() && def.colliders.empty() &&
                static_cast<double>(out->rows) * out->volume >= (1 - 1e-6) * room;
  out->shifting = def.shifting.value_or(out->closed ? 2 : 0);
  out->sound = def.sound_speed > 0 ? def.sound_speed : std::max(out->sound_for(gravity), 1e-6);
  for (const BodyDef& b : def.bodies) {
    out->lightest = std::min(out->lightest, b.density.value_or(def.density) / def.density);
  }
  for (const InletDef& e : def.emitters) {
    out->inlets.emplace_back(def, e);
    out->lightest = std::min(out->lightest, out->inlets.back().ratio);
  }
  out->capacity = def.changes() ? largest_count(def, out->rows) : out->rows;
  State::Column next = columns::report + 1;
  if (def.layered()) out->ratio = next++;
  if (def.changes()) out->layers = next++, out->counts = next++;
  return out;
}

}  // namespace truestep::sph
