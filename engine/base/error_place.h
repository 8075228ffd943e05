// What is wrong with an element of a list, as a fault of the document that holds the list.
#pragma once
#include <string>

#include "engine/base/errors.h"

namespace truestep {

/// The same error, its pointers below this one: "/index" becomes "/commands/3/index".
Error placed_below(const Error& error, const std::string& pointer);

}  // namespace truestep
