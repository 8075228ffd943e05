// Prints, for every scene of a folder, its name and its state's hash after 40 steps, on which all builds must
// agree. Or the first half of that in one process, which saves the states, and the other half in another.
// `short` is for slow builds: 8 steps if the state is large. `both` prints from one run what would be printed
// without a word and, in lines that begin with `short`, what would be printed with that word.
//   gallery_hashes FOLDER THREADS [short | both]
//   gallery_hashes FOLDER THREADS save | resume STATES
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
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

std::vector<std::byte> bytes_of(const std::filesystem::path& file) {
  const std::string text = text_of(file);
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::string line(const std::filesystem::path& file, uint64_t steps, const truestep::Session& session) {
  std::ostringstream text;
  text << file.stem().string() << ' ' << steps << ' ' << std::hex << session.hash() << '\n';
  return text.str();
}

// A scene that is meant to fail ends at its last good step, which is part of the comparison.
uint64_t run(truestep::Session& session, uint64_t steps) {
  try {
    session.step(steps);
  } catch (const truestep::Error&) {
  }
  return session.step_index();
}

}  // namespace

int main(int count, char** words) {
  const std::string_view mode = count > 3 ? words[3] : "";
  const int words_of_mode = mode == "save" || mode == "resume"  ? 2
                            : mode == "short" || mode == "both" ? 1
                                                                : 0;
  if (count != 3 + words_of_mode) {
    std::cerr << "gallery_hashes FOLDER THREADS [short | both | save STATES | resume STATES]\n";
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
    if (mode == "save") {
      run(session, kSteps / 2);
      const auto bytes = session.state().serialize();
      std::ofstream(std::filesystem::path(words[4]) / file.stem(), std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      continue;
    }
    if (mode == "resume")
      session.restore(
          truestep::WorldState::deserialize(bytes_of(std::filesystem::path(words[4]) / file.stem())));
    const bool large = session.state().serialize().size() > kLarge;
    if (mode == "both" && large) std::cout << "short " << line(file, run(session, kFewSteps), session);
    const uint64_t steps = mode == "short" && large ? kFewSteps : kSteps;
    const std::string last = line(file, run(session, steps - session.step_index()), session);
    std::cout << last;
    if (mode == "both" && !large) std::cout << "short " << last;
  }
}
