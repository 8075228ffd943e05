// What the export formats share; private to engine/sinks/recording.
#pragma once
#include <fstream>
#include <functional>

#include "engine/sinks/recording/export/export.h"

namespace truestep::exporting {

/// A file that is being written: throws Error (disk_full, export_io) as soon as a write fails.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path);
  void text(std::string_view s) { bytes(s.data(), s.size()); }
  void bytes(const void* data, size_t size);
  template <typename T>
  void number(T v) {
    bytes(&v, sizeof v);
  }
  uint64_t position() const { return position_; }
  void rewrite(uint64_t at, const void* data, size_t size);  ///< then continues at the end
  void close();

 private:
  [[noreturn]] void fail() const;
  std::string path_;
  std::ofstream file_;
  uint64_t position_ = 0;
};

/// Elements of a field in its own precision, little-endian, appended to `out`.
void pack(Precision precision, const std::vector<double>& values, std::vector<char>& out);

/// Shortest text that reads back as the same number of that precision; appended.
void print(Precision precision, double value, std::string& out);

/// Index of a system's position among its fields; -1 when it has no floating-point one of width 3.
int position_field(const RecordedPart& system);

/// Frames selected by the options, in order.
std::vector<uint64_t> chosen_frames(const RecordingInfo& info, const ExportOptions& options);

/// Indices of the systems selected by the options; throws Error("unknown_system").
std::vector<size_t> chosen_systems(const RecordingInfo& info, const ExportOptions& options);

/// Frame number as six digits or more, for file names that sort.
std::string digits(uint64_t frame);

/// The formats; `stem` is the output without its extension. They return the paths written.
using Paths = std::vector<std::string>;
Paths write_csv(RecordingReader& reader, const ExportOptions& options, const std::string& stem);
Paths write_ply(RecordingReader& reader, const ExportOptions& options, const std::string& stem);
Paths write_npz(RecordingReader& reader, const ExportOptions& options, const std::string& stem);
Paths write_vtu(RecordingReader& reader, const ExportOptions& options, const std::string& stem);
Paths write_vti(RecordingReader& reader, const ExportOptions& options, const std::string& stem);

}  // namespace truestep::exporting
