#include "engine/sinks/recording/file/recording_file.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/base/errors.h"
#include "engine/sinks/recording/export/vtkhdf.h"
#include "engine/sinks/recording/file/h5_types.h"
#include "engine/sinks/recording/file/plain_file.h"
#include "engine/sinks/recording/file/shapes_file.h"
#include "engine/sinks/recording/file/superblock.h"

namespace truestep {
namespace {

H5 file_access() {
  H5 access = h5_id(H5Pcreate(H5P_FILE_ACCESS), "make file properties");
  h5_ok(H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110), "set the format's version");
  h5_ok(H5Pset_fclose_degree(access, H5F_CLOSE_STRONG), "set how the file closes");
  // A kill can tear a write between two pages, and metadata is rewritten in place: anything that fits into a
  // page must lie within one. Chunks are written once, before they are announced, and are found by their
  // pages when larger metadata (the pages of a long index) is torn: chunk_search.h.
  h5_ok(H5Pset_alignment(access, 64, 4096), "align blocks to pages");
  // File systems without locks (some network mounts) must not make recording impossible.
  h5_ok(H5Pset_file_locking(access, 1, 1), "set file locking");
  return access;
}

H5 chunked_properties(const PlannedArray& a, size_t frames, const std::vector<hsize_t>& dims) {
  H5 create = h5_id(H5Pcreate(H5P_DATASET_CREATE), "make dataset properties");
  std::vector<hsize_t> chunk = dims;
  chunk[0] = frames;
  if (chunk.size() > 1) chunk[1] = a.chunk_rows;
  h5_ok(H5Pset_chunk(create, static_cast<int>(chunk.size()), chunk.data()), "set the chunk");
  h5_ok(H5Pset_fletcher32(create), "set the checksum");
  const float nan32 = std::numeric_limits<float>::quiet_NaN();
  const uint32_t ones = ~uint32_t{0};
  if (a.type == ElementType::kU32) {
    h5_ok(H5Pset_fill_value(create, H5T_NATIVE_UINT32, &ones), "set the fill value");
  } else if (a.type != ElementType::kI64) {
    h5_ok(H5Pset_fill_value(create, H5T_NATIVE_FLOAT, &nan32), "set the fill value");
  }
  return create;
}

void hard_link(hid_t file, const char* target, const std::string& name) {
  h5_ok(H5Lcreate_hard(file, target, file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "link the clock");
}

void write_lattice(hid_t group, const Lattice& l) {
  const int64_t counts[3] = {l.counts[0], l.counts[1], l.counts[2]};
  const double origin[3] = {l.origin.x, l.origin.y, l.origin.z};
  const double spacing[3] = {l.spacing.x, l.spacing.y, l.spacing.z};
  h5_attribute(group, "counts", counts, 3);
  h5_attribute(group, "origin", origin, 3);
  h5_attribute(group, "spacing", spacing, 3);
  h5_attribute(group, "centring", l.centring == Lattice::Centring::cells ? "cells" : "nodes");
}

}  // namespace

RecordingFile::RecordingFile(const RecordingLayout& layout, const ChunkPlan& plan)
    : layout_(layout), plan_(plan), log_(layout, plan) {
  create_plainly(layout.path, empty_file(), "create the recording");
  // Judged before anything else is closed, which forgets the library's reasons.
  const H5 access = file_access();
  H5 opened = h5_open_own(layout.path, H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, access);
  h5_ok(opened, "begin SWMR writing");
  file_ = std::move(opened);
  for (const PlannedArray& a : plan_.arrays)
    sets_.push_back(h5_id(H5Dopen2(file_, set_path(a).c_str(), H5P_DEFAULT), "open a dataset"));
}

// The file without a frame, made in memory: HDF5 1.10 does not survive a disk that fails while a file is
// created or while SWMR writing begins.
std::vector<std::byte> RecordingFile::empty_file() {
  H5 create = h5_id(H5Pcreate(H5P_FILE_CREATE), "make file properties");
  h5_ok(H5Pset_link_creation_order(create, H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "track links");
  H5 memory = file_access();
  constexpr size_t kGrows = 64 << 10;
  h5_ok(H5Pset_fapl_core(memory, kGrows, 0), "make a file in memory");
  file_ = h5_id(H5Fcreate(layout_.path.c_str(), H5F_ACC_TRUNC, create, memory), "make a file in memory");
  create_groups();
  create_arrays();
  h5_ok(H5Fflush(file_, H5F_SCOPE_LOCAL), "complete the file in memory");
  const ssize_t size = H5Fget_file_image(file_, nullptr, 0);
  h5_ok(size < 0 ? -1 : 0, "measure the file in memory");
  std::vector<std::byte> bytes(static_cast<size_t>(size));
  h5_ok(H5Fget_file_image(file_, bytes.data(), bytes.size()) < 0 ? -1 : 0, "copy the file in memory");
  file_.reset();
  // The library clears the writer's marks in the copy, but leaves the checksum that they had.
  h5_ok(repair_superblock(bytes, bytes.size()) ? 0 : -1, "close the file in memory");
  return bytes;
}

RecordingFile::~RecordingFile() {
  close();
}

void RecordingFile::create_groups() {
  const int64_t version[2] = {1, 1}, dimension = 3;
  H5 h5md = h5_group(file_, "/h5md");
  h5_attribute(h5md, "version", version, 2);
  h5_attribute(h5_group(h5md, "author"), "name", "Truestep");
  H5 creator = h5_group(h5md, "creator");
  h5_attribute(creator, "name", "truestep");
  h5_attribute(creator, "version", layout_.build);

  H5 parameters = h5_group(file_, "/parameters");
  h5_text(parameters, "scene", layout_.scene_json);
  h5_text(parameters, "build", layout_.build);
  h5_dataset(parameters, "seed", H5T_NATIVE_UINT64, {}, &layout_.seed);
  h5_dataset(parameters, "dt", H5T_NATIVE_DOUBLE, {}, &layout_.dt);

  h5_group(file_, "/clock");
  h5_group(file_, "/observables");
  for (const auto kind : {PartInfo::Kind::points, PartInfo::Kind::grid, PartInfo::Kind::values})
    h5_group(file_, part_folder(kind));
  h5_group(file_, "/connectivity");
  // Created now and filled at the end, so that finalising changes no group that leads to recorded frames.
  h5_group(file_, "/VTKHDF");
  write_shapes(file_, layout_, layout_.drawing);
  for (const RecordedPart& s : layout_.parts) {
    H5 group = h5_group(file_, part_path(s));
    h5_attribute(group, "type", s.type);
    h5_attribute(group, "row_policy", s.rows == RowPolicy::kFixed ? "fixed" : "variable");
    if (s.kind == PartInfo::Kind::points) {
      H5 box = h5_group(group, "box");
      h5_attribute(box, "dimension", &dimension, 0);
      h5_boundary_none(box);
    }
    if (s.kind == PartInfo::Kind::grid) write_lattice(group, s.lattice);
    H5 connectivity = h5_group(file_, "/connectivity/" + s.id);
    if (!s.lines.empty()) {
      h5_dataset(connectivity, "lines", H5T_NATIVE_UINT32, {s.lines.size() / 2, 2}, s.lines.data());
    }
    if (!s.triangles.empty()) {
      h5_dataset(connectivity, "triangles", H5T_NATIVE_UINT32, {s.triangles.size() / 3, 3},
                 s.triangles.data());
    }
  }
}

// A field or an observable is a group {value, step, time}; the clock's arrays are bare.
bool RecordingFile::is_element(const PlannedArray& a) const {
  return &a < plan_.arrays.data() + plan_.first_clock;
}

std::string RecordingFile::set_path(const PlannedArray& a) const {
  return is_element(a) ? a.path + "/value" : a.path;
}

// A part with a varying number of rows grows as its frames require.
size_t RecordingFile::rows_of(const PlannedArray& a) const {
  return a.system < 0 ? a.rows : rows_[static_cast<size_t>(a.system)];
}

void RecordingFile::create_arrays() {
  for (const RecordedPart& s : layout_.parts) {
    const bool grows = s.rows == RowPolicy::kVariable && s.usual_rows > 0;
    rows_.push_back(grows ? std::min(s.usual_rows, s.max_rows) : s.max_rows);
  }
  for (size_t i = 0; i < plan_.arrays.size(); ++i) {
    const PlannedArray& a = plan_.arrays[i];
    const bool element = is_element(a);
    std::vector<hsize_t> dims{0};
    if (a.rows > 0) dims.push_back(a.rows);
    if (a.rows > 0 && a.width > 1) dims.push_back(a.width);
    std::vector<hsize_t> most = dims;
    most[0] = H5S_UNLIMITED;
    if (a.rows > 0) dims[1] = rows_of(a);
    H5 space =
        h5_id(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), most.data()), "make a shape");
    H5 create = chunked_properties(a, plan_.frames, most);
    if (element) h5_group(file_, a.path);
    const H5 set = h5_id(
        H5Dcreate2(file_, set_path(a).c_str(), h5_file_type(a.type), space, H5P_DEFAULT, create, H5P_DEFAULT),
        "create a dataset");
    if (!a.unit.empty()) h5_attribute(set, "si_unit", a.unit);
    if (a.meaning != Meaning::value) h5_attribute(set, "meaning", name_of(a.meaning));
  }
  for (size_t i = 0; i < plan_.first_clock; ++i) {
    hard_link(file_, "/clock/step", plan_.arrays[i].path + "/step");
    hard_link(file_, "/clock/time", plan_.arrays[i].path + "/time");
  }
}

