// Mesh files: the contents of each format, limits checked before anything is allocated, and errors with their
// place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/geometry/read/msh.h"
#include "engine/geometry/read/obj.h"
#include "engine/geometry/read/ply.h"
#include "engine/geometry/read/stl.h"

namespace truestep {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

// Six times the enclosed volume of a closed surface: positive if its triangles are seen from outside.
double volume6(const SurfaceFile& s) {
  double out = 0;
  for (const auto& t : s.triangles) out += dot(s.vertices[t[0]], cross(s.vertices[t[1]], s.vertices[t[2]]));
  return out;
}

template <class Read>
std::string fault(Read read, std::string_view bytes) {
  try {
    read(bytes);
  } catch (const MeshFault& f) {
    return f.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

template <class T>
void put(std::string& out, T value, bool big = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (big) std::reverse(bytes, bytes + sizeof(T));
  out.append(bytes, sizeof(T));
}

const std::string kCubeObj =
    "# a tetrahedron\nmtllib a.mtl\nv 0 0 0\nv 1 0 0 0.5\nv 0 1 0 1 0 0\nv 0 0 +1e0\nvn 0 0 1\nusemtl red\n"
    "f 1//1 3//1 2//1\nf 1 2/1 4/1/1\nf -3 -2 -1\nf 1 4 \\\n 3 # the last\n";

TEST(Obj, ReadsFacesOfIndicesTexturesAndNormals) {
  const SurfaceFile s = read_obj(kCubeObj);
  EXPECT_EQ(s.vertices.size(), 4u);
  EXPECT_EQ(s.triangles, (Triangles{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}));
  EXPECT_EQ(volume6(s), 1);
}
TEST(Obj, CutsFacesIntoFansAndKeepsPointsAlone) {
  const std::string five = "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\r\nv 0 1 0\r\n";
  EXPECT_EQ(read_obj(five + "f 1 2 3 4 5").triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
  EXPECT_TRUE(read_obj(five).triangles.empty());
}
TEST(Obj, NamesTheLineOfAFault) {
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "v 1 0 0 0.5", "v 1 0")), "line 4: a coordinate is missing");
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "v 1 0 0 0.5", "v 1 0 zero")),
            "line 4: \"zero\" instead of a coordinate");
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "v 1 0 0 0.5", "v 1 0 nan")),
            "line 4: \"nan\" is not a coordinate: use a number of at most 1e12");
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "v 1 0 0 0.5", "v 1 0 1e400")),
            "line 4: \"1e400\" is not a coordinate: use a number of at most 1e12");
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "f -3", "f -5")),
            "line 11: a face has vertex -5, and 4 vertices come before it");
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "f -3", "f 0")),
            "line 11: a face has vertex 0, and 4 vertices come before it");
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "f -3 -2 -1", "f 1 2")),
            "line 11: a face has 2 corners: it needs at least three");
  EXPECT_EQ(fault(read_obj, replaced(kCubeObj, "usemtl", "usenothing")),
            "line 8: \"usenothing\" is not a statement of an OBJ file");
  EXPECT_NE(fault(read_obj, replaced(kCubeObj, "usemtl red", "curv 0 1 1 2")).find("line 8: free-form"),
            std::string::npos);
  EXPECT_EQ(fault(read_obj, "g one \\"), "line 2: the file ends without a vertex (v x y z)");
  EXPECT_EQ(fault(read_obj, "# nothing\n"), "line 2: the file ends without a vertex (v x y z)");
}

const std::string kStl =
    "solid a name of words\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 "
    "0\nendloop\n"
    "endfacet\nfacet normal nan nan nan\nouter loop\nvertex -0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\n"
    "endfacet\nendsolid a name of words\n";

std::string binary_stl(uint32_t announced, const std::vector<std::array<float, 9>>& triangles) {
  std::string out = "solid, and binary all the same";
  out.resize(80, ' ');
  put(out, announced);
  for (const auto& t : triangles) {
    out.append(12, '\0');
    for (const float c : t) put(out, c);
    out.append(2, '\0');
  }
  return out;
}

