// What should stand, and for how long: how far the top of a scene has moved sideways and down after 5, 20, 60
// and 120 s, what still moves then, and after how many seconds everything sleeps if it may. The same measure
// for every engine.
#pragma once
#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/sleep.h"

namespace truestep::bench {

inline constexpr int kStepsPerSecond = 60;
inline constexpr int kStandingSeconds[] = {5, 20, 60, 120};
/// s within which everything must sleep to count as sleeping.
inline constexpr int kSleepSeconds = 60;

/// Position of a body: across and up.
struct Spot {
  double x, y, up;
};

/// Measurable state of a scene on an engine.
struct Standing {
  std::string scene, engine;
  int settle = 0;
  std::optional<size_t> top = {};  ///< absent: the body that moved farthest counts
};

/// Prints the results, a line of JSON for each time. `step()` is one sixtieth of a second, `spots()` gives a
/// Spot for each moving body, `kinetic()` the energy in J.
template <class Step, class Spots, class Kinetic>
void watch_standing(const Standing& s, Step step, Spots spots, Kinetic kinetic) {
  for (int k = 0; k < s.settle; ++k) step();
  const std::vector<Spot> start = spots();
  int done = 0;
  for (const int seconds : kStandingSeconds) {
    for (; done < seconds * kStepsPerSecond; ++done) step();
    const std::vector<Spot> now = spots();
    double drift = 0, sinking = 0;
    for (size_t i = 0; i < now.size(); ++i) {
      if (s.top && i != *s.top) continue;
      drift = std::max(drift, std::hypot(now[i].x - start[i].x, now[i].y - start[i].y));
      sinking = std::max(sinking, std::abs(start[i].up - now[i].up));
    }
    std::cout << boost::json::object{{"scene", s.scene}, {"engine", s.engine}, {"seconds", seconds},
                                     {"drift", drift},   {"sinking", sinking}, {"kinetic", kinetic()}}
              << std::endl;
  }
}

/// Prints when everything slept, as JSON; null if it did not.
template <class Step, class AllAsleep>
void watch_sleep(const Standing& s, Step step, AllAsleep all_asleep) {
  for (int k = 0; k < s.settle; ++k) step();
  boost::json::value at;
  for (int done = 0; done <= kSleepSeconds * kStepsPerSecond; ++done) {
    if (all_asleep()) {
      at = static_cast<double>(done) / kStepsPerSecond;
      break;
    }
    step();
  }
  std::cout << boost::json::object{{"scene", s.scene}, {"engine", s.engine}, {"sleeps", at}} << std::endl;
}

}  // namespace truestep::bench
