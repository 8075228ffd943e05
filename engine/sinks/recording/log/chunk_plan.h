// How frames become chunks. A batch is the `frames` frames that share a chunk: one frame when frames are big,
// up to 64 when they are small, so that a chunk is worth its entry in the index. All datasets of a file use
// the same number, so a batch completes one chunk row of each, and every chunk is written exactly once, by
// one call, already laid out and followed by its checksum.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "engine/sinks/recording/file/layout.h"

namespace truestep {

enum class ElementType { kF32, kF64, kU32, kI64 };

/// One dataset: [T], [T, rows] or [T, rows, width] of `type`, split along rows into `chunks` chunks.
struct PlannedArray {
  std::string path;
  std::string unit;
  ElementType type = ElementType::kF64;
  size_t rows = 0;  ///< 0: one number per frame
  size_t width = 1;
  int system = -1;  ///< index of the system whose row count limits it, or -1
  size_t chunk_rows = 1;
  size_t chunks = 1;
  size_t row_bytes = 0;
  size_t chunk_bytes = 0;  ///< without the checksum
  size_t stride = 0;       ///< from chunk to chunk in the image: checksum and padding included
  size_t offset = 0;       ///< of the first chunk in the image
  Meaning meaning = Meaning::value;
};

/// All datasets of a recording, in the image's order: fields, observables, then the clock (rows, time, step).
struct ChunkPlan {
  size_t frames = 1;        ///< frames per chunk
  size_t bytes = 0;         ///< of one batch's image
  size_t first_clock = 0;   ///< index in `arrays` of the first clock array
  size_t clock_offset = 0;  ///< bytes of the image before the clock
  std::vector<PlannedArray> arrays;
  std::vector<size_t> first_field;  ///< per system: index in `arrays` of its first field
  size_t first_observable = 0;
  std::vector<int> rows_array;  ///< per system: index of its row count, -1 when fixed
};

/// Plans the file of `layout`.
ChunkPlan plan_chunks(const RecordingLayout& layout);

/// Converts one frame into slot `slot` of a batch's image. Throws Error("recording_mismatch") when `systems`
/// or `observables` do not match the layout.
void fill_frame(const RecordingLayout& layout, const ChunkPlan& plan, std::byte* image, size_t slot,
                int64_t step, double time, std::span<const PartRows> systems,
                std::span<const double> observables);

/// Fills absent rows with NaN (u32: all ones) and appends the checksums to the chunks of a filled image,
/// while it is still in the cache.
void seal_batch(const RecordingLayout& layout, const ChunkPlan& plan, std::byte* image);

/// Chunks of an array written for a filled image; those without rows in any of its frames are skipped.
size_t used_chunks(const RecordingLayout& layout, const ChunkPlan& plan, const std::byte* image,
                   const PlannedArray& array);

/// Row count of `system` in frame `slot` of a filled image.
size_t rows_in_image(const RecordingLayout& layout, const ChunkPlan& plan, const std::byte* image,
                     size_t system, size_t slot);

/// Largest row count of `system` in the first `frames` frames of a filled image.
size_t most_rows(const RecordingLayout& layout, const ChunkPlan& plan, const std::byte* image, size_t system,
                 size_t frames);

/// Bytes of one element.
size_t element_size(ElementType type);
ElementType element_type(Precision precision);

/// HDF5 path of a system's group.
std::string part_path(const RecordedPart& part);
/// Group that holds all parts of a kind; those of points are H5MD's.
std::string part_folder(PartInfo::Kind kind);

}  // namespace truestep
