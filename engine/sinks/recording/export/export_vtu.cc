// VTK XML unstructured grids with raw appended data, one per frame and system, and a .pvd that gives their
// times. Cells: triangles, otherwise lines, otherwise a vertex per point (both lines and triangles if both
// are recorded). Source: VTK file formats, XML section; cell types 1 vertex, 3 line, 5 triangle.
#include "engine/sinks/recording/export/export_vtk.h"

namespace truestep::exporting {
namespace {

struct Cells {
  std::vector<int64_t> connectivity, offsets;
  std::vector<uint8_t> types;

  void add(const std::vector<uint32_t>& indices, size_t corners, uint8_t type) {
    for (size_t i = 0; i < indices.size(); ++i) {
      connectivity.push_back(indices[i]);
      if ((i + 1) % corners != 0) continue;
      offsets.push_back(static_cast<int64_t>(connectivity.size()));
      types.push_back(type);
    }
  }
};

Cells cells_of(const RecordedPart& system, size_t rows) {
  Cells cells;
  cells.add(system.lines, 2, 3);
  cells.add(system.triangles, 3, 5);
  if (system.lines.empty() && system.triangles.empty()) {
    std::vector<uint32_t> every(rows);
    for (size_t i = 0; i < rows; ++i) every[i] = static_cast<uint32_t>(i);
    cells.add(every, 1, 1);
  }
  return cells;
}

void write_grid(const std::string& path, const RecordedPart& system, const RecordedRows& rows) {
  const Cells cells = cells_of(system, rows.rows);
  const size_t at = static_cast<size_t>(position_field(system));
  Document d;
  d.xml =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
      std::to_string(rows.rows) + "\" NumberOfCells=\"" + std::to_string(cells.types.size()) +
      "\">\n<PointData>\n";
  for (size_t f = 0; f < system.fields.size(); ++f) {
    if (f != at) append_field(d, system.fields[f], rows.fields[f]);
  }
  d.xml += "</PointData>\n<Points>\n";
  append_field(d, system.fields[at], rows.fields[at]);
  d.xml += "</Points>\n<Cells>\n";
  d.array("Int64", "connectivity", cells.connectivity);
  d.array("Int64", "offsets", cells.offsets);
  d.array("UInt8", "types", cells.types);
  d.xml += "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
  write(path, d);
}

}  // namespace

Paths write_vtu(RecordingReader& reader, const ExportOptions& options, const std::string& stem) {
  return write_times(reader, options, stem, ".vtu",
                     [](const std::string& path, const RecordedPart& part, const RecordedRows& rows) {
                       if (position_field(part) < 0) return false;
                       write_grid(path, part, rows);
                       return true;
                     });
}

}  // namespace truestep::exporting
