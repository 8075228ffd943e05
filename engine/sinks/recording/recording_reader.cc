#include "engine/sinks/recording/recording_reader.h"

#include "engine/sinks/recording/file/recorded_file.h"

namespace truestep {

struct RecordingReader::File {
  RecordedFile file;
};

RecordingReader::RecordingReader(std::shared_ptr<RecordingThread> thread, const std::string& path)
    : thread_(std::move(thread)) {
  thread_->run([&] { file_.reset(new File{RecordedFile(path)}); });
}

RecordingReader::~RecordingReader() {
  thread_->run([&] { file_.reset(); });
}

const RecordingInfo& RecordingReader::info() const {
  return file_->file.info();
}

void RecordingReader::read(uint64_t index, RecordedFrame& frame) {
  thread_->run([&] { file_->file.read(index, frame); });
}

RecordedClock RecordingReader::read_clock(uint64_t index) {
  RecordedClock clock;
  thread_->run([&] { clock = file_->file.read_clock(index); });
  return clock;
}

void RecordingReader::read_field(uint64_t index, size_t system, size_t field, std::vector<double>& out) {
  thread_->run([&] { file_->file.read_field(index, system, field, out); });
}

}  // namespace truestep
