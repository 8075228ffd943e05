#include "server/cli/run/run.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <optional>
#include <thread>

#include "engine/base/interrupt.h"
#include "engine/scene/admission.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/describe.h"
#include "engine/session/expectation.h"
#include "engine/session/session.h"
#include "engine/session/snapshot/snapshot.h"
#include "engine/studies/precision/accuracy.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"
#include "server/cli/interruption.h"
#include "server/cli/pictures/picture_options.h"
#include "server/cli/progress.h"
#include "server/cli/run/run_outputs.h"
#include "server/cli/run/run_report.h"
#include "server/cli/run/series_csv.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr double kAccuracySeconds = 2;      // CPU time for choosing a method
constexpr size_t kHistoryBytes = 16 << 20;  // to go back when a step fails or is interrupted

struct RunOptions {
  std::string scene, output, picture, csv, from, snapshot, progress = "auto";
  PictureOptions look;
  std::vector<std::string> observe;
  uint64_t every = 1;
  double seconds = -1;
  int64_t steps = -1;
  int threads = 0;
  bool json = false;
};

json::array describe_verdicts(const std::vector<Verdict>& verdicts, Reach reach) {
  json::array a;
  for (const Verdict& v : verdicts) {
    json::object o{{"quantity", v.expected.quantity}, {"met", v.met}};
    if (reach == Reach::cut_short) o["met"] = nullptr, o["not_judged"] = kNotJudged;
    o["measured"] =
        v.measured && std::isfinite(*v.measured) ? json::value(*v.measured) : json::value(nullptr);
    if (v.drift_scale) o["drift"] = *v.drift_scale > 0 ? "relative" : "absolute";
    if (v.drift_scale && *v.drift_scale > 0) o["drift_scale"] = *v.drift_scale;
    if (v.expected.min) o["min"] = *v.expected.min;
    if (v.expected.max) o["max"] = *v.expected.max;
    if (v.expected.equals) o["equals"] = *v.expected.equals, o["tolerance"] = v.expected.tolerance;
    if (!v.expected.source.empty()) o["source"] = v.expected.source;
    a.push_back(std::move(o));
  }
  return a;
}

/// Takes one step, or none if a signal has arrived. An expensive step is taken on a copy of the state, so
/// that one interrupted halfway need not be undone by repeating the run.
bool step_taken(Session& session) try {
  constexpr double kDear = 5e-3;  // s; the copy is a small share of that
  if (session.step_seconds() < kDear) return session.step(1) == 1;
  session.begin_aside();
  session.compute_aside();
  return session.commit_aside(Session::Output::aloud) == StepOutcome::done;
} catch (const Interrupted&) {
  return false;
}

