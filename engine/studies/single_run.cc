#include "engine/studies/single_run.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "engine/base/errors.h"
#include "engine/base/hash.h"
#include "engine/session/describe.h"
#include "engine/session/expectation.h"
#include "engine/session/session.h"
#include "engine/session/snapshot/references.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

const DefTable& run_table() {
  using P = RunParams;
  static const DefTable t =
      TableOf<P>("a run of the scene from its start")
          .number("duration", &P::duration, "s", above(0),
                  "simulated time; the scene's duration when left out")
          .texts("observables", &P::observables, {0, 64},
                 "observables in the table: names, or their beginnings up to a dot; all when left out")
          .integer("max_points", &P::max_points, between(2, 100000), "rows of the table at most")
          .build();
  return t;
}

/// The table while it grows.
class Rows {
 public:
  Rows(const World& world, const RunParams& p) {
    const auto known = world.known_observables();
    std::vector<Issue> issues;
    for (size_t i = 0; i < p.observables.size(); ++i) {
      if (auto fault = unknown_observable(p.observables[i], "/observables/" + std::to_string(i), known))
        issues.push_back(std::move(*fault));
    }
    if (!issues.empty()) throw Error("scene_invalid", "no observable has this name", std::move(issues));
    table.columns = {{"step", "1"}, {"time", "s"}};
    for (const Observation& o : known) {
      const auto means = [&](const std::string& entry) { return selects(entry, o.name); };
      if (p.observables.empty() || std::any_of(p.observables.begin(), p.observables.end(), means))
        table.columns.push_back({o.name, o.unit});
    }
  }
  void add(const Session& session) {
    const Observables values = session.observe();
    auto& row = table.rows.emplace_back();
    row.emplace_back(static_cast<double>(session.step_index()));
    row.emplace_back(session.time());
    for (size_t c = 2; c < table.columns.size(); ++c)
      row.emplace_back(values.find(table.columns[c].name).value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  StudyTable table;
};

// The first quantity and others with its unit, at most eight.
StudyPlot plot_of(const StudyTable& table) {
  StudyPlot plot;
  plot.x_label = "time (s)";
  plot.x_scale = plot.y_scale = StudyPlot::Scale::linear;
  for (size_t c = 2; c < table.columns.size() && plot.series.size() < 8; ++c) {
    if (table.columns[c].unit != table.columns[2].unit) continue;
    StudyPlot::Series series{table.columns[c].name};
    series.style = StudyPlot::Series::Style::line;
    for (const auto& row : table.rows) {
      series.x.push_back(std::get<double>(row[1]));
      series.y.push_back(std::get<double>(row[c]));
    }
    plot.series.push_back(std::move(series));
  }
  if (!plot.series.empty()) plot.y_label = table.columns[2].unit;
  return plot;
}

json::array describe(const std::vector<Verdict>& verdicts) {
  json::array out;
  for (const Verdict& v : verdicts) {
    const bool known = v.measured && std::isfinite(*v.measured);
    out.push_back(json::object{{"quantity", v.expected.quantity},
                               {"measured", known ? json::value(*v.measured) : json::value(nullptr)},
                               {"met", v.met}});
  }
  return out;
}

StudyResult run_once(const json::value& scene, const void* def, StudyContext& context) {
  const auto& p = *static_cast<const RunParams*>(def);
  Scene read = read_variant(scene, context);
  const double dt = read.header.time.dt, whole = read.header.time.duration;
  const double duration = p.duration.value_or(whole);
  const double most = 1e12;
  const auto steps = static_cast<uint64_t>(std::llround(std::min(duration / dt, most)));
  // Expectations refer to the whole run.
  if (duration < whole) read.header.expect.clear();
  Expectations expectations(read);
  const auto world = std::make_shared<const World>(std::move(read));
  const auto arena = std::make_shared<const ThreadArena>(1);
  Session session(world, arena, {.history_bytes = 0});
  Rows rows(*world, p);
  const uint64_t points = static_cast<uint64_t>(p.max_points) - 1;
  const uint64_t every = std::max<uint64_t>(1, (steps + points - 1) / points);
  rows.add(session);
  if (!expectations.empty()) expectations.add(session.observe(), session.time());
  const std::clock_t begun = std::clock();
  for (uint64_t n = 0; n < steps; ++n) {
    if (n % 16 == 0) {
      context.check();
      context.progress(static_cast<double>(n) / static_cast<double>(steps),
                       "step " + std::to_string(n) + " of " + std::to_string(steps));
    }
    if (session.step(1) == 0) break;
    const bool last = n + 1 == steps;
    if (!expectations.empty() && (last || expectations.needs_every_step()))
      expectations.add(session.observe(), session.time());
    if (last || session.step_index() % every == 0) rows.add(session);
  }
  session.examine();
  StudyResult r;
  r.summary = {{"steps", session.step_index()},
               {"time", session.time()},
               {"cpu_seconds", static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC},
               {"state_hash", hex64(session.hash())},
               {"observables", describe_observables(session.observe())},
               {"expect", describe(expectations.verdicts())}};
  if (session.failure()) r.summary["instability"] = describe_failure(*session.failure());
  r.table = std::move(rows.table);
  r.plot = plot_of(r.table);
  r.plot.title =
      world->scene().header.title.empty() ? world->scene().header.name : world->scene().header.title;
  return r;
}

}  // namespace

const StudyKind& run_kind() {
  static const StudyKind kRun{"run", "one run of a scene", run_table, run_once};
  return kRun;
}

}  // namespace truestep
