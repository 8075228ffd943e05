#include "engine/sinks/recording/log/chunk_plan.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/fletcher32.h"

namespace truestep {
namespace {

constexpr size_t kBatchBytes = size_t{256} << 10;  // small frames are gathered up to this size
constexpr size_t kImageBytes = size_t{4} << 20;    // the image of a batch is limited to this size
constexpr size_t kMaxFrames = 64;                  // and a batch to this many frames
constexpr size_t kChunkBytes = size_t{1} << 20;    // a large frame is split into chunks of about this size
constexpr size_t kGrowth = 64;                     // number of chunks in which a part may grow to its maximum
                                                   // rows

enum class Rows : uint8_t { usual, most };

size_t rows_of(const RecordedPart& s, Rows which) {
  const bool usual = which == Rows::usual && s.usual_rows > 0;
  return usual ? std::min(s.usual_rows, s.max_rows) : s.max_rows;
}

size_t frame_bytes(const RecordingLayout& layout, Rows which) {
  size_t bytes = 16 + 8 * layout.observables.size();
  for (const RecordedPart& s : layout.parts) {
    for (const RecordedField& f : s.fields) {
      bytes += rows_of(s, which) * f.width * element_size(element_type(f.precision));
    }
  }
  return bytes;
}

// Rows per chunk: the usual number, so that room for more costs nothing until it is used.
size_t chunk_rows(const ChunkPlan& plan, const PlannedArray& a, size_t usual) {
  const size_t rows = std::max<size_t>(a.rows, 1);
  const size_t fitting = std::min(rows, std::max(usual, (rows + kGrowth - 1) / kGrowth));
  if (plan.frames > 1 || fitting * a.row_bytes <= 2 * kChunkBytes) return fitting;
  // Equal parts, so that the last chunk is as full as the others.
  const size_t most = std::max<size_t>(1, kChunkBytes / a.row_bytes);
  const size_t parts = (fitting + most - 1) / most;
  return (fitting + parts - 1) / parts;
}

void place(ChunkPlan& plan, PlannedArray a, size_t usual = 1) {
  const size_t rows = std::max<size_t>(a.rows, 1);
  a.row_bytes = a.width * element_size(a.type);
  a.chunk_rows = chunk_rows(plan, a, usual);
  a.chunks = (rows + a.chunk_rows - 1) / a.chunk_rows;
  a.chunk_bytes = plan.frames * a.chunk_rows * a.row_bytes;
  a.stride = (a.chunk_bytes + 4 + 63) / 64 * 64;
  a.offset = plan.bytes;
  plan.bytes += a.chunks * a.stride;
  plan.arrays.push_back(std::move(a));
}

template <typename To, typename From>
void convert(std::byte* to, const From* from, size_t count) {
  if constexpr (std::is_same_v<To, From>) {
    if (count > 0) std::memcpy(to, from, count * sizeof(To));  // no values may have no address
  } else {
    auto* out = reinterpret_cast<To*>(to);
    for (size_t i = 0; i < count; ++i) out[i] = static_cast<To>(from[i]);
  }
}

void copy_elements(ElementType type, std::byte* to, const FieldValues& values, size_t first, size_t count) {
  std::visit(
      [&](auto span) {
        const auto* from = span.data() + first;
        if (type == ElementType::kF32) convert<float>(to, from, count);
        if (type == ElementType::kF64) convert<double>(to, from, count);
        if (type == ElementType::kU32) convert<uint32_t>(to, from, count);
      },
      values);
}

void fill_absent(ElementType type, std::byte* to, size_t count) {
  if (type == ElementType::kF32)
    std::fill_n(reinterpret_cast<float*>(to), count, std::numeric_limits<float>::quiet_NaN());
  if (type == ElementType::kF64)
    std::fill_n(reinterpret_cast<double*>(to), count, std::numeric_limits<double>::quiet_NaN());
  if (type == ElementType::kU32) std::memset(to, 0xff, count * sizeof(uint32_t));
}

// The existing rows; what lies behind them is filled when the batch is sealed.
void fill_array(const PlannedArray& a, std::byte* image, size_t slot, const FieldValues& values,
                size_t rows) {
  for (size_t c = 0; c * a.chunk_rows < rows; ++c) {
    const size_t first = c * a.chunk_rows, present = std::min(a.chunk_rows, rows - first);
    std::byte* to = image + a.offset + c * a.stride + slot * a.chunk_rows * a.row_bytes;
    copy_elements(a.type, to, values, first * a.width, present * a.width);
  }
}

void fill_absent_rows(const PlannedArray& a, std::byte* image, size_t slot, size_t rows, size_t used) {
  for (size_t c = std::min(rows / a.chunk_rows, used); c < used; ++c) {
    const size_t first = c * a.chunk_rows, present = rows > first ? std::min(a.chunk_rows, rows - first) : 0;
    std::byte* to = image + a.offset + c * a.stride + (slot * a.chunk_rows + present) * a.row_bytes;
    fill_absent(a.type, to, (a.chunk_rows - present) * a.width);
  }
}

template <typename T>
void put(const PlannedArray& a, std::byte* image, size_t slot, T value) {
  std::memcpy(image + a.offset + slot * sizeof(T), &value, sizeof(T));
}

[[noreturn]] void mismatch(const std::string& what) {
  throw Error("recording_mismatch", "the frame does not fit the recording: " + what);
}

void check_system(const RecordedPart& system, const PartRows& given) {
  if (given.fields.size() != system.fields.size()) mismatch("number of fields of " + system.id);
  if (system.rows == RowPolicy::kFixed ? given.rows != system.max_rows : given.rows > system.max_rows) {
    mismatch("number of rows of " + system.id);
  }
  for (size_t f = 0; f < system.fields.size(); ++f) {
    const size_t have = std::visit([](auto span) { return span.size(); }, given.fields[f]);
    if (have < given.rows * system.fields[f].width)
      mismatch("size of " + system.id + "." + system.fields[f].name);
  }
}

}  // namespace

size_t element_size(ElementType type) {
  return type == ElementType::kF32 || type == ElementType::kU32 ? 4 : 8;
}

ElementType element_type(Precision precision) {
  switch (precision) {
    case Precision::kF32:
      return ElementType::kF32;
    case Precision::kF64:
      return ElementType::kF64;
    case Precision::kU32:
      return ElementType::kU32;
  }
  return ElementType::kF64;
}

std::string part_folder(PartInfo::Kind kind) {
  constexpr const char* kFolders[] = {"/particles", "/grids", "/values"};
  return kFolders[static_cast<size_t>(kind)];
}

std::string part_path(const RecordedPart& part) {
  return part_folder(part.kind) + "/" + part.id;
}

ChunkPlan plan_chunks(const RecordingLayout& layout) {
  ChunkPlan plan;
  plan.frames = std::clamp<size_t>(
      std::min(kBatchBytes / frame_bytes(layout, Rows::usual), kImageBytes / frame_bytes(layout, Rows::most)),
      1, kMaxFrames);
  for (size_t s = 0; s < layout.parts.size(); ++s) {
    const RecordedPart& system = layout.parts[s];
    plan.first_field.push_back(plan.arrays.size());
    for (const RecordedField& f : system.fields) {
      PlannedArray a{part_path(system) + "/" + f.name, f.unit, element_type(f.precision)};
      a.rows = system.max_rows;
      a.width = f.width;
      a.system = static_cast<int>(s);
      a.meaning = f.meaning;
      place(plan, a, rows_of(system, Rows::usual));
    }
  }
  plan.first_observable = plan.arrays.size();
  for (const RecordedObservable& o : layout.observables) place(plan, {"/observables/" + o.name, o.unit});
  plan.first_clock = plan.arrays.size();
  plan.clock_offset = plan.bytes;
  for (const RecordedPart& system : layout.parts) {
    plan.rows_array.push_back(system.rows == RowPolicy::kVariable ? static_cast<int>(plan.arrays.size())
                                                                  : -1);
    if (system.rows == RowPolicy::kVariable)
      place(plan, {part_path(system) + "/rows", "", ElementType::kU32});
  }
  place(plan, {"/clock/time", "s", ElementType::kF64});
  place(plan, {"/clock/step", "", ElementType::kI64});
  return plan;
}

void fill_frame(const RecordingLayout& layout, const ChunkPlan& plan, std::byte* image, size_t slot,
                int64_t step, double time, std::span<const PartRows> systems,
                std::span<const double> observables) {
  if (systems.size() != layout.parts.size()) mismatch("number of systems");
  if (observables.size() != layout.observables.size()) mismatch("number of observables");
  for (size_t s = 0; s < systems.size(); ++s) check_system(layout.parts[s], systems[s]);
  for (size_t s = 0; s < systems.size(); ++s) {
    for (size_t f = 0; f < systems[s].fields.size(); ++f) {
      fill_array(plan.arrays[plan.first_field[s] + f], image, slot, systems[s].fields[f], systems[s].rows);
    }
    if (const int r = plan.rows_array[s]; r >= 0) {
      put(plan.arrays[r], image, slot, static_cast<uint32_t>(systems[s].rows));
    }
  }
  for (size_t o = 0; o < observables.size(); ++o) {
    put(plan.arrays[plan.first_observable + o], image, slot, observables[o]);
  }
  put(plan.arrays[plan.arrays.size() - 2], image, slot, time);
  put(plan.arrays[plan.arrays.size() - 1], image, slot, step);
}

void seal_batch(const RecordingLayout& layout, const ChunkPlan& plan, std::byte* image) {
  for (const PlannedArray& a : plan.arrays) {
    const size_t used = used_chunks(layout, plan, image, a);
    for (size_t slot = 0; a.system >= 0 && slot < plan.frames; ++slot) {
      const size_t rows = rows_in_image(layout, plan, image, static_cast<size_t>(a.system), slot);
      fill_absent_rows(a, image, slot, rows, used);
    }
    for (size_t c = 0; c < used; ++c) {
      std::byte* chunk = image + a.offset + c * a.stride;
      const uint32_t sum = fletcher32(chunk, a.chunk_bytes);
      std::memcpy(chunk + a.chunk_bytes, &sum, sizeof sum);
    }
  }
}

size_t used_chunks(const RecordingLayout& layout, const ChunkPlan& plan, const std::byte* image,
                   const PlannedArray& a) {
  if (a.system < 0 || a.chunks == 1) return a.chunks;
  const size_t rows = most_rows(layout, plan, image, static_cast<size_t>(a.system), plan.frames);
  return std::clamp<size_t>((rows + a.chunk_rows - 1) / a.chunk_rows, 1, a.chunks);
}

size_t most_rows(const RecordingLayout& layout, const ChunkPlan& plan, const std::byte* image, size_t system,
                 size_t frames) {
  size_t most = 0;
  for (size_t slot = 0; slot < frames; ++slot)
    most = std::max(most, rows_in_image(layout, plan, image, system, slot));
  return most;
}

size_t rows_in_image(const RecordingLayout& layout, const ChunkPlan& plan, const std::byte* image,
                     size_t system, size_t slot) {
  const int r = plan.rows_array[system];
  if (r < 0) return layout.parts[system].max_rows;
  uint32_t rows = 0;
  std::memcpy(&rows, image + plan.arrays[r].offset + slot * sizeof rows, sizeof rows);
  return rows;
}

}  // namespace truestep
