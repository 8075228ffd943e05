// The scenes that courses run through.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "tests/determinism/campaign/course.h"

namespace truestep {

namespace {

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> out;
  std::istringstream in(list);
  for (std::string word; std::getline(in, word, ',');) {
    const size_t begin = word.find_first_not_of(' ');
    if (begin != std::string::npos) out.push_back(word.substr(begin));
  }
  return out;
}

size_t most_rows(const WorldState& state, size_t system) {
  size_t most = 0;
  const State& s = state.systems[system];
  for (size_t c = 0; c < s.columns(); ++c) most = std::max(most, s.rows(static_cast<State::Column>(c)));
  return most;
}

}  // namespace

CourseScene course_scene(std::string name, std::shared_ptr<const World> world) {
  CourseScene scene{std::move(name), std::move(world), {}};
  const WorldState start = scene.world->initial_state();
  for (size_t i = 0; i < scene.world->size(); ++i) {
    CourseScene::Taker taker{scene.world->id(i), most_rows(start, i), {}};
    Command unknown;
    unknown.kind = CommandKind::set_parameter;
    unknown.system = taker.system;
    unknown.index = 0;
    unknown.name = "?";
    WorldState state = start;
    try {
      scene.world->apply(state, unknown);
    } catch (const Error& e) {
      for (const Issue& issue : e.issues()) {
        if (issue.pointer == "/name") taker.parameters = words_of(issue.allowed);
      }
    }
    scene.takers.push_back(std::move(taker));
  }
  return scene;
}

std::vector<CourseScene> course_scenes(const std::string& folder, size_t most_bytes, double most_seconds) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  std::vector<CourseScene> out;
  for (const auto& file : files) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    Scene scene = parse_scene(text.str());
    const Cost cost = estimate(scene);
    if (cost.seconds_per_step > most_seconds || cost.start_seconds > 0.1) continue;
    auto world = std::make_shared<const World>(std::move(scene));
    if (world->initial_state().memory_bytes() > most_bytes) continue;
    out.push_back(course_scene(file.stem().string(), std::move(world)));
  }
  return out;
}

}  // namespace truestep
