#include "engine/scene/scene.h"

#include <algorithm>

#include "engine/base/random.h"
#include "engine/integrators/table/integrators.h"
#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"
#include "engine/scene/row_references.h"
#include "engine/scene/scene_test.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr size_t kMaxSystems = 256, kMaxCouplings = 256;

template <class Row>
std::vector<std::string> type_names(std::span<const Row> rows) {
  std::vector<std::string> names;
  for (const Row& row : rows) names.emplace_back(row.type);
  return names;
}

bool good_id(std::string_view id) {
  if (id.empty() || id.size() > 64) return false;
  return std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// The row named by the object's "type"; null and a fault otherwise.
template <class Row>
const Row* read_type(const json::value& v, const std::string& where, const std::string& noun,
                     std::span<const Row> rows, std::vector<Issue>& errors) {
  if (!v.is_object()) {
    errors.push_back(
        {where, "wrong_type", "a " + noun + " is an object", shorten(v), "an object with \"type\"", "", ""});
    return nullptr;
  }
  const json::value* type = v.as_object().if_contains("type");
  const std::vector<std::string> names = type_names(rows);
  const std::string name = type && type->is_string() ? std::string(type->as_string().c_str()) : "";
  for (const Row& row : rows) {
    if (row.type == name) return &row;
  }
  errors.push_back({where + "/type", type ? "unknown_choice" : "missing",
                    type ? "no " + noun + " has this type" : "\"type\" is required",
                    type ? shorten(*type) : "", join_names(names), nearest_name(name, names), ""});
  return nullptr;
}

// The object's "id", or `otherwise`; an invalid id is a fault.
std::string read_id(const json::object& o, const std::string& where, std::string otherwise,
                    std::vector<Issue>& errors) {
  const json::value* id = o.if_contains("id");
  if (!id) return otherwise;
  if (id->is_string() && good_id({id->as_string().data(), id->as_string().size()})) {
    return id->as_string().c_str();
  }
  errors.push_back({where + "/id", "bad_id", "an id must have 1 to 64 letters, digits, _ or -", shorten(*id),
                    "[A-Za-z0-9_-]{1,64}", "", ""});
  return otherwise;
}

void require_new_id(const Scene& scene, const std::string& id, const std::string& where,
                    std::vector<Issue>& errors) {
  const auto taken = [&](const auto& other) { return other.id == id; };
  if (std::any_of(scene.systems.begin(), scene.systems.end(), taken)) {
    errors.push_back(
        {where + "/id", "duplicate_id", "another system has this id", '"' + id + '"', "", "", ""});
  } else if (std::any_of(scene.couplings.begin(), scene.couplings.end(), taken)) {
    errors.push_back(
        {where + "/id", "duplicate_id", "another coupling has this id", '"' + id + '"', "", "", ""});
  }
}

// Which methods suit a system is known only once it is built; a name that no method has is always a fault.
// Returns whether it is one.
bool unknown_method(const json::object& o, const CatalogueRow& row, const std::string& where,
                    std::vector<Issue>& errors) {
  const json::value* given = o.if_contains("integrator");
  if (!given || !given->is_string() || !row.table->find("integrator")) return false;
  const std::string name(given->as_string());
  std::vector<std::string> names(row.own_integrators.begin(), row.own_integrators.end());
  for (const Integrator& m : integrators()) names.emplace_back(m.name);
  if (name.empty() || std::find(names.begin(), names.end(), name) != names.end()) return false;
  errors.push_back({where + "/integrator", "unknown_integrator", "no integrator has this name",
                    shorten(*given), join_names(names), nearest_name(name, names), ""});
  return true;
}

// "type" picks the row; then "id" and the row's own parameters.
void read_system(const json::value& v, size_t index, Scene& scene, SceneReport& report) {
  std::vector<Issue>& errors = report.errors;
  const std::string where = "/systems/" + std::to_string(index);
  const CatalogueRow* row = read_type(v, where, "system", catalogue(), errors);
  if (!row) {
    if (v.is_object()) report.lost_ids.push_back(read_id(v.as_object(), where, "", errors));
    return;
  }
  SceneSystem system{read_id(v.as_object(), where, std::string(row->type) + std::to_string(index), errors),
                     row, row->table->make(), index};
  require_new_id(scene, system.id, where, errors);
  constexpr std::string_view kOwn[] = {"type", "id"};
  const size_t known = errors.size();
  const auto with_rows = with_own_rows(v.as_object(), *row, where, errors);
  system.reading =
      read_params(*row->table, system.def.get(), with_rows ? *with_rows : v.as_object(), where, kOwn, errors);
  if (errors.size() > known) system.reading = Reading::faulty;
  // A sound system is built and reports its methods itself, except for methods that serve only this type.
  const bool asked_here = system.reading == Reading::faulty || !row->own_integrators.empty();
  if (asked_here && unknown_method(v.as_object(), *row, where, errors)) system.reading = Reading::faulty;
  scene.systems.push_back(std::move(system));
}

// Index of the system that a coupling's "a" or "b" names.
size_t read_side(const json::object& o, std::string_view member, const std::string& where, const Scene& scene,
                 SceneReport& report) {
  std::vector<std::string> ids;
  for (const SceneSystem& s : scene.systems) ids.push_back(s.id);
  const json::value* v = o.if_contains(member);
  const std::string id = v && v->is_string() ? std::string(v->as_string().c_str()) : "";
  const auto at = std::find(ids.begin(), ids.end(), id);
  const auto& lost = report.lost_ids;
  if (at == ids.end() && std::find(lost.begin(), lost.end(), id) == lost.end()) {
    const std::string name(member);
    report.errors.push_back({where + "/" + name, v ? "unknown_system" : "missing",
                             v ? "no system has this id" : "\"" + name + "\" is required: id of a system",
                             v ? shorten(*v) : "", join_names(ids), nearest_name(id, ids), ""});
  }
  return static_cast<size_t>(at - ids.begin());
}

void read_coupling(const json::value& v, size_t index, Scene& scene, SceneReport& report) {
  std::vector<Issue>& errors = report.errors;
  const std::string where = "/couplings/" + std::to_string(index);
  const CouplingRow* row = read_type(v, where, "coupling", coupling_catalogue(), errors);
  if (!row) return;
  const json::object& o = v.as_object();
  SceneCoupling c;
  c.id = read_id(o, where, std::string(row->type) + std::to_string(index), errors);
  require_new_id(scene, c.id, where, errors);
  c.a = read_side(o, "a", where, scene, report);
  c.b = read_side(o, "b", where, scene, report);
  c.row = row;
  c.place = index;
  c.def = row->table->make();
  constexpr std::string_view kOwn[] = {"type", "id", "a", "b"};
  const bool sides = std::max(c.a, c.b) < scene.systems.size();
  const size_t known = errors.size();
  const json::object with_rows =
      sides ? with_rows_of_sides(o, *row, scene.systems[c.a], scene.systems[c.b], where, errors) : o;
  c.reading = read_params(*row->table, c.def.get(), with_rows, where, kOwn, errors);
  if (!sides || errors.size() > known) c.reading = Reading::faulty;
  scene.couplings.push_back(std::move(c));
}

void read_couplings(const json::value& v, Scene& scene, SceneReport& report) {
  if (!v.is_array() || v.as_array().size() > kMaxCouplings) {
    report.errors.push_back({"/couplings", v.is_array() ? "too_many" : "wrong_type",
                             "couplings must be an array of at most 256 objects", shorten(v),
                             "an array of at most 256 objects", "", ""});
    return;
  }
  for (size_t i = 0; i < v.as_array().size(); ++i) read_coupling(v.as_array()[i], i, scene, report);
}

// Schema of one system or coupling: its type and the common members, then the row's parameters.
json::object typed_schema(std::string_view type, std::string_view sentence, const DefTable& table,
                          json::object properties, std::vector<std::string_view> required) {
  json::object s = schema_of(table);
  for (auto& [key, value] : s["properties"].as_object()) properties[key] = std::move(value);
  properties["type"] = json::object{{"const", type}};
  properties["id"] = json::object{{"type", "string"}, {"pattern", "^[A-Za-z0-9_-]{1,64}$"}};
  s["properties"] = std::move(properties);
  s["description"] = sentence;
  json::array all(required.begin(), required.end());
  if (const json::value* own = s.if_contains("required")) {
    all.insert(all.end(), own->as_array().begin(), own->as_array().end());
  }
  s["required"] = std::move(all);
  return s;
}

// Bodies, points and springs are not resolved by steps of minutes, and some of their loops take time in
// proportion to the step.
void check_substep(const Scene& scene, std::vector<Issue>& errors) {
  for (const SceneSystem& s : scene.systems) {
    if (scene.substep() <= s.row->longest_substep) continue;
    errors.push_back({"/time/dt", "out_of_range",
                      "a system of type " + std::string(s.row->type) + " takes no substep this long",
                      write_json(json::value(scene.header.time.dt)),
                      "at most " + write_json(json::value(s.row->longest_substep)) + " s a substep", "",
                      "s"});
    return;
  }
}

// A request for accuracy needs a system whose method can be chosen.
void check_accuracy(const Scene& scene, std::vector<Issue>& errors) {
  if (!scene.header.accuracy) return;
  const std::string& id = scene.header.accuracy->system;
  if (scene.integrated_system(id)) return;
  std::vector<std::string> fit;
  for (const SceneSystem& s : scene.systems) {
    if (scene.integrated_system(s.id)) fit.push_back(s.id);
  }
  std::vector<std::string> types;
  for (const CatalogueRow& row : catalogue()) {
    if (row.table->find("integrator")) types.emplace_back(row.type);
  }
  errors.push_back(
      {"/accuracy/system", "unknown_system",
       "accuracy chooses an integrator and its step: it needs a system of type " + join_names(types),
       '"' + id.substr(0, 64) + '"', fit.empty() ? "a system of such a type" : join_names(fit),
       nearest_name(id, fit), ""});
}

// Ids of probes, and of the systems that they refer to.
void check_probes(const Scene& scene, SceneReport& report) {
  std::vector<Issue>& errors = report.errors;
  std::vector<std::string> ids;
  for (const SceneSystem& s : scene.systems) ids.push_back(s.id);
  const auto lost = [&](const std::string& id) {
    return std::find(report.lost_ids.begin(), report.lost_ids.end(), id) != report.lost_ids.end();
  };
  for (size_t i = 0; i < scene.header.probes.size(); ++i) {
    const ProbeParams& p = scene.header.probes[i];
    const std::string where = "/probes/" + std::to_string(i);
    const std::string owner = p.system.substr(0, p.system.find('.'));  // for the part "owner.part"
    if (std::find(ids.begin(), ids.end(), owner) == ids.end() && !lost(owner)) {
      errors.push_back({where + "/system", "unknown_system", "no system has this id", '"' + p.system + '"',
                        join_names(ids), nearest_name(p.system, ids), ""});
    }
    if (!good_id(p.id)) {
      errors.push_back({where + "/id", "bad_id", "an id must have 1 to 64 letters, digits, _ or -",
                        '"' + p.id.substr(0, 64) + '"', "[A-Za-z0-9_-]{1,64}", "", ""});
    }
    for (size_t k = 0; k < i; ++k) {
      if (scene.header.probes[k].id != p.id) continue;
      errors.push_back({where + "/id", "duplicate_id", "probe " + std::to_string(k) + " has this id",
                        '"' + p.id.substr(0, 64) + '"', "", "", ""});
      break;
    }
  }
}

void warn_of_empty_systems(const Scene& scene, std::vector<Issue>& warnings) {
  for (const SceneSystem& s : scene.systems) {
    if (s.row->cost(s.def.get()).elements > 0) continue;
    warnings.push_back({"/systems/" + std::to_string(s.place), "empty",
                        "the system \"" + s.id + "\" has nothing in it: it only has what commands spawn", "",
                        "", "", ""});
  }
}

}  // namespace

