#include "engine/studies/refinement/refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "engine/base/errors.h"
#include "engine/core/lattice.h"
#include "engine/scene/catalogue.h"
#include "engine/session/expectation.h"
#include "engine/studies/convergence.h"
#include "engine/studies/scene_variant.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr const char* kExact = "error.exact";

std::string types_with_resolution() {
  std::string out;
  for (const CatalogueRow& row : catalogue()) {
    if (!row.resolution) continue;
    out += (out.empty() ? "" : "; ") + std::string(row.type) + " (" + std::string(row.resolution->parameter) +
           ")";
  }
  return out;
}

[[noreturn]] void refuse(const std::string& pointer, const std::string& code, const std::string& why,
                         const std::string& value, const std::string& allowed) {
  throw Error("scene_invalid", why, {pointer, code, why, value, allowed, "", ""});
}

// Without everything that is meaningful at one resolution only: rows by number, expected values.
json::object plain(const Scene& scene) {
  json::object o = scene.canonical();
  for (const char* key : {"probes", "expect", "recording", "observables", "viewer", "accuracy"}) o.erase(key);
  return o;
}

}  // namespace

std::vector<std::string> refine_names() {
  return {"time", "space", "both"};
}

Refinement::Refinement(const json::value& scene, const std::string& id, const StudyContext& context)
    : scene_(read_variant(plain(require_scene(read_scene(scene))), context)) {
  for (system_ = 0; system_ < scene_.systems.size(); ++system_) {
    const SceneSystem& s = scene_.systems[system_];
    if ((resolution_ = s.row->resolution) && (id.empty() || s.id == id)) break;
  }
  if (system_ == scene_.systems.size()) {
    refuse(id.empty() ? "/refine" : "/system", "no_resolution",
           id.empty() ? "no system of the scene has a resolution parameter"
                      : "the scene has no such system with a resolution parameter",
           id.empty() ? "" : '"' + id.substr(0, 64) + '"', types_with_resolution());
  }
  const std::string prefix = scene_.systems[system_].id + '.';
  for (ExpectParams& e : require_scene(read_scene(scene)).header.expect) {
    if (!e.equals || expected_quantity(e.quantity).reduction != Reduction::last) continue;
    if (!e.quantity.starts_with(prefix)) continue;
    e.quantity.erase(0, prefix.size());
    expected_.push_back(std::move(e));
  }
  // As coarse as a quarter, if that gives whole counts and a valid scene.
  for (const double coarser : {4.0, 2.0, 1.0}) {
    coarsening_ = coarser;
    try {
      const World world = build_world(document(0), context);
      const State s = world.system(system_).initial_state();
      Observables seen;
      world.system(system_).observe(s, 0, seen);
      has_exact_ = seen.find(kExact).has_value();
      break;
    } catch (const Error& e) {
      if (coarser == 1 || e.code() == "cancelled") throw;
    }
  }
  // A division that is impossible is refused before anything is integrated.
  document(1);
}

std::string Refinement::subject() const {
  return scene_.systems[system_].id + "." + std::string(resolution_->parameter);
}

int Refinement::promised_order() const {
  return resolution_->order(scene_.systems[system_].def.get());
}

json::value Refinement::document(int level) const {
  Scene finer = require_scene(read_scene(scene_.canonical()));
  const double factor = std::ldexp(1 / coarsening_, level);
  if (factor != 1) {
    if (const auto why = resolution_->divide(finer.systems[system_].def.get(), factor)) {
      refuse("/refine", "not_divisible", "the resolution of the system cannot be changed: " + *why,
             '"' + scene_.systems[system_].id + '"', "");
    }
  }
  return finer.canonical();
}

TraceRequest Refinement::request(const std::string& quantity, const World& coarsest) const {
  const System& system = coarsest.system(system_);
  const std::string main_field = system.parts().at(resolution_->part).fields.at(0).name;
  TraceRequest r;
  if (quantity == kExpectedQuantity) {
    if (expected_.empty()) {
      refuse("/quantity", "nothing_expected",
             "the scene expects nothing of this system to equal a number at its end", "", "a field");
    }
    r.field = {system_, main_field};
    for (const ExpectParams& e : expected_) r.observables.push_back(e.quantity);
    return r;
  }
  r.field = {system_, quantity == "state" ? main_field : quantity};
  field_values(system, system.initial_state(), r.field.name);  // refuses a field that does not exist
  // The exact solution belongs to the first field.
  if (has_exact_ && r.field.name == main_field) r.observables = {kExact};
  return r;
}

