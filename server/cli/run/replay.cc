#include "server/cli/run/replay.h"

#include <iostream>
#include <thread>

#include "engine/base/hash.h"
#include "engine/base/version.h"
#include "engine/scene/admission.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/snapshot/bundle.h"
#include "server/cli/exit_codes.h"
#include "server/cli/input.h"
#include "server/cli/progress.h"

namespace truestep {

namespace json = boost::json;

namespace {

struct ReplayOptions {
  std::string bundle, progress = "auto";
  int threads = 0;
  bool json = false;
};

int replay_bundle(const ReplayOptions& options) {
  const Bundle bundle = read_bundle(load_bytes(options.bundle));
  require_admission(estimate(require_scene(read_scene(bundle.scene))), kOwnMachine);
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::thread::hardware_concurrency());
  Progress progress(progress_style(options.progress), bundle.end.step);
  const ReplayResult r = replay(bundle, std::make_shared<const ThreadArena>(threads), [&](uint64_t step) {
    if (step % 16 == 0) progress.update(step, "");
  });
  progress.finish();
  const auto& d = r.difference;
  if (options.json) {
    json::object o{{"equal", !d},           {"first_step", r.first_step},
                   {"step", r.last_step},   {"state_hash", hex64(r.hash)},
                   {"build", bundle.build}, {"commands", bundle.journal.size()}};
    if (d) {
      o["difference"] = json::object{{"after", d->after},
                                     {"step", d->step},
                                     {"expected", hex64(d->expected)},
                                     {"found", hex64(d->found)}};
    }
    std::cout << write_json(o) << '\n';
  } else if (d) {
    std::cout << "differs: " << hex64(d->found) << " at step " << d->step << ", expected "
              << hex64(d->expected) << " (" << bundle.build << "); equal at step " << d->after << '\n';
  } else {
    std::cout << "equal: " << hex64(r.hash) << " at step " << r.last_step << ", "
              << bundle.checkpoints.size() + 1 << " hashes compared\n";
  }
  return d ? kExitMissed : kExitOk;
}

}  // namespace

void add_replay_command(Arguments app, int& exit_code) {
  auto o = std::make_shared<ReplayOptions>();
  Arguments c = app.add_subcommand("replay", "repeats a session's bundle and compares its hashes");
  c.add_option("bundle", o->bundle, "file from GET /v1/sessions/{id}/bundle").required();
  c.add_option("--threads", o->threads, "threads of the simulation (default: all)").in_range(1, 1024);
  c.add_flag("--json", o->json, "the result as one JSON object on standard output");
  c.add_option("--progress", o->progress, "progress on standard error").one_of({"auto", "plain", "none"});
  c.callback([o, &exit_code] { exit_code = replay_bundle(*o); });
}

}  // namespace truestep
