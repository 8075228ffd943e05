// estimates [--times N] [--most-bytes B] [--judge memory|time] [--read] [SCENE...]: compares a scene's
// estimates of memory and time with what a separate process needs for its start and some steps, for every
// scene of the gallery (or those named) scaled up N times, or half as often until it needs at most B by its
// estimate.
// --judge memory: exit code 1 if the estimate is outside 0.7 to 1.5 of the truth
// and more than 64 KiB per system off. --judge time: if it is below half of the usual step's time or above
// twice that of the busiest steps, after the median of all scenes has calibrated the machine's speed; a
// benchmark, because other users of the machine's caches change a step's time as much.
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/session/session.h"
#include "scaled_scene.h"
#include "tests/gallery/weighed_memory.h"

namespace {

using namespace truestep;

struct Figures {
  double estimated_bytes = 0, bytes = 0, elements = 0, systems = 0;
  /// Of the busiest steps, and of the median one.
  double estimated_seconds = 0, seconds = 0, usual = 0, steps = 0;
  /// Once the systems are built, and the mean of all steps.
  double built_seconds = 0, mean = 0;
};

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

constexpr size_t kRow = 24;

// A scene's busiest stretch: the largest median of several consecutive steps, without the first, which builds
// what later ones reuse. Before it sources are not full; after it everything sleeps.
double busiest(const std::vector<double>& took) {
  const size_t first = std::min<size_t>(took.size() / 3, 2);
  double most = 0;
  std::vector<double> row;
  for (size_t begin = first; begin == first || begin + kRow <= took.size(); begin += kRow / 2) {
    const size_t end = std::min(begin + kRow, took.size());
    row.assign(took.begin() + static_cast<std::ptrdiff_t>(begin),
               took.begin() + static_cast<std::ptrdiff_t>(end));
    const auto middle = row.begin() + static_cast<std::ptrdiff_t>(row.size() / 2);
    std::nth_element(row.begin(), middle, row.end());
    most = std::max(most, *middle);
  }
  return most;
}

// When to stop weighing a scene.
enum class Until {
  kSeconds,  // after its time
  kSettled  // or once its memory has been constant for half of its steps, well within the allowed range; what
            // is beyond it has six times as long, because a pile may still fall
};

Figures measure(const boost::json::value& document, double most_seconds, Until until) {
  const auto arena = std::make_shared<const ThreadArena>(1);
  Figures f;
  {
    const Scene scene = require_scene(read_scene(document));
    const Cost cost = estimate(scene);
    f.estimated_bytes = cost.state_bytes + cost.workspace_bytes;
    f.estimated_seconds = cost.seconds_per_step;
    f.elements = cost.elements;
    f.systems = static_cast<double>(scene.systems.size());
  }
  // The scene's definition counts: it stays as long as the session.
  testing::WeighedMemory memory(f.estimated_bytes);
  const auto world = std::make_shared<const World>(require_scene(read_scene(document)));
  f.built_seconds = world->cost(world->initial_state()).seconds_per_step;
  Session session(world, arena, {.history_bytes = 0});
  std::vector<double> took;
  const double start = cpu_seconds();
  constexpr size_t kFewest = memory.kFewest, kWeighed = memory.kSteps, kLongest = 600;
  const auto go_on = [&] {
    const double spent = cpu_seconds() - start;
    const double longest = until == Until::kSettled && !memory.within() ? 60 : 10;
    return spent < most_seconds || (took.size() < kWeighed && spent < longest * most_seconds);
  };
  while (took.empty() || (took.size() < kLongest && go_on())) {
    const double begun = cpu_seconds();
    try {
      if (!session.step(1)) break;  // a scene that fails at this size, or is meant to fail
    } catch (const Error&) {
      break;
    }
    took.push_back(cpu_seconds() - begun);
    // Memory after a failure is meaningless: the last weighing before it counts.
    if (took.size() == kWeighed || (took.size() < kWeighed && std::has_single_bit(took.size()))) {
      const bool rests = memory.look();
      const size_t enough = cpu_seconds() - start > most_seconds ? kFewest / 4 : kFewest;
      if (until == Until::kSettled && rests && took.size() >= enough) break;
    }
  }
  f.bytes = memory.bytes();
  if (!took.empty()) {
    f.steps = static_cast<double>(took.size());
    f.seconds = busiest(took);
    f.mean = std::accumulate(took.begin(), took.end(), 0.0) / f.steps;
    std::ranges::sort(took);
    f.usual = took[took.size() / 2];
  }
  return f;
}

// In a process of its own: memory left by another scene would be reused. No systems if the scene cannot be
// scaled that far; empty if the process died.
std::optional<Figures> measure_apart(const boost::json::value& document, double most_seconds, Until until) {
  int ends[2];
  if (pipe(ends) != 0) throw Error("internal", "no pipe");
  const pid_t child = fork();
  if (child == 0) {
    Figures f;
    try {
      f = measure(document, most_seconds, until);
    } catch (const Error& e) {
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
  return got && status == 0 ? std::optional(f) : std::nullopt;
}

// `machine`: speed relative to the machine of the estimates. A step of some microseconds is mostly overhead,
// the first steps build what later ones reuse, and what sleeps or has not started costs nothing: an estimate
// is for a scene at work.
bool time_is_off(const Figures& f, double machine) {
  constexpr double kWhole = 300;  // steps after which the busy ones have occurred
  const double estimated = f.estimated_seconds / machine;
  // Hundreds of small systems in a scene do not stay in the cache, which counts do not reflect.
  constexpr double kMostSystems = 64;
  if (f.steps < kRow || f.seconds <= 20e-6 || f.systems > kMostSystems) return false;
  return !(2 * estimated >= f.usual) || (f.steps >= kWhole && estimated > 2 * f.seconds);
}

// Scaled up `times` times, or half as often, a quarter, ... until it needs at most `most_bytes`. What cannot
// be scaled that far, a scene with a fault, is for the process that measures it to say.
boost::json::value fitting(const boost::json::value& document, int times, double most_bytes) {
  for (;; times /= 2) {
    boost::json::value scaled = scaled_scene(document, times);
    if (times <= 1) return scaled;
    try {
      const Cost cost = estimate(require_scene(read_scene(scaled)));
      if (cost.state_bytes + cost.workspace_bytes <= most_bytes) return scaled;
    } catch (const Error&) {
      return scaled;
    }
  }
}

struct Row {
  const GalleryScene* scene;
  Figures figures;
};

double machine_factor(const std::vector<Row>& rows) {
  std::vector<double> ratios;
  for (const Row& r : rows) ratios.push_back(r.figures.estimated_seconds / r.figures.seconds);
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

// Line by line: a scene in, its figures out, or an empty object when it is refused or the process dies.
int answer_lines(double seconds) {
  std::string line;
  while (std::getline(std::cin, line)) {
    const auto f = measure_apart(parse_json(line), seconds, Until::kSeconds);
    boost::json::object out;
    if (f && f->steps > 0) {
      out = {{"steps", f->steps},
             {"estimated_bytes", f->estimated_bytes},
             {"bytes", f->bytes},
             {"estimated_seconds", f->estimated_seconds},
             {"built_seconds", f->built_seconds},
             {"seconds", f->mean},
             {"usual_seconds", f->usual},
             {"busiest_seconds", f->seconds}};
    }
    std::cout << out << std::endl;
  }
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  CLI::App app("compares estimates with the truth");
  int times = 1;
  std::string judge;
  double seconds = 0.3, factor = 1, most_bytes = std::numeric_limits<double>::infinity();
  std::vector<std::string> wanted;
  bool read = false;
  app.add_option("--times", times, "how much of everything");
  app.add_option("--most-bytes", most_bytes, "scenes that would need more are scaled up less");
  app.add_option("--seconds", seconds, "CPU time for a scene's steps");
  app.add_option("--factor", factor, "what estimates of memory are multiplied by, for a control");
  app.add_option("--judge", judge, "exit code 1 when an estimate is beyond its bounds")
      ->check(CLI::IsMember({"memory", "time"}));
  app.add_option("scenes", wanted, "of the gallery");
  app.add_flag("--read", read,
               "reads scenes from the standard input, one a line, and prints a line of figures for each");
  CLI11_PARSE(app, count, arguments);
  testing::return_large_blocks();
  if (read) return answer_lines(seconds);

  const auto figures = [&](const GalleryScene& scene) {
    const auto measured = measure_apart(fitting(parse_json(scene.text), times, most_bytes), seconds,
                                        judge == "memory" ? Until::kSettled : Until::kSeconds);
    if (!measured) std::printf("%s: the process died\n", scene.name.data()), std::exit(1);
    Figures f = *measured;
    f.estimated_bytes *= factor;
    return f;
  };
  std::vector<Row> rows;
  for (const GalleryScene& scene : gallery()) {
    if (!wanted.empty() && std::ranges::find(wanted, scene.name) == wanted.end()) continue;
    const Figures f = figures(scene);
    if (f.systems > 0) rows.push_back({&scene, f});  // a few cannot be scaled that far
  }
  if (rows.empty()) return 1;
  const double machine = machine_factor(rows);

  size_t wrong = 0;
  std::printf("%-28s %10s %12s %12s %6s %10s %10s %6s %5s\n", "scene", "elements", "estimated B", "B",
              "ratio", "est. s", "s", "ratio", "steps");
  for (size_t k = 0; k < rows.size(); ++k) {
    Figures& f = rows[k].figures;
    // Disturbances by other programs at one moment rarely recur at three.
    for (int again = 0; again < 2 && judge == "time" && time_is_off(f, machine); ++again) {
      f = figures(*rows[k].scene);
    }
    const bool memory = testing::memory_is_off(f.estimated_bytes, f.bytes, f.systems),
               time = time_is_off(f, machine);
    wrong += (judge != "time" && memory) || (judge != "memory" && time);
    std::printf(
        "%-28s %10.0f %12.0f %12.0f %6.2f %10.2e %10.2e %6.2f %5.0f%s%s\n", rows[k].scene->name.data(),
        f.elements, f.estimated_bytes, f.bytes, f.estimated_bytes / f.bytes, f.estimated_seconds, f.seconds,
        f.estimated_seconds / f.seconds / machine, f.steps, memory ? "  memory" : "", time ? "  time" : "");
  }
  std::printf(
      "%zu of %zu scenes are beyond 0.7 to 1.5 of their memory or half to twice the time of steps at work%s "
      "(this machine: %.2f)\n",
      wrong, rows.size(), judge.empty() ? "" : (", of which " + judge + " is judged").c_str(), machine);
  return !judge.empty() && wrong > 0 ? 1 : 0;
}
