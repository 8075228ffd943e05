#include "engine/sinks/recording/log/recover.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <functional>

#include "engine/base/errors.h"
#include "engine/sinks/recording/file/plain_file.h"
#include "engine/sinks/recording/file/recorded_file.h"
#include "engine/sinks/recording/file/recording_file.h"
#include "engine/sinks/recording/file/superblock.h"
#include "engine/sinks/recording/log/chunk_search.h"

namespace truestep {
namespace {

namespace fs = std::filesystem;

// The child's answer through a pipe: plain bytes, less than PIPE_BUF, so written atomically.
struct Answer {
  RecoveryOutcome outcome;
  uint64_t found, kept;
  char message[256];
};

Answer answer(RecoveryOutcome outcome, uint64_t found, uint64_t kept, const std::string& message) {
  Answer a{};
  a.outcome = outcome;
  a.found = found;
  a.kept = kept;
  message.copy(a.message, sizeof a.message - 1);
  return a;
}

// Copies frames from `source` until one is damaged; returns how many were written.
uint64_t rewrite(RecordedFile& source, const std::string& path, std::string& why) {
  RecordingLayout layout = source.info().layout;
  layout.path = path;
  const ChunkPlan plan = plan_chunks(layout);
  RecordingFile file(layout, plan);
  std::vector<std::byte> image(plan.bytes);
  RecordedFrame frame;
  std::vector<std::vector<FieldValues>> values(layout.parts.size());
  std::vector<PartRows> systems(layout.parts.size());
  uint64_t kept = 0;
  size_t filled = 0;
  for (; kept < source.info().frames; ++kept) {
    try {
      source.read(kept, frame);
    } catch (const Error& e) {
      why = e.what();
      break;
    }
    for (size_t s = 0; s < systems.size(); ++s) {
      values[s].clear();
      for (const std::vector<double>& f : frame.systems[s].fields)
        values[s].push_back(std::span<const double>(f));
      systems[s] = {frame.systems[s].rows, values[s]};
    }
    fill_frame(layout, plan, image.data(), filled, frame.step, frame.time, systems, frame.observables);
    if (++filled == plan.frames) {
      seal_batch(layout, plan, image.data());
      file.write(image.data(), filled);
      file.flush();
      filled = 0;
    }
  }
  if (filled > 0) {
    seal_batch(layout, plan, image.data());
    file.write(image.data(), filled);
  }
  file.finalize(source.info().journal);
  return kept;
}

// What a killed repair leaves behind.
void remove_leftovers(const std::string& path) {
  std::error_code ignored;
  for (const std::string& part : {path + ".recovering", path + ".repair"}) {
    fs::remove(part, ignored);
    fs::remove(chunk_log_path(part), ignored);
  }
}

// Replaces `path` by `path`.recovering, which holds `kept` of `found` frames.
Answer replace(const std::string& path, uint64_t found, uint64_t kept, const std::string& why) {
  const std::string log = chunk_log_path(path), damaged = path + ".damaged";
  std::error_code no_log;
  if (kept < found) {
    fs::rename(path, damaged);
    fs::rename(log, chunk_log_path(damaged), no_log);
  }
  fs::rename(path + ".recovering", path);
  fs::remove(log, no_log);
  return answer(RecoveryOutcome::kRecovered, found, kept, why);
}

using Copy = std::function<uint64_t(const std::string& fresh, std::string& why)>;

// Copies frames into a new file that replaces the old one; kUnreadable when there are fewer than `least`.
Answer copy_and_replace(const std::string& path, uint64_t found, uint64_t least, const Copy& copy) {
  const std::string fresh = path + ".recovering";
  std::string why;
  try {
    const uint64_t kept = copy(fresh, why);
    if (kept >= least) return replace(path, std::max(found, kept), kept, why);
    fs::remove(fresh);
    return answer(RecoveryOutcome::kUnreadable, found, kept, why);
  } catch (const std::exception& e) {
    remove_leftovers(path);
    return answer(RecoveryOutcome::kFailed, found, 0, e.what());
  }
}

Answer from_log(const std::string& path, const LoggedChunks& log, uint64_t least) {
  return copy_and_replace(path, log.frames, least, [&](const std::string& fresh, std::string& why) {
    const uint64_t kept = rebuild_from_log(log, path, fresh);
    if (kept < log.frames) why = "chunks listed in the log are missing from the file";
    return kept;
  });
}

// Neither is a link, nor was the new one there before.
bool copy_plainly(const std::string& from, const std::string& to) {
  const int file = open_plainly(from, O_RDONLY);
  if (file < 0) return false;
  std::error_code failed;
  const bool done = fs::copy_file("/proc/self/fd/" + std::to_string(file), to, failed);
  close(file);
  return done;
}

// From HDF5's structures, of the file itself or of a copy with a repaired superblock.
Answer from_structures(const std::string& path, uint64_t found, uint64_t least) {
  const auto read = [&](const std::string& from) {
    RecordedFile file(from, RecordingOwner::kDead);
    if (file.info().completion == RecordingCompletion::kFinalized && from == path) {
      std::error_code ignored;
      fs::remove(chunk_log_path(path), ignored);
      return answer(RecoveryOutcome::kIntact, file.info().frames, file.info().frames, "");
    }
    return copy_and_replace(
        path, std::max(found, file.info().frames), least,
        [&](const std::string& fresh, std::string& why) { return rewrite(file, fresh, why); });
  };
  std::string why;
  try {
    return read(path);
  } catch (const Error& e) {
    why = e.what();
  }
  const std::string copy = path + ".repair";
  Answer result = answer(RecoveryOutcome::kUnreadable, 0, 0, why);
  try {
    fs::remove(copy);
    if (copy_plainly(path, copy) && repair_superblock(copy)) result = read(copy);
  } catch (const std::exception& e) {
    result = answer(RecoveryOutcome::kUnreadable, 0, 0, e.what());
  }
  std::error_code ignored;
  fs::remove(copy, ignored);
  return result;
}

// The file's own description, if it can be read.
std::optional<RecordingInfo> info_of(const std::string& path) {
  try {
    return RecordedFile(path, RecordingOwner::kDead).info();
  } catch (const Error&) {
    return std::nullopt;
  }
}

enum class Trust : uint8_t { structures_and_log, log };

// In the child, where nothing else runs. The log comes first, once it is clear that the file was not
// finished: then it names every frame. Only if chunks are missing may the structures know better.
Answer recover_here(const std::string& path, Trust trust) {
  const auto log = read_chunk_log(path);
  if (trust == Trust::log) {
    return log ? from_log(path, *log, 1)
               : answer(RecoveryOutcome::kUnreadable, 0, 0, "the chunk log is damaged as well");
  }
  const auto info = info_of(path);
  const bool finished = info && info->completion == RecordingCompletion::kFinalized;
  if (!log || log->frames == 0 || finished) return from_structures(path, 0, 0);
  // The log is written before the clock: when it names fewer frames, it is the log that was damaged.
  if (info && info->frames > log->frames) {
    const Answer read = from_structures(path, 0, log->frames);
    if (read.outcome != RecoveryOutcome::kUnreadable) return read;
  }
  const Answer whole = from_log(path, *log, log->frames);
  if (whole.outcome != RecoveryOutcome::kUnreadable) return whole;
  const Answer read = from_structures(path, log->frames, std::max<uint64_t>(whole.kept, 1));
  return read.outcome == RecoveryOutcome::kUnreadable && whole.kept > 0 ? from_log(path, *log, 1) : read;
}

// Waits for the child to exit for at most `limit`, then kills it. Its answer stays in the pipe.
Answer wait_for(int pipe_end, pid_t child, std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  pid_t ended = 0;
  while ((ended = waitpid(child, nullptr, WNOHANG)) == 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (ended == 0) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return answer(RecoveryOutcome::kTimedOut, 0, 0, "the repair exceeded its time limit");
  }
  Answer a{};
  if (read(pipe_end, &a, sizeof a) == static_cast<ssize_t>(sizeof a)) return a;
  return answer(RecoveryOutcome::kUnreadable, 0, 0, "reading the file crashed the HDF5 library");
}

// Forked from the HDF5 thread itself, so that the child's library is in a consistent state.
RecoveryReport recover_in_child(const std::string& path, const RecoveryOptions& options, Trust trust) {
  RecoveryReport report;
  int ends[2];
  if (pipe(ends) != 0) throw Error("recording_io", "could not open a pipe for the repair");
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    // A killed server must not leave a repair running that collides with the next server's. Its parent may be
    // gone already.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    const Answer a = recover_here(path, trust);
    const bool told = write(ends[1], &a, sizeof a) == static_cast<ssize_t>(sizeof a);
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw Error("recording_io", "could not start a process for the repair");
  }
  const Answer a = wait_for(ends[0], child, options.time_limit);
  close(ends[0]);
  remove_leftovers(path);
  report.outcome = a.outcome;
  report.frames_found = a.found;
  report.frames_kept = a.kept;
  report.message = a.message;
  return report;
}

}  // namespace

RecoveryReport recover_recording(RecordingThread& thread, const std::string& path,
                                 const RecoveryOptions& options) {
  RecoveryReport report;
  thread.run([&] {
    report = recover_in_child(path, options, Trust::structures_and_log);
    const bool stuck =
        report.outcome == RecoveryOutcome::kUnreadable || report.outcome == RecoveryOutcome::kTimedOut;
    if (stuck && fs::exists(chunk_log_path(path))) report = recover_in_child(path, options, Trust::log);
  });
  return report;
}

}  // namespace truestep
