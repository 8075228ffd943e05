// What a user can do about a scene that became unstable.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/session/world.h"

namespace truestep {

/// The system's own advice, or two sentences at least: a smaller step, and a method that holds at this one.
/// `stable_dt` (s) is the largest session step that is expected to hold, where that is known.
std::vector<std::string> remedies(const World& world, const std::string& system,
                                  std::optional<double> stable_dt);

}  // namespace truestep
