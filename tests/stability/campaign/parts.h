// Building blocks shared by the scene generators.
#pragma once
#include <cstdio>
#include <string>

#include "tests/stability/campaign/campaign.h"

namespace truestep::campaign {

namespace json = boost::json;

inline json::array vec(double x, double y, double z = 0) {
  return {x, y, z};
}
inline json::array vec(const Vec3& a) {
  return {a.x, a.y, a.z};
}

/// 1/60 s mostly.
inline double usual_dt(Dice& d) {
  return d.chance(0.7) ? 1.0 / 60 : d.of({1.0 / 30, 1.0 / 120, 1.0 / 240, 0.001});
}

/// Of bodies in the plane that do not say: a trial's scene does not depend on the system's default.
inline constexpr double kFlatFriction = 0.6;

/// A scene of one or more systems; systems' ids are "a", "b" ...
inline void set_scene(Trial& t, double dt, double seconds, const Vec3& gravity, json::array systems) {
  for (size_t i = 0; i < systems.size(); ++i) {
    json::object& system = systems[i].as_object();
    system["id"] = std::string(1, static_cast<char>('a' + i));
    if (system["type"] == "rigid2d" && !system.contains("friction")) system["friction"] = kFlatFriction;
  }
  t.scene = {{"schema_version", "1.0"},       {"seed", t.seed},
             {"gravity", vec(gravity)},       {"time", json::object{{"dt", dt}, {"duration", seconds}}},
             {"systems", std::move(systems)}, {"probes", json::array{}},
             {"expect", json::array{}}};
}

/// As text in an expression, to the last bit.
inline std::string exact(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "(%.17g)", x);
  return text;
}

/// Watches a row of system "a"; quantities are then NAME.position.x and so on.
inline void probe(Trial& t, const char* name, int row, json::array fields) {
  t.scene["probes"].as_array().push_back(
      json::object{{"id", name}, {"system", "a"}, {"index", row}, {"fields", std::move(fields)}});
}

inline void expect_range(Trial& t, std::string quantity, double low, double high, const char* source) {
  t.scene["expect"].as_array().push_back(
      json::object{{"quantity", std::move(quantity)}, {"min", low}, {"max", high}, {"source", source}});
}
inline void expect_near(Trial& t, std::string quantity, double value, double tolerance, const char* source) {
  expect_range(t, std::move(quantity), value - tolerance, value + tolerance, source);
}

inline json::object& system_of(Trial& t, size_t i = 0) {
  return t.scene["systems"].as_array()[i].as_object();
}

// One function per family; what it draws is documented in its file.
void drop_2d(Dice&, Trial&);
void drop_3d(Dice&, Trial&);
void pile_2d(Dice&, Trial&);
void pile_3d(Dice&, Trial&);
void wheel_2d(Dice&, Trial&);
void wheel_3d(Dice&, Trial&);
void spin_3d(Dice&, Trial&);
void hit_2d(Dice&, Trial&);
void hit_3d(Dice&, Trial&);
void overlap_2d(Dice&, Trial&);
void overlap_3d(Dice&, Trial&);
void slow_2d(Dice&, Trial&);
void slow_3d(Dice&, Trial&);
void joints_2d(Dice&, Trial&);
void joints_3d(Dice&, Trial&);
void springs_2d(Dice&, Trial&);
void springs_3d(Dice&, Trial&);
void hinge_pendulum(Dice&, Trial&);
void rod_chain(Dice&, Trial&);
void rope(Dice&, Trial&);
void cloth(Dice&, Trial&);
void net(Dice&, Trial&);
void emitter(Dice&, Trial&);
void cloth_and_particles(Dice&, Trial&);
void attached(Dice&, Trial&);
void articulation(Dice&, Trial&);
void linkage(Dice&, Trial&);
void bounces(Dice&, Trial&);
void pendulum(Dice&, Trial&);
void cloth_and_bodies(Dice&, Trial&);
void crowd_and_bodies(Dice&, Trial&);
void bodies_on_ropes(Dice&, Trial&);
void shield_2d(Dice&, Trial&);
void shield_3d(Dice&, Trial&);
void bar_2d(Dice&, Trial&);
void bar_3d(Dice&, Trial&);
void shield_points(Dice&, Trial&);
void driven_shield_3d(Dice&, Trial&);
void driven_bar_3d(Dice&, Trial&);
void bar_points(Dice&, Trial&);
void seam_3d(Dice&, Trial&);
void turntable_3d(Dice&, Trial&);
void rolling_table_3d(Dice&, Trial&);
void motor_disc_3d(Dice&, Trial&);
void drum_2d(Dice&, Trial&);
void drum_3d(Dice&, Trial&);
void belt_2d(Dice&, Trial&);
void belt_3d(Dice&, Trial&);
void lift_2d(Dice&, Trial&);
void lift_3d(Dice&, Trial&);
void driven_lift_3d(Dice&, Trial&);
void driven_table_3d(Dice&, Trial&);
void driven_swing_3d(Dice&, Trial&);
void falls(Dice&, Trial&);
void friction(Dice&, Trial&);
void bouncing_bodies(Dice&, Trial&);
void merging_bodies(Dice&, Trial&);
void pulses(Dice&, Trial&);
void near_rest(Dice&, Trial&);
void stiff_elastic(Dice&, Trial&);
void closed_materials(Dice&, Trial&);
void fluid_layers(Dice&, Trial&);
/// Soft things with rigid bodies, a family for each kind of both.
std::span<const Family> coupled_families();
/// Soft things that fall on colliders, a family for each kind.
std::span<const Family> drape_families();

}  // namespace truestep::campaign
