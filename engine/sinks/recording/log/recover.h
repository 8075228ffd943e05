// Repairs recordings whose writer died, when a server starts. The longest prefix of frames with correct
// checksums is read from the file as it is (as a SWMR reader, without changing it) or, if HDF5 refuses that,
// from a copy with a repaired superblock, and written into a new, finalised file that takes the old one's
// name. If there is a chunk log (chunk_log.h) that names every frame's chunks, they are taken from there
// instead, whatever the file's structures say. This runs in a child process, because HDF5 may loop or crash
// on a damaged file.
#pragma once
#include <chrono>
#include <string>

#include "engine/sinks/recording/recording_thread.h"

namespace truestep {

enum class RecoveryOutcome {
  kIntact,      ///< finalised already, nothing was done
  kRecovered,   ///< replaced by a finalised file
  kUnreadable,  ///< nothing could be read; the file is unchanged
  kFailed,      ///< the new file could not be written (disk full ...); the file is unchanged
  kTimedOut,    ///< the time limit passed; the file is unchanged
};

struct RecoveryOptions {
  std::chrono::milliseconds time_limit{60000};
};

struct RecoveryReport {
  RecoveryOutcome outcome = RecoveryOutcome::kUnreadable;
  uint64_t frames_found = 0;  ///< frames the file claims
  uint64_t frames_kept = 0;   ///< frames in the finalised file; if fewer, the old file is kept as
                              ///< <path>.damaged
  std::string message;        ///< why, for a person; empty when all went well
};

/// Repairs the recording at `path`; never throws because of the file's contents. Blocks `thread` meanwhile.
RecoveryReport recover_recording(RecordingThread& thread, const std::string& path,
                                 const RecoveryOptions& options);

}  // namespace truestep
