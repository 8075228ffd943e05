// Repair of recordings whose writer died, at the start of a server. The longest prefix of frames whose every
// checksum is right is read from the file as it is (as a SWMR reader, without touching it) or, where HDF5
// refuses that, from a copy whose superblock was put right, and written into a new, finalised file that
// takes the old one's name. Where there is a chunk log (chunk_log.h) that names every frame's chunks, they
// are taken from there instead, whatever the structures of the file say. It runs in a child process: HDF5 may
// loop or crash on a damaged file.
#pragma once
#include <chrono>
#include <string>

#include "engine/sinks/recording/recording_thread.h"

namespace truestep {

enum class RecoveryOutcome {
  kIntact,      ///< finalised already, nothing was done
  kRecovered,   ///< replaced by a finalised file
  kUnreadable,  ///< nothing could be read; the file is as it was
  kFailed,      ///< the new file could not be written (disk full ...); the file is as it was
  kTimedOut,    ///< the time limit passed; the file is as it was
};

struct RecoveryOptions {
  std::chrono::milliseconds time_limit{60000};
};

struct RecoveryReport {
  RecoveryOutcome outcome = RecoveryOutcome::kUnreadable;
  uint64_t frames_found = 0;  ///< frames the file claims
  uint64_t frames_kept = 0;   ///< frames of the finalised file; fewer keeps the old file as <path>.damaged
  std::string message;        ///< why, for a person; empty when all went well
};

/// Repairs the recording at `path`; never throws for what the file contains. Blocks `thread` while it works.
RecoveryReport recover_recording(RecordingThread& thread, const std::string& path,
                                 const RecoveryOptions& options);

}  // namespace truestep
