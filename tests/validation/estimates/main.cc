// estimates [--times N] [--judge] [SCENE...]: what a scene's estimate says of memory and time beside what a
// process of its own needed for its start and some steps, for every scene of the gallery (or those named)
// with N times as much in it. --judge: exit code 1 when memory is beyond 0.7 to 1.5 of the truth and more
// than 64 KiB a system away from it.
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json.h"
#include "engine/session/session.h"
#include "scaled_scene.h"

namespace {

using namespace truestep;

struct Figures {
  double estimated_bytes = 0, bytes = 0, estimated_seconds = 0, seconds = 0, elements = 0, systems = 0;
};

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double allocated() {
  const struct mallinfo2 m = mallinfo2();
  return static_cast<double>(m.uordblks) + static_cast<double>(m.hblkhd);
}

// What the kernel has given at most since `forget_peak`.
double peak_bytes() {
  std::FILE* status = std::fopen("/proc/self/status", "r");
  char line[256];
  double kilobytes = 0;
  while (std::fgets(line, sizeof line, status)) {
    if (std::sscanf(line, "VmHWM: %lf", &kilobytes) == 1) break;
  }
  std::fclose(status);
  return 1024 * kilobytes;
}
void forget_peak() {
  if (std::FILE* f = std::fopen("/proc/self/clear_refs", "w")) {
    std::fputs("5", f);
    std::fclose(f);
  }
}

// What the kernel gives beside what is asked for: pages of the program, the allocator's slack.
constexpr double kCoarse = 8e6;

Figures measure(const boost::json::value& document, double most_seconds) {
  const auto arena = std::make_shared<const ThreadArena>(1);
  Figures f;
  Scene scene = require_scene(read_scene(document));
  const Cost cost = estimate(scene);
  f.estimated_bytes = cost.state_bytes + cost.workspace_bytes;
  f.estimated_seconds = cost.seconds_per_step;
  f.elements = cost.elements;
  f.systems = static_cast<double>(scene.systems.size());
  malloc_trim(0);
  forget_peak();
  const double before = allocated(), peak_before = peak_bytes();
  Session session(std::make_shared<const World>(std::move(scene)), arena, {.history_bytes = 0});
  std::vector<double> took;
  const double start = cpu_seconds();
  constexpr size_t kLeast = 1, kMost = 120;
  while (took.size() < kLeast || (took.size() < kMost && cpu_seconds() - start < most_seconds)) {
    const double begun = cpu_seconds();
    try {
      session.step(1);
    } catch (const Error&) {
      break;  // a scene that is there to fail
    }
    took.push_back(cpu_seconds() - begun);
  }
  const double grown = peak_bytes() - peak_before, held = allocated() - before;
  f.bytes = std::max(held, grown - kCoarse);
  if (!took.empty()) {
    std::nth_element(took.begin(), took.begin() + static_cast<std::ptrdiff_t>(took.size() / 2), took.end());
    f.seconds = took[took.size() / 2];
  }
  return f;
}

// In a process of its own: memory that another scene has left would be used again.
Figures measure_apart(const boost::json::value& document, double most_seconds) {
  int ends[2];
  if (pipe(ends) != 0) throw Error("internal", "no pipe");
  const pid_t child = fork();
  if (child == 0) {
    Figures f;
    try {
      f = measure(document, most_seconds);
    } catch (const std::exception& e) {
      std::fprintf(stderr, "%s\n", e.what());
    }
    const bool written = write(ends[1], &f, sizeof f) == sizeof f;
    _exit(written ? 0 : 1);
  }
  Figures f;
  const bool got = read(ends[0], &f, sizeof f) == sizeof f;
  close(ends[0]), close(ends[1]);
  int status = 0;
  waitpid(child, &status, 0);
  return got && status == 0 ? f : Figures{};
}

}  // namespace

int main(int count, char** arguments) {
  CLI::App app("compares estimates with the truth");
  int times = 1;
  bool judge = false;
  double seconds = 0.3, factor = 1;
  std::vector<std::string> wanted;
  app.add_option("--times", times, "how much of everything");
  app.add_option("--seconds", seconds, "CPU time for a scene's steps");
  app.add_option("--factor", factor, "what estimates are multiplied by, for a control");
  app.add_flag("--judge", judge, "exit code 1 when memory is beyond 0.7 to 1.5 of the truth");
  app.add_option("scenes", wanted, "of the gallery");
  CLI11_PARSE(app, count, arguments);

  // What a handful of rows or a short formula take beside their system is not told apart.
  constexpr double kLeast = 0.7, kMost = 1.5, kSmall = 64 << 10;
  // As the service does: what a large vector leaves when it grows goes back at once.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  int wrong = 0;
  std::printf("%-28s %10s %12s %12s %6s %10s %10s %6s\n", "scene", "elements", "estimated B", "B", "ratio",
              "est. s", "s", "ratio");
  for (const GalleryScene& scene : gallery()) {
    const std::string name(scene.name);
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end()) continue;
    Figures f = measure_apart(scaled_scene(parse_json(scene.text), times), seconds);
    f.estimated_bytes *= factor;
    const double ratio = f.estimated_bytes / f.bytes;
    const bool off = !(ratio >= kLeast && ratio <= kMost) &&
                     !(std::abs(f.estimated_bytes - f.bytes) <= kSmall * f.systems);
    wrong += off;
    std::printf("%-28s %10.0f %12.0f %12.0f %6.2f %10.2e %10.2e %6.2f%s\n", name.c_str(), f.elements,
                f.estimated_bytes, f.bytes, ratio, f.estimated_seconds, f.seconds,
                f.estimated_seconds / f.seconds, off ? "  memory" : "");
    std::fflush(stdout);
  }
  std::printf("%d scenes beyond %.1f to %.1f\n", wrong, kLeast, kMost);
  return judge && wrong > 0 ? 1 : 0;
}
