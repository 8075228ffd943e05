// Places of optical markers in the TRC format: five lines of heading (the third with rate, frames, markers
// and unit, the fourth with the markers' names), then a line a frame: its number, its time and x, y, z of
// every marker, between tabs. A marker out of sight has empty fields, or three zeros as some cameras write
// it. What is not TRC is a fault with its line.
#pragma once
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// Where a text is no TRC; lines count from 1.
class TrcFault : public std::runtime_error {
 public:
  TrcFault(size_t at_line, const std::string& message)
      : std::runtime_error("line " + std::to_string(at_line) + ": " + message), line(at_line) {}
  size_t line;
};

struct MarkerTracks {
  std::vector<std::string> names;
  double rate = 60;  ///< 1/s
  size_t frames = 0;
  std::vector<Vec3> places;   ///< frames x markers, m
  std::vector<uint8_t> seen;  ///< the same
};

/// Throws TrcFault.
MarkerTracks read_trc(std::span<const std::string> lines);

}  // namespace truestep
