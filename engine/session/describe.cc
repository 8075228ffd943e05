#include "engine/session/describe.h"

#include <cmath>

#include "engine/base/text/short_number.h"
#include "engine/core/equations/integrator.h"
#include "engine/integrators/table/integrators.h"
#include "engine/scene/gallery.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/scene/settable.h"

namespace truestep {

namespace json = boost::json;

json::object describe_issue(const Issue& issue) {
  json::object o{{"pointer", issue.pointer}, {"code", issue.code}, {"message", issue.message}};
  if (!issue.value.empty()) o["value"] = issue.value;
  if (!issue.allowed.empty()) o["allowed"] = issue.allowed;
  if (!issue.did_you_mean.empty()) o["did_you_mean"] = issue.did_you_mean;
  if (!issue.unit.empty()) o["unit"] = issue.unit;
  return o;
}

json::array describe_issues(const std::vector<Issue>& issues) {
  json::array a;
  for (const Issue& i : issues) a.push_back(describe_issue(i));
  return a;
}

json::object describe_integrator(const Integrator& m) {
  const auto limit = [](double v) {
    return std::isnan(v) ? json::value(nullptr) : std::isinf(v) ? json::value("unlimited") : json::value(v);
  };
  return {{"name", m.name},
          {"title", m.title},
          {"order", m.order},
          {"symplectic", m.structure == Integrator::Structure::symplectic},
          {"adaptive", m.stepping == Integrator::Stepping::adaptive},
          {"implicit", m.kind == Integrator::Kind::implicit},
          {"stable_omega_dt", limit(m.imaginary_limit)},
          {"stable_lambda_dt", limit(m.real_limit)},
          {"order_with_velocity_forces", m.order_with_velocity},
          {"source", m.source}};
}

json::object describe_system(const CatalogueRow& row) {
  json::array guarantees, methods, fields, observables, settable;
  for (const FieldOutput& f : row.outputs->fields) {
    fields.push_back(
        json::object{{"name", f.name}, {"unit", f.unit}, {"width", f.width}, {"description", f.sentence}});
  }
  for (const OutputInfo& o : row.outputs->observables) {
    observables.push_back(json::object{{"name", o.name}, {"unit", o.unit}, {"description", o.sentence}});
  }
  for (const std::string_view g : row.guarantees) guarantees.emplace_back(g);
  for (const SettableParameter& p : settable_parameters(row.type)) {
    const ParamRow* of_scene = row.table->find(p.name);
    json::object o{{"name", p.name}, {"of", name_of(p.of)}, {"takes", name_of(p.form)}};
    o["unit"] = p.unit.empty() && of_scene ? std::string_view(of_scene->unit) : p.unit;
    o["description"] = p.sentence.empty() && of_scene ? std::string_view(of_scene->sentence) : p.sentence;
    settable.push_back(std::move(o));
  }
  if (!row.default_integrator.empty()) {
    for (const Integrator& m : integrators()) {
      if (serves(m, row)) methods.push_back(describe_integrator(m));
    }
  }
  return {{"type", row.type},
          {"group", row.group},
          {"description", row.sentence},
          {"parameters", describe_params(*row.table)},
          {"resolution", row.resolution ? json::value(row.resolution->parameter) : json::value(nullptr)},
          {"default_integrator", row.default_integrator},
          {"integrators", std::move(methods)},
          {"guarantees", std::move(guarantees)},
          {"rows", row.outputs->rows},
          {"fields", std::move(fields)},
          {"observables", std::move(observables)},
          {"settable", std::move(settable)},
          {"cost_of_defaults", describe_cost(row.cost(row.table->make().get()))}};
}

json::array describe_systems() {
  json::array a;
  for (const CatalogueRow& row : catalogue()) {
    a.push_back(json::object{{"type", row.type}, {"group", row.group}, {"description", row.sentence}});
  }
  return a;
}

json::array describe_gallery() {
  json::array a;
  for (const GalleryScene& g : gallery()) {
    const json::value document = parse_json(g.text);
    const json::object& o = document.as_object();
    json::object entry{{"name", g.name}};
    for (const char* key : {"title", "teaches", "tags"}) {
      if (const json::value* v = o.if_contains(key)) entry[key] = *v;
    }
    json::array systems;
    for (const json::value& system : o.at("systems").as_array()) systems.push_back(system.at("type"));
    entry["systems"] = std::move(systems);
    entry["thumbnail"] = "/v1/gallery/" + std::string(g.name) + "/picture.png";
    a.push_back(std::move(entry));
  }
  return a;
}

json::array describe_fields(const PartInfo& part) {
  json::array fields;
  for (const FieldInfo& f : part.fields) {
    json::object field{{"name", f.name},
                       {"unit", f.unit},
                       {"width", f.width},
                       {"type", scalar_name(f.type)},
                       {"meaning", name_of(f.meaning)}};
    if (f.scale != FieldInfo::Scale::amount) field["scale"] = name_of(f.scale);
    if (!f.kinds.empty()) {
      json::array& kinds = field["kinds"].emplace_array();
      for (const std::string& kind : f.kinds) kinds.emplace_back(kind);
    }
    fields.push_back(std::move(field));
  }
  return fields;
}

json::object describe_part(const PartTable::Entry& part) {
  const PartInfo& info = part.info();
  json::object o{{"id", part.id},
                 {"kind", name_of(info.kind)},
                 {"fields", describe_fields(info)},
                 {"max_rows", info.max_rows}};
  if (info.kind == PartInfo::Kind::grid) {
    const Lattice& l = info.lattice;
    o["lattice"] = json::object{{"counts", json::array{l.counts[0], l.counts[1], l.counts[2]}},
                                {"origin", json::array{l.origin.x, l.origin.y, l.origin.z}},
                                {"spacing", json::array{l.spacing.x, l.spacing.y, l.spacing.z}},
                                {"centring", l.centring == Lattice::Centring::cells ? "cells" : "nodes"}};
  }
  return o;
}

json::object describe_cost(const Cost& cost) {
  return {{"memory_bytes", cost.state_bytes + cost.workspace_bytes},
          {"elements", cost.elements},
          {"seconds_per_step", cost.seconds_per_step}};
}

json::array describe_plan(const World& world, std::span<const Profile> profiles) {
  double total = 0;
  for (const Profile& p : profiles) {
    for (const Profile::Row& r : p.rows()) total += r.seconds;
  }
  json::array a;
  for (const World::PlanEntry& e : world.plan()) {
    json::object row{{"system", e.system},
                     {"pass", e.row.name},
                     {"runs", e.row.status == PlanRow::Status::runs},
                     {"reason", e.row.reason}};
    if (!profiles.empty() && e.profile) {
      for (const Profile::Row& r : profiles[*e.profile].rows()) {
        if (r.name != e.row.name) continue;
        row["seconds"] = r.seconds;
        row["calls"] = r.calls;
        row["share"] = total > 0 ? r.seconds / total : 0;
      }
    }
    a.push_back(std::move(row));
  }
  return a;
}

json::array describe_warnings(const std::vector<SessionWarning>& warnings) {
  json::array out;
  for (const SessionWarning& w : warnings) {
    json::object o{{"system", w.system},         {"quantity", w.warning.quantity},
                   {"value", w.warning.value},   {"limit", w.warning.limit},
                   {"detail", w.warning.detail}, {"first_step", w.first_step}};
    if (w.warning.suggested_dt > 0) o["suggested_dt"] = w.warning.suggested_dt;
    out.push_back(std::move(o));
  }
  return out;
}

json::object describe_failure(const Failure& f) {
  json::object o{{"system", f.system},
                 {"quantity", f.quantity},
                 {"index", f.index},
                 {"detail", f.detail},
                 {"step", f.step},
                 {"time", f.time},
                 {"last_good_step", f.last_good_step}};
  if (f.suggested_dt) o["suggested_dt"] = *f.suggested_dt;
  json::array remedies;
  for (const std::string& r : f.remedies) remedies.emplace_back(r);
  o["remedies"] = std::move(remedies);
  return o;
}

json::object describe_observables(const Observables& values) {
  json::object o;
  for (const Observation& v : values.rows()) {
    // JSON has no NaN: a quantity that is not finite is null.
    o[v.name] = std::isfinite(v.value) ? json::value(v.value) : json::value(nullptr);
  }
  return o;
}

SceneReport examine_scene(const json::value& document, const AdmissionLimits& limits) {
  return examine_further(read_scene(document), limits);
}

SceneReport examine_further(SceneReport report, const AdmissionLimits& limits) {
  if (report.scene || !report.draft) return report;
  try {
    require_admission(estimate(*report.draft), limits);
    for (Issue& issue : World::more_faults(report)) report.errors.push_back(std::move(issue));
  } catch (const Error& e) {
    report.errors.insert(report.errors.end(), e.issues().begin(), e.issues().end());
  }
  return report;
}

json::object validate_scene(const json::value& document, const AdmissionLimits& limits) {
  SceneReport report = examine_scene(document, limits);
  json::object out;
  if (report.scene) {
    try {
      const Cost cost = estimate(*report.scene);
      out["estimate"] = describe_cost(cost);
      require_admission(cost, limits);
      const World world(*report.scene);
      out["plan"] = describe_plan(world, {});
      const WorldState state = world.initial_state();
      world.require_finite_energy(state);
      const Cost built = world.cost(state);
      out["estimate"] = describe_cost(built);
      require_admission(built, limits);
      for (Issue& doubt : scene_doubts(world, state)) report.warnings.push_back(std::move(doubt));
      for (const World::SystemWarning& w : world.warnings(state)) {
        const SceneSystem& system = report.scene->systems[w.system];
        report.warnings.push_back({"/systems/" + std::to_string(system.place), w.warning.quantity,
                                   w.warning.detail, write_json(json::value(w.warning.value)), "", "", ""});
      }
      if (const auto dt = world.stable_dt(state)) {
        if (*dt > 0) out["stable_dt"] = *dt;
        if (*dt <= 0) {
          report.warnings.push_back({"/time/dt", "no_stable_dt",
                                     "a method of this scene gains energy at every step, however short: "
                                     "shorter steps only delay the instability",
                                     "", "", "", ""});
        } else if (*dt < world.dt()) {
          report.warnings.push_back(
              {"/time/dt", "unstable_dt",
               "the step exceeds the stability limit of this method; the run will become unstable",
               write_json(json::value(world.dt())), "at most " + write_json(json::value(*dt)), "", "s"});
        }
      }
      const double pressed = world.substeps_of_pressed();
      if (const auto present = static_cast<double>(world.scene().substeps()); pressed > present) {
        std::string enough("at least ");
        enough += short_number(pressed);
        enough += ", or none: the default";
        report.warnings.push_back(
            {"/time/substeps", "few_substeps",
             "points that bodies press on or hang on give way before their links pull: energy may come from "
             "nothing, and steps in which it does are divided",
             short_number(present), enough, "", ""});
      }
      out["scene"] = report.scene->canonical();
    } catch (const Error& e) {
      report.errors = e.issues();
      if (report.errors.empty()) report.errors.push_back({"", e.code(), e.what(), "", "", "", ""});
    }
  }
  json::object result{{"valid", report.errors.empty()},
                      {"errors", describe_issues(report.errors)},
                      {"warnings", describe_issues(report.warnings)}};
  for (auto& [key, value] : out) result[key] = std::move(value);
  return result;
}

}  // namespace truestep
