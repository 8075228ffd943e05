// Refusing commands: the error names the member that is wrong and what is accepted.
#pragma once
#include <cmath>
#include <string>

#include "engine/base/errors.h"
#include "engine/core/commands/command.h"

namespace truestep {

/// Error "bad_command" about one member of a command ("index", "value" ...).
[[noreturn]] void refuse_command(const std::string& member, const std::string& code, const std::string& why,
                                 const std::string& allowed = "");

inline bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Refuses numbers that are not finite, and a negative duration.
void check_command_numbers(const Command& c);

/// Refuses `at` where rows have no extent: a point, a particle.
void refuse_place(const Command& c, const std::string& noun);

/// Refuses a number where the parameter is a vector in this place, and a vector where it is a number. (What is
/// absent is 0: a 0 of the wrong form means the same.)
void check_command_form(const Command& c, bool vector);

/// The command's row; refused unless it is below `rows`. `noun` is what a row is called ("point",
/// "particle").
size_t checked_command_row(const Command& c, size_t rows, const std::string& noun);

}  // namespace truestep