TEST(Stl, TextAndBinaryWeldCornersAtOnePlace) {
  const SurfaceFile text = read_stl(kStl);
  EXPECT_EQ(text.vertices.size(), 4u);
  EXPECT_EQ(text.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  const SurfaceFile binary =
      read_stl(binary_stl(2, {{0, 0, 0, 0, 1, 0, 1, 0, 0}, {-0.0f, 0, 0, 1, 0, 0, 0, 0, 1}}));
  EXPECT_EQ(binary.triangles, text.triangles);
  EXPECT_EQ(binary.vertices.size(), 4u);
}
TEST(Stl, NamesTheLineOrTheByteOfAFault) {
  EXPECT_EQ(fault(read_stl, replaced(kStl, "vertex 0 1 0", "vertex 0 1")),
            "line 6: \"vertex\" instead of a coordinate");
  EXPECT_EQ(fault(read_stl, replaced(kStl, "endloop", "vertex 1 1 1")),
            "line 7: \"vertex\" instead of endloop");
  EXPECT_EQ(fault(read_stl, "solid\nendsolid"), "line 3: the file ends without a facet");
  EXPECT_EQ(fault(read_stl, "nothing of the kind").substr(0, 8), "byte 20:");
  EXPECT_EQ(fault(read_stl, binary_stl(3, {{0, 0, 0, 0, 1, 0, 1, 0, 0}}).substr(1)).substr(0, 5), "byte ");
  EXPECT_EQ(fault(read_stl, replaced(binary_stl(2, {{0, 0, 0, 0, 1, 0, 1, 0, 0}}), "solid", "SOLAR")),
            "byte 135: the file ends in triangle 1 of 2");
  EXPECT_EQ(fault(read_stl, binary_stl(1, {{0, 0, 0, 0, NAN, 0, 1, 0, 0}})),
            "byte 113: a coordinate of triangle 0 is not a number of at most 1e12");
  // A count of four thousand million is not allocated.
  EXPECT_EQ(fault(read_stl, replaced(binary_stl(0xfffffff0, {}), "solid", "SOLAR")).substr(0, 31),
            "byte 81: the file announces 429");
}

std::string ply_head(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment written by hand\nelement vertex 4\nproperty double x\nproperty float y\n"
         "property short z\nproperty uchar red\nelement face 2\nproperty list uchar uint vertex_indices\n"
         "property list ushort float weights\nend_header\n";
}
const std::string kPly =
    ply_head("ascii") + "0 0 0 9\n1 0 0 9\n1 1 2 9\n0 1 2 9\n4 0 1 2 3 0\n3 0 1 3 2 0.5 0.25\n";
std::string binary_ply(bool big) {
  std::string out = ply_head(big ? "binary_big_endian" : "binary_little_endian");
  const double x[] = {0, 1, 1, 0};
  const float y[] = {0, 0, 1, 1};
  const int16_t z[] = {0, 0, 2, 2};
  for (size_t k = 0; k < 4; ++k) put(out, x[k], big), put(out, y[k], big), put(out, z[k], big), out += '\t';
  out += '\4';
  for (const uint32_t p : {0u, 1u, 2u, 3u}) put(out, p, big);
  put(out, uint16_t{0}, big);
  out += '\3';
  for (const uint32_t p : {0u, 1u, 3u}) put(out, p, big);
  put(out, uint16_t{2}, big), put(out, 0.5f, big), put(out, 0.25f, big);
  return out;
}

TEST(Ply, TextAndBothByteOrdersSayTheSame) {
  const SurfaceFile text = read_ply(kPly);
  EXPECT_EQ(text.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 3}}));
  EXPECT_EQ(text.vertices[3].z, 2);
  for (const bool big : {false, true}) {
    const SurfaceFile binary = read_ply(binary_ply(big));
    EXPECT_EQ(binary.triangles, text.triangles);
    for (size_t k = 0; k < 4; ++k) EXPECT_EQ(norm(binary.vertices[k] - text.vertices[k]), 0);
  }
}
TEST(Ply, NamesTheLineOrTheByteOfAFault) {
  EXPECT_EQ(fault(read_ply, replaced(kPly, "property short z", "property half z")),
            "line 7: \"half\" is not a type: use char, uchar, short, ushort, int, uint, float, double");
  EXPECT_EQ(fault(read_ply, replaced(kPly, "4 0 1 2 3 0", "4 0 1 2 4 0")),
            "line 17: a face has vertex 4, and the file has 4");
  EXPECT_EQ(fault(read_ply, replaced(kPly, "4 0 1 2 3 0", "2 0 1 0")),
            "line 17: face 0 has 2 corners: it must have 3 to 10000");
  EXPECT_EQ(fault(read_ply, replaced(kPly, "1 1 2 9", "1 inf 2 9")),
            "line 15: vertex 2 has no x, y and z of at most 1e12");
  EXPECT_EQ(fault(read_ply, replaced(kPly, "property float y", "property float why")),
            "line 13: vertex 0 has no x, y and z of at most 1e12");
  EXPECT_EQ(fault(read_ply, replaced(kPly, "vertex 4", "vertex 1900000")).substr(0, 44),
            "line 12: the header announces 15200008 bytes");
  EXPECT_EQ(fault(read_ply, replaced(kPly, "vertex 4", "vertex 2000001")),
            "line 12: more than 2000000 vertices are announced");
  const std::string binary = binary_ply(false);
  EXPECT_NE(fault(read_ply, binary.substr(0, binary.size() - 1)).find("the file ends in weights"),
            std::string::npos);
  EXPECT_EQ(fault(read_ply, "ply\nformat ascii 2.0\n"), "line 2: version \"2.0\" is not supported: use 1.0");
  EXPECT_EQ(fault(read_ply, "plywood\n"), "line 1: a PLY file begins with a line \"ply\"");
}

