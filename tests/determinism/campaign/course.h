// Random courses through a session: steps, commands that are carried out and commands that are refused,
// seeks, branches, snapshots, restores and resets, in any order. Judged by what one run promises: whichever
// way a step is reached, it has one hash; a refused command changes nothing; and the bundle repeats on other
// threads.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "engine/session/session.h"
#include "engine/session/snapshot/sealed.h"

namespace truestep {

struct Course {
  std::string scene;               ///< of which it was
  uint64_t seed = 0;               ///< with which it is repeated
  std::vector<std::string> deeds;  ///< what was done, one line each
  size_t commands = 0, refused = 0, seeks = 0, branches = 0, restores = 0;
  std::string fault;  ///< what differs; empty: nothing
  Bytes bundle;       ///< at its end; empty when the session had failed
};

/// A scene as courses need it, with the commands that its systems understand.
struct CourseScene {
  std::string name;
  std::shared_ptr<const World> world;
  struct Taker {
    std::string system;
    size_t rows = 0;
    std::vector<std::string> parameters;
  };
  std::vector<Taker> takers;
};

/// Asks every system which parameters it takes.
CourseScene course_scene(std::string name, std::shared_ptr<const World> world);

/// The threads that a course and its repetition run on.
struct CourseThreads {
  std::shared_ptr<const ThreadArena> one, many;
};

Course run_course(const CourseScene& scene, uint64_t seed, const CourseThreads& threads);

/// Scenes of a folder with states of at most this many bytes and steps of at most so many estimated seconds.
std::vector<CourseScene> course_scenes(const std::string& folder, size_t most_bytes, double most_seconds);

}  // namespace truestep
