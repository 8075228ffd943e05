// What to do with a recording that could not be completed because its disk is full. If there is room by now,
// it is repaired like one whose writer died (recover.h). If not, its superblock is repaired in place, which
// needs no room, so that any HDF5 reader opens it; if that would lose frames that were readable before, the
// old superblock is restored.
#pragma once
#include "engine/sinks/recording/recording_thread.h"

#include <string>

namespace truestep {

struct SalvageReport {
  enum class Outcome : uint8_t {
    complete,  ///< a finished file
    open,      ///< every frame, without the journal and the VTKHDF part
    as_it_was  ///< only Truestep and SWMR readers open it
  } outcome = Outcome::as_it_was;
  uint64_t frames = 0;
};

SalvageReport salvage_recording(RecordingThread& thread, const std::string& path);

}  // namespace truestep
