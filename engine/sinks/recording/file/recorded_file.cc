#include "engine/sinks/recording/file/recorded_file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/fletcher32.h"
#include "engine/sinks/recording/file/shapes_file.h"
#include "engine/sinks/recording/log/chunk_plan.h"

namespace truestep {
namespace {

[[noreturn]] void damaged(const std::string& what) {
  throw Error("recording_damaged", what);
}

H5 open_file(const std::string& path, RecordingOwner owner) {
  H5 access = h5_id(H5Pcreate(H5P_FILE_ACCESS), "make file properties");
  h5_ok(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "set how the file closes");
  h5_ok(H5Pset_file_locking(access, 1, 1), "set file locking");
  // The library doubles the wait before each attempt: 20 take a millisecond, its default 100 would never end.
  const unsigned attempts = owner == RecordingOwner::kDead ? 1 : 20;
  h5_ok(H5Pset_metadata_read_attempts(access, attempts), "set the attempts");
  // A file whose writer is alive or died is marked: only a SWMR reader may open it, and needs no repair.
  for (unsigned mode : {H5F_ACC_RDONLY, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ}) {
    // What a dead writer left is repaired where it is; a reader may come by a link.
    H5 file = owner == RecordingOwner::kDead ? h5_open_own(path, mode, access)
                                             : H5(H5Fopen(path.c_str(), mode, access));
    if (file >= 0) return file;
  }
  if (std::filesystem::exists(path) && H5Fis_hdf5(path.c_str()) == 0)
    throw Error("recording_foreign", "this file is not a Truestep recording: it is not an HDF5 file");
  throw_h5_error("open the recording");
}

bool exists(hid_t at, const std::string& name) {
  return H5Lexists(at, name.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> links(hid_t file, const char* path) {
  H5 group = h5_id(H5Gopen2(file, path, H5P_DEFAULT), "open a group");
  std::vector<std::string> names;
  const auto visit = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  hsize_t at = 0;
  h5_ok(H5Literate(group, H5_INDEX_CRT_ORDER, H5_ITER_INC, &at, visit, &names), "list a group");
  return names;
}

// A text of `bytes` bytes cannot be longer than the file that contains it.
std::string room_for_text(hid_t type, uint64_t file_size) {
  const size_t bytes = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || bytes > file_size)
    damaged("a text is missing or longer than the file");
  return std::string(bytes, '\0');
}

std::string text_of(const std::string& bytes) {
  return bytes.substr(0, bytes.find_last_not_of('\0') + 1);
}

// Must be one element, or reading it would write past the end of the destination.
void check_scalar(hid_t space) {
  if (H5Sget_simple_extent_npoints(space) != 1) damaged("a single value has several elements");
}

std::string read_text(hid_t file, const std::string& path, uint64_t file_size) {
  H5 set = h5_id(H5Dopen2(file, path.c_str(), H5P_DEFAULT), "open a text");
  H5 type = h5_id(H5Dget_type(set), "read a type");
  check_scalar(h5_id(H5Dget_space(set), "read a shape"));
  if (H5Tis_variable_str(type) > 0) return "";
  std::string bytes = room_for_text(type, file_size);
  h5_ok(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), "read a text");
  return text_of(bytes);
}

std::string read_text_attribute(hid_t object, const char* name, uint64_t file_size) {
  if (H5Aexists(object, name) <= 0) return "";
  H5 attribute = h5_id(H5Aopen(object, name, H5P_DEFAULT), "open an attribute");
  H5 type = h5_id(H5Aget_type(attribute), "read a type");
  check_scalar(h5_id(H5Aget_space(attribute), "read a shape"));
  if (H5Tis_variable_str(type) > 0) return "";
  std::string bytes = room_for_text(type, file_size);
  h5_ok(H5Aread(attribute, type, bytes.data()), "read an attribute");
  return text_of(bytes);
}

template <typename T>
void read_scalar(hid_t file, const char* path, hid_t type, T& value) {
  H5 set = h5_id(H5Dopen2(file, path, H5P_DEFAULT), "open a parameter");
  check_scalar(h5_id(H5Dget_space(set), "read a shape"));
  h5_ok(H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value), "read a parameter");
}

// Rows of `corners` indices below `rows`.
std::vector<uint32_t> read_indices(hid_t file, const std::string& path, uint64_t corners, uint64_t rows,
                                   uint64_t file_size) {
  if (!exists(file, path)) return {};
  H5 set = h5_id(H5Dopen2(file, path.c_str(), H5P_DEFAULT), "open the topology");
  H5 space = h5_id(H5Dget_space(set), "read a shape");
  const auto count = static_cast<uint64_t>(H5Sget_simple_extent_npoints(space));
  if (count > file_size / sizeof(uint32_t) || count % corners != 0)
    damaged("the topology has an unknown shape");
  std::vector<uint32_t> v(count);
  h5_ok(H5Dread(set, H5T_NATIVE_UINT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, v.data()), "read the topology");
  for (const uint32_t index : v) {
    if (index >= rows) damaged("the topology refers to a row that does not exist");
  }
  return v;
}

double element(Precision precision, const std::byte* p) {
  if (precision == Precision::kF64) {
    double v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  if (precision == Precision::kF32) {
    float v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  uint32_t v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

template <class T>
void read_three(hid_t group, const char* name, hid_t type, T (&values)[3]) {
  H5 attribute = h5_id(H5Aopen(group, name, H5P_DEFAULT), "open a lattice");
  H5 space = h5_id(H5Aget_space(attribute), "read a shape");
  if (H5Sget_simple_extent_npoints(space) != 3) damaged("a lattice has an unknown shape");
  h5_ok(H5Aread(attribute, type, values), "read a lattice");
}

Lattice read_lattice(hid_t group, uint64_t file_size) {
  int64_t counts[3];
  double origin[3], spacing[3];
  read_three(group, "counts", H5T_NATIVE_INT64, counts);
  read_three(group, "origin", H5T_NATIVE_DOUBLE, origin);
  read_three(group, "spacing", H5T_NATIVE_DOUBLE, spacing);
  Lattice out;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (counts[axis] < 1 || counts[axis] > UINT32_MAX) damaged("a lattice has an unknown shape");
    out.counts[axis] = static_cast<uint32_t>(counts[axis]);
  }
  out.origin = {origin[0], origin[1], origin[2]};
  out.spacing = {spacing[0], spacing[1], spacing[2]};
  if (read_text_attribute(group, "centring", file_size) == "cells") out.centring = Lattice::Centring::cells;
  return out;
}

}  // namespace

RecordedFile::RecordedFile(const std::string& path, RecordingOwner owner) : file_(open_file(path, owner)) {
  file_size_ = std::filesystem::file_size(path);
  info_.layout.path = path;
  if (!exists(file_, "/clock") || !exists(file_, "/clock/step") ||
      (!exists(file_, "/particles") && !exists(file_, "/grids"))) {
    throw Error("recording_foreign", "this HDF5 file is not a Truestep recording");
  }
  info_.frames = ~uint64_t{0};
  step_ = open_number("/clock/step", Precision::kU32, 8);
  time_ = open_number("/clock/time", Precision::kF64, 8);
  read_parameters();
  for (const auto kind : {PartInfo::Kind::points, PartInfo::Kind::grid, PartInfo::Kind::values})
    read_parts(kind);
  read_observables();
  info_.layout.drawing = read_shapes(file_, info_.layout, file_size_);
  if (info_.completion != RecordingCompletion::kFinalized) leave_out_missing_frames();
}

void RecordedFile::read_parameters() {
  RecordingLayout& layout = info_.layout;
  layout.scene_json = read_text(file_, "/parameters/scene", file_size_);
  layout.build = read_text(file_, "/parameters/build", file_size_);
  read_scalar(file_, "/parameters/seed", H5T_NATIVE_UINT64, layout.seed);
  read_scalar(file_, "/parameters/dt", H5T_NATIVE_DOUBLE, layout.dt);
  if (exists(file_, "/parameters/journal")) {
    try {
      info_.journal = read_text(file_, "/parameters/journal", file_size_);
      info_.completion = RecordingCompletion::kFinalized;
    } catch (const Error&) {  // it is written last: a file that lost its tail lost the journal first
      info_.completion = RecordingCompletion::kUnfinished;
    }
  }
}

RecordedFile::Array RecordedFile::open_array(const std::string& path, uint64_t& frames) {
  Array a;
  a.set = h5_id(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), "open a dataset");
  H5 space = h5_id(H5Dget_space(a.set), "read a shape");
  H5 create = h5_id(H5Dget_create_plist(a.set), "read dataset properties");
  hsize_t dims[3] = {0, 1, 1}, chunk[3] = {1, 1, 1};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 1 || rank > 3 || H5Pget_chunk(create, rank, chunk) != rank) damaged("a dataset has no chunks");
  h5_ok(H5Sget_simple_extent_dims(space, dims, nullptr), "read a shape");
  H5 type = h5_id(H5Dget_type(a.set), "read a type");
  a.element = H5Tget_size(type);
  const bool floating = H5Tget_class(type) == H5T_FLOAT;
  a.precision = !floating ? Precision::kU32 : a.element == 4 ? Precision::kF32 : Precision::kF64;
  a.rows = dims[1];
  a.width = dims[2];
  a.frames = chunk[0];
  a.chunk_rows = chunk[1];
  const bool known = floating ? a.element == 4 || a.element == 8
                              : H5Tget_class(type) == H5T_INTEGER && (a.element == 4 || a.element == 8);
  if (!known || chunk[2] != dims[2] || a.rows == 0 || a.rows > UINT32_MAX || a.chunk_rows == 0) {
    damaged("a dataset has an unknown shape");
  }
  // An existing chunk fits into the file, so none of these products overflows.
  if (dims[0] > 0 && (a.width > file_size_ || a.chunk_rows > file_size_ / (a.width * a.element) ||
                      a.frames > file_size_ / (a.chunk_rows * a.width * a.element))) {
    damaged("a dataset's chunks are larger than the file");
  }
  a.chunks = (a.rows + a.chunk_rows - 1) / a.chunk_rows;
  frames = std::min<uint64_t>(frames, dims[0]);
  return a;
}

