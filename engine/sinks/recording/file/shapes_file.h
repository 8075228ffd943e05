// The shapes of a recording in its HDF5 file, a column for every property:
//   /shapes/<part>/{instances [M, 2]: row and shape, kind [V], position [V, 3], orientation [V, 4] (w x y z),
//   size [V, 3], color [V, 3], motion, group, mesh [V]}, /meshes/<k>/{positions [n, 3], triangles [m, 3]}
#pragma once
#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/file/layout.h"

namespace truestep {

/// Writes `drawing`, whose parts are those of `layout`; parts without shapes have no group.
void write_shapes(hid_t file, const RecordingLayout& layout, const RecordedDrawing& drawing);

/// Removes what write_shapes wrote and writes `drawing` in its place.
void replace_shapes(hid_t file, const RecordingLayout& layout, const RecordedDrawing& drawing);

/// What write_shapes wrote; empty for files without shapes. Throws Error("recording_damaged") when columns do
/// not match.
RecordedDrawing read_shapes(hid_t file, const RecordingLayout& layout, uint64_t file_size);

}  // namespace truestep
