// Meshes of elements in Gmsh's MSH format, versions 2.2 and 4.1 as text: triangles, quadrangles, tetrahedra
// or hexahedra with straight edges, and the physical groups that they, their faces, edges and points belong
// to. The elements of the highest dimension form the mesh and must all be of one form; those of a lower
// dimension only say which vertices a group has. Partitions, periods and fields are skipped.
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
  std::vector<Vec3> vertices;   ///< in the file's order, without those unused by elements
  std::vector<uint32_t> cells;  ///< corners of every element, one after another, in VTK's order
  struct Group {
    std::string name;                ///< the file's name, or one like "surface_3"
    std::vector<uint32_t> vertices;  ///< ascending
  };
  std::vector<Group> groups;  ///< by dimension, then by number; groups of the same name are merged

  size_t size() const { return cells.size() / corners_of(form); }
};

/// Throws MeshFault with a line.
CellFile read_msh(std::string_view text);

/// The surface of a mesh in space, seen from outside; for a mesh in the plane or a shell, its elements.
/// Quadrangles are cut in two.
SurfaceFile surface_of(const CellFile& mesh);

}  // namespace truestep
