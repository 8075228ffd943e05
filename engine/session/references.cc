#include "engine/session/references.h"

#include <algorithm>
#include <cmath>

#include "engine/base/nearest_name.h"
#include "engine/scene/params_text.h"
#include "engine/session/expectation.h"

namespace truestep {

namespace {

constexpr std::string_view kSums[] = {"energy.kinetic", "energy.potential", "energy.total"};

std::string quoted(const std::string& text) {
  return '"' + text.substr(0, 64) + '"';
}

// Names for a message: as many as a person reads.
std::string listed(std::span<const std::string> names) {
  constexpr size_t kMost = 40;
  if (names.size() <= kMost) return join_names(names);
  return join_names(names.first(kMost)) + " and " + std::to_string(names.size() - kMost) + " more";
}

std::vector<std::string> names_of(std::span<const Observation> known) {
  std::vector<std::string> names;
  for (const Observation& o : known) names.push_back(o.name);
  return names;
}

bool recordable(const FieldInfo& field) {
  return field.type == Scalar::f64 || field.type == Scalar::f32 || field.type == Scalar::u32;
}

class Checker {
 public:
  Checker(const BuiltParts& parts, std::vector<Issue>& issues) : parts_(parts), issues_(issues) {}

  void run() {
    const SceneHeader& h = parts_.scene.header;
    for (size_t i = 0; i < h.probes.size(); ++i) probe(h.probes[i], "/probes/" + std::to_string(i));
    if (h.recording) recording(*h.recording);
    if (h.accuracy) accuracy(*h.accuracy);
    if (h.observables.empty() && h.expect.empty()) return;
    known_ = known_observables(parts_);
    for (size_t i = 0; i < h.observables.size(); ++i) {
      const std::string& entry = h.observables[i];
      if (hidden(entry)) continue;
      if (auto fault = unknown_observable(entry, "/observables/" + std::to_string(i), known_)) {
        issues_.push_back(std::move(*fault));
      }
    }
    for (size_t i = 0; i < h.expect.size(); ++i) expectation(h.expect[i], "/expect/" + std::to_string(i));
  }

 private:
  // May name something of a part that is not built.
  bool hidden(const std::string& name) const {
    bool whole = !parts_.systems.empty() && parts_.lost_ids.empty();
    const auto within = [&](const std::string& id) { return name == id || name.starts_with(id + '.'); };
    if (std::any_of(parts_.lost_ids.begin(), parts_.lost_ids.end(), within)) return true;
    for (size_t i = 0; i < parts_.systems.size(); ++i) {
      if (parts_.systems[i]) continue;
      whole = false;
      if (within(parts_.scene.systems[i].id)) return true;
    }
    for (size_t k = 0; k < parts_.couplings.size(); ++k) {
      if (!parts_.couplings[k] && within(parts_.scene.couplings[k].id)) return true;
    }
    return !whole && within("energy");
  }

  const System* find(const std::string& id) const {
    for (size_t i = 0; i < parts_.systems.size(); ++i) {
      if (parts_.scene.systems[i].id == id) return parts_.systems[i].get();
    }
    return nullptr;
  }

  // Rows come by themselves only where something emits them; commands may bring more, which no scene can
  // name.
  bool emits(const std::string& id) const {
    for (const SceneSystem& s : parts_.scene.systems) {
      const ParamRow* emitters = s.id == id ? s.row->table->find("emitters") : nullptr;
      if (emitters && emitters->size && emitters->size(s.def.get()) > 0) return true;
    }
    return false;
  }

  void probe(const ProbeParams& p, const std::string& where) {
    const System* system = find(p.system);
    if (!system) return;
    const auto fields = system->fields();
    std::vector<std::string> names;
    for (const FieldInfo& f : fields) names.push_back(f.name);
    const State state = system->initial_state();
    std::vector<double> scratch;
    for (size_t k = 0; k < p.fields.size(); ++k) {
      const auto at = std::find(names.begin(), names.end(), p.fields[k]);
      if (at == names.end()) {
        issues_.push_back({where + "/fields/" + std::to_string(k), "unknown_field",
                           "the system \"" + p.system + "\" has no such field", quoted(p.fields[k]),
                           listed(names), nearest_name(p.fields[k], names), ""});
        continue;
      }
      const auto f = static_cast<size_t>(at - names.begin());
      // Fields that are as long as the system's first one grow with it.
      const size_t rows = system->field(state, f, scratch).rows;
      const bool grows = emits(p.system) && rows == system->field(state, 0, scratch).rows;
      const size_t most = grows ? std::max(rows, system->max_rows()) : rows;
      const auto n = static_cast<int64_t>(most);
      if (p.index >= -n && p.index < n) continue;
      issues_.push_back(
          {where + "/index", "out_of_range",
           n == 0
               ? "the field \"" + p.fields[k] + "\" has no rows"
               : "the field \"" + p.fields[k] + "\" has " + std::to_string(n) + (n == 1 ? " row" : " rows"),
           std::to_string(p.index),
           n == 0 ? "" : "[" + std::to_string(-n) + ", " + std::to_string(n - 1) + "]", "", ""});
      break;
    }
  }

