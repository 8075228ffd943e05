// Positions of optical markers in the TRC format: five header lines (the third with rate, frames, markers and
// unit, the fourth with the markers' names), then one line per frame: its number, its time and x, y, z of
// every marker, separated by tabs. A hidden marker has empty fields, NaN, or three zeros as some cameras
// write them. Times that are there have to advance at the rate. Anything else is a fault with its line.
#pragma once
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "engine/math/vec3.h"

namespace truestep {

/// A text that is not valid TRC; lines count from 1.
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
  std::vector<uint8_t> seen;  ///< frames x markers: whether visible
};

/// Throws TrcFault.
MarkerTracks read_trc(std::span<const std::string> lines);

}  // namespace truestep
