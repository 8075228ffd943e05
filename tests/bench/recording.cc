// Bandwidth of a recording, from the first append to the finalised file, beside H5Dwrite of the same arrays
// into the same chunks by a program that does nothing else: bare (no checksum, no SWMR, no flush), and with
// the Fletcher-32 that a recording carries. In memory (tmpfs, where there is one) and in the temporary
// folder.
#include <hdf5.h>

#include <cstdio>
#include <filesystem>
#include <vector>

#include "engine/sinks/recording/recording_writer.h"
#include "tests/bench/report.h"

namespace {

using namespace truestep;
namespace fs = std::filesystem;

enum class Checksum { kNone, kFletcher32 };

template <typename T>
struct Case {
  fs::path folder;
  uint32_t points;
  uint64_t frames;
  std::vector<T> x;

  std::string file(const char* name) const { return folder / name; }

  size_t ours(const std::shared_ptr<RecordingThread>& thread) const {
    RecordingLayout layout;
    layout.path = file("truestep_bench.vtkhdf");
    const Precision precision = sizeof(T) == 4 ? Precision::kF32 : Precision::kF64;
    layout.parts.push_back({"p",
                            "particles",
                            points,
                            RowPolicy::kFixed,
                            {{"position", "m", 3, precision, Meaning::position}},
                            {},
                            {}});
    RecordingWriter writer(thread, layout);
    const std::vector<FieldValues> fields{std::span<const T>(x)};
    const std::vector<PartRows> systems{{points, fields}};
    for (uint64_t i = 0; i < frames; ++i)
      writer.append(static_cast<int64_t>(i), 0.01 * double(i), systems, {});
    writer.finalize("");
    return writer.frames_per_chunk();
  }

  // The chunk holds as many frames as ours, so that both write pieces of the same size.
  void peer(size_t chunk_frames, Checksum checksum) const {
    const hid_t type = sizeof(T) == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
    hsize_t dims[3] = {0, points, 3}, most[3] = {H5S_UNLIMITED, points, 3},
            chunk[3] = {chunk_frames, points, 3};
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS), create = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    H5Pset_chunk(create, 3, chunk);
    if (checksum == Checksum::kFletcher32) H5Pset_fletcher32(create);
    const hid_t out = H5Fcreate(file("bare_bench.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    const hid_t space = H5Screate_simple(3, dims, most);
    const hid_t set = H5Dcreate2(out, "x", type, space, H5P_DEFAULT, create, H5P_DEFAULT);
    const hsize_t count[3] = {1, points, 3};
    const hid_t memory = H5Screate_simple(3, count, nullptr);
    for (uint64_t i = 0; i < frames; ++i) {
      const hsize_t start[3] = {i, 0, 0};
      dims[0] = i + 1;
      H5Dset_extent(set, dims);
      const hid_t where = H5Dget_space(set);
      H5Sselect_hyperslab(where, H5S_SELECT_SET, start, nullptr, count, nullptr);
      H5Dwrite(set, type, memory, where, H5P_DEFAULT, x.data());
      H5Sclose(where);
    }
    for (hid_t id : {memory, space}) H5Sclose(id);
    H5Dclose(set);
    H5Fclose(out);
    for (hid_t id : {access, create}) H5Pclose(id);
  }
};

template <typename T>
void compare(const std::shared_ptr<RecordingThread>& thread, const fs::path& folder, const char* where,
             uint32_t points) {
  Case<T> c{folder, points, 120000000 / (points * 3 * sizeof(T)), std::vector<T>(size_t{points} * 3)};
  for (size_t i = 0; i < c.x.size(); ++i) c.x[i] = static_cast<T>(i % 9973) * T(0.001);
  const double megabytes = 1e-6 * double(c.frames) * double(c.x.size() * sizeof(T));
  size_t chunk_frames = c.ours(thread);
  for (Checksum checksum : {Checksum::kNone, Checksum::kFletcher32}) {
    const auto times = bench::interleaved(
        9, [&] { c.ours(thread); }, [&] { thread->run([&] { c.peer(chunk_frames, checksum); }); });
    const std::string metric =
        "MB/s, " + std::to_string(points) + " points, " + (sizeof(T) == 4 ? "f32" : "f64") + ", " + where;
    bench::Comparison row;
    row.bench = "recording";
    row.metric = metric;
    row.ours = megabytes / times.ours;
    row.peer = megabytes / times.peer;
    row.peer_name = checksum == Checksum::kNone ? "H5Dwrite" : "H5Dwrite with Fletcher-32";
    row.better = bench::Comparison::Better::higher;
    row.threads = 2;
    bench::report(row);
  }
  fs::remove(c.file("truestep_bench.vtkhdf"));
  fs::remove(c.file("bare_bench.h5"));
}

}  // namespace

int main() {
  const auto thread = std::make_shared<RecordingThread>();
  for (const auto& [folder, where] :
       {std::pair{fs::path("/dev/shm"), "memory"}, std::pair{fs::temp_directory_path(), "disk"}}) {
    if (!fs::is_directory(folder)) continue;
    for (uint32_t points : {10000u, 100000u}) {
      compare<float>(thread, folder, where, points);
      compare<double>(thread, folder, where, points);
    }
  }
}