// An array of one number per frame.
RecordedFile::Array RecordedFile::open_number(const std::string& path, Precision precision, size_t element) {
  Array a = open_array(path, info_.frames);
  if (a.precision != precision || a.element != element || a.rows != 1 || a.width != 1) {
    damaged("the dataset " + path + " has an unknown shape");
  }
  return a;
}

RecordedField RecordedFile::read_field(const std::string& path, const std::string& name) {
  fields_.back().push_back(open_array(path + "/" + name + "/value", info_.frames));
  const Array& a = fields_.back().back();
  // A part that grows while its file is being read may have one more row here than there.
  const bool grows = info_.completion == RecordingCompletion::kUnfinished;
  if ((!grows && a.rows != fields_.back().front().rows) ||
      (a.precision == Precision::kU32 && a.element != 4)) {
    damaged("the field '" + name + "' has an unknown shape");
  }
  RecordedField field{name, read_text_attribute(a.set, "si_unit", file_size_), static_cast<uint32_t>(a.width),
                      a.precision};
  const std::string meaning = read_text_attribute(a.set, "meaning", file_size_);
  for (size_t m = 0; m < kMeanings; ++m) {
    if (name_of(static_cast<Meaning>(m)) == meaning) field.meaning = static_cast<Meaning>(m);
  }
  // Files from before meanings were recorded.
  if (meaning.empty() && name == "position" && field.width == 3) field.meaning = Meaning::position;
  return field;
}