void RecordingFile::write_chunks(const PlannedArray& a, hid_t set, const std::byte* chunks, uint64_t first,
                                 size_t frames, size_t chunks_used) {
  const hsize_t dims[3] = {first + frames, rows_of(a), a.width};
  h5_ok(H5Dset_extent(set, dims), "extend a dataset");
  for (size_t c = 0; c < chunks_used; ++c) {
    // The image already is the output of HDF5's filter, so the library only stores it: one pass over the data
    // instead of three, and never a partly filled chunk that is written again.
    const std::byte* chunk = chunks + c * a.stride;
    const hsize_t at[3] = {first, c * a.chunk_rows, 0};
    h5_ok(H5Dwrite_chunk(set, H5P_DEFAULT, 0, at, a.chunk_bytes + 4, chunk), "write a frame");
  }
}

void RecordingFile::write(const std::byte* image, size_t frames) {
  for (size_t s = 0; s < rows_.size(); ++s)
    rows_[s] = std::max(rows_[s], most_rows(layout_, plan_, image, s, frames));
  for (size_t i = 0; i < plan_.first_clock; ++i) {
    const PlannedArray& a = plan_.arrays[i];
    const size_t used = used_chunks(layout_, plan_, image, a);
    write_chunks(a, sets_[i], image + a.offset, written_, frames, used);
  }
  log_.add(image, frames);
  if (pending_count_ == pending_.size()) pending_.emplace_back();
  PendingClock& clock = pending_[pending_count_++];
  clock.first_frame = written_;
  clock.frames = frames;
  clock.bytes.assign(image + plan_.clock_offset, image + plan_.bytes);
  written_ += frames;
}

