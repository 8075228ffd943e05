// Random scenes and invariants that hold for all of them: energy never above the initial energy plus what
// drives added, momentum conserved where nothing acts from outside, no deep overlaps, no non-finite value,
// nothing asleep that would move, and the scene's own `expect`. Scenes are JSON and go through the ordinary
// scene parser, at defaults except for what is drawn. A family and a seed always give the same scene.
#pragma once
#include <boost/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/stability/campaign/dice.h"

namespace truestep::campaign {

/// How a trial is judged, besides the scene's `expect`.
struct Rules {
  /// Largest fraction of the energy at work by which the total may exceed that at the start. At work are the
  /// initial kinetic energy, the most that falling releases, and `stored`.
  std::optional<double> gain = 0.01;
  /// Largest fraction that may be lost; empty: any.
  std::optional<double> loss;
  double stored = 0;  ///< J that springs hold at the start, whether the observable energy counts them or not
  double drives = 0;  ///< J that motors, emitters and the lift out of an overlap at the start can give
  /// Closed systems: kg m/s and kg m^2/s by which the totals may change; empty: not closed.
  std::optional<double> momentum, angular_momentum;
  /// m that a body found asleep may move within 0.4 s of being woken; empty: sleep is not judged.
  std::optional<double> still;
  /// Whether the run may end with an instability event, the proper answer if no step of this size is stable.
  enum class Event : uint8_t { fault, allowed } event = Event::fault;
  /// Whether expectations may be missed where a warning says that nothing holds what falls.
  Event unheld = Event::fault;
};

struct Trial {
  std::string family;
  uint64_t seed = 0;
  boost::json::object scene;
  Rules rules;
};

struct Finding {
  std::string kind;  ///< a quantity that was missed, or: instability, not_finite, still, refused, invalid
  std::string detail;
};
struct Outcome {
  std::vector<Finding> findings;
  std::optional<std::string> event;  ///< how it ended, when that was allowed
  double cpu_seconds = 0;
};

struct Family {
  const char* name;
  void (*make)(Dice&, Trial&);
  /// Some of its scenes still have findings: it is judged only when it is named.
  bool open = false;
};
std::span<const Family> families();

Trial make_trial(const Family& family, uint64_t seed);
/// The family of that name; there must be one.
Trial make_trial(std::string_view family, uint64_t seed);
/// Gives the first system this method.
void set_integrator(Trial& trial, const std::string& name);
/// Gives all systems of rigid bodies this precision.
void set_precision(Trial& trial, const std::string& name);
/// The scene with its rules as a test, which `truestep check` judges: a trial that found something is kept
/// so.
boost::json::object document(const Trial& trial);
Outcome judge(const Trial& trial);
/// "family, seed: kind: detail" of every finding, a line each; empty when all is well.
std::string report(const Trial& trial, const Outcome& outcome);

}  // namespace truestep::campaign
