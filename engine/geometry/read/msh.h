// Meshes of elements in Gmsh's MSH format, versions 2.2 and 4.1 as text: triangles, quadrangles, tetrahedra
// or hexahedra with straight edges, and what physical groups they, their faces, edges and points belong to.
// Of a file the elements of the highest dimension are the mesh, which all have to be of one form; what is of
// a lower one only says which vertices a group has. Partitions, periods and fields are passed over.
#pragma once
#include <string>
#include <string_view>

#include "engine/geometry/read/mesh_fault.h"

namespace truestep {

enum class CellForm : uint8_t { triangles, quadrangles, tetrahedra, hexahedra };
size_t corners_of(CellForm form);
/// triangles, quadrangles, tetrahedra, hexahedra.
const char* name_of(CellForm form);

struct CellFile {
  CellForm form = CellForm::tetrahedra;
  std::vector<Vec3> vertices;   ///< in the file's order, without those that no element has
  std::vector<uint32_t> cells;  ///< corners of every element, one after another, in VTK's order
  struct Group {
    std::string name;                ///< that of the file, or like "surface_3"
    std::vector<uint32_t> vertices;  ///< ascending
  };
  std::vector<Group> groups;  ///< by dimension, then by number; those of one name are one

  size_t size() const { return cells.size() / corners_of(form); }
};

/// Throws MeshFault with a line.
CellFile read_msh(std::string_view text);

/// The surface of a mesh in space, seen from outside; the elements of one in the plane or of a shell.
/// Quadrangles are cut in two.
SurfaceFile surface_of(const CellFile& mesh);

}  // namespace truestep