void RecordingFile::flush() {
  if (pending_count_ == 0) return;
  h5_ok(H5Fflush(file_, H5F_SCOPE_LOCAL), "flush the recording");
  log_.write();
  for (size_t i = plan_.first_clock; i < plan_.arrays.size(); ++i) {
    const PlannedArray& a = plan_.arrays[i];
    for (size_t p = 0; p < pending_count_; ++p) {
      const PendingClock& clock = pending_[p];
      write_chunks(a, sets_[i], clock.bytes.data() + (a.offset - plan_.clock_offset), clock.first_frame,
                   clock.frames, 1);
    }
    h5_ok(H5Dflush(sets_[i]), "flush the clock");
  }
  pending_count_ = 0;
  durable_ = written_;
}

void RecordingFile::close() {
  sets_.clear();
  file_.reset();
}

void RecordingFile::finalize(std::string_view journal, const RecordedDrawing* drawing) {
  flush();
  sets_.clear();
  h5_ok(H5Fflush(file_, H5F_SCOPE_LOCAL), "flush the recording");
  file_.reset();
  const H5 access = file_access();
  H5 opened = h5_open_own(layout_.path, H5F_ACC_RDWR, access);
  h5_ok(opened, "open the recording again");
  file_ = std::move(opened);
  h5_text(h5_id(H5Gopen2(file_, "/parameters", H5P_DEFAULT), "open the parameters"), "journal", journal);
  RecordingLayout reached = layout_;
  for (size_t s = 0; s < rows_.size(); ++s) reached.parts[s].max_rows = static_cast<uint32_t>(rows_[s]);
  write_vtkhdf(file_, reached, written_);
  if (drawing) replace_shapes(file_, reached, *drawing);
  h5_ok(H5Fflush(file_, H5F_SCOPE_LOCAL), "flush the recording");
  file_.reset();
  log_.remove();
}

}  // namespace truestep
