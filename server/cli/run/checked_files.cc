#include "server/cli/run/checked_files.h"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>
#include <thread>

#include "engine/base/interrupt.h"
#include "engine/scene/gallery.h"
#include "engine/studies/check/merge_patch.h"
#include "server/cli/input.h"
#include "server/cli/interruption.h"

namespace truestep {

namespace fs = std::filesystem;
namespace json = boost::json;

std::vector<std::string> scene_files(const std::vector<std::string>& paths) {
  std::vector<std::string> out;
  for (const std::string& path : paths) {
    std::error_code none;
    if (!fs::is_directory(path, none)) {
      require_file(path);
      out.push_back(path);
      continue;
    }
    const size_t before = out.size();
    for (const auto& entry : fs::recursive_directory_iterator(path)) {
      if (entry.is_regular_file() && entry.path().extension() == ".json")
        out.push_back(entry.path().string());
    }
    if (out.size() == before) throw Error("not_found", "there is no scene (*.json) in " + path);
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(before), out.end());
  }
  return out;
}

namespace {

// Follows "scene" down to a scene that has none.
json::value load_based(const std::string& path, int depth = 0) {
  constexpr int kDeepest = 8;
  json::value document = load_scene_document(path);
  const json::object* o = document.if_object();
  const json::value* base = o ? o->if_contains("scene") : nullptr;
  if (!base) return document;
  if (!base->is_string() || depth == kDeepest)
    throw Error(
        "scene_invalid", "\"scene\" names a gallery scene or a file",
        {{"/scene", "wrong_type", "expected the name of a gallery scene, or a path", "", "", "", ""}});
  const std::string name(base->as_string());
  const fs::path file = fs::path(path).parent_path() / name;
  std::error_code none;
  json::value scene = load_based(fs::is_regular_file(file, none) ? file.string() : name, depth + 1);
  document.as_object().erase("scene");
  merge_patch(scene, document);
  return scene;
}

}  // namespace

CheckedFile read_checked(const std::string& path) {
  CheckedFile out{path, nullptr, std::nullopt};
  try {
    out.check = std::make_unique<SceneCheck>(load_based(path));
  } catch (const Error& e) {
    out.error = e;
  }
  return out;
}

bool run_all(std::vector<CheckedFile>& files, int threads) {
  struct Job {
    CheckedFile* file;
    size_t run;
    double seconds;
  };
  std::vector<Job> jobs;
  for (CheckedFile& f : files) {
    for (size_t i = 0; f.check && i < f.check->size(); ++i)
      jobs.push_back({&f, i, estimated_seconds(f.check->trial(i))});
  }
  std::stable_sort(jobs.begin(), jobs.end(),
                   [](const Job& a, const Job& b) { return a.seconds > b.seconds; });
  note_interruptions();
  std::atomic<size_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  const auto work = [&] {
    const InterruptScope stoppable(interruption_flag());
    for (size_t i = next++; i < jobs.size() && !stopped; i = next++) {
      const Job& job = jobs[i];
      try {
        job.file->check->run(job.run);
        const std::lock_guard lock(mutex);
        job.file->cpu_seconds += job.file->check->result(job.run).cpu_seconds;
      } catch (const Interrupted&) {
        stopped = true;
      } catch (const std::exception& e) {
        const std::lock_guard lock(mutex);
        job.file->error = Error("internal", job.file->check->variation(job.run) + ": " + e.what());
      }
    }
  };
  std::vector<std::thread> workers;
  for (int k = 1; k < threads; ++k) workers.emplace_back(work);
  work();
  for (std::thread& w : workers) w.join();
  return !stopped;
}

}  // namespace truestep
