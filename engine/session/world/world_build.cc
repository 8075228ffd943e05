// How a world is built from its scene: systems, couplings, the finer companion, and the plan of a step.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/base/text/short_number.h"
#include "engine/base/version.h"
#include "engine/core/ports/pressed_points.h"
#include "engine/integrators/table/integrators.h"
#include "engine/session/world/world.h"

namespace truestep {

namespace {

/// Substeps when the scene does not set them: this share of the longest substep that the springs tolerate,
/// because points held against bodies make them stiffer (of 400 random scenes 18 gain more than a fiftieth of
/// the energy at work with 0.8, one with 0.4). And the largest number of substeps.
constexpr double kOfLongest = 0.4, kMostSubsteps = 10'000;
/// The largest number for points that are put where constraints hold: steps that gain energy nevertheless are
/// divided when they do.
constexpr double kMostPressed = 256;

/// Runs `build`; refusals are collected with pointers below `where`.
template <class Build>
void collecting(std::vector<Issue>& issues, const std::string& where, Build build) {
  try {
    build();
  } catch (const Error& e) {
    if (e.code() != "scene_invalid") throw;
    for (Issue issue : e.issues()) {
      issue.pointer = where + issue.pointer;
      issues.push_back(std::move(issue));
    }
  }
}

}  // namespace

void World::build_system(size_t i, bool meets_bodies, std::vector<Issue>& issues) {
  interruption_point();
  const SceneSystem& s = scene_.systems[i];
  if (s.reading == Reading::faulty) return;
  collecting(issues, "/systems/" + std::to_string(s.place), [&] {
    BuildContext context = scene_.context(i);
    context.meets_bodies = meets_bodies;
    systems_[i] = s.row->build(s.def.get(), context);
  });
}

void World::build(std::vector<Issue>& issues, std::span<const std::string> lost_ids) {
  systems_.resize(scene_.systems.size());
  for (size_t i = 0; i < scene_.systems.size(); ++i) build_system(i, false, issues);
  if (!scene_.couplings.empty()) {
    couple(let_bodies_be_met(issues), issues);
  }
  BuiltScene built = this->built();
  built.lost_ids = lost_ids;
  check_references(built, issues);
}

World::World(Scene scene) : scene_(std::move(scene)) {
  std::vector<Issue> issues;
  build(issues, {});
  scene_.header.time.substeps = scene_.substeps();  // the session's document states the number
  if (!issues.empty()) {
    const std::string first = issues[0].message;
    throw Error("scene_invalid", first, std::move(issues));
  }
  constexpr double kNone = std::numeric_limits<double>::infinity();
  for (const auto& s : systems_) speed_limits_.push_back(s->limit(Limit::speed, {}, dt()).value_or(kNone));
  parts_ = PartTable(scene_, systems_);
  find_joined(), find_tied();
  if (scene_.header.accuracy) build_finer();
  list_plan();
}

std::vector<Issue> World::more_faults(const SceneReport& report) {
  std::vector<Issue> issues;
  World part;
  part.scene_ = report.draft.value();
  part.build(issues, report.lost_ids);
  return issues;
}

// Half the substep, and a tenth of every tolerance.
void World::build_finer() {
  boost::json::object d = scene_.canonical();
  d.erase("accuracy");
  d["time"].as_object()["substeps"] = 2 * scene_.substeps();
  for (boost::json::value& s : d["systems"].as_array()) {
    // A tolerance left to the method is made explicit; otherwise both would use the same.
    boost::json::object& o = s.as_object();
    const boost::json::value* name = o.if_contains("integrator");
    const Integrator* method = name && name->is_string() ? find_integrator(name->as_string()) : nullptr;
    if (method && method->stepping == Integrator::Stepping::adaptive && !o.contains("tolerance"))
      o["tolerance"] = IntegratorOptions{}.tolerance;
    for (const char* key : {"tolerance", "relative_tolerance", "absolute_tolerance"}) {
      boost::json::value* v = s.as_object().if_contains(key);
      if (v && v->is_number()) *v = 0.1 * v->to_number<double>();
    }
  }
  finer_ = std::make_unique<const World>(require_scene(read_scene(d)));
}

void World::find_joined() {
  joined_to_.resize(size());
  std::iota(joined_to_.begin(), joined_to_.end(), size_t{0});
  for (const SceneCoupling& c : scene_.couplings) {
    const size_t a = joined_to_[c.a], b = joined_to_[c.b];
    for (size_t& first : joined_to_) {
      if (first == a || first == b) first = std::min(a, b);
    }
  }
}

std::vector<bool> World::let_bodies_be_met(std::vector<Issue>& issues) {
  std::vector<bool> meets(systems_.size());
  for (const SceneCoupling& c : scene_.couplings) {
    if (c.reading == Reading::faulty || !c.row->touches || !systems_[c.a] || !systems_[c.b]) continue;
    for (const auto& [points, bodies] : {std::pair(c.a, c.b), std::pair(c.b, c.a)}) {
      if (systems_[bodies]->ports().bodies && systems_[points]->ports().answers) meets[points] = true;
    }
  }
  for (size_t i = 0; i < systems_.size(); ++i) {
    if (meets[i]) build_system(i, true, issues);
  }
  return meets;
}

double World::substeps_of_points(const std::vector<bool>& meets) const {
  double parts = 1;
  for (size_t i = 0; i < systems_.size(); ++i) {
    if (!meets[i]) continue;
    const auto longest = systems_[i]->limit(Limit::stable_dt, systems_[i]->initial_state(), dt());
    if (longest) parts = std::max(parts, std::ceil(dt() / (kOfLongest * *longest)));
  }
  return std::min(std::max(parts, substeps_of_pressed()), kMostSubsteps);
}

double World::substeps_of_pressed() const {
  double parts = 1;
  for (const SceneCoupling& c : scene_.couplings) {
    if (c.reading == Reading::faulty || c.a == c.b || !systems_[c.a] || !systems_[c.b]) continue;
    for (const auto& [points, on] : {std::pair(c.a, c.b), std::pair(c.b, c.a)}) {
      const PressedPoints* pressed = systems_[points]->ports().pressed;
      const Ports ports = systems_[on]->ports();
      if (!pressed || !ports.bodies) continue;
      double heaviest = 0;
      for (const BodyForm& f : ports.bodies->forms) heaviest = std::max(heaviest, f.mass);
      if (!(heaviest > 0)) continue;
      constexpr double kRounding = 1e-9;
      parts = std::max(parts, std::ceil(dt() / pressed->pressed_h(heaviest) * (1 - kRounding)));
    }
  }
  return std::min(parts, kMostPressed);
}

std::pair<double, std::string> World::substeps_of_couplings() const {
  constexpr double kRounding = 1e-9;
  std::pair<double, std::string> most{1, ""};
  for (size_t k = 0; k < couplings_.size(); ++k) {
    if (!couplings_[k]) continue;
    const SceneCoupling& c = scene_.couplings[k];
    const State a = systems_[c.a]->initial_state(), b = systems_[c.b]->initial_state();
    const auto longest = couplings_[k]->stable_h({couplings_[k]->initial_state(), a, b});
    const double parts = longest ? std::ceil(dt() / *longest - kRounding) : 1;
    if (parts > most.first) most = {parts, c.id};
  }
  return most;
}

Issue World::too_few_substeps(double needed, const std::string& coupling) const {
  const std::string why = "the coupling \"" + coupling + "\" needs " + short_number(needed) +
                          " substeps in a step of " + short_number(dt()) + " s";
  if (!scene_.header.time.substeps) {
    return {"/time/dt",
            "out_of_range",
            why,
            short_number(dt()),
            "<= " + short_number(dt() * kMostSubsteps / needed),
            "",
            ""};
  }
  const auto chosen = static_cast<double>(scene_.substeps());
  return {"/time/substeps",
          "out_of_range",
          why,
          short_number(chosen),
          ">= " + short_number(needed) + ", or a dt of at most " + short_number(dt() / needed * chosen),
          "",
          ""};
}

void World::couple(const std::vector<bool>& meets, std::vector<Issue>& issues) {
  const bool chosen = scene_.header.time.substeps.has_value();
  // Systems that are built for a shorter step may need a shorter one still: seldom, and never a longer one.
  for (;;) {
    std::vector<Issue> faults;
    couplings_.clear();
    build_couplings(faults);
    const auto present = static_cast<double>(scene_.substeps());
    const auto [needed, which] = substeps_of_couplings();
    const double wanted = chosen ? needed : std::max(needed, substeps_of_points(meets));
    const bool refused = needed > present && (chosen || needed > kMostSubsteps);
    if (refused && issues.empty() && faults.empty()) {
      if (!chosen) scene_.header.time.substeps.reset();
      faults.push_back(too_few_substeps(needed, which));
    }
    if (refused || !issues.empty() || !(wanted > present)) {
      issues.insert(issues.end(), faults.begin(), faults.end());
      return;
    }
    scene_.header.time.substeps = static_cast<int64_t>(wanted);
    for (size_t i = 0; i < systems_.size(); ++i) build_system(i, meets[i], issues);
  }
}

// Couplings inspect their sides, so both must exist.
void World::build_couplings(std::vector<Issue>& issues) {
  if (scene_.couplings.empty()) return;
  std::vector<std::optional<CouplingSide>> sides(size());
  for (size_t i = 0; i < size(); ++i) {
    if (systems_[i]) sides[i].emplace(CouplingSide{id(i), *systems_[i], systems_[i]->initial_state()});
  }
  for (const SceneCoupling& c : scene_.couplings) {
    couplings_.emplace_back();
    if (c.reading == Reading::faulty || !sides[c.a] || !sides[c.b]) continue;
    collecting(issues, "/couplings/" + std::to_string(c.place), [&] {
      couplings_.back() = c.row->build(c.def.get(), {c.id, *sides[c.a], *sides[c.b]});
    });
  }
}

void World::list_plan() {
  const double pressed = substeps_of_pressed();
  const auto present = static_cast<double>(scene_.substeps());
  if (pressed > 1 && !(pressed > present)) {
    plan_.push_back({"",
                     {PlanRow::Status::runs, "substeps",
                      short_number(present) + " a step: in " + short_number(pressed) +
                          " or more, points that bodies press on or hang on answer with all their stiffness"},
                     std::nullopt});
  }
  for (size_t i = 0; i < size(); ++i) {
    for (PlanRow& row : systems_[i]->plan()) plan_.push_back({id(i), std::move(row), i});
  }
  for (size_t k = 0; k < couplings_.size(); ++k) {
    for (PlanRow& row : couplings_[k]->plan()) {
      plan_.push_back({scene_.couplings[k].id, std::move(row), size() + k});
    }
  }
  if (couplings_.empty()) {
    plan_.push_back({"",
                     {PlanRow::Status::skipped, "couplings",
                      size() > 1 ? "none given: the systems do not interact" : "there is only one system"},
                     std::nullopt});
  }
  if (!deviations().empty()) {
    plan_.push_back({"",
                     {PlanRow::Status::skipped, "same bits",
                      "built with " + std::string(deviations()) +
                          ": last bits may differ from those of a program built as usual"},
                     std::nullopt});
  }
}

}  // namespace truestep
