// What other notations allow and JSON does not, named: comments, trailing commas, NaN, single quotes ...
#pragma once
#include <string>
#include <string_view>

namespace truestep {

/// What the text at which reading JSON failed would be in a notation that people know (JavaScript, JSON5,
/// Python, YAML), and what to write instead; empty where it is none. `before` is what had been read.
std::string foreign_notation(std::string_view before, std::string_view at);

}  // namespace truestep
