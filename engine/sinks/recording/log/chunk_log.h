// The chunk log of a recording that is being written, <recording>.chunks beside it: enough to find every
// acknowledged frame again when HDF5's own index of chunks is torn (its pages are rewritten in place while
// the file grows, so that a kill may leave half of an old and half of a new one). It holds the layout, then
// one record per batch of frames, only ever appended, written after the batch's chunks and before its clock:
//   small chunks (clock, observables, fields of few rows) verbatim,
//   for every other chunk a key: a hash of its checksum and of samples of it.
// Chunks are aligned to pages of the recording (recording_file.cc requests that), so that a search through
// all pages finds a chunk by its key wherever it lies, and no address needs to be known. All integers
// little-endian: "TSCHUNK1" | u64 size | layout | u32 sum and
//   "CREC" | u32 size | body | u32 sum,   body = u64 frames | per array: its bytes, or u64 count | u64 keys
// (sum: lookup3 of what stands before it). A finished recording has no log.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/sinks/recording/log/chunk_plan.h"

namespace truestep {

/// What a log's name adds to the recording's.
constexpr std::string_view kChunkLogEnding = ".chunks";
std::string chunk_log_path(const std::string& recording);

/// Whether the log holds this array's chunks themselves.
bool is_logged_whole(const PlannedArray& array);

/// Key of a chunk of `size` bytes followed by its checksum (at least 64 bytes).
uint64_t chunk_key(const std::byte* chunk, size_t size);

/// Writes the log of one recording.
class ChunkLog {
 public:
  /// Creates the log of `layout.path`. Throws Error (disk_full, recording_io), as every member does.
  ChunkLog(const RecordingLayout& layout, const ChunkPlan& plan);
  ~ChunkLog();
  ChunkLog(const ChunkLog&) = delete;
  ChunkLog& operator=(const ChunkLog&) = delete;

  /// Notes the first `frames` frames of a sealed batch's image.
  void add(const std::byte* image, size_t frames);
  /// Writes what was noted.
  void write();
  /// Removes the log: the recording is finished.
  void remove();

 private:
  const RecordingLayout& layout_;
  const ChunkPlan& plan_;
  std::string path_;
  int file_ = -1;
  std::vector<std::byte> bytes_;
};

/// The contents of a log, up to the first incomplete record.
struct LoggedChunks {
  struct Batch {
    uint64_t frames = 0;
    std::vector<std::byte> whole;             ///< chunks of the arrays logged verbatim, in the plan's order
    std::vector<std::vector<uint64_t>> keys;  ///< of the others, in the plan's order
  };
  RecordingLayout layout;  ///< path: the recording's
  ChunkPlan plan;
  std::vector<Batch> batches;
  uint64_t frames = 0;  ///< in all batches
};

/// The log of `recording`; empty when there is none or its head is damaged.
std::optional<LoggedChunks> read_chunk_log(const std::string& recording);

}  // namespace truestep
