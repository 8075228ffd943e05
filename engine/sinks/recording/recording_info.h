// The result of reading a recording: its description, and frames as numbers.
#pragma once
#include "engine/sinks/recording/file/layout.h"

namespace truestep {

/// Whether the run ended properly (journal and VTKHDF part present) or the file was abandoned while frames
/// arrived.
enum class RecordingCompletion { kFinalized, kUnfinished };

struct RecordingInfo {
  RecordingLayout layout;
  RecordingCompletion completion = RecordingCompletion::kUnfinished;
  uint64_t frames = 0;
  std::string journal;
};

/// One system at one frame: every field holds rows x width elements (f32 and u32 are exact as double).
struct RecordedRows {
  size_t rows = 0;
  std::vector<std::vector<double>> fields;
};

/// The parts of a frame other than its fields.
struct RecordedClock {
  int64_t step = 0;
  double time = 0;           ///< s
  std::vector<size_t> rows;  ///< per system
  std::vector<double> observables;
};

struct RecordedFrame {
  int64_t step = 0;
  double time = 0;  ///< s
  std::vector<RecordedRows> systems;
  std::vector<double> observables;
};

}  // namespace truestep
