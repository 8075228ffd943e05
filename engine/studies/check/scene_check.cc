#include "engine/studies/check/scene_check.h"

#include <algorithm>
#include <cmath>

#include "engine/base/errors.h"
#include "engine/scene/json/json_write.h"
#include "engine/studies/check/comparisons.h"
#include "engine/studies/check/refusals.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr double kNoBound = -1e300;  // every measured number meets it

[[noreturn]] void refuse(const std::string& what, const std::string& value) {
  throw Error("scene_invalid", what, {{"/test", "bad_change", what, value, "", "", ""}});
}

// Pointers to the systems of a scene that have a parameter.
std::vector<std::string> systems_with(const json::value& scene, std::string_view name) {
  std::vector<std::string> out;
  const json::value* systems = scene.is_object() ? scene.as_object().if_contains("systems") : nullptr;
  for (size_t i = 0; systems && systems->is_array() && i < systems->as_array().size(); ++i) {
    const json::object* system = systems->as_array()[i].if_object();
    const json::value* type = system ? system->if_contains("type") : nullptr;
    if (!type || !type->is_string()) continue;
    const auto of = [&](const CatalogueRow& row) { return row.type == std::string_view(type->as_string()); };
    const auto row = std::find_if(catalogue().begin(), catalogue().end(), of);
    if (row != catalogue().end() && row->table->find(name)) out.push_back("/systems/" + std::to_string(i));
  }
  return out;
}

void set_everywhere(json::value& scene, const std::string& name, const json::value& value) {
  const std::vector<std::string> systems = systems_with(scene, name);
  if (systems.empty()) refuse("no system of the scene has a parameter " + name, write_json(value));
  for (const std::string& system : systems) set_at(scene, system + '/' + name, value);
}

void apply(const SceneChange& change, Trial& trial) {
  const json::value& v = change.value;
  if (change.where == "threads") {
    if (!v.is_int64() || v.as_int64() < 1 || v.as_int64() > 1024)
      refuse("threads are a number from 1 to 1024", write_json(v));
    trial.threads = static_cast<int>(v.as_int64());
  } else if (change.where == "resumed") {
    if (!v.is_bool()) refuse("resumed is true or false", write_json(v));
    trial.resumed = v.as_bool();
  } else if (change.where == "scratch") {
    if (v != json::value("kept") && v != json::value("dropped"))
      refuse("scratch is kept or dropped", write_json(v));
    trial.drops_scratch = v == json::value("dropped");
  } else if (change.where == "dt") {
    set_at(trial.document, "/time/dt", v);
  } else if (change.where.starts_with('/')) {
    set_at(trial.document, change.where, v);
  } else {
    set_everywhere(trial.document, change.where, v);
  }
}

/// The commands of a document, which it then no longer has.
std::vector<TestCommand> take_commands(json::value& document) {
  std::vector<TestCommand> out;
  std::vector<Issue> issues;
  json::object* o = document.if_object();
  const json::value* test = o ? o->if_contains("test") : nullptr;
  if (!test) return out;
  for (const json::value& c : test->at("commands").as_array())
    out.push_back(read_test_command(c, "/test/commands/" + std::to_string(out.size()), issues));
  if (!issues.empty()) throw Error("scene_invalid", "a change makes a command that cannot be read", issues);
  o->erase("test");
  return out;
}

std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + ", " + b;
}

std::string bounds(const ExpectParams& e) {
  std::string out;
  if (e.min) out = joined(out, "at least " + number(*e.min));
  if (e.max) out = joined(out, "at most " + number(*e.max));
  if (e.equals) out = joined(out, "equal to " + number(*e.equals) + " +- " + number(e.tolerance));
  return out;
}

}  // namespace

SceneCheck::SceneCheck(const json::value& document) {
  json::value scene = document;
  std::vector<Issue> issues;
  json::value test = json::object();
  if (json::object* o = scene.if_object()) {
    if (const json::value* given = o->if_contains("test")) test = *given;
    o->erase("test");
  }
  test_ = read_scene_test(test, "/test", issues);
  if (!issues.empty()) throw Error("scene_invalid", "the test of the scene has faults", issues);
  for (size_t c = 0; c < test_.cases.size(); ++c) add_runs(scene, c, std::nullopt);
  for (size_t k = 0; k < test_.controls.size(); ++k) {
    const auto named = [&](const TestCase& c) { return c.name == test_.controls[k].of; };
    const auto at = std::find_if(test_.cases.begin(), test_.cases.end(), named);
    const bool first = test_.controls[k].of.empty() || at == test_.cases.end();
    add_runs(scene, first ? 0 : static_cast<size_t>(at - test_.cases.begin()), k);
  }
}

