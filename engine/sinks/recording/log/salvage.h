// What to do with a recording that could not be completed because its disk is full: where there is room by
// now it is repaired like one whose writer died (recover.h). Where there is none, its superblock is put right
// in place, which needs no room, so that any reader of HDF5 opens it; when not every frame that could be read
// before can be read then, the old superblock is put back.
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
