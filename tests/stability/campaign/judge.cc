// A trial as a scene with its test: rules become expectations, and `truestep check` judges them.
#include <algorithm>
#include <cstdio>
#include <map>

#include "engine/base/errors.h"
#include "engine/base/parallel.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/studies/check/scene_check.h"
#include "tests/stability/campaign/parts.h"

namespace truestep::campaign {
namespace {

/// Sums over all systems, by name without the system's id: "momentum.x" -> "a.momentum.x + b.momentum.x".
std::map<std::string, std::string> momenta(const Observables& seen) {
  std::map<std::string, std::string> out;
  for (const Observation& o : seen.rows()) {
    if (o.name.find("momentum") == std::string::npos) continue;
    std::string& sum = out[o.name.substr(o.name.find('.') + 1)];
    sum += (sum.empty() ? "" : " + ") + o.name;
  }
  return out;
}

void add_rules(const Rules& r, const Observables& seen, json::array& expect) {
  const auto potential = seen.find("energy.potential");
  if (seen.find("energy.total") && potential) {
    // The potential may include the stored energy, which then shows at the start.
    const double unseen = *potential > 0.5 * r.stored ? 0 : r.stored;
    const auto add = [&](const char* quantity, double most) {
      json::object e{{"quantity", quantity}, {"max", most}};
      if (unseen + r.drives > 0) e["given"] = unseen + r.drives;
      expect.push_back(std::move(e));
    };
    if (r.gain) add("energy.gain", *r.gain);
    if (r.loss) add("energy.loss", *r.loss);
  }
  for (const auto& [name, sum] : momenta(seen)) {
    const auto& bound = name.find("angular") == std::string::npos ? r.momentum : r.angular_momentum;
    if (bound) expect.push_back(json::object{{"quantity", "change(" + sum + ")"}, {"max", *bound}});
  }
}

/// Whether a scene is refused because its step is too long, which answers as an instability does.
bool too_fast(const Error& e) {
  return !e.issues().empty() && std::ranges::all_of(e.issues(), [](const Issue& i) {
    return i.code == "out_of_range" && (i.pointer == "/time/dt" || i.pointer == "/time/substeps" ||
                                        i.message.find("substeps per step") != std::string::npos);
  });
}

}  // namespace

json::object document(const Trial& trial) {
  json::object scene = trial.scene;
  const World world(parse_scene(write_json(scene)));
  add_rules(trial.rules, world.observe(world.initial_state()), scene["expect"].as_array());
  json::object test;
  if (trial.rules.still) test["still"] = *trial.rules.still;
  if (trial.rules.event == Rules::Event::allowed) test["instability"] = "allowed";
  scene["name"] = trial.family + '_' + std::to_string(trial.seed);
  scene["test"] = std::move(test);
  return scene;
}

Outcome judge(const Trial& trial) {
  Outcome out;
  try {
    // As text, the way every scene comes in.
    SceneCheck check(parse_json(write_json(document(trial))));
    check.run(0);
    for (const CheckFinding& f : check.findings()) {
      char value[32] = "";
      if (f.measured) std::snprintf(value, sizeof value, " = %.4g", *f.measured);
      out.findings.push_back({f.quantity, value + (" " + f.wanted) + ' ' + f.detail});
    }
    if (out.findings.empty()) out.event = check.result(0).failure;
    if (!out.findings.empty() && trial.rules.unheld == Rules::Event::allowed) {
      const auto& told = check.result(0).told;
      const auto says = [](const std::string& w) { return w.find("holds") != std::string::npos; };
      const auto at = std::ranges::find_if(told, says);
      if (at != told.end()) out.event = *at, out.findings.clear();
    }
    out.cpu_seconds = check.result(0).cpu_seconds;
  } catch (const Error& e) {
    if (trial.rules.event == Rules::Event::allowed && too_fast(e)) {
      out.event = e.what();
      return out;
    }
    std::string what = e.what();
    for (const Issue& i : e.issues()) what += "; " + i.pointer + ": " + i.message;
    out.findings.push_back({"invalid", what});
  }
  return out;
}

std::string report(const Trial& trial, const Outcome& outcome) {
  std::string text;
  for (const Finding& f : outcome.findings)
    text += trial.family + ", seed " + std::to_string(trial.seed) + ": " + f.kind + f.detail + '\n';
  return text;
}

}  // namespace truestep::campaign
