#include "engine/session/snapshot/references.h"

#include <algorithm>
#include <cmath>

#include "engine/base/text/nearest_name.h"
#include "engine/core/lattice.h"
#include "engine/scene/params/params_text.h"
#include "engine/session/expectation.h"

namespace truestep {

namespace {

constexpr std::string_view kSums[] = {"energy.kinetic", "energy.potential", "energy.total"};

std::string quoted(const std::string& text) {
  return '"' + text.substr(0, 64) + '"';
}

// Names for a message, no more than a person reads.
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
  Checker(const BuiltScene& built, std::vector<Issue>& issues)
      : built_(built), table_(built.scene, built.systems), issues_(issues) {}

  void run() {
    const SceneHeader& h = built_.scene.header;
    for (size_t i = 0; i < h.probes.size(); ++i) probe(h.probes[i], "/probes/" + std::to_string(i));
    if (h.recording) recording(*h.recording);
    color(h.viewer.color_by);
    grids(h.viewer);
    if (h.accuracy) accuracy(*h.accuracy);
    if (h.observables.empty() && h.expect.empty()) return;
    known_ = known_observables(built_);
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
  // Whether the name may belong to a part that is not built.
  bool hidden(const std::string& name) const {
    bool whole = !built_.systems.empty() && built_.lost_ids.empty();
    const auto within = [&](const std::string& id) { return name == id || name.starts_with(id + '.'); };
    if (std::any_of(built_.lost_ids.begin(), built_.lost_ids.end(), within)) return true;
    for (size_t i = 0; i < built_.systems.size(); ++i) {
      if (built_.systems[i]) continue;
      whole = false;
      if (within(built_.scene.systems[i].id)) return true;
    }
    for (size_t k = 0; k < built_.couplings.size(); ++k) {
      if (!built_.couplings[k] && within(built_.scene.couplings[k].id)) return true;
    }
    return !whole && within("energy");
  }

  const System* find(const std::string& id) const {
    for (size_t i = 0; i < built_.systems.size(); ++i) {
      if (built_.scene.systems[i].id == id) return built_.systems[i].get();
    }
    return nullptr;
  }

  // Rows appear by themselves only if something emits them; commands may add more, which a scene cannot name.
  bool emits(const std::string& id) const {
    for (const SceneSystem& s : built_.scene.systems) {
      const ParamRow* emitters = s.id == id ? s.row->table->find("emitters") : nullptr;
      if (emitters && emitters->size && emitters->size(s.def.get()) > 0) return true;
    }
    return false;
  }

  void probe(const ProbeParams& p, const std::string& where) {
    const std::string owner = p.system.substr(0, p.system.find('.'));
    if (!find(owner)) return;
    const std::vector<std::string> names = table_.field_names(p.system);
    if (names.empty()) {
      std::vector<std::string> ids = table_.ids();
      std::erase_if(ids, [&](const std::string& id) { return id != owner && !id.starts_with(owner + '.'); });
      issues_.push_back({where + "/system", "unknown_part", "the system \"" + owner + "\" has no such part",
                         quoted(p.system), listed(ids), nearest_name(p.system, ids), ""});
      return;
    }
    std::vector<double> scratch;
    for (size_t k = 0; k < p.fields.size(); ++k) {
      const auto at = table_.find(p.system, p.fields[k]);
      if (!at) {
        issues_.push_back({where + "/fields/" + std::to_string(k), "unknown_field",
                           "the system \"" + p.system + "\" has no such field", quoted(p.fields[k]),
                           listed(names), nearest_name(p.fields[k], names), ""});
        continue;
      }
      const PartTable::Entry& part = table_[at->part];
      if (p.at) {
        place(*p.at, part, where);
        continue;
      }
      const size_t rows = part.field(part.of->initial_state(), at->field, scratch).rows;
      const auto n = static_cast<int64_t>(emits(owner) ? std::max(rows, part.info().max_rows) : rows);
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

  void place(const Vec3& at, const PartTable::Entry& part, const std::string& where) {
    if (part.info().kind != PartInfo::Kind::grid) {
      issues_.push_back({where + "/at", "inconsistent", "\"" + part.id + "\" is not a grid: give an index",
                         "", "index", "", "m"});
    } else if (!locate(part.info().lattice, at)) {
      issues_.push_back({where + "/at", "out_of_range", "this position lies outside \"" + part.id + "\"", "",
                         "a position in the grid", "", "m"});
    }
  }

  /// Whether every system of the scene could be built, so that all fields are known.
  bool complete() const {
    return !built_.systems.empty() && built_.lost_ids.empty() &&
           std::find(built_.systems.begin(), built_.systems.end(), nullptr) == built_.systems.end();
  }

  // Fields of values that nothing on the screen belongs to are told from those that do not exist.
  void color(const std::string& by) {
    if (by.empty() || !complete()) return;
    const std::vector<std::string> names = table_.color_names();
    if (std::find(names.begin(), names.end(), by) != names.end()) return;
    const std::vector<std::string> all = table_.field_names("");
    const bool known = std::find(all.begin(), all.end(), by) != all.end();
    issues_.push_back({"/viewer/color_by", "unknown_field",
                       known ? "no colours can show this field: nothing is drawn for its rows"
                             : "nothing in this scene has this field",
                       quoted(by), listed(names), nearest_name(by, names), ""});
  }

  /// What only grids can show, and only grids of some kind.
  void grids(const ViewerParams& v) {
    if (!complete()) return;
    bool any = false, plane = false, space = false, vectors = false;
    for (const PartTable::Entry& part : table_) {
      const PartInfo& info = part.info();
      if (info.kind != PartInfo::Kind::grid) continue;
      any = true;
      (info.lattice.dimensions() == 3 ? space : plane) = true;
      for (const FieldInfo& f : info.fields)
        vectors |= f.width > 1 && (v.color_by.empty() || f.name == v.color_by);
    }
    const auto need = [&](bool wish, bool there, const char* where, const std::string& what,
                          const std::string& allowed) {
      if (wish && !there)
        issues_.push_back({std::string("/viewer/") + where, "inconsistent", what, "", allowed, "", ""});
    };
    need(v.contours > 0, any, "contours", "no system of this scene is a grid: there are no level lines", "");
    need(v.slice.has_value(), space, "slice",
         "no system of this scene is a grid in space: nothing can be cut", "");
    need(v.height.has_value(), plane, "height",
         "no system of this scene is a grid on a line or in the plane: nothing can be raised", "");
    need(v.streamlines > 0, any, "streamlines",
         "no system of this scene is a grid: there is no flow to follow", "");
    need(v.streamlines > 0 && any, vectors, "streamlines",
         "streamlines follow the field that is shown, and " +
             (v.color_by.empty() ? "no field" : quoted(v.color_by)) + " is a vector",
         "color_by a field of vectors, such as velocity");
  }

  void recording(const RecordingParams& r) {
    if (!complete()) return;
    std::vector<std::string> names;
    for (const PartTable::Entry& part : table_) {
      for (const FieldInfo& f : part.info().fields) {
        if (recordable(f) && std::find(names.begin(), names.end(), f.name) == names.end())
          names.push_back(f.name);
      }
    }
    for (size_t k = 0; k < r.fields.size(); ++k) {
      if (std::find(names.begin(), names.end(), r.fields[k]) != names.end()) continue;
      issues_.push_back({"/recording/fields/" + std::to_string(k), "unknown_field",
                         "no system has this field for recording", quoted(r.fields[k]), listed(names),
                         nearest_name(r.fields[k], names), ""});
    }
  }

  void accuracy(const AccuracyParams& a) {
    const auto i = built_.scene.integrated_system(a.system);
    if (!i || !built_.systems[*i] || a.quantity == "state") return;
    std::vector<std::string> names{"state"};
    for (const PartInfo& part : built_.systems[*i]->parts()) {
      for (const FieldInfo& f : part.fields) {
        if (f.type == Scalar::f64) names.push_back(f.name);
      }
    }
    if (std::find(names.begin(), names.end(), a.quantity) != names.end()) return;
    issues_.push_back({"/accuracy/quantity", "unknown_field", "the system has no such field",
                       quoted(a.quantity), listed(names), nearest_name(a.quantity, names), ""});
  }

  void expectation(const ExpectParams& e, const std::string& where) {
    try {
      const ExpectedQuantity quantity(e.quantity);
      for (const QuantityTrack& track : quantity.tracks()) {
        for (const std::string& name : track.term.names()) expected(e, name, where);
      }
    } catch (const ExpressionFault&) {  // reported where the scene was read
    }
  }

  void expected(const ExpectParams& e, const std::string& name, const std::string& where) {
    if (hidden(name)) return;
    const auto is = [&](const Observation& o) { return o.name == name; };
    if (std::any_of(known_.begin(), known_.end(), is)) return;
    const auto names = names_of(known_);
    std::string near = nearest_name(name, names);
    const size_t inner = e.quantity.find(name);
    if (!near.empty() && inner != std::string::npos)
      near = std::string(e.quantity).replace(inner, name.size(), near);
    issues_.push_back(
        {where + "/quantity", "unknown_quantity", "no observable of this scene has this name",
         quoted(e.quantity),
         names.empty() ? "" : listed(names) + ", and min(...), max(...), drift(...) and more of each", near,
         ""});
  }

  const BuiltScene& built_;
  PartTable table_;
  std::vector<Issue>& issues_;
  std::vector<Observation> known_;
};

}  // namespace

std::vector<std::string> probed_fields(const PartTable& parts, const ProbeParams& probe) {
  std::vector<std::string> names = parts.field_names(probe.system);
  std::erase_if(names, [&](const std::string& name) {
    return std::find(probe.fields.begin(), probe.fields.end(), name) == probe.fields.end();
  });
  return names;
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
  const std::string allowed = names.empty() ? "" : listed(names) + ", or beginnings of these up to a dot";
  for (const Observation& o : known) {
    for (size_t dot = o.name.find('.'); dot != std::string::npos; dot = o.name.find('.', dot + 1)) {
      names.push_back(o.name.substr(0, dot));
    }
  }
  return Issue{pointer,
               "unknown_observable",
               "no observable of this scene has this name",
               quoted(entry),
               allowed,
               nearest_name(entry, names),
               ""};
}

Observables observe_parts(const BuiltScene& parts, std::span<const State> systems,
                          std::span<const State> couplings, double t, const WantedObservables& wanted) {
  Observables total, own;
  const auto of = [&wanted](const std::string& id) {
    if (!wanted) return Observables{};
    return Observables([&wanted, id](std::string_view name) { return wanted(id + "." + std::string(name)); });
  };
  double sums[3] = {};
  bool known[3] = {true, true, true};
  for (size_t i = 0; i < parts.systems.size(); ++i) {
    const std::string& id = parts.scene.systems[i].id;
    Observables one = of(id);
    if (parts.systems[i]) parts.systems[i]->observe(systems[i], t, one);
    for (size_t k = 0; k < 3; ++k) {
      const auto v = one.find(kSums[k]);
      known[k] = known[k] && v;
      sums[k] += v.value_or(0);
    }
    for (const Observation& o : one.rows()) own.add(id + "." + o.name, o.value, o.unit);
  }
  for (size_t k = 0; k < parts.couplings.size(); ++k) {
    if (!parts.couplings[k]) continue;
    const SceneCoupling& c = parts.scene.couplings[k];
    Observables one = of(c.id);
    parts.couplings[k]->observe({couplings[k], systems[c.a], systems[c.b]}, one);
    // Energy stored by a coupling counts towards the potential and the total.
    const double stored = one.find("energy.potential").value_or(0);
    sums[1] += stored, sums[2] += stored;
    for (const Observation& o : one.rows()) own.add(c.id + "." + o.name, o.value, o.unit);
  }
  // A sum that leaves out a system would be misleading.
  for (size_t k = 0; k < 3; ++k) {
    if (known[k]) total.add(kSums[k], sums[k], "J");
  }
  for (const Observation& o : own.rows()) total.add(o.name, o.value, o.unit);
  return total;
}

std::vector<Observation> known_observables(const BuiltScene& parts) {
  std::vector<State> systems(parts.systems.size()), couplings(parts.couplings.size());
  for (size_t i = 0; i < systems.size(); ++i) {
    if (parts.systems[i]) systems[i] = parts.systems[i]->initial_state();
  }
  for (size_t k = 0; k < couplings.size(); ++k) {
    if (parts.couplings[k]) couplings[k] = parts.couplings[k]->initial_state();
  }
  std::vector<Observation> out = observe_parts(parts, systems, couplings, 0, {}).rows();
  const PartTable table(parts.scene, parts.systems);
  for (const ProbeParams& p : parts.scene.header.probes) {
    for (const std::string& field : probed_fields(table, p)) {
      const FieldPlace at = *table.find(p.system, field);
      const FieldInfo& f = table[at.part].info().fields[at.field];
      for (const std::string& name : component_names(p.id + "." + field, f.width))
        out.push_back({name, std::nan(""), f.unit});
    }
  }
  if (parts.scene.header.accuracy) out.push_back({"error.estimate", std::nan(""), "1"});
  return out;
}

void check_references(const BuiltScene& parts, std::vector<Issue>& issues) {
  Checker(parts, issues).run();
}

}  // namespace truestep
