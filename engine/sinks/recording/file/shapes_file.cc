#include "engine/sinks/recording/file/shapes_file.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/core/drawing.h"

namespace truestep {
namespace {

constexpr size_t kKindBytes = 12;
constexpr const char* kKinds[] = {"plane", "box", "sphere", "capsule", "cylinder", "mesh"};
constexpr const char* kMotions[] = {"fixed", "kinematic", "dynamic", "sensor"};
static_assert(static_cast<size_t>(DrawnShape::Kind::mesh) + 1 == std::size(kKinds));
static_assert(static_cast<size_t>(Visual::Motion::sensor) + 1 == std::size(kMotions));

[[noreturn]] void shapes_damaged(const std::string& what) {
  throw Error("recording_damaged", what);
}

H5 word_type() {
  H5 type = h5_id(H5Tcopy(H5T_C_S1), "make a text type");
  h5_ok(H5Tset_size(type, kKindBytes), "size a text type");
  h5_ok(H5Tset_strpad(type, H5T_STR_NULLPAD), "set the padding");
  return type;
}

template <size_t kCount>
void write_words(hid_t group, const char* name, const std::vector<uint32_t>& values,
                 const char* const (&words)[kCount]) {
  std::vector<std::array<char, kKindBytes>> out(values.size());
  for (size_t i = 0; i < values.size(); ++i) std::strncpy(out[i].data(), words[values[i]], kKindBytes);
  h5_dataset(group, name, word_type(), {values.size()}, out.data());
}

void write_rows(hid_t group, const char* name, hid_t type, size_t count, size_t width, const void* data) {
  h5_dataset(group, name, type, width > 1 ? std::vector<hsize_t>{count, width} : std::vector<hsize_t>{count},
             data);
}

H5 open_set(hid_t at, const std::string& name, uint64_t width, uint64_t file_size, uint64_t& count) {
  H5 set = h5_id(H5Dopen2(at, name.c_str(), H5P_DEFAULT), "open the shapes");
  H5 space = h5_id(H5Dget_space(set), "read a shape");
  const auto points = static_cast<uint64_t>(H5Sget_simple_extent_npoints(space));
  if (points > file_size || points % width != 0) shapes_damaged("the shapes have an unknown form");
  count = points;
  return set;
}

template <typename T>
std::vector<T> read_rows(hid_t at, const std::string& name, hid_t type, uint64_t width, uint64_t file_size) {
  uint64_t count = 0;
  H5 set = open_set(at, name, width, file_size, count);
  std::vector<T> out(count);
  h5_ok(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()), "read the shapes");
  return out;
}

template <size_t kCount>
std::vector<uint32_t> read_words(hid_t at, const std::string& name, uint64_t file_size,
                                 const char* const (&words)[kCount]) {
  uint64_t count = 0;
  H5 set = open_set(at, name, 1, file_size, count);
  std::vector<std::array<char, kKindBytes>> text(count);
  h5_ok(H5Dread(set, word_type(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read the shapes");
  std::vector<uint32_t> out;
  for (const auto& t : text) {
    const std::string_view word(t.data(), strnlen(t.data(), kKindBytes));
    const auto* const at_word = std::find(std::begin(words), std::end(words), word);
    if (at_word == std::end(words)) shapes_damaged("the shapes have an unknown kind");
    out.push_back(static_cast<uint32_t>(at_word - words));
  }
  return out;
}

void write_part(hid_t file, const std::string& id, const RecordedShapes& s) {
  const size_t n = s.kinds.size();
  H5 group = h5_group(file, "/shapes/" + id);
  h5_attribute(group, "point_radius", &s.point_radius, 1);
  write_rows(group, "instances", H5T_NATIVE_UINT32, s.instances.size() / 2, 2, s.instances.data());
  write_words(group, "kind", s.kinds, kKinds);
  write_rows(group, "position", H5T_NATIVE_DOUBLE, n, 3, s.positions.data());
  write_rows(group, "orientation", H5T_NATIVE_DOUBLE, n, 4, s.orientations.data());
  write_rows(group, "size", H5T_NATIVE_DOUBLE, n, 3, s.sizes.data());
  write_rows(group, "color", H5T_NATIVE_DOUBLE, n, 3, s.colors.data());
  write_words(group, "motion", s.motions, kMotions);
  write_rows(group, "group", H5T_NATIVE_UINT32, n, 1, s.groups.data());
  write_rows(group, "mesh", H5T_NATIVE_UINT32, n, 1, s.meshes.data());
}

double read_radius(hid_t group) {
  H5 attribute = h5_id(H5Aopen(group, "point_radius", H5P_DEFAULT), "open an attribute");
  H5 space = h5_id(H5Aget_space(attribute), "read a shape");
  if (H5Sget_simple_extent_npoints(space) != 1) shapes_damaged("a single value has several elements");
  double radius = 0;
  h5_ok(H5Aread(attribute, H5T_NATIVE_DOUBLE, &radius), "read an attribute");
  return radius;
}

RecordedShapes read_part(hid_t file, const std::string& path, uint64_t rows, size_t meshes, uint64_t size) {
  H5 group = h5_id(H5Gopen2(file, path.c_str(), H5P_DEFAULT), "open the shapes");
  RecordedShapes s;
  s.point_radius = read_radius(group);
  s.instances = read_rows<uint32_t>(group, "instances", H5T_NATIVE_UINT32, 2, size);
  s.kinds = read_words(group, "kind", size, kKinds);
  s.positions = read_rows<double>(group, "position", H5T_NATIVE_DOUBLE, 3, size);
  s.orientations = read_rows<double>(group, "orientation", H5T_NATIVE_DOUBLE, 4, size);
  s.sizes = read_rows<double>(group, "size", H5T_NATIVE_DOUBLE, 3, size);
  s.colors = read_rows<double>(group, "color", H5T_NATIVE_DOUBLE, 3, size);
  s.motions = read_words(group, "motion", size, kMotions);
  s.groups = read_rows<uint32_t>(group, "group", H5T_NATIVE_UINT32, 1, size);
  s.meshes = read_rows<uint32_t>(group, "mesh", H5T_NATIVE_UINT32, 1, size);
  const size_t n = s.kinds.size();
  bool fits = s.positions.size() == 3 * n && s.orientations.size() == 4 * n && s.sizes.size() == 3 * n &&
              s.colors.size() == 3 * n && s.motions.size() == n && s.groups.size() == n &&
              s.meshes.size() == n;
  for (size_t i = 0; i + 1 < s.instances.size(); i += 2)
    fits = fits && s.instances[i] < rows && s.instances[i + 1] < n;
  for (const uint32_t m : s.meshes) fits = fits && (m == RecordedShapes::kNoMesh || m < meshes);
  if (!fits) shapes_damaged("the shapes do not fit their part");
  return s;
}

}  // namespace

void write_shapes(hid_t file, const RecordingLayout& layout, const RecordedDrawing& drawing) {
  for (size_t p = 0; p < drawing.parts.size(); ++p) {
    const RecordedShapes& s = drawing.parts[p];
    if (!s.kinds.empty() || s.point_radius > 0) write_part(file, layout.parts[p].id, s);
  }
  for (size_t k = 0; k < drawing.meshes.size(); ++k) {
    const RecordedMesh& m = drawing.meshes[k];
    H5 group = h5_group(file, "/meshes/" + std::to_string(k));
    write_rows(group, "positions", H5T_NATIVE_FLOAT, m.positions.size() / 3, 3, m.positions.data());
    write_rows(group, "triangles", H5T_NATIVE_UINT32, m.triangles.size() / 3, 3, m.triangles.data());
  }
}

void replace_shapes(hid_t file, const RecordingLayout& layout, const RecordedDrawing& drawing) {
  for (const char* group : {"/shapes", "/meshes"}) {
    if (H5Lexists(file, group, H5P_DEFAULT) > 0)
      h5_ok(H5Ldelete(file, group, H5P_DEFAULT), "remove the shapes of the start");
  }
  write_shapes(file, layout, drawing);
}

RecordedDrawing read_shapes(hid_t file, const RecordingLayout& layout, uint64_t file_size) {
  RecordedDrawing out;
  if (H5Lexists(file, "/shapes", H5P_DEFAULT) <= 0) return out;
  for (size_t k = 0;; ++k) {
    const std::string path = "/meshes/" + std::to_string(k);
    if (H5Lexists(file, "/meshes", H5P_DEFAULT) <= 0 || H5Lexists(file, path.c_str(), H5P_DEFAULT) <= 0)
      break;
    H5 group = h5_id(H5Gopen2(file, path.c_str(), H5P_DEFAULT), "open a mesh");
    RecordedMesh& m = out.meshes.emplace_back();
    m.positions = read_rows<float>(group, "positions", H5T_NATIVE_FLOAT, 3, file_size);
    m.triangles = read_rows<uint32_t>(group, "triangles", H5T_NATIVE_UINT32, 3, file_size);
    for (const uint32_t corner : m.triangles) {
      if (corner >= m.positions.size() / 3) shapes_damaged("a mesh refers to a corner that does not exist");
    }
  }
  for (const RecordedPart& part : layout.parts) {
    const std::string path = "/shapes/" + part.id;
    RecordedShapes& s = out.parts.emplace_back();
    if (H5Lexists(file, path.c_str(), H5P_DEFAULT) > 0)
      s = read_part(file, path, part.max_rows, out.meshes.size(), file_size);
  }
  return out;
}

}  // namespace truestep
