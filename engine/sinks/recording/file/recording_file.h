// The HDF5 file of one recording, for a single thread. While frames arrive it is an H5MD file that SWMR
// readers may follow:
//   /h5md, /particles/<system>/{box, <field>/{value,step,time}, rows}, /observables/<name>/{value,step,time},
//   /connectivity/<system>/{lines,triangles}, /shapes, /meshes (shapes_file.h), /parameters,
//   /clock/{step,time} (the others are hard links to these)
// and when it is finalised it becomes a VTKHDF file as well. Sources: H5MD 1.1; VTKHDF 2.1; HDF5 SWMR guide.
// Order of writing: the chunks of a batch, a flush, the chunk log, then rows, time and step, each flushed:
// the length of /clock/step is the number of frames that can be read whatever happens to the process, and the
// chunk log (chunk_log.h) finds them even when the file's structures are torn.
#pragma once
#include <string_view>

#include "engine/sinks/recording/file/h5.h"
#include "engine/sinks/recording/log/chunk_log.h"
#include "engine/sinks/recording/log/chunk_plan.h"

namespace truestep {

/// Rows of a part with a varying number of rows are added to its arrays when a frame first has them. Every
/// member throws Error (disk_full, recording_io); after that only destruction is allowed.
class RecordingFile {
 public:
  /// Creates the file of `layout` (replacing an existing one) and begins SWMR writing.
  RecordingFile(const RecordingLayout& layout, const ChunkPlan& plan);
  ~RecordingFile();

  /// Writes the first `frames` frames of a sealed batch's image.
  void write(const std::byte* image, size_t frames);

  /// Makes all frames written so far readable even if the process dies.
  void flush();

  /// Flushes, ends SWMR, adds the journal and the /VTKHDF group, closes the file and removes its chunk log.
  /// If not null, `drawing` replaces the initial shapes.
  void finalize(std::string_view journal, const RecordedDrawing* drawing = nullptr);

  uint64_t written_frames() const { return written_; }
  uint64_t durable_frames() const { return durable_; }

 private:
  struct PendingClock {
    uint64_t first_frame;
    size_t frames;
    std::vector<std::byte> bytes;  // the clock's part of a batch's image
  };

  std::vector<std::byte> empty_file();
  bool is_element(const PlannedArray& a) const;
  std::string set_path(const PlannedArray& a) const;
  void create_groups();
  void create_arrays();
  void write_chunks(const PlannedArray& a, hid_t set, const std::byte* chunks, uint64_t first, size_t frames,
                    size_t chunks_used);
  size_t rows_of(const PlannedArray& a) const;
  void close();

  const RecordingLayout& layout_;
  const ChunkPlan& plan_;
  ChunkLog log_;
  H5 file_;
  std::vector<H5> sets_;      // one per planned array
  std::vector<size_t> rows_;  // per part: most rows of any frame
  std::vector<PendingClock> pending_;
  size_t pending_count_ = 0;
  uint64_t written_ = 0;
  uint64_t durable_ = 0;
};

}  // namespace truestep
