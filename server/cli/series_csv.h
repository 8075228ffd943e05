// `truestep run --csv`: observables over time, one line per sampled step.
#pragma once
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include "engine/session/world.h"

namespace truestep {

class SeriesCsv {
 public:
  /// The columns: everything that is chosen of what the world can observe.
  struct Choice {
    std::vector<Observation> columns;
    /// Values of the chosen ones only.
    Observables of(const Observables& all) const;
  };

  /// Opens the file ("-": standard output) and writes the header: step, time [s], then name [unit] of each
  /// column. Error "write_failed".
  SeriesCsv(const std::string& path, const Choice& choice);
  /// One line; a value that there is not (the row of a probe that no emitter has filled yet) is left empty.
  void add(uint64_t step, double time, const Observables& values);
  /// Error "write_failed" when something could not be written.
  void finish();

 private:
  std::string path_;
  std::vector<Observation> columns_;
  std::ofstream file_;
  std::ostream& out_;
};

/// Entries (names or their beginnings) against what the world observes; none: the scene's list, or all. Error
/// "bad_request" with an issue per entry that means nothing.
SeriesCsv::Choice choose_observables(const World& world, const std::vector<std::string>& entries);

}  // namespace truestep
