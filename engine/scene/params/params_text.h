// Parameters, their limits and their kinds in words, for faults and descriptions alike.
#pragma once
#include <span>
#include <string>

#include "engine/core/def/def.h"

namespace truestep {

/// "a, b, c".
std::string join_names(std::span<const std::string> names);

/// "[0, 1)", "> 0" or "any finite number".
std::string limits_text(const Limits& limits);

/// What a row accepts: "a number > 0", its choices, "an array of [x, y, z]" ...
std::string kind_text(const ParamRow& row);

}  // namespace truestep