std::optional<size_t> Scene::integrated_system(std::string_view id) const {
  for (size_t i = 0; i < systems.size(); ++i) {
    if ((id.empty() || systems[i].id == id) && systems[i].row->table->find("integrator")) return i;
  }
  return std::nullopt;
}

BuildContext Scene::context(size_t system) const {
  BuildContext c;
  c.id = systems[system].id;
  c.gravity = header.gravity;
  c.dt = substep();
  const auto r = philox4x32({static_cast<uint32_t>(system), 0, 0, 0},
                            {static_cast<uint32_t>(header.seed), static_cast<uint32_t>(header.seed >> 32)});
  c.seed = uint64_t{r[0]} << 32 | r[1];
  return c;
}

json::object Scene::canonical() const {
  json::object o = write_params(scene_table(), &header);
  json::array list;
  for (const SceneSystem& s : systems) {
    json::object entry{{"type", s.row->type}, {"id", s.id}};
    for (auto& [key, value] : write_params(*s.row->table, s.def.get())) entry[key] = std::move(value);
    list.push_back(std::move(entry));
  }
  o["systems"] = std::move(list);
  if (couplings.empty()) return o;
  json::array joined;
  for (const SceneCoupling& c : couplings) {
    json::object entry{{"type", c.row->type}, {"id", c.id}, {"a", systems[c.a].id}, {"b", systems[c.b].id}};
    for (auto& [key, value] : write_params(*c.row->table, c.def.get())) entry[key] = std::move(value);
    joined.push_back(std::move(entry));
  }
  o["couplings"] = std::move(joined);
  return o;
}

