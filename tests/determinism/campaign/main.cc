// courses FOLDER [--count N] [--first SEED] [--scene NAME] [--show]: random courses through sessions of a
// folder's scenes, in turn. Prints what differs with the course that led there, and a table. Exit code 1 if
// anything does.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <map>

#include "tests/determinism/campaign/course.h"

int main(int count, char** arguments) {
  using namespace truestep;
  CLI::App app("random courses through sessions");
  std::string folder, wanted;
  uint64_t courses = 500, first = 0;
  double most_seconds = 1.5e-3, most_kilobytes = 256;
  bool show = false;
  app.add_option("folder", folder, "of scenes")->required();
  app.add_option("--count", courses, "how many courses");
  app.add_option("--first", first, "the first seed");
  app.add_option("--scene", wanted, "only of this scene");
  app.add_option("--most-seconds", most_seconds, "of scenes whose step is estimated to take at most this");
  app.add_option("--most-kilobytes", most_kilobytes, "of scenes with states of at most this size");
  app.add_flag("--show", show, "prints every course");
  CLI11_PARSE(app, count, arguments);

  auto scenes = course_scenes(folder, static_cast<size_t>(most_kilobytes * 1024), most_seconds);
  if (!wanted.empty()) std::erase_if(scenes, [&](const CourseScene& s) { return s.name != wanted; });
  if (scenes.empty()) {
    std::cerr << "no scene is left\n";
    return 2;
  }
  const CourseThreads threads{std::make_shared<const ThreadArena>(1), std::make_shared<const ThreadArena>(2)};
  size_t commands = 0, refused = 0, seeks = 0, branches = 0, restores = 0, differ = 0;
  std::map<std::string, size_t> by_scene;
  for (uint64_t k = 0; k < courses; ++k) {
    const CourseScene& scene = scenes[k % scenes.size()];
    const Course course = run_course(scene, first + k, threads);
    commands += course.commands, refused += course.refused, seeks += course.seeks;
    branches += course.branches, restores += course.restores;
    if (course.fault.empty() && !show) continue;
    std::cout << course.scene << " --first " << course.seed << ": " << course.fault << '\n';
    for (const std::string& deed : course.deeds) std::cout << "    " << deed << '\n';
    if (course.fault.empty()) continue;
    ++differ, ++by_scene[course.scene];
  }
  std::printf(
      "%llu courses of %zu scenes: %zu commands, %zu refused, %zu seeks, %zu branches, %zu restores; %zu "
      "differ\n",
      static_cast<unsigned long long>(courses), scenes.size(), commands, refused, seeks, branches, restores,
      differ);
  for (const auto& [name, n] : by_scene) std::printf("  %s %zu\n", name.c_str(), n);
  return differ > 0;
}