void RecordedFile::read_parts(PartInfo::Kind kind) {
  const std::string folder = part_folder(kind);
  if (!exists(file_, folder)) return;
  for (const std::string& id : links(file_, folder.c_str())) {
    const std::string path = folder + "/" + id;
    H5 group = h5_id(H5Gopen2(file_, path.c_str(), H5P_DEFAULT), "open a part");
    RecordedPart part;
    part.id = id;
    part.kind = kind;
    part.type = read_text_attribute(group, "type", file_size_);
    part.rows = read_text_attribute(group, "row_policy", file_size_) == "fixed" ? RowPolicy::kFixed
                                                                                : RowPolicy::kVariable;
    fields_.emplace_back();
    for (const std::string& name : links(file_, path.c_str())) {
      if (name != "box" && name != "rows") part.fields.push_back(read_field(path, name));
    }
    if (fields_.back().empty()) damaged("the part '" + id + "' has no fields");
    size_t rows = SIZE_MAX;
    for (const Array& a : fields_.back()) rows = std::min(rows, a.rows);
    part.max_rows = static_cast<uint32_t>(rows);
    counts_.push_back(part.rows == RowPolicy::kVariable ? open_number(path + "/rows", Precision::kU32, 4)
                                                        : Array());
    part.lines = read_indices(file_, "/connectivity/" + id + "/lines", 2, part.max_rows, file_size_);
    part.triangles = read_indices(file_, "/connectivity/" + id + "/triangles", 3, part.max_rows, file_size_);
    if (kind == PartInfo::Kind::grid) {
      part.lattice = read_lattice(group, file_size_);
      if (part.lattice.rows() != part.max_rows)
        damaged("the grid '" + id + "' does not have the rows of its lattice");
    }
    info_.layout.parts.push_back(std::move(part));
  }
}

void RecordedFile::read_observables() {
  for (const std::string& name : links(file_, "/observables")) {
    observables_.push_back(open_number("/observables/" + name + "/value", Precision::kF64, 8));
    info_.layout.observables.push_back(
        {name, read_text_attribute(observables_.back().set, "si_unit", file_size_)});
  }
}

