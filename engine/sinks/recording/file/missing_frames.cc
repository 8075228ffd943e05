// A disk that was full while HDF5 wrote its index leaves datasets longer than their chunks.
#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/file/recorded_file.h"

namespace truestep {

void RecordedFile::leave_out_missing_frames() {
  const auto leave_out = [&](const Array& a) {
    if (a.set < 0 || a.frames == 0) return;
    for (; info_.frames > 0; info_.frames = (info_.frames - 1) / a.frames * a.frames) {
      bool whole = true;
      for (size_t column = 0; whole && column < a.chunks; ++column) {
        const hsize_t at[3] = {(info_.frames - 1) / a.frames * a.frames, column * a.chunk_rows, 0};
        haddr_t address = HADDR_UNDEF;
        hsize_t size = 0;
        unsigned filters = 0;
        whole =
            H5Dget_chunk_info_by_coord(a.set, at, &filters, &address, &size) >= 0 && address != HADDR_UNDEF;
      }
      if (whole) return;
    }
  };
  leave_out(step_), leave_out(time_);
  for (const auto& part : fields_) {
    for (const Array& a : part) leave_out(a);
  }
  for (const Array& a : counts_) leave_out(a);
  for (const Array& a : observables_) leave_out(a);
}

}  // namespace truestep
