// `truestep run --csv`: observables over time, one line per sampled step.
#pragma once
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include "engine/session/world/world.h"

namespace truestep {

class SeriesCsv {
 public:
  /// The columns: the chosen ones of what the world can observe.
  struct Choice {
    std::vector<Observation> columns;
    bool has(std::string_view name) const;
    /// The values of the chosen columns.
    Observables of(const Observables& all) const;
  };

  /// Opens the file ("-": standard output) and writes the header: step, time [s], then name [unit] of each
  /// column. Error "write_failed".
  SeriesCsv(const std::string& path, const Choice& choice);
  /// Writes one line; a missing value (a probe's row that no emitter has filled yet) is left empty.
  void add(uint64_t step, double time, const Observables& values);
  /// Error "write_failed" when a write has failed.
  void finish();

 private:
  std::string path_;
  std::vector<Observation> columns_;
  std::ofstream file_;
  std::ostream& out_;
};

/// Matches entries (names or prefixes) against what the world observes; without entries, the scene's list, or
/// everything. Error "bad_request" with an issue per entry that matches nothing.
SeriesCsv::Choice choose_observables(const World& world, const std::vector<std::string>& entries);

}  // namespace truestep
