// A disk that was full while HDF5 wrote its index leaves datasets longer than their chunks. Frames whose
// chunks are missing are left out. A part that grew has columns of chunks that its earlier frames do not use,
// nor its later ones after it shrank: what a frame needs follows from its number of rows.
#include <algorithm>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/file/recorded_file.h"

namespace truestep {

// Columns of chunks with rows of the frames begin to end - 1; the first one is always there.
size_t RecordedFile::columns_used(const Array& a, size_t system, uint64_t begin, uint64_t end) {
  if (info_.layout.parts[system].rows == RowPolicy::kFixed) return a.chunks;
  size_t rows = 1;
  try {
    for (uint64_t frame = begin; frame < end; ++frame) rows = std::max(rows, row_count(frame, system));
  } catch (const Error&) {  // damaged counts: reading these frames says so
  }
  return std::min(a.chunks, (rows + a.chunk_rows - 1) / a.chunk_rows);
}

void RecordedFile::leave_out_missing_frames() {
  const auto has_columns = [&](const Array& a, uint64_t begin, size_t columns) {
    for (size_t column = 0; column < columns; ++column) {
      const hsize_t at[3] = {begin, column * a.chunk_rows, 0};
      hsize_t size = 0;
      if (H5Dget_chunk_storage_size(a.set, at, &size) < 0 || size == 0) return false;
    }
    return true;
  };
  // The last frames that a dataset promises are looked at: the index is written in the order of frames.
  const auto leave_out = [&](const Array& a, const auto& columns) {
    if (a.set < 0 || a.frames == 0) return;
    while (info_.frames > 0) {
      const uint64_t begin = (info_.frames - 1) / a.frames * a.frames;
      if (has_columns(a, begin, columns(a, begin))) return;
      info_.frames = begin;
    }
  };
  const auto all = [](const Array& a, uint64_t) { return a.chunks; };
  leave_out(step_, all), leave_out(time_, all);
  // Before the fields, because numbers of rows are read from them.
  for (const Array& a : counts_) leave_out(a, all);
  for (const Array& a : observables_) leave_out(a, all);
  for (size_t s = 0; s < fields_.size(); ++s) {
    for (const Array& a : fields_[s])
      leave_out(a, [&](const Array& f, uint64_t begin) { return columns_used(f, s, begin, info_.frames); });
  }
}

}  // namespace truestep
