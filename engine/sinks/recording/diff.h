// Where two recordings diverge: the first frame, system and field that differ, and by how much.
#pragma once
#include <optional>
#include <string>

#include "engine/sinks/recording/recording_reader.h"

namespace truestep {

struct RecordingDifference {
  enum class Kind { kStructure, kClock, kRows, kField, kObservable, kLength } kind = Kind::kStructure;
  uint64_t frame = 0;  ///< index in both recordings
  int64_t step = 0;    ///< of the first recording
  std::string system;  ///< empty for observables and the clock
  std::string field;   ///< or the observable's name
  size_t row = 0;      ///< first element that differs
  size_t component = 0;
  double first = 0, second = 0;  ///< its two values
  double largest = 0;            ///< largest absolute difference in that field at that frame
  std::string message;           ///< one sentence for a person
};

/// Compares frames in order; values differ when |a - b| > tolerance (NaN equals NaN). Empty when all agree.
/// Throws whatever reading throws.
std::optional<RecordingDifference> first_difference(RecordingReader& a, RecordingReader& b, double tolerance);

}  // namespace truestep
