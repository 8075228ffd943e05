// The table of methods: its families (rows.h) one after the other.
#pragma once
#include <span>
#include <string_view>

#include "engine/core/def/build.h"
#include "engine/core/equations/integrator.h"

namespace truestep {

/// All methods, in the order shown to users.
std::span<const Integrator> integrators();
/// The row with that name, or null.
const Integrator* find_integrator(std::string_view name);
/// The method with that name for this field. Error "scene_invalid" with pointer "/integrator", listing the
/// suitable methods, when it is unknown or cannot handle the field.
const Integrator& choose_integrator(const IntegratorChoice& choice, std::string_view fallback,
                                    const ForceField& field);

}  // namespace truestep
