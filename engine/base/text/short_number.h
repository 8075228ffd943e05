// Numbers for use in sentences.
#pragma once
#include <charconv>
#include <string>

namespace truestep {

/// Significant digits, whatever the magnitude: 0.0166667, 3.2e-17.
inline std::string short_number(double v, int digits = 6) {
  char buffer[48];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, v, std::chars_format::general, digits).ptr};
}

}  // namespace truestep
