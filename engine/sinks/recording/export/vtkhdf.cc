#include "engine/sinks/recording/export/vtkhdf.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <set>

#include "engine/sinks/recording/file/h5_types.h"

namespace truestep {
namespace {

constexpr int64_t kVersion[2] = {2, 1};

// VTK compares fixed-length ASCII.
void write_type(hid_t group, const std::string& type) {
  h5_attribute(group, "Version", kVersion, 2);
  H5 text = h5_id(H5Tcopy(H5T_C_S1), "make a text type");
  h5_ok(H5Tset_size(text, type.size()), "size a text type");
  h5_ok(H5Tset_strpad(text, H5T_STR_NULLPAD), "set the padding");
  H5 space = h5_id(H5Screate(H5S_SCALAR), "make a scalar");
  H5 attribute =
      h5_id(H5Acreate2(group, "Type", text, space, H5P_DEFAULT, H5P_DEFAULT), "create an attribute");
  h5_ok(H5Awrite(attribute, text, type.data()), "write an attribute");
}

void write_ids(hid_t group, const char* name, const std::vector<int64_t>& values) {
  h5_dataset(group, name, H5T_NATIVE_INT64, {values.size()}, values.data());
}

void write_zeros(hid_t group, const char* name, uint64_t rows, uint64_t columns) {
  const std::vector<int64_t> zeros(rows * columns, 0);
  std::vector<hsize_t> dims{rows};
  if (columns > 1) dims.push_back(columns);
  h5_dataset(group, name, H5T_NATIVE_INT64, dims, zeros.data());
}

// [T, N, w] at `source` in another shape with as many elements: both selections are complete, so elements map
// in storage order.
void write_view(hid_t group, const std::string& name, const std::string& source, const RecordedField& field,
                std::vector<hsize_t> from, std::vector<hsize_t> to) {
  if (field.width > 1) {
    from.push_back(field.width);
    to.push_back(field.width);
  }
  H5 from_space =
      h5_id(H5Screate_simple(static_cast<int>(from.size()), from.data(), nullptr), "make a shape");
  H5 to_space = h5_id(H5Screate_simple(static_cast<int>(to.size()), to.data(), nullptr), "make a shape");
  H5 create = h5_id(H5Pcreate(H5P_DATASET_CREATE), "make dataset properties");
  h5_ok(H5Pset_virtual(create, to_space, ".", source.c_str(), from_space), "map a virtual dataset");
  h5_id(H5Dcreate2(group, name.c_str(), h5_file_type(element_type(field.precision)), to_space, H5P_DEFAULT,
                   create, H5P_DEFAULT),
        "create a virtual dataset");
}

// [T, N, w] as [T * N, w].
void write_flat_view(hid_t group, const std::string& name, const std::string& source,
                     const RecordedField& field, uint64_t frames, uint64_t rows) {
  write_view(group, name, source, field, {frames, rows}, {frames * rows});
}

// One of Vertices, Lines, Polygons, Strips. `cells` per part, each with `corners` entries of `connectivity`.
void write_cells(hid_t block, const char* name, const std::vector<int64_t>& cells,
                 const std::vector<int64_t>& connectivity, int64_t corners) {
  H5 group = h5_group(block, name);
  std::vector<int64_t> ids(cells), offsets(connectivity.size() / corners + 1);
  for (int64_t& n : ids) n *= corners;
  for (size_t i = 0; i < offsets.size(); ++i) offsets[i] = static_cast<int64_t>(i) * corners;
  write_ids(group, "NumberOfCells", cells);
  write_ids(group, "NumberOfConnectivityIds", ids);
  write_ids(group, "Connectivity", connectivity);
  write_ids(group, "Offsets", offsets);
}

void write_steps(hid_t block, const RecordedPart& system, const std::vector<double>& times) {
  const uint64_t frames = times.size();
  const int64_t count = static_cast<int64_t>(frames);
  H5 steps = h5_group(block, "Steps");
  h5_attribute(steps, "NSteps", &count, 0);
  std::vector<int64_t> part(frames, 0), point(frames), one(frames, 1);
  if (system.rows == RowPolicy::kVariable) std::iota(part.begin(), part.end(), 0);
  for (uint64_t i = 0; i < frames; ++i) point[i] = static_cast<int64_t>(i * system.max_rows);
  h5_dataset(steps, "Values", H5T_NATIVE_DOUBLE, {frames}, times.data());
  write_ids(steps, "PartOffsets", part);
  write_ids(steps, "NumberOfParts", one);
  write_ids(steps, "PointOffsets", point);
  write_zeros(steps, "CellOffsets", frames, 4);
  write_zeros(steps, "ConnectivityIdOffsets", frames, 4);
  H5 data = h5_group(steps, "PointDataOffsets");
  for (const RecordedField& f : system.fields) {
    if (f.meaning != Meaning::position) write_ids(data, f.name.c_str(), point);
  }
}

void write_block(hid_t file, hid_t block, const RecordedPart& system, const std::vector<double>& times) {
  const uint64_t frames = times.size();
  write_type(block, "PolyData");
  std::vector<int64_t> rows{static_cast<int64_t>(system.max_rows)};
  if (system.rows == RowPolicy::kVariable) {
    std::vector<uint32_t> recorded(frames);
    H5 set = h5_id(H5Dopen2(file, (part_path(system) + "/rows").c_str(), H5P_DEFAULT), "open the row counts");
    h5_ok(H5Dread(set, H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, recorded.data()),
          "read the row counts");
    rows.assign(recorded.begin(), recorded.end());
  }
  write_ids(block, "NumberOfPoints", rows);
  H5 point_data = h5_group(block, "PointData");
  for (const RecordedField& f : system.fields) {
    const std::string source = part_path(system) + "/" + f.name + "/value";
    if (f.meaning == Meaning::position) {
      write_flat_view(block, "Points", source, f, frames, system.max_rows);
    } else {
      write_flat_view(point_data, f.name, source, f, frames, system.max_rows);
    }
  }
  // Points that nothing connects become vertices, so that they are visible.
  std::vector<int64_t> none(rows.size(), 0), vertices;
  const bool bare = system.lines.empty() && system.triangles.empty();
  if (bare) {
    vertices.resize(system.max_rows);
    std::iota(vertices.begin(), vertices.end(), 0);
  }
  const std::vector<int64_t> lines(system.lines.begin(), system.lines.end());
  const std::vector<int64_t> triangles(system.triangles.begin(), system.triangles.end());
  write_cells(block, "Vertices", bare ? rows : none, vertices, 1);
  write_cells(block, "Lines", std::vector<int64_t>(rows.size(), static_cast<int64_t>(lines.size() / 2)),
              lines, 2);
  write_cells(block, "Polygons",
              std::vector<int64_t>(rows.size(), static_cast<int64_t>(triangles.size() / 3)), triangles, 3);
  write_cells(block, "Strips", none, {}, 1);
  write_steps(block, system, times);
}

// An image: [T, N, w] as [T, z, y, x, w] without the axes that the grid lacks; readers take what has one step
// for something without time, so that a single frame has no T either.
void write_image(hid_t block, const RecordedPart& part, const std::vector<double>& times) {
  const uint64_t frames = times.size();
  const Lattice& l = part.lattice;
  const bool cells = l.centring == Lattice::Centring::cells;
  write_type(block, "ImageData");
  // The extent counts nodes, of which there is one more than cells along each direction of the grid.
  int64_t extent[6];
  for (size_t axis = 0; axis < 3; ++axis) {
    extent[2 * axis] = 0;
    extent[2 * axis + 1] = l.counts[axis] - (cells && l.counts[axis] > 1 ? 0 : 1);
  }
  const auto corner = [&](double origin, double spacing, uint32_t count) {
    return origin - (cells && count > 1 ? spacing / 2 : 0);
  };
  const double origin[3] = {corner(l.origin.x, l.spacing.x, l.counts[0]),
                            corner(l.origin.y, l.spacing.y, l.counts[1]),
                            corner(l.origin.z, l.spacing.z, l.counts[2])};
  const double spacing[3] = {l.spacing.x, l.spacing.y, l.spacing.z};
  const double direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  h5_attribute(block, "WholeExtent", extent, 6);
  h5_attribute(block, "Origin", origin, 3);
  h5_attribute(block, "Spacing", spacing, 3);
  h5_attribute(block, "Direction", direction, 9);
  std::vector<hsize_t> shape;
  if (frames > 1) shape.push_back(frames);
  for (const size_t axis : {2, 1, 0}) {
    if (l.counts[axis] > 1) shape.push_back(l.counts[axis]);
  }
  const char* kind = cells ? "CellData" : "PointData";
  H5 data = h5_group(block, kind);
  for (const RecordedField& f : part.fields) {
    write_view(data, f.name, part_path(part) + "/" + f.name + "/value", f, {frames, part.max_rows}, shape);
  }
  if (frames == 1) return;
  H5 steps = h5_group(block, "Steps");
  const int64_t count = static_cast<int64_t>(frames);
  h5_attribute(steps, "NSteps", &count, 0);
  h5_dataset(steps, "Values", H5T_NATIVE_DOUBLE, {frames}, times.data());
  H5 offsets = h5_group(steps, std::string(kind) + "Offsets");
  std::vector<int64_t> step(frames);
  std::iota(step.begin(), step.end(), 0);
  for (const RecordedField& f : part.fields) write_ids(offsets, f.name.c_str(), step);
}

// VTK 9.7 takes a collection for one without time on the first update after its information, unless the
// collection itself has Steps; and every group of a collection is one of its blocks. So there is a last,
// empty block of that name, which 9.4 to 9.6 read as what it is.
void write_steps_block(hid_t file, hid_t root, size_t index, const std::vector<double>& times) {
  H5 block = h5_group(root, "Steps");
  RecordedPart nothing;
  nothing.id = "Steps";
  write_block(file, block, nothing, times);
  const float no_points[3] = {};
  h5_dataset(block, "Points", H5T_NATIVE_FLOAT, {0, 3}, no_points);
  const int64_t at = static_cast<int64_t>(index), count = static_cast<int64_t>(times.size());
  h5_attribute(block, "Index", &at, 0);
  h5_attribute(block, "NSteps", &count, 0);
  h5_ok(H5Lcreate_soft("/VTKHDF/Steps/Steps/Values", block, "Values", H5P_DEFAULT, H5P_DEFAULT),
        "link the times");
}

bool has_points(const RecordedPart& s) {
  return std::any_of(s.fields.begin(), s.fields.end(), [](const RecordedField& f) {
    return f.meaning == Meaning::position && f.precision != Precision::kU32;
  });
}

// VTK turns block names into XML names and keeps "Assembly" for itself.
std::string block_name(const std::string& id, std::set<std::string>& used) {
  std::string name = id;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-' && c != '.') c = '_';
  }
  if (!std::isalpha(static_cast<unsigned char>(name[0])) && name[0] != '_') name.insert(name.begin(), '_');
  while (!used.insert(name).second) name += '_';
  return name;
}

}  // namespace

