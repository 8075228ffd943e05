// Shared by the tests of the recorder: a temporary folder, and recordings of the fixture's frames.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "engine/base/errors.h"
#include "engine/sinks/recording/log/chunk_log.h"
#include "engine/sinks/recording/recording_reader.h"
#include "engine/sinks/recording/recording_writer.h"
#include "tests/service/fixtures/record_check.h"

namespace truestep::fixture {

namespace fs = std::filesystem;

class RecordingTest : public ::testing::Test {
 protected:
  RecordingTest() {
    std::string name = (fs::temp_directory_path() / "truestep_recording_XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  ~RecordingTest() override { fs::remove_all(folder); }

  std::string path(const std::string& name) const { return folder / name; }

  void append(RecordingWriter& writer, uint64_t first, uint64_t count) {
    for (uint64_t i = first; i < first + count; ++i) {
      frame.make(writer.layout(), i);
      writer.append(static_cast<int64_t>(i), 0.004 * static_cast<double>(i), frame.systems,
                    frame.observables);
    }
  }

  std::string record(const std::string& name, uint32_t points, uint64_t frames) {
    RecordingWriter writer(thread, layout(path(name), points));
    append(writer, 0, frames);
    EXPECT_EQ(writer.finalize("[]").state, RecordingState::kFinalized);
    return path(name);
  }

  // Whether the chunk log is beside a file left behind.
  enum class Log : uint8_t { lost, kept };
  // A file as a killed process leaves it: copied while its writer holds it open, with everything durable.
  std::string leave(const std::string& name, uint32_t points, uint64_t frames, Log log = Log::lost) {
    RecordingWriter writer(thread, layout(path(name + ".alive"), points));
    append(writer, 0, frames);
    thread->run([] {});  // the queue is empty, hence flushed
    fs::copy_file(path(name + ".alive"), path(name));
    if (log == Log::kept) fs::copy_file(chunk_log_path(path(name + ".alive")), chunk_log_path(path(name)));
    return path(name);
  }

  // Number of leading frames that are right.
  uint64_t good_frames(const std::string& file) {
    RecordingReader reader(thread, file);
    RecordedFrame got;
    for (uint64_t i = 0; i < reader.info().frames; ++i) {
      reader.read(i, got);
      if (!is_frame(reader.info().layout, got, i)) return i;
    }
    return reader.info().frames;
  }

  std::shared_ptr<RecordingThread> thread = std::make_shared<RecordingThread>();
  fs::path folder;
  Frame frame;
};

}  // namespace truestep::fixture
