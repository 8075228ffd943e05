// Reads a recording, for a single thread: finished files, files still being extended by a writer (SWMR) and
// files whose writer died. Frames are read chunk by chunk and each chunk's Fletcher-32 is checked here.
#pragma once
#include <string>
#include <vector>

#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/recording_info.h"

namespace truestep {

/// Whether somebody may be writing the file, so that a torn read is worth repeating.
enum class RecordingOwner { kMayLive, kDead };

/// Every member throws Error: recording_damaged when bytes are missing or wrong, recording_foreign for other
/// files.
class RecordedFile {
 public:
  explicit RecordedFile(const std::string& path, RecordingOwner owner = RecordingOwner::kMayLive);

  const RecordingInfo& info() const { return info_; }

  /// Frame `index` below info().frames. Precondition: index in range, else Error("out_of_range").
  void read(uint64_t index, RecordedFrame& frame);
  RecordedClock read_clock(uint64_t index);
  void read_field(uint64_t index, size_t system, size_t field, std::vector<double>& out);

 private:
  struct Array {
    H5 set;
    Precision precision = Precision::kF64;
    size_t element = 8;
    size_t rows = 1, width = 1;
    size_t frames = 1, chunk_rows = 1, chunks = 1;  // of a chunk, and chunks per frame
    std::vector<std::byte> chunk;                   // the chunk last read ...
    uint64_t chunk_row = ~uint64_t{0};              // ... and where it is
    size_t chunk_column = 0;
  };

  void read_parameters();
  void read_parts(PartInfo::Kind kind);
  void read_observables();
  RecordedField read_field(const std::string& path, const std::string& name);
  void leave_out_missing_frames();
  size_t columns_used(const Array& a, size_t system, uint64_t begin, uint64_t end);
  Array open_array(const std::string& path, uint64_t& frames);
  Array open_number(const std::string& path, Precision precision, size_t element);
  const std::byte* row_data(Array& a, uint64_t frame, size_t column);
  size_t row_count(uint64_t frame, size_t system);
  void check_index(uint64_t index) const;
  void read_rows(Array& a, uint64_t frame, size_t rows, std::vector<double>& out);

  void check_not_behind_end(hid_t set, const hsize_t* at, uint64_t frame);

  H5 file_;
  uint64_t file_size_ = 0;
  RecordingInfo info_;
  std::vector<std::vector<Array>> fields_;  // per system
  std::vector<Array> counts_;               // per system; no dataset when its rows are fixed
  std::vector<Array> observables_;
  Array step_, time_;
};

}  // namespace truestep
