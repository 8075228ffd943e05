#include "engine/scene/scene.h"

#include <algorithm>

#include "engine/base/random.h"
#include "engine/scene/json.h"
#include "engine/scene/params.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr size_t kMaxSystems = 256;

std::vector<std::string> type_names() {
  std::vector<std::string> names;
  for (const CatalogueRow& row : catalogue()) names.emplace_back(row.type);
  return names;
}

std::string join(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

bool good_id(std::string_view id) {
  if (id.empty() || id.size() > 64) return false;
  return std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// "type" picks the row; then "id" and the row's own parameters.
void read_system(const json::value& v, size_t index, Scene& scene, std::vector<Issue>& errors) {
  const std::string where = "/systems/" + std::to_string(index);
  if (!v.is_object()) {
    errors.push_back(
        {where, "wrong_type", "a system is an object", shorten(v), "an object with \"type\"", "", ""});
    return;
  }
  const json::object& o = v.as_object();
  const json::value* type = o.if_contains("type");
  const std::vector<std::string> names = type_names();
  const std::string name = type && type->is_string() ? std::string(type->as_string().c_str()) : "";
  const CatalogueRow* row = find_system_type(name);
  if (!row) {
    errors.push_back({where + "/type", type ? "unknown_choice" : "missing",
                      type ? "no system has this type" : "\"type\" is required", type ? shorten(*type) : "",
                      join(names), nearest_name(name, names), ""});
    return;
  }
  SceneSystem system{std::string(row->type) + std::to_string(index), row, row->table->make()};
  if (const json::value* id = o.if_contains("id")) {
    const bool good = id->is_string() && good_id({id->as_string().data(), id->as_string().size()});
    if (good) {
      system.id = id->as_string().c_str();
    } else {
      errors.push_back({where + "/id", "bad_id", "an id is 1 to 64 letters, digits, _ or -", shorten(*id),
                        "[A-Za-z0-9_-]{1,64}", "", ""});
    }
  }
  for (const SceneSystem& other : scene.systems) {
    if (other.id == system.id) {
      errors.push_back(
          {where + "/id", "duplicate_id", "another system has this id", '"' + system.id + '"', "", "", ""});
    }
  }
  constexpr std::string_view kOwn[] = {"type", "id"};
  read_params(*row->table, system.def.get(), o, where, kOwn, errors);
  scene.systems.push_back(std::move(system));
}

// References from the header to systems.
void check_references(const Scene& scene, std::vector<Issue>& errors) {
  std::vector<std::string> ids;
  for (const SceneSystem& s : scene.systems) ids.push_back(s.id);
  for (size_t i = 0; i < scene.header.probes.size(); ++i) {
    const ProbeParams& p = scene.header.probes[i];
    const std::string where = "/probes/" + std::to_string(i);
    if (std::find(ids.begin(), ids.end(), p.system) == ids.end()) {
      errors.push_back({where + "/system", "unknown_system", "no system has this id", '"' + p.system + '"',
                        join(ids), nearest_name(p.system, ids), ""});
    }
    if (!good_id(p.id)) {
      errors.push_back({where + "/id", "bad_id", "an id is 1 to 64 letters, digits, _ or -",
                        '"' + p.id.substr(0, 64) + '"', "[A-Za-z0-9_-]{1,64}", "", ""});
    }
  }
}

}  // namespace

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
  return o;
}

SceneReport read_scene(const json::value& document) {
  SceneReport report;
  if (!document.is_object()) {
    report.errors.push_back(
        {"", "wrong_type", "a scene is a JSON object", shorten(document), "an object", "", ""});
    return report;
  }
  const json::object& o = document.as_object();
  Scene scene;
  constexpr std::string_view kOwn[] = {"systems"};
  read_params(scene_table(), &scene.header, o, "", kOwn, report.errors);
  const json::value* systems = o.if_contains("systems");
  if (!systems || !systems->is_array() || systems->as_array().empty() ||
      systems->as_array().size() > kMaxSystems) {
    report.errors.push_back({"/systems", systems ? "wrong_type" : "missing", "a scene has 1 to 256 systems",
                             systems ? shorten(*systems) : "", "an array of 1 to 256 objects", "", ""});
  } else {
    for (size_t i = 0; i < systems->as_array().size(); ++i)
      read_system(systems->as_array()[i], i, scene, report.errors);
    if (report.errors.empty()) check_references(scene, report.errors);
  }
  if (scene.header.expect.empty() && !scene.header.teaches.empty()) {
    report.warnings.push_back({"/expect", "no_expectation",
                               "a scene that teaches something should say what to expect", "", "", "", ""});
  }
  if (report.errors.empty()) report.scene = std::move(scene);
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
  json::array systems;
  for (const CatalogueRow& row : catalogue()) {
    json::object s = schema_of(*row.table);
    json::object properties{{"type", json::object{{"const", row.type}}},
                            {"id", json::object{{"type", "string"}, {"pattern", "^[A-Za-z0-9_-]{1,64}$"}}}};
    for (auto& [key, value] : s["properties"].as_object()) properties[key] = std::move(value);
    s["properties"] = std::move(properties);
    s["description"] = row.sentence;
    if (!s.contains("required")) s["required"] = json::array{};
    s["required"].as_array().insert(s["required"].as_array().begin(), json::value("type"));
    systems.push_back(std::move(s));
  }
  json::object array{{"type", "array"},
                     {"minItems", 1},
                     {"maxItems", kMaxSystems},
                     {"items", json::object{{"oneOf", std::move(systems)}}}};
  schema["properties"].as_object()["systems"] = std::move(array);
  if (!schema.contains("required")) schema["required"] = json::array{};
  schema["required"].as_array().emplace_back("systems");
  json::object out{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                   {"title", "Truestep scene 1.0"}};
  for (auto& [key, value] : schema) out[key] = std::move(value);
  return out;
}

}  // namespace truestep
