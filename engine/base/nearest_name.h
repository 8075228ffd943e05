// "Did you mean": the nearest of the names that would have been right.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace truestep {

/// Nearest of `names` in edits (a letter more, less, changed, or two neighbours swapped), at most a third of
/// the longer name's length and at least one; else the shortest name that begins or ends with at least three
/// letters given. Empty when none is near.
std::string nearest_name(std::string_view name, std::span<const std::string> names);

}  // namespace truestep
