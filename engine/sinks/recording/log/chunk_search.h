// Rebuilds a recording from its chunk log (chunk_log.h): every page of the damaged file is tried as the start
// of a chunk whose key is in the log; data with the key and the right checksum is the chunk. None of the
// file's HDF5 structures are read.
#pragma once
#include <string>

#include "engine/sinks/recording/log/chunk_log.h"

namespace truestep {

/// Writes the longest prefix of the log's frames whose chunks are all in the recording at `damaged` into a
/// new, finished file `fresh`; returns the number of frames. Throws Error when it cannot be written.
uint64_t rebuild_from_log(const LoggedChunks& log, const std::string& damaged, const std::string& fresh);

}  // namespace truestep
