// Recordings: any bytes give frames or an Error with a code, never using more memory than a few times the
// file. What can be read exports in every format, and reading it again gives the same; now and then the bytes
// are repaired as well, in the child process in which repairs always run, and what the repair reports as good
// must read as reported.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>

#include "engine/base/errors.h"
#include "engine/base/hash.h"
#include "engine/sinks/recording/diff.h"
#include "engine/sinks/recording/export/export.h"
#include "engine/sinks/recording/log/recover.h"
#include "tests/fuzz/scratch_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace truestep;

void write_exports(RecordingReader& reader) {
  for (const ExportFormat format :
       {ExportFormat::kCsv, ExportFormat::kPly, ExportFormat::kNpz, ExportFormat::kVtu}) {
    try {
      for (const std::string& path :
           export_recording(reader, {format, fuzz::scratch_folder() / "out", {}, 0, 1, 1}))
        fs::remove(path);
    } catch (const Error& error) {
      if (error.code().empty()) __builtin_trap();
    }
  }
}

}  // namespace

// The library leaks memory of its own when it refuses a file; ours is checked.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto thread = std::make_shared<RecordingThread>();
  const std::string path = fuzz::scratch_folder() / "input";
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    RecordingReader reader(thread, path), again(thread, path);
    write_exports(reader);
    const auto difference = first_difference(reader, again, 0);
    if (difference) __builtin_trap();
  } catch (const Error& error) {
    if (error.code().empty()) __builtin_trap();
  }
  Hasher hasher;
  hasher.bytes(data, size);
  if (hasher.value() % 32 != 0) return 0;
  const RecoveryReport report = recover_recording(*thread, path, {std::chrono::seconds(5)});
  if (report.outcome == RecoveryOutcome::kRecovered || report.outcome == RecoveryOutcome::kIntact) {
    RecordingReader reader(thread, path);
    if (reader.info().frames != report.frames_kept) __builtin_trap();
  }
  fs::remove(path + ".damaged");
  return 0;
}