  void recording(const RecordingParams& r) {
    std::vector<std::string> names;
    bool whole = !parts_.systems.empty() && parts_.lost_ids.empty();
    for (const auto& system : parts_.systems) {
      whole = whole && system;
      if (!system) continue;
      for (const FieldInfo& f : system->fields()) {
        if (recordable(f) && std::find(names.begin(), names.end(), f.name) == names.end())
          names.push_back(f.name);
      }
    }
    for (size_t k = 0; whole && k < r.fields.size(); ++k) {
      if (std::find(names.begin(), names.end(), r.fields[k]) != names.end()) continue;
      issues_.push_back({"/recording/fields/" + std::to_string(k), "unknown_field",
                         "no system has such a field that can be recorded", quoted(r.fields[k]),
                         listed(names), nearest_name(r.fields[k], names), ""});
    }
    for (size_t i = 0; i < parts_.systems.size(); ++i) {
      if (parts_.systems[i]) one_length(*parts_.systems[i], parts_.scene.systems[i].id, r);
    }
  }

  // A recording keeps one number of rows per system.
  void one_length(const System& system, const std::string& id, const RecordingParams& r) {
    const State state = system.initial_state();
    const auto infos = system.fields();
    std::vector<double> scratch;
    std::optional<std::pair<std::string, size_t>> first;
    for (size_t k = 0; k < r.fields.size(); ++k) {
      for (size_t f = 0; f < infos.size(); ++f) {
        if (infos[f].name != r.fields[k] || !recordable(infos[f])) continue;
        const size_t rows = system.field(state, f, scratch).rows;
        if (!first) first.emplace(infos[f].name, rows);
        if (rows == first->second) continue;
        issues_.push_back({"/recording/fields/" + std::to_string(k), "inconsistent",
                           "in \"" + id + "\" this field has " + std::to_string(rows) + " rows and " +
                               first->first + " " + std::to_string(first->second) +
                               ": a recording keeps fields of one length",
                           quoted(r.fields[k]), "", "", ""});
      }
    }
  }

  void accuracy(const AccuracyParams& a) {
    const auto i = parts_.scene.integrated_system(a.system);
    if (!i || !parts_.systems[*i] || a.quantity == "state") return;
    std::vector<std::string> names{"state"};
    for (const FieldInfo& f : parts_.systems[*i]->fields()) {
      if (f.type == Scalar::f64) names.push_back(f.name);
    }
    if (std::find(names.begin(), names.end(), a.quantity) != names.end()) return;
    issues_.push_back({"/accuracy/quantity", "unknown_field", "the system has no such field",
                       quoted(a.quantity), listed(names), nearest_name(a.quantity, names), ""});
  }

  void expectation(const ExpectParams& e, const std::string& where) {
    const ExpectedQuantity q = expected_quantity(e.quantity);
    if (hidden(q.name)) return;
    const auto is = [&](const Observation& o) { return o.name == q.name; };
    if (std::any_of(known_.begin(), known_.end(), is)) return;
    const auto names = names_of(known_);
    const std::string near = nearest_name(q.name, names);
    const size_t inner = e.quantity.find(q.name);
    const bool wrapped = !near.empty() && q.reduction != Reduction::last && inner != std::string::npos;
    issues_.push_back({where + "/quantity", "unknown_quantity",
                       "nothing in this scene is observed by this name", quoted(e.quantity),
                       listed(names) + ", and min(...), max(...), drift(...) of each",
                       wrapped ? e.quantity.substr(0, inner) + near + ")" : near, ""});
  }

