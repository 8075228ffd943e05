// VTK XML unstructured grids with raw appended data, one per frame and system, and a .pvd that gives their
// times. Cells: triangles, else lines, else a vertex per point (lines and triangles both where both are
// recorded). Source: VTK file formats, XML section; cell types 1 vertex, 3 line, 5 triangle.
#include "engine/sinks/recording/export_parts.h"

#include <filesystem>

#include "engine/base/xml.h"

namespace truestep::exporting {
namespace {

const char* type_name(Precision p) {
  return p == Precision::kF32 ? "Float32" : p == Precision::kF64 ? "Float64" : "UInt32";
}

// The XML text and the block of arrays behind it grow together.
struct Document {
  std::string xml;
  std::vector<char> data;

  void array(const std::string& type, const std::string& name, size_t width, const std::vector<char>& bytes) {
    xml += "<DataArray type=\"" + type + "\" Name=\"" + escaped_xml(name) + "\" NumberOfComponents=\"" +
           std::to_string(width) + "\" format=\"appended\" offset=\"" + std::to_string(data.size()) +
           "\"/>\n";
    const uint64_t size = bytes.size();
    const char* head = reinterpret_cast<const char*>(&size);
    data.insert(data.end(), head, head + sizeof size);
    data.insert(data.end(), bytes.begin(), bytes.end());
  }
  template <typename T>
  void array(const std::string& type, const std::string& name, const std::vector<T>& values) {
    const char* from = reinterpret_cast<const char*>(values.data());
    array(type, name, 1, std::vector<char>(from, from + values.size() * sizeof(T)));
  }
};

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

Cells cells_of(const RecordedSystem& system, size_t rows) {
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

void field(Document& d, const RecordedField& f, const std::vector<double>& values) {
  std::vector<char> bytes;
  pack(f.precision, values, bytes);
  d.array(type_name(f.precision), f.name, f.width, bytes);
}

void write_grid(const std::string& path, const RecordedSystem& system, const RecordedRows& rows) {
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
    if (f != at) field(d, system.fields[f], rows.fields[f]);
  }
  d.xml += "</PointData>\n<Points>\n";
  field(d, system.fields[at], rows.fields[at]);
  d.xml += "</Points>\n<Cells>\n";
  d.array("Int64", "connectivity", cells.connectivity);
  d.array("Int64", "offsets", cells.offsets);
  d.array("UInt8", "types", cells.types);
  d.xml += "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";
  OutputFile out(path);
  out.text(d.xml);
  out.bytes(d.data.data(), d.data.size());
  out.text("\n</AppendedData>\n</VTKFile>\n");
  out.close();
}

}  // namespace

Paths write_vtu(RecordingReader& reader, const ExportOptions& options, const std::string& stem) {
  const RecordingInfo& info = reader.info();
  Paths paths;
  std::string list;
  RecordedFrame frame;
  for (uint64_t i : chosen_frames(info, options)) {
    reader.read(i, frame);
    int part = 0;
    for (size_t s : chosen_systems(info, options)) {
      const RecordedSystem& system = info.layout.systems[s];
      if (position_field(system) < 0) continue;
      paths.push_back(stem + "." + system.id + "." + digits(i) + ".vtu");
      write_grid(paths.back(), system, frame.systems[s]);
      std::string time;
      print(Precision::kF64, frame.time, time);
      list += "<DataSet timestep=\"" + time + "\" part=\"" + std::to_string(part++) + "\" name=\"" +
              escaped_xml(system.id) + "\" file=\"" +
              escaped_xml(std::filesystem::path(paths.back()).filename().string()) + "\"/>\n";
    }
  }
  paths.push_back(stem + ".pvd");
  OutputFile out(paths.back());
  out.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n" + list +
           "</Collection>\n</VTKFile>\n");
  out.close();
  return paths;
}

}  // namespace truestep::exporting
