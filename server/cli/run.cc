#include "server/cli/run.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include "engine/scene/admission.h"
#include "engine/scene/json_write.h"
#include "engine/session/describe.h"
#include "engine/session/expectation.h"
#include "engine/session/session.h"
#include "engine/studies/accuracy.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"
#include "server/cli/progress.h"
#include "server/cli/run_outputs.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr double kAccuracySeconds = 2;  // CPU time for choosing a method

struct RunOptions {
  std::string scene, output, picture, show, hashes, progress = "auto";
  double seconds = -1;
  int64_t steps = -1;
  int threads = 0;
  bool json = false;
};

void print_verdicts(const std::vector<Verdict>& verdicts) {
  for (const Verdict& v : verdicts) {
    std::cout << (v.met ? "ok      " : "MISSED  ") << v.expected.quantity << " = ";
    if (v.measured)
      std::cout << *v.measured;
    else
      std::cout << "(no such quantity)";
    if (v.expected.min) std::cout << ", at least " << *v.expected.min;
    if (v.expected.max) std::cout << ", at most " << *v.expected.max;
    if (v.expected.equals) std::cout << ", expected " << *v.expected.equals << " +- " << v.expected.tolerance;
    std::cout << '\n';
  }
}

json::array describe_verdicts(const std::vector<Verdict>& verdicts) {
  json::array a;
  for (const Verdict& v : verdicts) {
    json::object o{{"quantity", v.expected.quantity}, {"met", v.met}};
    o["measured"] =
        v.measured && std::isfinite(*v.measured) ? json::value(*v.measured) : json::value(nullptr);
    if (v.expected.min) o["min"] = *v.expected.min;
    if (v.expected.max) o["max"] = *v.expected.max;
    if (v.expected.equals) o["equals"] = *v.expected.equals, o["tolerance"] = v.expected.tolerance;
    if (!v.expected.source.empty()) o["source"] = v.expected.source;
    a.push_back(std::move(o));
  }
  return a;
}

int run(const RunOptions& options) {
  const json::value document = load_scene_document(options.scene);
  require_admission(estimate(require_scene(read_scene(document))),
                    AdmissionLimits{.memory_bytes = 16e9, .elements = 1e9, .seconds_per_step = 1e6});
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  const auto arena = std::make_shared<const ThreadArena>(threads);
  auto [scene, accuracy] = settle_accuracy(document, kAccuracySeconds, *arena);
  const double dt = scene.header.time.dt;
  const double seconds = options.seconds >= 0 ? options.seconds : scene.header.time.duration;
  const uint64_t steps = options.steps >= 0 ? static_cast<uint64_t>(options.steps)
                                            : static_cast<uint64_t>(std::llround(seconds / dt));
  Expectations expectations(scene);

  const auto world = std::make_shared<const World>(std::move(scene));
  Session session(world, arena, {.history_bytes = 0});
  RunOutputs outputs(session, options.output, {options.picture, options.show});

  const auto start = std::chrono::steady_clock::now();
  Progress progress(options.progress == "none"    ? Progress::Style::none
                    : options.progress == "plain" ? Progress::Style::plain
                                                  : Progress::Style::automatic,
                    steps);
  const bool every_step = expectations.needs_every_step();
  if (!expectations.empty()) expectations.add(session.observe());
  for (uint64_t n = 0; n < steps; ++n) {
    if (session.step(1) == 0) break;
    if (every_step) expectations.add(session.observe());
    if (n % 16 == 0) progress.update(n, "");
  }
  progress.finish();
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!expectations.empty() && !every_step) expectations.add(session.observe());

  outputs.finish();

  const auto verdicts = expectations.verdicts();
  const auto& failure = session.failure();
  if (options.json) {
    json::object o{{"scene", session.world().scene().header.name},
                   {"steps", session.step_index()},
                   {"time", session.time()},
                   {"wall_seconds", wall},
                   {"state_hash", hex64(session.hash())},
                   {"observables", describe_observables(session.observe())},
                   {"expect", describe_verdicts(verdicts)}};
    if (!accuracy.empty()) o["accuracy"] = accuracy;
    if (failure) {
      o["instability"] = describe_failure(*failure);
    }
    std::cout << write_json(o) << '\n';
  } else {
    std::cout << "steps   " << session.step_index() << "\ntime    " << session.time() << " s\nwall    "
              << wall << " s\nhash    " << hex64(session.hash()) << '\n';
    const Observables final_values = session.observe();
    for (const Observation& v : final_values.rows())
      std::cout << v.name << " = " << v.value << ' ' << v.unit << '\n';
    if (!accuracy.empty()) std::cout << "chosen  " << write_json(accuracy.at("chosen")) << '\n';
    print_verdicts(verdicts);
    if (failure) {
      std::cerr << "unstable: " << failure->detail << '\n';
    }
  }
  for (const Verdict& v : verdicts) {
    if (!v.met) return failure ? kExitUnstable : kExitMissed;
  }
  return failure ? kExitUnstable : kExitOk;
}

}  // namespace

void add_run_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* c = app.add_subcommand("run", "simulates a scene and says what came out");
  c->add_option("scene", options->scene, "scene file, gallery name, or - for standard input")->required();
  auto* seconds =
      c->add_option("--seconds", options->seconds, "simulated seconds (default: the scene's duration)")
          ->check(CLI::Range(0.0, 1e12));
  c->add_option("--steps", options->steps, "steps instead of seconds")
      ->check(CLI::Range(int64_t{0}, int64_t{1} << 60))
      ->excludes(seconds);
  c->add_option("-o,--output", options->output, "recording to write (.vtkhdf)");
  c->add_option("--picture", options->picture, "picture of the last frame to write (.png)");
  c->add_option("--show", options->show,
                "what the picture shows over bodies: one, or both as contacts,joints")
      ->check(CLI::IsMember({"contacts", "joints", "contacts,joints"}));
  c->add_option("--threads", options->threads, "threads of the simulation (default: all)")
      ->check(CLI::Range(1, 1024));
  c->add_flag("--json", options->json, "the result as one JSON object on standard output");
  c->add_option("--progress", options->progress, "progress on standard error")
      ->check(CLI::IsMember({"auto", "plain", "none"}));
  c->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace truestep