const std::string kMsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 7 \"a foot\"\n3 1 "
    "\"body\"\n$EndPhysicalNames\n"
    "$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 1 1 1\n12 5 5 5\n$EndNodes\n$Elements\n4\n"
    "1 15 2 0 1 12\n2 2 2 7 3 1 3 2\n3 4 2 1 1 1 2 3 4\n4 4 2 1 1 2 3 4 9\n$EndElements\n";
const std::string kMsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 5 \"left\"\n$EndPhysicalNames\n$Entities\n1 "
    "1 1 "
    "0\n1 0 0 0 0\n1 0 0 0 0 1 0 1 5 2 1 -1\n1 0 0 0 2 1 0 1 3 0\n$EndEntities\n$Nodes\n2 6 1 6\n1 1 0 "
    "2\n1\n2\n"
    "0 0 0\n0 1 0\n2 1 0 4\n3\n4\n5\n6\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n$EndNodes\n$Elements\n2 3 1 3\n1 1 1 1\n"
    "1 1 2\n2 1 3 2\n2 1 3 4 2\n3 3 5 6 4\n$EndElements\n$Comments\nnothing\n$EndComments\n";

TEST(Msh, ReadsElementsOfTheHighestDimensionAndGroups) {
  const CellFile two = read_msh(kMsh2);
  EXPECT_EQ(two.form, CellForm::tetrahedra);
  EXPECT_EQ(two.vertices.size(), 5u) << "the point that no element has is left out";
  EXPECT_EQ(two.cells, (std::vector<uint32_t>{0, 1, 2, 3, 1, 2, 3, 4}));
  ASSERT_EQ(two.groups.size(), 2u);
  EXPECT_EQ(two.groups[0].name, "a foot");
  EXPECT_EQ(two.groups[0].vertices, (std::vector<uint32_t>{0, 1, 2}));
  EXPECT_EQ(two.groups[1].vertices.size(), 5u);
  const CellFile four = read_msh(kMsh4);
  EXPECT_EQ(four.form, CellForm::quadrangles);
  EXPECT_EQ(four.cells, (std::vector<uint32_t>{0, 2, 3, 1, 2, 4, 5, 3}));
  ASSERT_EQ(four.groups.size(), 2u);
  EXPECT_EQ(four.groups[0].name, "left");
  EXPECT_EQ(four.groups[0].vertices, (std::vector<uint32_t>{0, 1}));
  EXPECT_EQ(four.groups[1].name, "surface_3");
}
TEST(Msh, ItsSurfaceIsClosedAndSeenFromOutside) {
  // A sixth and a third of the unit cube; the face between them is inside.
  const SurfaceFile s = surface_of(read_msh(kMsh2));
  EXPECT_EQ(s.triangles.size(), 6u);
  EXPECT_EQ(volume6(s), 3);
  EXPECT_EQ(surface_of(read_msh(kMsh4)).triangles.size(), 4u);
}
TEST(Msh, NamesTheLineOfAFault) {
  EXPECT_EQ(fault(read_msh, replaced(kMsh2, "2.2 0 8", "2.2 1 8")),
            "line 2: binary MSH files are not read: set Gmsh's Mesh.Binary to 0");
  EXPECT_NE(
      fault(read_msh, replaced(kMsh2, "2.2 0 8", "3 0 8")).find("line 2: version \"3\" is not supported"),
      std::string::npos);
  EXPECT_EQ(fault(read_msh, replaced(kMsh2, "2 3 4 9", "2 3 4 10")),
            "line 23: an element refers to node 10, which is not in the file");
  EXPECT_EQ(fault(read_msh, replaced(kMsh2, "9 1 1 1", "4 1 1 1")), "line 16: node 4 is defined twice");
  EXPECT_EQ(
      fault(read_msh, replaced(kMsh2, "4 4 2 1 1 2 3 4 9", "4 11 2 1 1 2 3 4 9 1 2 3 4 9 1")).substr(0, 43),
      "line 23: elements of type 11 are not read: ");
  EXPECT_EQ(fault(read_msh, replaced(kMsh2, "4 4 2 1 1 2 3 4 9", "4 5 2 1 1 1 2 3 4 9 2 3 4")),
            "line 25: the file has tetrahedra and hexahedra: a mesh must consist of one form");
  EXPECT_EQ(fault(read_msh, replaced(kMsh2, "$Nodes\n6", "$Nodes\n1900000")).substr(0, 43),
            "line 10: the number of nodes is 1900000, an");
  EXPECT_EQ(fault(read_msh, replaced(kMsh2, "$Nodes\n6", "$Nodes\n2000001")).substr(0, 42),
            "line 10: the number of nodes is 2000001: f");
  EXPECT_EQ(fault(read_msh, replaced(kMsh4, "2 6 1 6", "2 5 1 6")),
            "line 21: the number of nodes in a block is 4: from 0 to 3 are possible");
  EXPECT_EQ(fault(read_msh, kMsh2.substr(0, kMsh2.find("$Elements"))),
            "line 18: the file ends without $Elements");
}

}  // namespace
}  // namespace truestep
