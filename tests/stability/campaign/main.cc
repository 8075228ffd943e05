// campaign [--seeds N] [--first SEED] [--family NAME] [--integrator NAME] [--precision NAME] [--scene]:
// judges N random scenes of each family (default 10), prints the findings, one per line, and a table of
// families. --integrator gives their first systems this method, --precision all systems of bodies this one.
// --scene prints the scenes with their tests instead, one JSON document per line: what found something is
// kept below tests/scenes, for `truestep check`. Exit code 1 if anything was found.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <map>

#include "engine/scene/json/json_write.h"
#include "tests/stability/campaign/campaign.h"

int main(int count, char** arguments) {
  using namespace truestep::campaign;
  CLI::App app("judges random scenes");
  uint64_t seeds = 10, first = 0;
  std::string wanted, integrator, precision;
  bool print_scenes = false;
  app.add_option("--seeds", seeds, "how many scenes of each family");
  app.add_option("--first", first, "the first seed");
  app.add_option("--family", wanted, "only scenes of families whose names begin so");
  app.add_option("--integrator", integrator, "the method of the scenes' first systems");
  app.add_option("--precision", precision, "of all systems of rigid bodies: f32 or f64");
  app.add_flag("--scene", print_scenes, "prints the scenes instead of judging them");
  CLI11_PARSE(app, count, arguments);

  struct Row {
    int scenes = 0, found = 0, events = 0;
    double seconds = 0;
    std::map<std::string, int> kinds = {};
  };
  std::map<std::string, Row> table;
  int found = 0;
  for (uint64_t k = 0; k < seeds * families().size(); ++k) {
    const Family& family = families()[k % families().size()];
    if (wanted.empty() ? family.open : !std::string_view(family.name).starts_with(wanted)) continue;
    Trial trial = make_trial(family, first + k / families().size());
    if (!integrator.empty()) set_integrator(trial, integrator);
    if (!precision.empty()) set_precision(trial, precision);
    if (print_scenes) {
      std::cout << truestep::write_json(document(trial)) << '\n';
      continue;
    }
    const Outcome outcome = judge(trial);
    std::cout << report(trial, outcome) << std::flush;
    Row& row = table[trial.family];
    ++row.scenes, row.found += !outcome.findings.empty(), row.events += outcome.event.has_value();
    row.seconds += outcome.cpu_seconds;
    for (const Finding& f : outcome.findings) ++row.kinds[f.kind];
    found += !outcome.findings.empty();
  }
  if (print_scenes) return 0;
  std::printf(
      "\n| family | scenes | with findings | ended by an allowed event | CPU s | findings |\n"
      "| --- | --- | --- | --- | --- | --- |\n");
  for (const auto& [name, row] : table) {
    std::printf("| %s | %d | %d | %d | %.1f |", name.c_str(), row.scenes, row.found, row.events, row.seconds);
    for (const auto& [kind, n] : row.kinds) std::printf(" %s %d", kind.c_str(), n);
    std::printf(" |\n");
  }
  return found ? 1 : 0;
}
