// Rows of tables of outputs that systems led by controls share.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "engine/animation/driver.h"
#include "engine/core/outputs/outputs_of.h"

namespace truestep::animation {

struct Named {
  double value;
};
struct Place {
  Vec3 x;  ///< m
};

inline std::vector<Named> named(const std::vector<double>& values) {
  std::vector<Named> out;
  for (const double value : values) out.push_back({value});
  return out;
}
/// The family of a system's controls, and their values; `set`: the column of set values.
template <class S>
auto control_names(Driver S::*driver) {
  return [driver](const S& system) { return (system.*driver).control_names(); };
}
template <class S>
auto control_values(Driver S::*driver, State::Column set) {
  return [driver, set](const S& system, const State& s, double t) {
    return named((system.*driver).control_values(t, s.f64(set)));
  };
}
inline constexpr auto kControlRows =
    std::to_array<Measured<Named>>({{"control.<name>", "1", &Named::value, "value of a control"}});

}  // namespace truestep::animation
