#include "engine/sinks/recording/export/export_vtk.h"

#include <filesystem>

#include "engine/base/text/xml.h"

namespace truestep::exporting {
namespace {

const char* vtk_type(Precision p) {
  return p == Precision::kF32 ? "Float32" : p == Precision::kF64 ? "Float64" : "UInt32";
}

}  // namespace

void Document::array(const std::string& type, const std::string& name, size_t width,
                     const std::vector<char>& bytes) {
  xml += "<DataArray type=\"" + type + "\" Name=\"" + escaped_xml(name) + "\" NumberOfComponents=\"" +
         std::to_string(width) + "\" format=\"appended\" offset=\"" + std::to_string(data.size()) + "\"/>\n";
  const uint64_t size = bytes.size();
  const char* head = reinterpret_cast<const char*>(&size);
  data.insert(data.end(), head, head + sizeof size);
  data.insert(data.end(), bytes.begin(), bytes.end());
}

void append_field(Document& d, const RecordedField& f, const std::vector<double>& values) {
  std::vector<char> bytes;
  pack(f.precision, values, bytes);
  d.array(vtk_type(f.precision), f.name, f.width, bytes);
}

void write(const std::string& path, Document& d) {
  OutputFile out(path);
  out.text(d.xml + "<AppendedData encoding=\"raw\">\n_");
  out.bytes(d.data.data(), d.data.size());
  out.text("\n</AppendedData>\n</VTKFile>\n");
  out.close();
}

Paths write_times(RecordingReader& reader, const ExportOptions& options, const std::string& stem,
                  const std::string& ending, const WritePart& write_part) {
  const RecordingInfo& info = reader.info();
  Paths paths;
  std::string list;
  RecordedFrame frame;
  for (uint64_t i : chosen_frames(info, options)) {
    reader.read(i, frame);
    int number = 0;
    for (size_t s : chosen_systems(info, options)) {
      const RecordedPart& part = info.layout.parts[s];
      const std::string path = stem + "." + part.id + "." + digits(i) + ending;
      if (!write_part(path, part, frame.systems[s])) continue;
      paths.push_back(path);
      std::string time;
      print(Precision::kF64, frame.time, time);
      list += "<DataSet timestep=\"" + time + "\" part=\"" + std::to_string(number++) + "\" name=\"" +
              escaped_xml(part.id) + "\" file=\"" +
              escaped_xml(std::filesystem::path(path).filename().string()) + "\"/>\n";
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
