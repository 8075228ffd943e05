// The table of letters' outlines that make_outlines.py writes; see font_outlines.cc for its form.
#pragma once
#include <cstdint>
#include <span>

namespace truestep::picture {

constexpr double kOutlineUnits = 1024;     ///< per em
constexpr double kOutlineCapital = 746.5;  ///< height of a capital letter

struct Outline {
  uint16_t code;      ///< Unicode
  uint16_t advance;   ///< from this letter to the next
  uint32_t first;     ///< of its contours among the numbers
  uint16_t contours;  ///< how many
};

/// Sorted by their codes.
std::span<const Outline> outlines();
std::span<const int16_t> outline_numbers();

}  // namespace truestep::picture
