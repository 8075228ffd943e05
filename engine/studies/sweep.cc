#include "engine/studies/sweep.h"

#include <cmath>
#include <map>
#include <mutex>

#include "engine/base/errors.h"
#include "engine/base/random.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/expectation.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

double between_ends(const SweepAxis& a, double w) {
  if (a.scale == SweepAxis::Scale::linear) return *a.min + w * (*a.max - *a.min);
  return std::exp(std::log(*a.min) + w * (std::log(*a.max) - std::log(*a.min)));
}

std::vector<double> grid_values(const SweepAxis& a) {
  if (!a.values.empty()) return a.values;
  std::vector<double> v;
  for (int64_t i = 0; i < a.count; ++i)
    v.push_back(
        between_ends(a, a.count == 1 ? 0 : static_cast<double>(i) / static_cast<double>(a.count - 1)));
  return v;
}

std::vector<std::vector<double>> cases_of(const SweepParams& p) {
  std::vector<std::vector<double>> cases;
  if (p.mode == SweepParams::Mode::random) {
    for (int64_t n = 0; n < p.draws; ++n) {
      std::vector<double> c;
      for (size_t i = 0; i < p.axes.size(); ++i) {
        const double u = uniform4(p.seed, i, static_cast<uint64_t>(n))[0];
        const SweepAxis& a = p.axes[i];
        const size_t k = a.values.size();
        c.push_back(k ? a.values[std::min(k - 1, static_cast<size_t>(u * static_cast<double>(k)))]
                      : between_ends(a, u));
      }
      cases.push_back(std::move(c));
    }
    return cases;
  }
  cases.emplace_back();
  for (const SweepAxis& a : p.axes) {
    std::vector<std::vector<double>> longer;
    const auto values = grid_values(a);
    if (cases.size() * values.size() > kMaxSweepCases) {
      throw Error(
          "too_large", "the grid has more than " + std::to_string(kMaxSweepCases) + " cases",
          {"/axes", "too_large", "the grid has too many cases", "", std::to_string(kMaxSweepCases), "", ""});
    }
    for (const auto& c : cases) {
      for (const double v : values) {
        longer.push_back(c);
        longer.back().push_back(v);
      }
    }
    cases = std::move(longer);
  }
  return cases;
}

// {"case": n, pointer: value ..., measure: value ..., "status": "ok" or the reason why not}
json::object run_case(const json::value& scene, const SweepParams& p, size_t number,
                      const std::vector<double>& parameters, const StudyContext& context) {
  static const ThreadArena kSerial(1);
  json::object row{{"case", number}};
  json::value d = scene;
  for (size_t i = 0; i < p.axes.size(); ++i) {
    const double v = parameters[i];
    // Counts are integers in a scene.
    const bool whole = v == std::floor(v) && std::abs(v) < 9e15;
    set_at(d, p.axes[i].pointer, whole ? json::value(static_cast<int64_t>(v)) : json::value(v));
    row[p.axes[i].pointer] = v;
  }
  std::string status = "ok";
  try {
    Scene read = read_variant(d, context);
    read.header.expect.clear();
    for (const std::string& q : p.measure) {
      ExpectParams e;
      e.quantity = q;
      read.header.expect.push_back(std::move(e));
    }
    const auto steps = static_cast<uint64_t>(
        std::llround(p.horizon.value_or(read.header.time.duration) / read.header.time.dt));
    const World world(std::move(read));
    Expectations watch(world.scene());
    WorldState state = world.initial_state();
    Workspace workspace;
    watch.add(world.observe(state));
    try {
      for (uint64_t n = 0; n < steps; ++n) {
        if (n % 16 == 0) context.check();
        world.step(state, workspace, kSerial, {});
        if (watch.needs_every_step() && n + 1 < steps) watch.add(world.observe(state));
      }
      watch.add(world.observe(state));
    } catch (const Instability& e) {
      status = std::string("unstable: ") + e.what();
    }
    for (const Verdict& v : watch.verdicts()) {
      const bool known = v.measured && std::isfinite(*v.measured) && status == "ok";
      row[v.expected.quantity] = known ? json::value(*v.measured) : json::value(nullptr);
      if (!v.measured) status = "no quantity " + v.expected.quantity;
    }
  } catch (const Error& e) {
    if (e.code() == "cancelled") throw;
    status = e.issues().empty() ? e.what() : e.issues().front().pointer + ": " + e.issues().front().message;
  }
  row["status"] = status;
  return row;
}

const DefTable& axis_table() {
  using A = SweepAxis;
  static const DefTable t =
      TableOf<A>("a parameter that varies")
          .text("pointer", &A::pointer, "JSON pointer to a number of the scene, e.g. /systems/0/stiffness")
          .required()
          .numbers("values", &A::values, "", any(), {0, 10000}, "list of values")
          .number("min", &A::min, "", any(), "first value, if there is no list")
          .number("max", &A::max, "", any(), "last value, if there is no list")
          .integer("count", &A::count, between(1, 10000), "values from min to max on a grid")
          .choice("scale", &A::scale, {"linear", "log"}, "spacing between min and max")
          .check([](const A& a, const DefTable::Report& report) {
            if (a.values.empty() && !(a.min && a.max)) report("", "an axis needs values, or min and max");
            if (a.min && a.max && a.scale == A::Scale::logarithmic && !(*a.min > 0 && *a.max > 0))
              report("/scale", "a logarithmic axis needs min and max above 0");
          })
          .build();
  return t;
}

}  // namespace

