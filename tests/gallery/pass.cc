// gallery_pass SCENE.json [--golden FILE] [--control expect|golden|memory|threads|resumed|picture]:
// everything that a scene of the gallery promises, by two starts, each in a process of its own. The first
// runs its duration with one thread: what it expects to measure, its memory beside its estimate, hashes on
// the way, its state at two fifths. The second has eight threads: the first steps once more, then on from the
// saved state; its hashes are those of the first, and the picture of that state shows what it is about. FILE
// has lines `name hash`: after 40 steps (or the last, of shorter scenes), for scenes whose hash is committed.
// --control alters one thing; exit code 0 if that is found and nothing else.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>

#include "tests/gallery/starts.h"

namespace {

using namespace truestep::gallery_pass;

/// What `start` finds in a process of its own; a process that dies finds everything.
template <class Start>
unsigned found_apart(Marks& marks, Start start) {
  std::cout.flush();
  const pid_t child = fork();
  if (child == 0) {
    try {
      marks.found |= start();
    } catch (const std::exception& e) {
      std::cout << e.what() << '\n';
      marks.found |= kDied;
    }
    std::cout.flush();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (child < 0 || status != 0) {
    std::cout << "the process died with status " << status << '\n';
    marks.found |= kDied;
  }
  return marks.found;
}

unsigned control_of(const std::string& name) {
  for (unsigned k = 0; k < std::size(kNames); ++k) {
    if (name == kNames[k]) return 1U << k;
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  Wish wish;
  for (int k = 2; k + 1 < count; k += 2) {
    const std::string_view option = words[k];
    if (option == "--golden") wish.golden = words[k + 1];
    if (option == "--control") wish.control = control_of(words[k + 1]);
  }
  if (count < 2 || count % 2 != 0) {
    std::cerr << "gallery_pass SCENE.json [--golden FILE] [--control "
                 "expect|golden|memory|threads|resumed|picture]\n";
    return 2;
  }
  wish.scene = words[1];
  std::string folder = std::filesystem::temp_directory_path() / "truestep_gallery_XXXXXX";
  if (!mkdtemp(folder.data())) return std::perror("no temporary folder"), 2;
  wish.state = std::filesystem::path(folder) / "state";
  // Both processes write here.
  void* shared = mmap(nullptr, sizeof(Marks), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) return std::perror("no shared memory"), 2;
  Marks& marks = *new (shared) Marks;
  if (!(found_apart(marks, [&] { return first_start(wish, marks); }) & kDied)) {
    found_apart(marks, [&] { return second_start(wish, marks); });
  }
  std::filesystem::remove_all(folder);
  if (wish.control) return marks.found == wish.control ? 0 : 1;
  return marks.found ? 1 : 0;
}
