// A recording made again from its chunk log (chunk_log.h): every page of the damaged file is looked at as the
// possible beginning of a chunk whose key the log names; what has the key and the right checksum is the
// chunk. Nothing of HDF5's structures in the file is read.
#pragma once
#include <string>

#include "engine/sinks/recording/log/chunk_log.h"

namespace truestep {

/// Writes the longest prefix of the log's frames whose chunks are all in the recording at `damaged` into a
/// new, finished file `fresh`; the number of frames. Throws Error when it cannot be written.
uint64_t rebuild_from_log(const LoggedChunks& log, const std::string& damaged, const std::string& fresh);

}  // namespace truestep