SceneReport read_scene(const json::value& document) {
  SceneReport report;
  if (!document.is_object()) {
    report.errors.push_back(
        {"", "wrong_type", "a scene must be a JSON object", shorten(document), "an object", "", ""});
    return report;
  }
  const json::object& o = document.as_object();
  Scene scene;
  constexpr std::string_view kOwn[] = {"systems", "couplings", "test"};
  const auto numbered = without_names_of_probes(o);
  read_params(scene_table(), &scene.header, numbered ? *numbered : o, "", kOwn, report.errors);
  if (const json::value* test = o.if_contains("test")) read_scene_test(*test, "/test", report.errors);
  const json::value* systems = o.if_contains("systems");
  if (!systems || !systems->is_array() || systems->as_array().empty() ||
      systems->as_array().size() > kMaxSystems) {
    report.errors.push_back({"/systems", systems ? "wrong_type" : "missing",
                             "a scene must have 1 to 256 systems", systems ? shorten(*systems) : "",
                             "an array of 1 to 256 objects", "", ""});
  } else {
    for (size_t i = 0; i < systems->as_array().size(); ++i)
      read_system(systems->as_array()[i], i, scene, report);
    if (const json::value* couplings = o.if_contains("couplings")) {
      read_couplings(*couplings, scene, report);
    }
    check_substep(scene, report.errors);
    check_probes(scene, report);
    name_rows_of_probes(o, scene, report.errors);
    if (report.lost_ids.empty()) check_accuracy(scene, report.errors);
  }
  if (scene.header.expect.empty() && !scene.header.teaches.empty()) {
    report.warnings.push_back({"/expect", "no_expectation",
                               "a scene with \"teaches\" should also have \"expect\"", "", "", "", ""});
  }
  if (report.errors.empty()) warn_of_empty_systems(scene, report.warnings);
  (report.errors.empty() ? report.scene : report.draft) = std::move(scene);
  return report;
}