bool SceneCheck::changes_no_bit(const std::string& axis) const {
  return keeps_bits(axis) || std::find(test_.same.begin(), test_.same.end(), axis) != test_.same.end();
}

// A control is run once, unless it is a comparison that must fail.
bool SceneCheck::varies(size_t axis, std::optional<size_t> control) const {
  if (!control) return true;
  const std::vector<std::string>& fails = test_.controls[*control].fails;
  const auto fails_in = [&](const char* what) {
    return std::find(fails.begin(), fails.end(), what) != fails.end();
  };
  const std::string& name = test_.vary[axis].name;
  const bool same = changes_no_bit(name);
  const bool agree = std::any_of(test_.agree.begin(), test_.agree.end(),
                                 [&](const TestAgreement& a) { return a.over == name; });
  return (same && fails_in(kSame)) || (agree && fails_in(kAgree));
}

void SceneCheck::add_runs(const json::value& scene, size_t of_case, std::optional<size_t> control) {
  std::vector<size_t> at(test_.vary.size());
  while (true) {
    add_run(scene, {"", {}, of_case, control, at, {}});
    size_t axis = 0;
    for (; axis < at.size(); ++axis) {
      if (varies(axis, control) && ++at[axis] < test_.vary[axis].steps.size()) break;
      at[axis] = 0;
    }
    if (axis == at.size()) return;
  }
}

// What runs must agree in is measured, whether or not the scene expects anything of it.
void SceneCheck::measure_agreements(json::value& document) const {
  if (!document.is_object()) return;
  json::value& expected = document.as_object()["expect"];
  if (expected.is_null()) expected = json::array{};
  if (!expected.is_array()) return;
  for (const TestAgreement& a : test_.agree) {
    const auto named = [&](const json::value& e) {
      const json::value* quantity = e.is_object() ? e.as_object().if_contains("quantity") : nullptr;
      return quantity && *quantity == json::value(a.quantity);
    };
    if (std::ranges::none_of(expected.as_array(), named))
      expected.as_array().push_back(json::object{{"quantity", a.quantity}, {"min", kNoBound}});
  }
}

void SceneCheck::add_run(const json::value& scene, Run run) {
  const TestCase& c = test_.cases[run.of_case];
  run.trial.document = scene;
  run.trial.plan = c.plan;
  run.trial.sleepers = test_.still.has_value();
  run.trial.compared = std::any_of(test_.vary.begin(), test_.vary.end(),
                                   [this](const TestAxis& a) { return changes_no_bit(a.name); });
  if (c.expect) run.trial.document.as_object()["expect"] = *c.expect;
  // What cannot be built measures nothing: that is no fault of its own.
  if (c.is_refused() && !c.expect && run.trial.document.is_object())
    run.trial.document.as_object().erase("expect");
  std::vector<SceneChange> changes = c.changes;
  run.label = c.name.empty() && test_.cases.size() > 1 ? "case " + std::to_string(run.of_case) : c.name;
  for (size_t axis = 0; axis < run.at.size(); ++axis) {
    const TestAxis::Step& step = test_.vary[axis].steps[run.at[axis]];
    changes.insert(changes.end(), step.changes.begin(), step.changes.end());
    if (varies(axis, run.control)) run.label = joined(run.label, step.label);
  }
  if (run.control) {
    const TestControl& k = test_.controls[*run.control];
    changes.insert(changes.end(), k.changes.begin(), k.changes.end());
    run.label = joined("control " + std::to_string(*run.control), run.label);
  }
  json::value& document = run.trial.document;
  if (!test_.commands.empty()) set_at(document, "/test", json::object{{"commands", test_.commands}});
  for (const SceneChange& change : changes) apply(change, run.trial);
  run.trial.commands = take_commands(document);
  if (!c.is_refused()) measure_agreements(document);
  runs_.push_back(std::move(run));
}

