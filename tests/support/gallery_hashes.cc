// Prints, for every scene of a folder, its name and its state's hash after 40 steps: what all builds must
// agree on.
//   gallery_hashes FOLDER THREADS
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <vector>

#include "engine/base/errors.h"
#include "engine/session/session.h"

namespace {

constexpr uint64_t kSteps = 40;

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// A scene that is there to fail ends at its last good step, which belongs to what is compared.
uint64_t run(truestep::Session& session) {
  try {
    session.step(kSteps);
  } catch (const truestep::Error&) {
  }
  return session.step_index();
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::cerr << "gallery_hashes FOLDER THREADS\n";
    return 2;
  }
  std::vector<std::filesystem::path> scenes;
  for (const auto& entry : std::filesystem::directory_iterator(words[1])) scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  const auto arena = std::make_shared<const truestep::ThreadArena>(std::atoi(words[2]));
  for (const auto& file : scenes) {
    if (file.extension() != ".json") continue;
    const auto world = std::make_shared<const truestep::World>(truestep::parse_scene(text_of(file)));
    truestep::Session session(world, arena);
    const uint64_t steps = run(session);
    std::cout << file.stem().string() << ' ' << steps << ' ' << std::hex << session.hash() << std::dec
              << '\n';
  }
}