void write_vtkhdf(hid_t file, const RecordingLayout& layout, uint64_t frames) {
  std::vector<const RecordedPart*> systems;
  for (const RecordedPart& s : layout.parts) {
    if (s.kind == PartInfo::Kind::grid || has_points(s)) systems.push_back(&s);
  }
  if (systems.empty() || frames == 0) return;
  std::vector<double> times(frames);
  H5 time = h5_id(H5Dopen2(file, "/clock/time", H5P_DEFAULT), "open the clock");
  h5_ok(H5Dread(time, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, times.data()), "read the clock");

  const auto write_any = [&](hid_t block, const RecordedPart& part) {
    if (part.kind == PartInfo::Kind::grid) return write_image(block, part, times);
    write_block(file, block, part, times);
  };
  H5 root = h5_id(H5Gopen2(file, "/VTKHDF", H5P_DEFAULT), "open /VTKHDF");
  if (systems.size() == 1) return write_any(root, *systems[0]);
  write_type(root, "PartitionedDataSetCollection");
  std::set<std::string> used{"Assembly", "Steps"};
  std::vector<std::string> names;
  for (size_t i = 0; i < systems.size(); ++i) {
    names.push_back(block_name(systems[i]->id, used));
    H5 block = h5_group(root, names.back());
    write_any(block, *systems[i]);
    const int64_t index = static_cast<int64_t>(i);
    h5_attribute(block, "Index", &index, 0);
  }
  if (frames > 1) {
    write_steps_block(file, root, names.size(), times);
    names.push_back("Steps");
  }
  H5 assembly = h5_group(root, "Assembly");
  for (const std::string& name : names) {
    h5_ok(H5Lcreate_soft(("/VTKHDF/" + name).c_str(), assembly, name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
          "link the assembly");
  }
}

}  // namespace truestep