// HDF5 reads zeros past the end of a file that lost its tail, and zeros have the checksum zero. The search is
// linear in the frames, so it is made only for chunks of zeros.
void RecordedFile::check_not_behind_end(hid_t set, const hsize_t* at, uint64_t frame) {
  haddr_t address = HADDR_UNDEF;
  hsize_t size = 0;
  unsigned filters = 0;
  h5_ok(H5Dget_chunk_info_by_coord(set, at, &filters, &address, &size), "find a frame");
  if (address == HADDR_UNDEF || address + size > file_size_) {
    damaged("frame " + std::to_string(frame) + " lies beyond the end of the file");
  }
}

// The stored row of `frame` in chunk column `column`, checked, and cached for neighbouring frames.
const std::byte* RecordedFile::row_data(Array& a, uint64_t frame, size_t column) {
  const uint64_t row = frame / a.frames;
  const size_t frame_bytes = a.chunk_rows * a.width * a.element;
  const size_t bytes = a.frames * frame_bytes;
  if (a.chunk_row != row || a.chunk_column != column) {
    const hsize_t at[3] = {row * a.frames, column * a.chunk_rows, 0};
    hsize_t stored = 0;
    uint32_t skipped_filters = 0, sum = 0;
    a.chunk_row = ~uint64_t{0};
    h5_ok(H5Dget_chunk_storage_size(a.set, at, &stored), "find a frame");
    if (stored != bytes + 4) damaged("frame " + std::to_string(frame) + " is missing");
    a.chunk.resize(bytes + 4);
    h5_ok(H5Dread_chunk(a.set, H5P_DEFAULT, at, &skipped_filters, a.chunk.data()), "read a frame");
    std::memcpy(&sum, a.chunk.data() + bytes, 4);
    if (skipped_filters != 0 || sum != fletcher32(a.chunk.data(), bytes)) {
      damaged("frame " + std::to_string(frame) + " has a wrong checksum");
    }
    if (sum == 0 && info_.completion == RecordingCompletion::kUnfinished)
      check_not_behind_end(a.set, at, frame);
    a.chunk_row = row;
    a.chunk_column = column;
  }
  return a.chunk.data() + (frame % a.frames) * frame_bytes;
}

void RecordedFile::read_rows(Array& a, uint64_t frame, size_t rows, std::vector<double>& out) {
  out.clear();
  for (size_t c = 0; c * a.chunk_rows < std::max<size_t>(rows, 1); ++c) {
    const std::byte* from = row_data(a, frame, c);
    const size_t count = std::min(rows - c * a.chunk_rows, a.chunk_rows) * a.width;
    // Grown as chunks are found, so that sizes claimed by a damaged file are never trusted in advance.
    out.resize(out.size() + count);
    double* to = out.data() + out.size() - count;
    for (size_t i = 0; i < count; ++i) to[i] = element(a.precision, from + i * a.element);
  }
}

void RecordedFile::check_index(uint64_t index) const {
  if (index >= info_.frames) {
    throw Error("out_of_range", "the recording has " + std::to_string(info_.frames) + " frames");
  }
}

size_t RecordedFile::row_count(uint64_t frame, size_t system) {
  const RecordedPart& s = info_.layout.parts[system];
  if (s.rows == RowPolicy::kFixed) return s.max_rows;
  const size_t rows = static_cast<size_t>(element(Precision::kU32, row_data(counts_[system], frame, 0)));
  if (rows > s.max_rows) damaged("frame " + std::to_string(frame) + " has too many rows");
  return rows;
}

RecordedClock RecordedFile::read_clock(uint64_t index) {
  check_index(index);
  RecordedClock clock;
  std::memcpy(&clock.step, row_data(step_, index, 0), sizeof clock.step);
  std::memcpy(&clock.time, row_data(time_, index, 0), sizeof clock.time);
  for (size_t s = 0; s < info_.layout.parts.size(); ++s) clock.rows.push_back(row_count(index, s));
  for (Array& o : observables_) clock.observables.push_back(element(Precision::kF64, row_data(o, index, 0)));
  return clock;
}

void RecordedFile::read_field(uint64_t index, size_t system, size_t field, std::vector<double>& out) {
  check_index(index);
  read_rows(fields_.at(system).at(field), index, row_count(index, system), out);
}

void RecordedFile::read(uint64_t index, RecordedFrame& frame) {
  RecordedClock clock = read_clock(index);
  frame.step = clock.step;
  frame.time = clock.time;
  frame.observables = std::move(clock.observables);
  frame.systems.resize(fields_.size());
  for (size_t s = 0; s < fields_.size(); ++s) {
    frame.systems[s].rows = clock.rows[s];
    frame.systems[s].fields.resize(fields_[s].size());
    for (size_t f = 0; f < fields_[s].size(); ++f) {
      read_rows(fields_[s][f], index, clock.rows[s], frame.systems[s].fields[f]);
    }
  }
}

}  // namespace truestep
