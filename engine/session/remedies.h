// What a user can do about a scene that became unstable: every remedy named has been tried on the state that
// failed.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/session/world/world.h"

namespace truestep {

struct Remedies {
  std::vector<std::string> sentences;  ///< at least one
  std::optional<double> dt;            ///< s, largest session step that was tried and stable
};

/// Largest number of steps of a trial before and after the failed one.
inline constexpr uint64_t kTrialBefore = 128, kTrialAfter = 64;
/// How far before a failure trials may begin so that together they cost seconds, whatever the scene.
uint64_t trial_steps_before(const World& world);

/// Applies the commands given before the step that follows a state.
using Commands = std::function<void(const World&, WorldState&)>;

/// Tries smaller steps and other methods from `before`, a state of `world` some steps before step `failed`
/// failed, through that step and at most kTrialAfter more. `hint` (s): a session step that theory expects to
/// be stable.
Remedies try_remedies(const World& world, const WorldState& before, uint64_t failed,
                      const std::string& system, std::optional<double> hint, const Commands& commands,
                      const ThreadArena& arena);

}  // namespace truestep
