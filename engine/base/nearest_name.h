// "Did you mean": the nearest of the names that would have been right.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace truestep {

/// Nearest of `names` in edit distance, empty when none is near.
std::string nearest_name(std::string_view name, std::span<const std::string> names);

}  // namespace truestep
