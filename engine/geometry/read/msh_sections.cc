#include "engine/geometry/read/msh_sections.h"

#include <algorithm>
#include <cstdlib>
#include <limits>

namespace truestep {

namespace {

constexpr int64_t kMostTag = std::numeric_limits<int64_t>::max() / 4;
constexpr int64_t kMostMshElements = 8'000'000;  // of all dimensions
constexpr int64_t kMostGroups = 10'000;          // of one entity, and in all

struct Type {
  uint8_t corners;
  int8_t dimension;
};
// By Gmsh's number: line, triangle, quadrangle, tetrahedron, hexahedron; a point is number 15.
constexpr Type kElementTypes[] = {{0, 0}, {2, 1}, {3, 2}, {4, 2}, {4, 3}, {8, 3}};
constexpr int64_t kPoint = 15, kPrism = 6, kPyramid = 7;

class MshReader {
 public:
  explicit MshReader(std::string_view text) : lines_(text) {}

  MshSections read() {
    std::string_view begin = lines_.next_filled() ? lines_.word() : std::string_view{};
    if (begin == "$NOD")
      lines_.fail("version 1 is not supported: use 2.2 or 4.1 (Gmsh's Mesh.MshFileVersion)");
    if (begin == "$Comments") {
      skip_to("$EndComments");
      begin = lines_.next_filled() ? lines_.word() : std::string_view{};
    }
    if (begin != "$MeshFormat") lines_.fail("an MSH file begins with $MeshFormat");
    format();
    bool nodes = false, elements = false;
    while (lines_.next_filled()) {
      const std::string section(lines_.word());
      if (!section.starts_with('$')) lines_.fail(quoted(section) + " where a section should begin");
      if (section == "$PhysicalNames") {
        physical_names();
      } else if (section == "$Entities") {
        if (!old_) entities();
      } else if (section == "$PartitionedEntities") {
        lines_.fail("partitioned meshes are not read: save the whole one");
      } else if (section == "$Nodes" || (old_ && section == "$ParametricNodes")) {
        if (std::exchange(nodes, true)) lines_.fail("there is a second $Nodes");
        old_ ? old_nodes() : new_nodes();
        sort_tags();
      } else if (section == "$Elements") {
        if (!nodes) lines_.fail("$Elements must come after $Nodes");
        if (std::exchange(elements, true)) lines_.fail("there is a second $Elements");
        old_ ? old_elements() : new_elements();
      }
      skip_to("$End" + section.substr(1));
    }
    if (!elements) lines_.fail("the file ends without $Elements");
    return std::move(out_);
  }

 private:
  void line(const char* what) {
    if (!lines_.next_filled()) lines_.fail(std::string("the file ends where ") + what + " should be");
  }
  int64_t count(const char* what, int64_t most) {
    const int64_t n = lines_.integer(what, 0, most);
    // Each of them takes at least a digit and a blank.
    if (static_cast<size_t>(n) > lines_.text_after().size()) {
      lines_.fail(std::string(what) + " is " + std::to_string(n) + ", and " +
                  std::to_string(lines_.text_after().size()) + " bytes follow");
    }
    return n;
  }
  int64_t tag(const char* what) { return lines_.integer(what, -kMostTag, kMostTag); }
  void skip_to(const std::string& end) {
    while (lines_.next_filled()) {
      if (lines_.peek() == end) {
        lines_.word();
        return;
      }
    }
    lines_.fail("the file ends without " + end);
  }

  void format() {
    line("the version");
    const std::string_view version = lines_.word(), binary = lines_.word();
    old_ = version == "2.2" || version == "2.1" || version == "2";
    if (!old_ && version != "4.1") {
      lines_.fail("version " + quoted(version) +
                  " is not supported: use 2.2 or 4.1 (Gmsh's Mesh.MshFileVersion)");
    }
    if (binary != "0") lines_.fail("binary MSH files are not read: set Gmsh's Mesh.Binary to 0");
    skip_to("$EndMeshFormat");
  }

  void physical_names() {
    line("the number of names");
    const int64_t n = count("the number of names", kMostGroups);
    for (int64_t k = 0; k < n; ++k) {
      line("a name");
      const auto dimension = static_cast<int>(lines_.integer("a dimension", 0, 3));
      const int64_t number = tag("the number of a group");
      std::string_view name = lines_.rest();
      if (name.size() < 2 || name.front() != '"' || name.back() != '"')
        lines_.fail(quoted(name) + " is not a name in quotation marks");
      name = name.substr(1, name.size() - 2);
      if (!name.empty()) out_.names[{dimension, number}] = name;
    }
  }

  // Version 4.1: groups belong to entities of the geometry, elements to entities.
  void entities() {
    line("numbers of entities");
    int64_t numbers[4];
    for (int64_t& n : numbers) n = count("the number of entities", kMostMshElements);
    for (int dimension = 0; dimension < 4; ++dimension) {
      for (int64_t k = 0; k < numbers[dimension]; ++k) {
        line("an entity");
        const int64_t number = tag("the number of an entity");
        for (int c = 0; c < (dimension == 0 ? 3 : 6); ++c) lines_.coordinate("a coordinate");
        const int64_t groups = lines_.integer("the number of groups", 0, kMostGroups);
        std::vector<MshSections::Group> in;
        // Negative where the group runs against the entity.
        for (int64_t g = 0; g < groups; ++g)
          in.emplace_back(dimension, std::abs(tag("the number of a group")));
        entity_groups_[{dimension, number}] = std::move(in);
      }
    }
  }