int run(const RunOptions& options) {
  if (!options.picture.empty() && !options.picture.ends_with(".png"))
    throw Error("bad_request", "--picture " + options.picture + ": a picture is a .png file");
  picture_size(options.look);
  DrawList unused;
  aim(options.look, unused);  // reports errors before anything is computed
  const json::value document = load_scene_document(options.scene);
  require_admission(estimate(require_scene(examine_scene(document, kOwnMachine))), kOwnMachine);
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  const auto arena = std::make_shared<const ThreadArena>(threads);
  auto [scene, accuracy] = settle_accuracy(document, kAccuracySeconds, *arena);
  const double dt = scene.header.time.dt;
  const double duration = scene.header.time.duration;
  // Expectations refer to a run from the start of the scene.
  if (!options.from.empty()) scene.header.expect.clear();
  Expectations expectations(scene);

  const auto world = std::make_shared<const World>(std::move(scene));
  Session session(world, arena, {.history_bytes = kHistoryBytes});
  if (!options.from.empty()) session.restore(read_snapshot(*world, load_bytes(options.from)));
  const double seconds = options.seconds >= 0 ? options.seconds : std::max(0.0, duration - session.time());
  const uint64_t steps = options.steps >= 0 ? static_cast<uint64_t>(options.steps)
                                            : static_cast<uint64_t>(std::llround(seconds / dt));
  note_interruptions();  // files already begun are completed
  RunOutputs outputs(session, options.output, {options.picture, options.look});

  const auto start = std::chrono::steady_clock::now();
  Progress progress(progress_style(options.progress), steps);
  const bool every_step = expectations.needs_every_step();
  const SeriesCsv::Choice chosen = choose_observables(*world, options.observe);
  const auto reported = [&](const Observables& all) {
    return options.observe.empty() ? all : chosen.of(all);
  };
  std::optional<SeriesCsv> csv;
  if (!options.csv.empty()) csv.emplace(options.csv, chosen);
  if (csv) csv->add(session.step_index(), session.time(), session.observe());
  if (!expectations.empty()) expectations.add(session.observe(), session.time());
  std::optional<InterruptScope> stoppable(interruption_flag());
  for (uint64_t n = 0; n < steps && !interrupted(); ++n) {
    if (!step_taken(session)) break;
    const bool row = csv && (n + 1) % options.every == 0;
    if (every_step || row) {
      const Observables values =
          every_step ? session.observe()
                     : session.observe([&](std::string_view name) { return chosen.has(name); });
      if (every_step) expectations.add(values, session.time());
      if (row) csv->add(session.step_index(), session.time(), values);
    }
    if (n % 16 == 0) progress.update(n, "");
  }
  stoppable.reset();
  session.examine();
  progress.finish();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!expectations.empty() && !every_step) expectations.add(session.observe(), session.time());

  outputs.finish();
  if (!options.snapshot.empty()) save_bytes(options.snapshot, write_snapshot(*world, session.state()));
  if (csv) csv->finish();

  const auto verdicts = expectations.verdicts();
  const auto& failure = session.failure();
  const Reach reach = session.time() < duration - dt / 2 && !failure ? Reach::cut_short : Reach::whole;
  if (options.json) {
    json::object o{{"scene", session.world().scene().header.name},
                   {"steps", session.step_index()},
                   {"time", session.time()},
                   {"wall_seconds", wall},
                   {"state_hash", hex64(session.hash())},
                   {"observables", describe_observables(reported(session.observe()))},
                   {"expect", describe_verdicts(verdicts, reach)}};
    if (interrupted()) o["interrupted"] = true;
    if (!accuracy.empty()) o["accuracy"] = accuracy;
    if (!session.warnings().empty()) o["warnings"] = describe_warnings(session.warnings());
    if (failure) {
      o["instability"] = describe_failure(*failure);
    }
    std::cout << write_json(o) << '\n';
  } else {
    // When the series goes to standard output, the report goes elsewhere.
    const bool aside = options.csv == "-";
    RunReport report(aside ? std::cerr : std::cout, is_terminal(aside ? STDERR_FILENO : STDOUT_FILENO));
    report.head(session, wall);
    report.values(reported(session.observe()));
    if (!accuracy.empty()) report.chosen(write_json(accuracy.at("chosen")));
    report.verdicts(verdicts, reach);
    for (const SessionWarning& w : session.warnings())
      std::cerr << "warning: system \"" << w.system
                << "\", from t = " << static_cast<double>(w.first_step) * dt << " s: " << w.warning.detail
                << " (the worst so far)\n";
    if (interrupted())
      std::cerr << "interrupted at step " << session.step_index() << "; the requested files are written\n";
    if (failure) {
      std::cerr << "unstable: " << failure->detail << '\n';
    }
  }
  if (failure) return kExitUnstable;
  if (interrupted()) return kExitInterrupted;
  const bool all_met = std::ranges::all_of(verdicts, [](const Verdict& v) { return v.met; });
  return reach == Reach::cut_short || all_met ? kExitOk : kExitMissed;
}

}  // namespace

void add_run_command(Arguments app, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  Arguments c = app.add_subcommand("run", "simulates a scene and reports the results");
  c.add_option("scene", options->scene, "scene file, gallery name, or - for standard input").required();
  const Argument seconds =
      c.add_option("--seconds", options->seconds, "simulated seconds (default: the scene's duration)")
          .in_range(0.0, 1e12)
          .of_time();
  c.add_option("--steps", options->steps, "steps instead of seconds")
      .in_range(int64_t{0}, int64_t{1} << 60)
      .excludes(seconds);
  c.add_option("--from", options->from,
               "snapshot of this scene to continue from; the run then lasts to the scene's duration");
  c.add_option("--snapshot", options->snapshot, "snapshot of the last state to write");
  c.add_option("-o,--output", options->output, "recording to write (.vtkhdf)");
  c.add_option("--picture", options->picture, "picture of the last frame to write (.png)");
  add_picture_options(c, options->look);
  c.add_option("--observe", options->observe,
               "observables to report and to write with --csv: names or their beginnings up to a dot, "
               "separated by commas (default: all; of --csv the scene's list, where it has one)")
      .separated_by(',');
  const Argument csv = c.add_option("--csv", options->csv,
                                    "time series of observables to write (.csv, - for standard output)");
  c.add_option("--every", options->every, "steps from one row of --csv to the next")
      .in_range(uint64_t{1}, uint64_t{1} << 40)
      .needs(csv);
  c.add_option("--threads", options->threads, "threads of the simulation (default: all)").in_range(1, 1024);
  c.add_flag("--json", options->json, "the result as one JSON object on standard output");
  c.add_option("--progress", options->progress, "progress on standard error")
      .one_of({"auto", "plain", "none"});
  c.callback([options, &exit_code] {
    if (options->json && options->csv == "-") {
      throw Error("bad_request", "--json and --csv - would both write to standard output");
    }
    exit_code = run(*options);
  });
}

}  // namespace truestep