  const BuiltParts& parts_;
  std::vector<Issue>& issues_;
  std::vector<Observation> known_;
};

}  // namespace

std::vector<std::string> component_names(const std::string& stem, uint32_t width) {
  constexpr std::string_view kAxes[] = {".x", ".y", ".z"};
  std::vector<std::string> out;
  for (uint32_t c = 0; c < width; ++c) {
    out.push_back(width == 3   ? stem + std::string(kAxes[c])
                  : width == 1 ? stem
                               : stem + "." + std::to_string(c));
  }
  return out;
}

bool selects(std::string_view entry, std::string_view name) {
  return name == entry ||
         (name.starts_with(entry) && name.size() > entry.size() && name[entry.size()] == '.');
}

std::optional<Issue> unknown_observable(const std::string& entry, const std::string& pointer,
                                        std::span<const Observation> known) {
  const auto is = [&](const Observation& o) { return selects(entry, o.name); };
  if (std::any_of(known.begin(), known.end(), is)) return std::nullopt;
  std::vector<std::string> names = names_of(known);
  const std::string allowed = listed(names) + ", or beginnings of these up to a dot";
  for (const Observation& o : known) {
    for (size_t dot = o.name.find('.'); dot != std::string::npos; dot = o.name.find('.', dot + 1)) {
      names.push_back(o.name.substr(0, dot));
    }
  }
  return Issue{pointer,
               "unknown_observable",
               "nothing in this scene is observed by this name",
               quoted(entry),
               allowed,
               nearest_name(entry, names),
               ""};
}

Observables observe_parts(const BuiltParts& parts, std::span<const State> systems,
                          std::span<const State> couplings, double t) {
  Observables total, own;
  double sums[3] = {};
  bool known[3] = {true, true, true};
  for (size_t i = 0; i < parts.systems.size(); ++i) {
    Observables one;
    if (parts.systems[i]) parts.systems[i]->observe(systems[i], t, one);
    for (size_t k = 0; k < 3; ++k) {
      const auto v = one.find(kSums[k]);
      known[k] = known[k] && v;
      sums[k] += v.value_or(0);
    }
    const std::string& id = parts.scene.systems[i].id;
    for (const Observation& o : one.rows()) own.add(id + "." + o.name, o.value, o.unit);
  }
  for (size_t k = 0; k < parts.couplings.size(); ++k) {
    if (!parts.couplings[k]) continue;
    const SceneCoupling& c = parts.scene.couplings[k];
    Observables one;
    parts.couplings[k]->observe({couplings[k], systems[c.a], systems[c.b]}, one);
    // What a coupling stores belongs to the potential and to the total.
    const double stored = one.find("energy.potential").value_or(0);
    sums[1] += stored, sums[2] += stored;
    for (const Observation& o : one.rows()) own.add(c.id + "." + o.name, o.value, o.unit);
  }
  // A sum that leaves out a system would mislead.
  for (size_t k = 0; k < 3; ++k) {
    if (known[k]) total.add(kSums[k], sums[k], "J");
  }
  for (const Observation& o : own.rows()) total.add(o.name, o.value, o.unit);
  return total;
}

std::vector<Observation> known_observables(const BuiltParts& parts) {
  std::vector<State> systems(parts.systems.size()), couplings(parts.couplings.size());
  for (size_t i = 0; i < systems.size(); ++i) {
    if (parts.systems[i]) systems[i] = parts.systems[i]->initial_state();
  }
  for (size_t k = 0; k < couplings.size(); ++k) {
    if (parts.couplings[k]) couplings[k] = parts.couplings[k]->initial_state();
  }
  std::vector<Observation> out = observe_parts(parts, systems, couplings, 0).rows();
  for (size_t i = 0; i < systems.size(); ++i) {
    Observables late;
    if (parts.systems[i]) parts.systems[i]->late_observables(late);
    for (const Observation& o : late.rows())
      out.push_back({parts.scene.systems[i].id + "." + o.name, std::nan(""), o.unit});
  }
  std::vector<double> scratch;
  for (const ProbeParams& p : parts.scene.header.probes) {
    for (size_t i = 0; i < parts.systems.size(); ++i) {
      if (!parts.systems[i] || parts.scene.systems[i].id != p.system) continue;
      const auto fields = parts.systems[i]->fields();
      for (const FieldInfo& f : fields) {
        if (std::find(p.fields.begin(), p.fields.end(), f.name) == p.fields.end()) continue;
        for (const std::string& name : component_names(p.id + "." + f.name, f.width)) {
          out.push_back({name, std::nan(""), f.unit});
        }
      }
    }
  }
  if (parts.scene.header.accuracy) out.push_back({"error.estimate", std::nan(""), "1"});
  return out;
}

void check_references(const BuiltParts& parts, std::vector<Issue>& issues) {
  Checker(parts, issues).run();
}

}  // namespace truestep
