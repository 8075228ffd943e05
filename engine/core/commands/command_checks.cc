// Refusals of commands that every system shares.
#include "engine/core/commands/command_checks.h"

namespace truestep {

void refuse_command(const std::string& member, const std::string& code, const std::string& why,
                    const std::string& allowed) {
  throw Error("bad_command", why, {"/" + member, code, why, "", allowed, "", ""});
}

void check_command_numbers(const Command& c) {
  if (!finite(c.vector)) refuse_command("vector", "not_finite", "the vector must be finite");
  if (!finite(c.velocity)) refuse_command("velocity", "not_finite", "the velocity must be finite");
  if (c.at && !finite(*c.at)) refuse_command("at", "not_finite", "the point must be finite");
  if (!std::isfinite(c.value)) refuse_command("value", "not_finite", "the value must be finite");
  if (!std::isfinite(c.duration) || c.duration < 0) {
    refuse_command("duration", "out_of_range", "the duration must be at least 0");
  }
}

void refuse_place(const Command& c, const std::string& noun) {
  if (c.at) refuse_command("at", "not_a_body", "a " + noun + " has no extent to act on", "absent");
}

void check_command_form(const Command& c, bool vector) {
  if (vector && c.value != 0)
    refuse_command("value", "wrong_type", c.name + " is a vector here", "three numbers in \"vector\"");
  if (!vector && (c.vector.x != 0 || c.vector.y != 0 || c.vector.z != 0))
    refuse_command("vector", "wrong_type", c.name + " is a number here", "a number in \"value\"");
}

size_t checked_command_row(const Command& c, size_t rows, const std::string& noun) {
  if (c.index < 0 || static_cast<size_t>(c.index) >= rows) {
    refuse_command("index", "out_of_range", "there is no " + noun + " " + std::to_string(c.index),
                   rows > 0 ? "0 to " + std::to_string(rows - 1) : "no " + noun + " is there");
  }
  return static_cast<size_t>(c.index);
}

}  // namespace truestep