Scene require_scene(SceneReport report) {
  if (!report.scene) {
    const size_t n = report.errors.size();
    throw Error("scene_invalid", "the scene has " + std::to_string(n) + (n == 1 ? " fault" : " faults"),
                std::move(report.errors));
  }
  return std::move(*report.scene);
}

Scene parse_scene(std::string_view text) {
  return require_scene(read_scene(parse_json(text)));
}

json::object scene_schema() {
  json::object schema = schema_of(scene_table());
  json::array systems, couplings;
  for (const CatalogueRow& row : catalogue()) {
    systems.push_back(typed_schema(row.type, row.sentence, *row.table, {}, {"type"}));
  }
  const json::object side{{"type", "string"}, {"description", "id of a system"}};
  for (const CouplingRow& row : coupling_catalogue()) {
    couplings.push_back(
        typed_schema(row.type, row.sentence, *row.table, {{"a", side}, {"b", side}}, {"type", "a", "b"}));
  }
  json::object array{{"type", "array"},
                     {"minItems", 1},
                     {"maxItems", kMaxSystems},
                     {"items", json::object{{"oneOf", std::move(systems)}}}};
  schema["properties"].as_object()["systems"] = std::move(array);
  schema["properties"].as_object()["couplings"] =
      json::object{{"type", "array"},
                   {"description", "interactions between systems"},
                   {"maxItems", kMaxCouplings},
                   {"items", json::object{{"oneOf", std::move(couplings)}}}};
  schema["properties"].as_object()["test"] = scene_test_schema();
  if (!schema.contains("required")) schema["required"] = json::array{};
  schema["required"].as_array().emplace_back("systems");
  allow_ids(schema);
  json::object out{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                   {"title", "Truestep scene 1.0"}};
  for (auto& [key, value] : schema) out[key] = std::move(value);
  return out;
}

}  // namespace truestep