  void node(int64_t number) {
    Vec3 p;
    p.x = lines_.coordinate("a coordinate");
    p.y = lines_.coordinate("a coordinate");
    p.z = lines_.coordinate("a coordinate");
    out_.tags.emplace_back(number, static_cast<uint32_t>(out_.nodes.size()));
    out_.nodes.push_back(p);
  }
  /// What follows the coordinates of parametric nodes is passed over.
  void old_nodes() {
    line("the number of nodes");
    const int64_t n = count("the number of nodes", static_cast<int64_t>(kMostFileVertices));
    for (int64_t k = 0; k < n; ++k) {
      line("a node");
      node(tag("the number of a node"));
    }
  }
  void new_nodes() {
    line("numbers of nodes");
    const int64_t blocks = count("the number of blocks", kMostMshElements),
                  n = count("the number of nodes", static_cast<int64_t>(kMostFileVertices));
    std::vector<int64_t> numbers;
    for (int64_t b = 0; b < blocks; ++b) {
      line("a block of nodes");
      lines_.integer("a dimension", 0, 3);
      tag("the number of an entity");
      lines_.integer("whether it has parameters", 0, 1);
      const int64_t size =
          lines_.integer("the number of nodes in a block", 0, n - static_cast<int64_t>(out_.nodes.size()));
      numbers.clear();
      for (int64_t k = 0; k < size; ++k) {
        line("the number of a node");
        numbers.push_back(tag("the number of a node"));
      }
      for (const int64_t number : numbers) {
        line("a node");
        node(number);
      }
    }
  }
  void sort_tags() {
    std::sort(out_.tags.begin(), out_.tags.end());
    const auto twin = std::adjacent_find(out_.tags.begin(), out_.tags.end(),
                                         [](const auto& a, const auto& b) { return a.first == b.first; });
    if (twin != out_.tags.end()) lines_.fail("node " + std::to_string(twin->first) + " is defined twice");
  }

  void element(int64_t type, uint32_t entity) {
    out_.elements.push_back({static_cast<uint32_t>(out_.corners.size()), static_cast<uint8_t>(type), entity});
    for (size_t a = 0; a < msh_corners(type); ++a) {
      const int64_t number = tag("a node of an element");
      const auto at = std::lower_bound(out_.tags.begin(), out_.tags.end(), std::pair(number, uint32_t{0}));
      if (at == out_.tags.end() || at->first != number) {
        lines_.fail("an element refers to node " + std::to_string(number) + ", which is not in the file");
      }
      out_.corners.push_back(at->second);
    }
    if (!lines_.peek().empty()) lines_.fail(quoted(lines_.peek()) + " after the nodes of an element");
  }
  void check_type(int64_t type) {
    if (msh_corners(type) > 0) return;
    if (type == kPrism || type == kPyramid)
      lines_.fail("only triangles, quadrangles, tetrahedra and hexahedra are read, not prisms and pyramids");
    lines_.fail("elements of type " + std::to_string(type) +
                " are not read: save the mesh with order 1 (nodes between corners are added where needed)");
  }
  void old_elements() {
    line("the number of elements");
    const int64_t n = count("the number of elements", kMostMshElements);
    for (int64_t k = 0; k < n; ++k) {
      line("an element");
      tag("the number of an element");
      const int64_t type = lines_.integer("the type of an element", 0, 200);
      check_type(type);
      const int64_t tags = lines_.integer("the number of tags", 0, kMostGroups);
      const int64_t group = tags > 0 ? std::abs(tag("a tag")) : 0;
      for (int64_t t = 1; t < tags; ++t) tag("a tag");
      element(type, entity_of(msh_dimension(static_cast<uint8_t>(type)), group));
    }
  }
  uint32_t entity_of(int dimension, int64_t group) {
    const MshSections::Group key{dimension, group};
    const auto [at, fresh] = group_entities_.emplace(key, static_cast<uint32_t>(out_.entities.size()));
    if (fresh) {
      out_.entities.emplace_back();
      // Group 0 means none.
      if (group != 0) out_.entities.back().push_back(key);
    }
    return at->second;
  }
  void new_elements() {
    line("numbers of elements");
    const int64_t blocks = count("the number of blocks", kMostMshElements),
                  n = count("the number of elements", kMostMshElements);
    for (int64_t b = 0; b < blocks; ++b) {
      line("a block of elements");
      const auto dimension = static_cast<int>(lines_.integer("a dimension", 0, 3));
      const int64_t number = tag("the number of an entity"),
                    type = lines_.integer("the type of elements", 0, 200);
      check_type(type);
      if (msh_dimension(static_cast<uint8_t>(type)) != dimension)
        lines_.fail("elements of type " + std::to_string(type) + " in an entity of dimension " +
                    std::to_string(dimension));
      const int64_t size = lines_.integer("the number of elements in a block", 0,
                                          n - static_cast<int64_t>(out_.elements.size()));
      const auto entity = static_cast<uint32_t>(out_.entities.size());
      const auto groups = entity_groups_.find({dimension, number});
      out_.entities.push_back(groups == entity_groups_.end() ? std::vector<MshSections::Group>{}
                                                             : groups->second);
      for (int64_t k = 0; k < size; ++k) {
        line("an element");
        tag("the number of an element");
        element(type, entity);
      }
    }
  }

  TextLines lines_;
  bool old_ = false;
  MshSections out_;
  std::map<std::pair<int, int64_t>, std::vector<MshSections::Group>> entity_groups_;
  std::map<MshSections::Group, uint32_t> group_entities_;
};

}  // namespace

size_t msh_corners(int64_t type) {
  if (type == kPoint) return 1;
  return type >= 1 && type < static_cast<int64_t>(std::size(kElementTypes)) ? kElementTypes[type].corners : 0;
}
int msh_dimension(uint8_t type) {
  return type == kPoint ? 0 : kElementTypes[type].dimension;
}

MshSections read_msh_sections(std::string_view text) {
  return MshReader(text).read();
}

}  // namespace truestep
