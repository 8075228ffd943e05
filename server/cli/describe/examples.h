// The smallest scene of every kind of system and coupling that shows what it does: `truestep systems TYPE
// --example`.
#pragma once
#include <string_view>

namespace truestep {

/// A scene as JSON text; empty for a type that is none.
std::string_view example_of(std::string_view type);

}  // namespace truestep
