// "Did you mean": the nearest of the valid names.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace truestep {

/// The one of `names` that other programs call so (names_for); otherwise the nearest of `names` by edit
/// distance (a letter inserted, deleted or changed, or two neighbours swapped), with at most a third of the
/// longer name's length in edits and at least one allowed; otherwise the shortest name that begins or ends
/// with the given letters, if there are at least three. Empty when none is near.
std::string nearest_name(std::string_view name, std::span<const std::string> names);

}  // namespace truestep
