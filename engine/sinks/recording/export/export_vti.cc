// VTK XML image data with raw appended data, one per frame and grid. Source: VTK file formats, XML section.
#include "engine/sinks/recording/export/export_vtk.h"

namespace truestep::exporting {
namespace {

std::string three(double x, double y, double z) {
  std::string out;
  print(Precision::kF64, x, out);
  out += ' ';
  print(Precision::kF64, y, out);
  out += ' ';
  print(Precision::kF64, z, out);
  return out;
}

void write_image(const std::string& path, const RecordedPart& part, const RecordedRows& rows) {
  const Lattice& l = part.lattice;
  const bool cells = l.centring == Lattice::Centring::cells;
  std::string extent;
  Vec3 origin = l.origin;
  double* corner[3] = {&origin.x, &origin.y, &origin.z};
  const double spacing[3] = {l.spacing.x, l.spacing.y, l.spacing.z};
  for (size_t axis = 0; axis < 3; ++axis) {
    const bool wide = cells && l.counts[axis] > 1;
    extent += (axis ? " 0 " : "0 ") + std::to_string(l.counts[axis] - (wide ? 0 : 1));
    if (wide) *corner[axis] -= spacing[axis] / 2;
  }
  Document d;
  d.xml =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<ImageData WholeExtent=\"" +
      extent + "\" Origin=\"" + three(origin.x, origin.y, origin.z) + "\" Spacing=\"" +
      three(l.spacing.x, l.spacing.y, l.spacing.z) + "\">\n<Piece Extent=\"" + extent + "\">\n";
  const std::string kind = cells ? "CellData" : "PointData";
  d.xml += "<" + kind + ">\n";
  for (size_t f = 0; f < part.fields.size(); ++f) append_field(d, part.fields[f], rows.fields[f]);
  d.xml += "</" + kind + ">\n</Piece>\n</ImageData>\n";
  write(path, d);
}

}  // namespace

Paths write_vti(RecordingReader& reader, const ExportOptions& options, const std::string& stem) {
  return write_times(reader, options, stem, ".vti",
                     [](const std::string& path, const RecordedPart& part, const RecordedRows& rows) {
                       if (part.kind != PartInfo::Kind::grid) return false;
                       write_image(path, part, rows);
                       return true;
                     });
}

}  // namespace truestep::exporting
