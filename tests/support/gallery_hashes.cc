// gallery_hashes FOLDER [NAME...]: prints, for every scene of a folder (or those named), its name, 40 and its
// state's hash after so many steps, on which all builds must agree; 8 steps if the state is large, because
// one of the builds may be slow. `--all-steps` instead of a name: 40 of all.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <sstream>
#include <vector>

#include "engine/base/errors.h"
#include "engine/session/session.h"

namespace {

constexpr uint64_t kSteps = 40, kFewSteps = 8;
constexpr size_t kLarge = 64 << 10;  // bytes of a state

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

}  // namespace

int main(int count, char** words) {
  if (count < 2) {
    std::cerr << "gallery_hashes FOLDER [--all-steps] [NAME...]\n";
    return 2;
  }
  std::set<std::string> wanted(words + 2, words + count);
  const bool all_steps = wanted.erase("--all-steps") > 0;
  std::vector<std::filesystem::path> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(words[1])) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() == ".json" && (wanted.empty() || wanted.contains(file.stem())))
      scenes.push_back(file);
  }
  std::sort(scenes.begin(), scenes.end());
  const auto arena = std::make_shared<const truestep::ThreadArena>(1);
  for (const auto& file : scenes) {
    const auto world = std::make_shared<const truestep::World>(truestep::parse_scene(text_of(file)));
    truestep::Session session(world, arena, {.history_bytes = 0});
    const bool large = session.state().serialize().size() > kLarge;
    const uint64_t steps = large && !all_steps ? kFewSteps : kSteps;
    session.step(steps);
    std::cout << file.stem().string() << ' ' << steps << ' ' << std::hex << session.hash() << std::dec
              << '\n';
  }
}
