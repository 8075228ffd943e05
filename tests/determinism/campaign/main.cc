// courses FOLDER [--count N] [--first SEED] [--scene NAME] [--patience S] [--show]: random courses through
// sessions of a folder's scenes, in turn. Prints what differs with the course that led there, and a table.
// Exit code 1 if anything does.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <thread>

#include "engine/base/interrupt.h"
#include "tests/determinism/campaign/course.h"

namespace {

using namespace truestep;

/// Stops a course that a command has made too slow: a G of ten times lets bodies orbit each other in no time.
class Watch {
 public:
  explicit Watch(double seconds)
      : thread_([this, seconds] {
          std::unique_lock lock(mutex_);
          if (!ended_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return done_; }))
            interrupt_.raise();
        }) {}
  ~Watch() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    ended_.notify_one();
    thread_.join();
  }
  const Interrupt& interrupt() const { return interrupt_; }

 private:
  Interrupt interrupt_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;
  std::thread thread_;
};

/// Whether a process of its own, on two threads, repeats the bundle.
bool repeats(const std::string& program, const Bytes& bundle) {
  const auto file =
      std::filesystem::temp_directory_path() / ("course-" + std::to_string(::getpid()) + ".bundle");
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(bundle.data()), static_cast<std::streamsize>(bundle.size()));
  const std::string command =
      '"' + program + "\" replay --threads 2 \"" + file.string() + "\" >/dev/null 2>&1";
  const bool same = std::system(command.c_str()) == 0;
  std::filesystem::remove(file);
  return same;
}

}  // namespace

int main(int count, char** arguments) {
  CLI::App app("random courses through sessions");
  std::string folder, wanted, program;
  uint64_t courses = 500, first = 0;
  double most_seconds = 1.5e-3, most_kilobytes = 256, patience = 20;
  bool show = false;
  app.add_option("folder", folder, "of scenes")->required();
  app.add_option("--count", courses, "how many courses");
  app.add_option("--first", first, "the first seed");
  app.add_option("--scene", wanted, "only of this scene");
  app.add_option("--most-seconds", most_seconds, "of scenes whose step is estimated to take at most this");
  app.add_option("--most-kilobytes", most_kilobytes, "of scenes with states of at most this size");
  app.add_option("--fresh", program,
                 "the program truestep, which repeats every course's bundle in a process of its own");
  app.add_option("--patience", patience, "seconds after which a course is given up, and counted");
  app.add_flag("--show", show, "prints every course");
  CLI11_PARSE(app, count, arguments);

  auto scenes = course_scenes(folder, static_cast<size_t>(most_kilobytes * 1024), most_seconds);
  if (!wanted.empty()) std::erase_if(scenes, [&](const CourseScene& s) { return s.name != wanted; });
  if (scenes.empty()) {
    std::cerr << "no scene is left\n";
    return 2;
  }
  const CourseThreads threads{std::make_shared<const ThreadArena>(1), std::make_shared<const ThreadArena>(2)};
  size_t commands = 0, refused = 0, seeks = 0, branches = 0, restores = 0, differ = 0, slow = 0;
  std::map<std::string, size_t> by_scene;
  for (uint64_t k = 0; k < courses; ++k) {
    const CourseScene& scene = scenes[k % scenes.size()];
    const Watch watch(patience);
    const InterruptScope scope(watch.interrupt());
    Course course = run_course(scene, first + k, threads);
    if (watch.interrupt().raised()) {
      // What was interrupted is no state to be compared.
      course.fault.clear();
      ++slow;
      std::cout << course.scene << " --first " << course.seed << " is slow: " << course.deeds.back()
                << std::endl;
    }
    if (course.fault.empty() && !program.empty() && !course.bundle.empty() &&
        !repeats(program, course.bundle))
      course.fault = "a fresh process";
    commands += course.commands, refused += course.refused, seeks += course.seeks;
    branches += course.branches, restores += course.restores;
    if (course.fault.empty() && !show) continue;
    std::cout << course.scene << " --first " << course.seed << ": " << course.fault << '\n';
    for (const std::string& deed : course.deeds) std::cout << "    " << deed << std::endl;
    if (course.fault.empty()) continue;
    ++differ, ++by_scene[course.scene];
  }
  std::printf(
      "%llu courses of %zu scenes: %zu commands, %zu refused, %zu seeks, %zu branches, %zu restores; %zu "
      "given up, %zu differ\n",
      static_cast<unsigned long long>(courses), scenes.size(), commands, refused, seeks, branches, restores,
      slow, differ);
  for (const auto& [name, n] : by_scene) std::printf("  %s %zu\n", name.c_str(), n);
  return differ > 0;
}