const DefTable& sweep_table() {
  using P = SweepParams;
  static const DefTable t =
      TableOf<P>("measured quantities over a grid of parameters, or random draws of them")
          .objects("axes", &P::axes, axis_table(), {1, 16}, "parameters that vary")
          .required()
          .choice("mode", &P::mode, {"grid", "random"}, "every combination, or random draws")
          .integer("draws", &P::draws, between(1, static_cast<double>(kMaxSweepCases)),
                   "cases of a random sweep")
          .integer("seed", &P::seed, between(0, 9e15), "of the random draws")
          .texts("measure", &P::measure, {1, 64}, "quantities, as in a scene's \"expect\"")
          .required()
          .number("horizon", &P::horizon, "s", above(0), "simulated time; the scene's duration when left out")
          .build();
  return t;
}

StudyResult run_sweep(const json::value& scene, const void* def, StudyContext& context) {
  const auto& p = *static_cast<const SweepParams*>(def);
  const auto cases = cases_of(p);
  std::map<size_t, json::object> rows;
  for (const json::object& row : context.finished_rows) {
    const json::value* n = row.if_contains("case");
    if (n && n->is_number() && n->to_number<double>() >= 0 &&
        n->to_number<double>() < static_cast<double>(cases.size()))
      rows[static_cast<size_t>(n->to_number<double>())] = row;
  }
  const size_t reused = rows.size();
  std::vector<size_t> left;
  for (size_t n = 0; n < cases.size(); ++n) {
    if (!rows.contains(n)) left.push_back(n);
  }
  std::mutex mutex;
  std::exception_ptr failure;
  context.arena.for_blocks(left.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      {
        const std::lock_guard lock(mutex);
        if (failure) return;
      }
      try {
        json::object row = run_case(scene, p, left[i], cases[left[i]], context);
        const std::lock_guard lock(mutex);
        if (context.row_finished) context.row_finished(row);
        rows[left[i]] = std::move(row);
        context.progress(static_cast<double>(rows.size()) / static_cast<double>(cases.size()),
                         "case " + std::to_string(rows.size()) + " of " + std::to_string(cases.size()));
      } catch (...) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::current_exception();
      }
    }
  });
  if (failure) std::rethrow_exception(failure);

  StudyResult r;
  r.table.columns = {{"case", "1"}};
  for (const SweepAxis& a : p.axes) r.table.columns.push_back({a.pointer, ""});
  for (const std::string& q : p.measure) r.table.columns.push_back({q, ""});
  r.table.columns.push_back({"status", ""});
  size_t failed = 0;
  for (const auto& [n, row] : rows) {
    std::vector<StudyTable::Cell> cells;
    for (const auto& c : r.table.columns) {
      const json::value* v = row.if_contains(c.name);
      if (v && v->is_number())
        cells.emplace_back(v->to_number<double>());
      else if (v && v->is_string())
        cells.emplace_back(std::string(v->as_string()));
      else
        cells.emplace_back();
    }
    const auto* status = std::get_if<std::string>(&cells.back());
    if (!status || *status != "ok") ++failed;
    r.table.rows.push_back(std::move(cells));
  }
  r.summary = {{"cases", cases.size()}, {"reused", reused}, {"failed", failed}};
  const bool log_x = p.axes[0].scale == SweepAxis::Scale::logarithmic;
  r.plot = {.title = "Sweep",
            .x_label = p.axes[0].pointer,
            .y_label = p.measure[0],
            .x_scale = log_x ? StudyPlot::Scale::logarithmic : StudyPlot::Scale::linear,
            .y_scale = StudyPlot::Scale::linear};
  // One curve per combination of the other axes; random draws form one cloud of points.
  std::map<std::string, StudyPlot::Series> curves;
  for (const auto& row : r.table.rows) {
    const auto* x = std::get_if<double>(&row[1]);
    const auto* y = std::get_if<double>(&row[1 + p.axes.size()]);
    if (!x || !y) continue;
    std::string name;
    for (size_t i = 1; i < p.axes.size() && p.mode == SweepParams::Mode::grid; ++i) {
      const auto* v = std::get_if<double>(&row[1 + i]);
      name += (i > 1 ? ", " : "") + p.axes[i].pointer + " = " + (v ? write_json(*v) : "");
    }
    auto& curve = curves[name];
    curve.name = name.empty() ? p.measure[0] : name;
    if (p.mode == SweepParams::Mode::random) curve.style = StudyPlot::Series::Style::markers;
    curve.x.push_back(*x), curve.y.push_back(*y);
  }
  for (auto& [name, curve] : curves) r.plot.series.push_back(std::move(curve));
  return r;
}

}  // namespace truestep
