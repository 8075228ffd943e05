// Recordings for programs that read neither H5MD nor VTKHDF: tables (csv), polygon files (ply), NumPy
// archives (npz) and VTK XML files (vtu, and vti for grids, with a pvd for the times; VTK 9.2 and older read
// them).
#pragma once
#include <limits>
#include <string>
#include <vector>

#include "engine/sinks/recording/recording_reader.h"

namespace truestep {

enum class ExportFormat { kCsv, kPly, kNpz, kVtu, kVti };

struct ExportOptions {
  ExportFormat format = ExportFormat::kCsv;
  std::string output;  ///< path without its extension, which is added (an existing one is removed)
  std::vector<std::string> systems;  ///< ids; empty means all
  uint64_t first = 0;                ///< frames first, first + every, ... up to last
  uint64_t last = std::numeric_limits<uint64_t>::max();
  uint64_t every = 1;
};

/// csv, ply, npz, vtu or vti; throws Error("unknown_format") naming these.
ExportFormat export_format(const std::string& name);

/// Writes the files and returns their paths: csv one per system and one of observables; ply and vtu one per
/// frame and system (systems without positions are skipped), vti one per frame and grid; npz a single one.
/// Throws Error: unknown_system, disk_full, export_io, and whatever reading throws.
std::vector<std::string> export_recording(RecordingReader& reader, const ExportOptions& options);

}  // namespace truestep
