// A NumPy archive: `step`, `time`, `<system>.<field>` [T, rows, width] in the recorded precision (absent rows
// are NaN, u32 all ones), `<system>.rows` where the number changes, `<system>.lines` and `.triangles`,
// `observables.<name>`. Source: NumPy enhancement proposal 1, the npy format 1.0.
#include <cstring>
#include <limits>

#include "engine/sinks/recording/export/export_parts.h"
#include "engine/sinks/recording/export/zip_writer.h"

namespace truestep::exporting {
namespace {

const char* npz_type(Precision p) {
  return p == Precision::kF32 ? "<f4" : p == Precision::kF64 ? "<f8" : "<u4";
}

void begin_array(ZipWriter& zip, const std::string& name, const char* type,
                 const std::vector<uint64_t>& shape) {
  std::string head = std::string("{'descr': '") + type + "', 'fortran_order': False, 'shape': (";
  for (uint64_t n : shape) head += std::to_string(n) + ",";
  head += "), }";
  // Magic, version and length take 10 bytes; all of it is a multiple of 64 and ends with a line break.
  head.resize((10 + head.size() + 1 + 63) / 64 * 64 - 10, ' ');
  head.back() = '\n';
  const uint16_t size = static_cast<uint16_t>(head.size());
  zip.begin(name + ".npy");
  zip.bytes("\x93NUMPY\x01\x00", 8);
  zip.bytes(&size, 2);
  zip.bytes(head.data(), head.size());
}

template <typename T>
void whole_array(ZipWriter& zip, const std::string& name, const char* type,
                 const std::vector<uint64_t>& shape, const std::vector<T>& values) {
  begin_array(zip, name, type, shape);
  zip.bytes(values.data(), values.size() * sizeof(T));
  zip.end();
}

void field_array(ZipWriter& zip, RecordingReader& reader, size_t s, size_t f,
                 const std::vector<uint64_t>& frames) {
  const RecordedPart& system = reader.info().layout.parts[s];
  const RecordedField& field = system.fields[f];
  std::vector<uint64_t> shape{frames.size(), system.max_rows};
  if (field.width > 1) shape.push_back(field.width);
  begin_array(zip, system.id + "." + field.name, npz_type(field.precision), shape);
  const double absent =
      field.precision == Precision::kU32 ? double(~uint32_t{0}) : std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values;
  std::vector<char> bytes;
  for (uint64_t i : frames) {
    reader.read_field(i, s, f, values);
    values.resize(size_t{system.max_rows} * field.width, absent);
    bytes.clear();
    pack(field.precision, values, bytes);
    zip.bytes(bytes.data(), bytes.size());
  }
  zip.end();
}

}  // namespace

Paths write_npz(RecordingReader& reader, const ExportOptions& options, const std::string& stem) {
  const RecordingInfo& info = reader.info();
  const std::vector<uint64_t> frames = chosen_frames(info, options);
  const std::vector<size_t> systems = chosen_systems(info, options);
  const uint64_t count = frames.size();
  std::vector<int64_t> steps;
  std::vector<double> times;
  std::vector<std::vector<uint32_t>> rows(info.layout.parts.size());
  std::vector<std::vector<double>> observables(info.layout.observables.size());
  for (uint64_t i : frames) {
    const RecordedClock clock = reader.read_clock(i);
    steps.push_back(clock.step);
    times.push_back(clock.time);
    for (size_t s = 0; s < rows.size(); ++s) rows[s].push_back(static_cast<uint32_t>(clock.rows[s]));
    for (size_t o = 0; o < observables.size(); ++o) observables[o].push_back(clock.observables[o]);
  }
  ZipWriter zip(stem + ".npz");
  whole_array(zip, "step", "<i8", {count}, steps);
  whole_array(zip, "time", "<f8", {count}, times);
  for (size_t o = 0; o < observables.size(); ++o) {
    whole_array(zip, "observables." + info.layout.observables[o].name, "<f8", {count}, observables[o]);
  }
  for (size_t s : systems) {
    const RecordedPart& system = info.layout.parts[s];
    if (system.rows == RowPolicy::kVariable) whole_array(zip, system.id + ".rows", "<u4", {count}, rows[s]);
    if (!system.lines.empty())
      whole_array(zip, system.id + ".lines", "<u4", {system.lines.size() / 2, 2}, system.lines);
    if (!system.triangles.empty()) {
      whole_array(zip, system.id + ".triangles", "<u4", {system.triangles.size() / 3, 3}, system.triangles);
    }
    for (size_t f = 0; f < system.fields.size(); ++f) field_array(zip, reader, s, f, frames);
  }
  zip.close();
  return {stem + ".npz"};
}

}  // namespace truestep::exporting