double Refinement::off_expected(const std::vector<double>& observed) const {
  double most = 0;
  for (size_t k = 0; k < expected_.size(); ++k) {
    const double equals = *expected_[k].equals, size = std::abs(equals);
    const double off = std::abs(observed[k] - equals) / (size > 0 ? size : 1);
    if (!(off <= most)) most = off;
  }
  return most;
}

std::vector<double> Refinement::at_common(const World& coarsest, const World& world, const TraceField& field,
                                          const std::vector<double>& values) const {
  const System& system = world.system(system_);
  const auto place = system.find_field(field.name).value();
  const PartInfo &fine = system.parts()[place.part], &coarse = coarsest.system(system_).parts()[place.part];
  const size_t width = fine.fields[place.field].width;
  std::vector<double> out;
  if (fine.kind == PartInfo::Kind::grid) {
    const Lattice& l = coarse.lattice;
    for (size_t row = 0; row < l.rows(); ++row) {
      const size_t x = row % l.counts[0], y = row / l.counts[0] % l.counts[1],
                   z = row / (size_t{l.counts[0]} * l.counts[1]);
      const Vec3 at{l.origin.x + static_cast<double>(x) * l.spacing.x,
                    l.origin.y + static_cast<double>(y) * l.spacing.y,
                    l.origin.z + static_cast<double>(z) * l.spacing.z};
      const auto found = locate(fine.lattice, at);
      for (size_t c = 0; c < width; ++c) {
        double sum = found ? 0 : std::numeric_limits<double>::quiet_NaN();
        for (size_t k = 0; found && k < 8; ++k) {
          if (found->weights[k] > 0) sum += found->weights[k] * values[found->rows[k] * width + c];
        }
        out.push_back(sum);
      }
    }
    return out;
  }
  if (!resolution_->places || place.part != resolution_->part) {
    refuse("/quantity", "no_place", "rows of this field have no counterpart at other resolutions",
           '"' + field.name + '"',
           "a field of " + (resolution_->part == 0
                                ? "the main part"
                                : "part " + std::string(system.parts()[resolution_->part].name)));
  }
  const auto places_of = [&](const World& w) {
    return resolution_->places(w.scene().systems[system_].def.get());
  };
  const auto key = [](const Vec3& at) {
    const auto whole = [](double v) { return std::llround(v * 1e9); };
    return std::array{whole(at.x), whole(at.y), whole(at.z)};
  };
  std::map<std::array<long long, 3>, size_t> rows;
  size_t next = 0;
  for (const Vec3& at : places_of(world)) rows.emplace(key(at), next++);
  for (const Vec3& at : places_of(coarsest)) {
    const auto found = rows.find(key(at));
    for (size_t c = 0; c < width; ++c) {
      out.push_back(found == rows.end() ? std::numeric_limits<double>::quiet_NaN()
                                        : values[found->second * width + c]);
    }
  }
  return out;
}

LevelErrors judge_levels(const std::vector<std::vector<double>>& common, const std::vector<double>& exact,
                         double floor) {
  LevelErrors out;
  if (!exact.empty()) {
    const ObservedOrder order = observed_order(exact, floor);
    out.errors = exact, out.per_level = order.per_halving;
    out.settled = order.settled, out.mean = order.mean, out.reason = order.reason;
    out.against = "the scene's exact solution";
    return out;
  }
  // Differences between neighbouring levels fall as the errors do, and need no solution.
  std::vector<double> differences;
  for (size_t k = 0; k + 1 < common.size(); ++k) {
    differences.push_back(relative_error(common[k], common[k + 1]));
  }
  const ObservedOrder order = observed_order(differences, floor);
  out.settled = order.settled, out.mean = order.mean, out.reason = order.reason;
  out.limit = common.empty() ? std::vector<double>{} : common.back();
  out.against = "the finest resolution";
  const double p = order.per_halving.empty() ? NAN : order.per_halving.back();
  if (order.settled && std::isfinite(p) && p > 0) {
    const std::vector<double>& before = common[common.size() - 2];
    const double share = 1 / (std::exp2(p) - 1);
    for (size_t i = 0; i < out.limit.size(); ++i) out.limit[i] += share * (out.limit[i] - before[i]);
    out.against = "extrapolation of the finest resolutions (Richardson)";
  }
  for (const std::vector<double>& values : common) out.errors.push_back(relative_error(values, out.limit));
  out.per_level = order.per_halving;
  out.per_level.push_back(NAN);
  return out;
}

}  // namespace truestep
