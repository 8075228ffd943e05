// Polygon files, binary little-endian: vertices with every field as properties (position is x y z, other
// fields of several components are field_0, field_1 ...), triangles as faces; without triangles, lines as
// faces with two corners, because few readers know the element "edge". Source: G. Turk, The PLY polygon file
// format, 1994.
#include "engine/sinks/recording/export/export_parts.h"

namespace truestep::exporting {
namespace {

const char* type_name(Precision p) {
  return p == Precision::kF32 ? "float" : p == Precision::kF64 ? "double" : "uint";
}

struct Faces {
  const std::vector<uint32_t>* indices;
  size_t corners;
};
Faces faces_of(const RecordedPart& part) {
  return part.triangles.empty() ? Faces{&part.lines, 2} : Faces{&part.triangles, 3};
}

std::string header(const RecordedPart& system, const RecordedFrame& frame, size_t rows) {
  std::string h =
      "ply\nformat binary_little_endian 1.0\ncomment step " + std::to_string(frame.step) + "\ncomment time ";
  print(Precision::kF64, frame.time, h);
  h += "\nelement vertex " + std::to_string(rows) + "\n";
  for (const RecordedField& f : system.fields) {
    for (uint32_t c = 0; c < f.width; ++c) {
      std::string name = f.width == 1 ? f.name : f.name + "_" + std::to_string(c);
      if (f.meaning == Meaning::position) name = std::string(1, static_cast<char>('x' + c));
      h += std::string("property ") + type_name(f.precision) + " " + name + "\n";
    }
  }
  if (const Faces f = faces_of(system); !f.indices->empty())
    h += "element face " + std::to_string(f.indices->size() / f.corners) +
         "\nproperty list uchar int vertex_indices\n";
  return h + "end_header\n";
}

void body(const RecordedPart& system, const RecordedRows& rows, OutputFile& out) {
  std::vector<std::vector<char>> columns(system.fields.size());
  std::vector<size_t> sizes;
  for (size_t f = 0; f < columns.size(); ++f) {
    pack(system.fields[f].precision, rows.fields[f], columns[f]);
    sizes.push_back(system.fields[f].width * (system.fields[f].precision == Precision::kF64 ? 8 : 4));
  }
  std::vector<char> text;
  for (size_t r = 0; r < rows.rows; ++r) {
    for (size_t f = 0; f < columns.size(); ++f) {
      const char* from = columns[f].data() + r * sizes[f];
      text.insert(text.end(), from, from + sizes[f]);
    }
  }
  out.bytes(text.data(), text.size());
  const Faces f = faces_of(system);
  for (size_t k = 0; k + f.corners <= f.indices->size(); k += f.corners) {
    out.number(static_cast<uint8_t>(f.corners));
    out.bytes(&(*f.indices)[k], f.corners * sizeof(uint32_t));
  }
}

}  // namespace

Paths write_ply(RecordingReader& reader, const ExportOptions& options, const std::string& stem) {
  const RecordingInfo& info = reader.info();
  Paths paths;
  RecordedFrame frame;
  for (uint64_t i : chosen_frames(info, options)) {
    reader.read(i, frame);
    for (size_t s : chosen_systems(info, options)) {
      const RecordedPart& system = info.layout.parts[s];
      if (position_field(system) < 0) continue;
      paths.push_back(stem + "." + system.id + "." + digits(i) + ".ply");
      OutputFile out(paths.back());
      out.text(header(system, frame, frame.systems[s].rows));
      body(system, frame.systems[s], out);
      out.close();
    }
  }
  return paths;
}

}  // namespace truestep::exporting