// What the run itself shows; comparisons come later.
void SceneCheck::judge(const Run& run, std::vector<CheckFinding>& out) const {
  const TestCase& c = test_.cases[run.of_case];
  const TrialResult& r = run.result;
  const auto add = [&](const char* kind, std::optional<double> value, const std::string& wanted,
                       const std::string& detail) {
    out.push_back({run.label, kind, value, wanted, detail});
  };
  if (c.is_refused()) {
    const auto other = c.refused ? other_fault(r.refused, *c.refused) : std::nullopt;
    const std::string differ = c.faults.empty() ? "" : differing_faults(r.refused, c.faults);
    if (!r.refusal) {
      add("refused", std::nullopt, "a refusal", "the scene is accepted");
    } else if (other) {
      add("refused", std::nullopt, described(*c.refused), "it is refused for " + described(*other));
    } else if (!differ.empty()) {
      add("refused", std::nullopt, "", differ);
    }
    return;
  }
  if (r.refusal) {
    for (const Issue& i : r.refused) add("refused", std::nullopt, "", described(i));
    return;
  }
  if (r.failure) {
    // A control may show that a run ends, also where that is allowed.
    if (c.instability == TestEnding::runs || (run.control && c.instability == TestEnding::may_fail) ||
        r.failure->find(c.says) == std::string::npos)
      add("instability", std::nullopt, c.says, *r.failure);
    // What a run ends with is still meaningful.
    if (!r.not_finite.empty()) add("not_finite", std::nullopt, "", r.not_finite + " is not finite");
    return;
  }
  if (c.instability == TestEnding::fails)
    add("instability", std::nullopt, "an instability", "the run goes on to its end");
  for (const std::string& what : r.commands) add("commands", std::nullopt, "a refusal", what);
  for (const std::string& what : r.plan) add("plan", std::nullopt, "", what);
  const auto contains = [&](const std::string& told) { return told.find(c.warns) != std::string::npos; };
  if (c.warns == "none" && !r.told.empty()) {
    add("warnings", std::nullopt, "none", r.told[0]);
  } else if (!c.warns.empty() && c.warns != "none" && std::ranges::none_of(r.told, contains)) {
    add("warnings", std::nullopt, c.warns, r.told.empty() ? "nothing is told" : r.told[0]);
  }
  if (!r.not_finite.empty()) add("not_finite", std::nullopt, "", r.not_finite + " is not finite");
  if (test_.still && r.moved > *test_.still)
    add("still", r.moved, "at most " + number(*test_.still),
        "what slept at " + number(r.moved_at) + " s moves within 0.4 s once woken");
  for (const Verdict& v : r.verdicts) {
    if (v.met) continue;
    out.push_back({run.label, v.expected.quantity, v.measured, bounds(v.expected),
                   v.measured ? v.expected.source : "there is no such quantity"});
  }
}

// What a control makes fail must be what it names.
void SceneCheck::judge_control(size_t control, std::vector<CheckFinding>& out) const {
  std::vector<CheckFinding> missed;
  std::string label;
  for (const Run& run : runs_) {
    if (run.control != control) continue;
    judge(run, missed);
    label = run.label;
  }
  const TestControl& k = test_.controls[control];
  const auto named = [&](const TestCase& c) { return c.name == k.of; };
  const auto of = std::find_if(test_.cases.begin(), test_.cases.end(), named);
  compare(k.of.empty() || of == test_.cases.end() ? 0 : static_cast<size_t>(of - test_.cases.begin()),
          control, missed);
  const auto misses = [&](const std::string& quantity) {
    return std::any_of(missed.begin(), missed.end(),
                       [&](const CheckFinding& f) { return f.quantity == quantity; });
  };
  const std::string because = k.why.empty() ? "" : ": " + k.why;
  // A control that could not be run shows nothing, unless that is what it names.
  if (k.fails.empty()) {
    for (const Run& run : runs_) {
      if (run.control != control || !run.result.refusal || test_.cases[run.of_case].is_refused()) continue;
      out.push_back(
          {label, "control", std::nullopt, "a run", "it is refused: " + described(run.result.refused[0])});
      return;
    }
  }
  if (k.fails.empty() && missed.empty())
    out.push_back({label, "control", std::nullopt, "a failure", "nothing fails" + because});
  for (const std::string& quantity : k.fails) {
    if (misses(quantity)) continue;
    std::string detail = quantity + " does not fail";
    for (const Run& run : runs_) {
      const auto value = run.control == control ? measured(run.result, quantity) : std::nullopt;
      if (value) detail += ", it is " + number(*value);
    }
    if (!missed.empty()) detail += "; instead " + missed[0].quantity + ": " + missed[0].detail;
    out.push_back({label, "control", std::nullopt, "a failure", detail + because});
  }
}

std::vector<CheckFinding> SceneCheck::findings() const {
  std::vector<CheckFinding> out;
  for (const Run& run : runs_) {
    if (!run.control) judge(run, out);
  }
  for (size_t c = 0; c < test_.cases.size(); ++c) compare(c, std::nullopt, out);
  for (size_t k = 0; k < test_.controls.size(); ++k) judge_control(k, out);
  return out;
}

}  // namespace truestep
