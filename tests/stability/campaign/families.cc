// The table of families: a new one is a new row, in any place.
#include <algorithm>
#include <vector>

#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {

std::span<const Family> families() {
  static const std::vector<Family> kAll = [] {
    std::vector<Family> all{
        {"drop_2d", drop_2d},
        {"drop_3d", drop_3d},
        {"pile_2d", pile_2d},
        {"pile_3d", pile_3d},
        {"wheel_2d", wheel_2d},
        {"wheel_3d", wheel_3d},
        {"spin_3d", spin_3d},
        {"hit_2d", hit_2d},
        {"hit_3d", hit_3d},
        {"overlap_2d", overlap_2d},
        {"overlap_3d", overlap_3d},
        {"slow_2d", slow_2d},
        {"slow_3d", slow_3d},
        {"joints_2d", joints_2d},
        {"joints_3d", joints_3d},
        {"springs_2d", springs_2d},
        {"springs_3d", springs_3d},
        {"hinge_pendulum", hinge_pendulum},
        {"rod_chain", rod_chain},
        {"rope", rope},
        {"cloth", cloth},
        {"net", net},
        {"emitter", emitter},
        {"cloth_and_particles", cloth_and_particles},
        {"attached", attached},
        {"articulation", articulation},
        {"linkage", linkage},
        {"bounces", bounces},
        {"pendulum", pendulum},
        {"cloth_and_bodies", cloth_and_bodies},
        {"crowd_and_bodies", crowd_and_bodies},
        {"bodies_on_ropes", bodies_on_ropes},
        {"shield_2d", shield_2d, true},
        {"shield_3d", shield_3d, true},
        {"bar_2d", bar_2d},
        {"bar_3d", bar_3d, true},
        {"driven_shield_3d", driven_shield_3d, true},
        {"driven_bar_3d", driven_bar_3d, true},
        {"shield_points", shield_points, true},
        {"bar_points", bar_points, true},
        {"seam_3d", seam_3d, true},
        {"turntable_3d", turntable_3d, true},
        {"rolling_table_3d", rolling_table_3d},
        {"motor_disc_3d", motor_disc_3d},
        {"drum_2d", drum_2d},
        {"drum_3d", drum_3d, true},
        {"belt_2d", belt_2d},
        {"belt_3d", belt_3d, true},
        {"lift_2d", lift_2d},
        {"lift_3d", lift_3d, true},
        {"driven_lift_3d", driven_lift_3d, true},
        {"driven_table_3d", driven_table_3d, true},
        {"driven_swing_3d", driven_swing_3d, true},
        {"falls", falls},
        {"friction", friction},
        {"bouncing_bodies", bouncing_bodies},
        {"merging_bodies", merging_bodies},
        {"pulses", pulses},
        {"near_rest", near_rest},
        {"stiff_elastic", stiff_elastic},
        {"closed_materials", closed_materials},
        {"fluid_layers", fluid_layers},
    };
    for (const auto& more : {coupled_families(), drape_families()})
      all.insert(all.end(), more.begin(), more.end());
    return all;
  }();
  return kAll;
}

Trial make_trial(const Family& family, uint64_t seed) {
  Trial t{.family = family.name, .seed = seed};
  Dice dice(seed, 0);
  family.make(dice, t);
  return t;
}

Trial make_trial(std::string_view family, uint64_t seed) {
  const auto all = families();
  return make_trial(*std::ranges::find(all, family, [](const Family& f) { return std::string_view(f.name); }),
                    seed);
}

void set_integrator(Trial& trial, const std::string& name) {
  system_of(trial)["integrator"] = name;
}

void set_precision(Trial& trial, const std::string& name) {
  for (json::value& system : trial.scene["systems"].as_array()) {
    const std::string type(system.at("type").as_string());
    if (type == "rigid2d" || type == "rigid3d") system.as_object()["precision"] = name;
  }
}

}  // namespace truestep::campaign
