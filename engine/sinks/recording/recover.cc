#include "engine/sinks/recording/recover.h"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>

#include "engine/base/errors.h"
#include "engine/sinks/recording/recorded_file.h"
#include "engine/sinks/recording/recording_file.h"
#include "engine/sinks/recording/superblock.h"

namespace truestep {
namespace {

namespace fs = std::filesystem;

// The answer of the child through a pipe: plain bytes, less than PIPE_BUF, so written at once.
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
  std::vector<std::vector<FieldValues>> values(layout.systems.size());
  std::vector<SystemRows> systems(layout.systems.size());
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

Answer rewrite_and_replace(RecordedFile& source, const std::string& path) {
  const uint64_t found = source.info().frames;
  const std::string fresh = path + ".recovering";
  std::string why;
  uint64_t kept = 0;
  try {
    kept = rewrite(source, fresh, why);
  } catch (const std::exception& e) {
    std::error_code ignored;
    fs::remove(fresh, ignored);
    return answer(RecoveryOutcome::kFailed, found, 0, e.what());
  }
  if (kept < found) fs::rename(path, path + ".damaged");
  fs::rename(fresh, path);
  return answer(RecoveryOutcome::kRecovered, found, kept, why);
}

// In the child, where nothing else runs.
Answer recover_here(const std::string& path) {
  std::string why;
  try {
    RecordedFile file(path, RecordingOwner::kDead);
    if (file.info().completion == RecordingCompletion::kFinalized) {
      return answer(RecoveryOutcome::kIntact, file.info().frames, file.info().frames, "");
    }
    return rewrite_and_replace(file, path);
  } catch (const Error& e) {
    why = e.what();
  }
  const std::string copy = path + ".repair";
  Answer result = answer(RecoveryOutcome::kUnreadable, 0, 0, why);
  try {
    fs::copy_file(path, copy, fs::copy_options::overwrite_existing);
    if (repair_superblock(copy)) {
      RecordedFile file(copy, RecordingOwner::kDead);
      result = rewrite_and_replace(file, path);
    }
  } catch (const std::exception& e) {
    result = answer(RecoveryOutcome::kUnreadable, 0, 0, e.what());
  }
  std::error_code ignored;
  fs::remove(copy, ignored);
  return result;
}

// Waits for the child's end at most `limit`, then ends it. Its answer stays in the pipe.
Answer wait_for(int pipe_end, pid_t child, std::chrono::milliseconds limit) {
  const auto end = std::chrono::steady_clock::now() + limit;
  pid_t ended = 0;
  while ((ended = waitpid(child, nullptr, WNOHANG)) == 0 && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (ended == 0) {
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    return answer(RecoveryOutcome::kTimedOut, 0, 0, "the time limit passed");
  }
  Answer a{};
  if (read(pipe_end, &a, sizeof a) == static_cast<ssize_t>(sizeof a)) return a;
  return answer(RecoveryOutcome::kUnreadable, 0, 0, "reading the file crashed the HDF5 library");
}

// Forked from the HDF5 thread itself, so that the child's library is in no half-done state.
RecoveryReport recover_in_child(const std::string& path, const RecoveryOptions& options) {
  RecoveryReport report;
  int ends[2];
  if (pipe(ends) != 0) throw Error("recording_io", "no pipe for the repair");
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    // A killed server must not leave a repair behind that meets the next server's. Its parent may be gone
    // already.
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    const Answer a = recover_here(path);
    const bool told = write(ends[1], &a, sizeof a) == static_cast<ssize_t>(sizeof a);
    _exit(told ? 0 : 1);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw Error("recording_io", "no process for the repair");
  }
  const Answer a = wait_for(ends[0], child, options.time_limit);
  close(ends[0]);
  std::error_code ignored;
  fs::remove(path + ".recovering", ignored);
  fs::remove(path + ".repair", ignored);
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
  thread.run([&] { report = recover_in_child(path, options); });
  return report;
}

}  // namespace truestep
