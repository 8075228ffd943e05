// The /VTKHDF group of a finished recording: PolyData for one system, a PartitionedDataSetCollection with an
// Assembly for several. Nothing recorded is copied: Points and every point data array are virtual datasets,
//   [T, N, w] seen as [T * N, w],   step i beginning at row i * N  (N = max_rows).
// A changing row count is one part per step, NumberOfPoints[i] = rows[i]; static topology is stored once.
// Source: VTKHDF file format 2.1 (PolyData, temporal data, composite data).
#pragma once
#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/file/layout.h"

namespace truestep {

/// Fills the empty group /VTKHDF of `file` for `frames` frames; systems without a position of width 3 are
/// left out, and nothing is written when there are no frames or no such systems. Throws Error (disk_full,
/// recording_io).
void write_vtkhdf(hid_t file, const RecordingLayout& layout, uint64_t frames);

}  // namespace truestep
