#include "engine/scene/row_references.h"

#include <algorithm>
#include <charconv>
#include <functional>

#include "engine/base/text/nearest_name.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"
#include "engine/scene/row_names.h"

namespace truestep {
namespace {

namespace json = boost::json;

using Names = std::vector<FirstRow>;

std::string_view view_of(const json::value& v) {
  return {v.as_string().data(), v.as_string().size()};
}

// "crate", or "crate.3" for the fourth of its copies; as observables call them.
std::optional<int64_t> row_called(std::string_view id, const Names& names) {
  for (const FirstRow& n : names) {
    if (n.id == id) return static_cast<int64_t>(n.row);
  }
  const size_t dot = id.rfind('.');
  if (dot == std::string_view::npos) return std::nullopt;
  size_t k = 0;
  const char* last = id.data() + id.size();
  if (const auto r = std::from_chars(id.data() + dot + 1, last, k); r.ec != std::errc() || r.ptr != last)
    return std::nullopt;
  for (const FirstRow& n : names) {
    if (n.id == id.substr(0, dot) && k < n.count) return static_cast<int64_t>(n.row + k);
  }
  return std::nullopt;
}

// The row for the id, or a fault.
void resolve(json::value& v, const Names& names, const char* noun, const std::string& where,
             std::vector<Issue>& errors) {
  if (!v.is_string()) return;
  const std::string id(view_of(v));
  if (const auto row = row_called(id, names)) {
    v = *row;
    return;
  }
  std::vector<std::string> ids;
  for (const FirstRow& n : names) ids.push_back(n.id);
  errors.push_back({where, "unknown_name", std::string("no ") + noun + " has this id", shorten(v),
                    ids.empty() ? "a row" : "a row, or an id: " + join_names(ids), nearest_name(id, ids),
                    ""});
  v = 0;
}

constexpr std::string_view kBodyMembers[] = {"a", "b"}, kJointMembers[] = {"first", "second"};

template <class F>
void each_member(json::object& joint, std::span<const std::string_view> members, F f) {
  for (const std::string_view m : members) {
    if (json::value* v = joint.if_contains(m)) f(*v, m);
  }
}

bool names_rows(const json::object& joint) {
  const auto any = [&](std::span<const std::string_view> members) {
    return std::ranges::any_of(members, [&](std::string_view m) {
      const json::value* v = joint.if_contains(m);
      return v && v->is_string();
    });
  };
  return any(kBodyMembers) || any(kJointMembers);
}

Names names_of_joints(const json::array& joints) {
  Names out;
  size_t row = 0;
  for (const json::value& v : joints) {
    const json::object* o = v.if_object();
    const json::value* id = o ? o->if_contains("id") : nullptr;
    const json::value* repeat = o ? o->if_contains("repeat") : nullptr;
    const size_t n =
        repeat && repeat->is_int64() && repeat->as_int64() > 0 ? static_cast<size_t>(repeat->as_int64()) : 1;
    if (id && id->is_string()) out.push_back({std::string(view_of(*id)), row, n});
    row += n;
  }
  return out;
}

/// A member of a coupling that holds rows of one side.
struct Reference {
  std::string_view coupling, member;
  enum class Side : uint8_t { a, b } side;
};
constexpr Reference kReferences[] = {
    {"attachment", "a_points", Reference::Side::a}, {"attachment", "b_points", Reference::Side::b},
    {"drive", "index", Reference::Side::b},         {"drive", "body", Reference::Side::b},
    {"ragdoll", "bodies", Reference::Side::b},      {"ragdoll", "impact_bodies", Reference::Side::b}};

Names with_ends(Names names) {
  names.push_back({"first", 0, 1});
  names.push_back({"last", static_cast<size_t>(-1), 1});
  return names;
}

void allow(json::object& properties, std::string_view member) {
  json::value* v = properties.if_contains(member);
  if (!v || !v->is_object()) return;
  json::object& o = v->as_object();
  if (json::value* items = o.if_contains("items")) {
    json::object row = items->as_object();
    *items = json::object{{"anyOf", json::array{row, json::object{{"type", "string"}}}}};
    return;
  }
  json::object row = o, both;
  for (const char* kept : {"description", "x-unit", "default"}) {
    if (!row.contains(kept)) continue;
    both[kept] = row.at(kept);
    row.erase(kept);
  }
  both["anyOf"] = json::array{row, json::object{{"type", "string"}}};
  *v = std::move(both);
}

}  // namespace

std::optional<json::object> with_own_rows(const json::object& system, const CatalogueRow& row,
                                          const std::string& where, std::vector<Issue>& errors) {
  const json::value* joints = system.if_contains("joints");
  if (!joints || !joints->is_array() || (row.type != "rigid2d" && row.type != "rigid3d")) return std::nullopt;
  if (std::ranges::none_of(joints->as_array(),
                           [](const json::value& j) { return j.is_object() && names_rows(j.as_object()); }))
    return std::nullopt;
  json::object out = system;
  json::array& list = out.at("joints").as_array();
  // The bodies alone, for the rows of their copies; their faults are told when the whole is read.
  json::object alone;
  for (const char* kept : {"bodies", "generators"}) {
    if (const json::value* v = system.if_contains(kept)) alone[kept] = *v;
  }
  SceneSystem bodies{"", &row, row.table->make(), 0};
  std::vector<Issue> unused;
  read_params(*row.table, bodies.def.get(), alone, where, {}, unused);
  const Names of_bodies = first_rows(bodies), of_joints = names_of_joints(list);
  for (size_t k = 0; k < list.size(); ++k) {
    if (!list[k].is_object()) continue;
    const std::string at = where + "/joints/" + std::to_string(k) + "/";
    json::object& joint = list[k].as_object();
    each_member(joint, kBodyMembers, [&](json::value& v, std::string_view m) {
      if (v.is_string() && view_of(v) == "world") v = -1;
      resolve(v, of_bodies, "body", at + std::string(m), errors);
    });
    each_member(joint, kJointMembers, [&](json::value& v, std::string_view m) {
      resolve(v, of_joints, "joint", at + std::string(m), errors);
    });
  }
  return out;
}

json::object with_rows_of_sides(const json::object& coupling, const CouplingRow& row, const SceneSystem& a,
                                const SceneSystem& b, const std::string& where, std::vector<Issue>& errors) {
  json::object out = coupling;
  for (const Reference& r : kReferences) {
    json::value* v = r.coupling == row.type ? out.if_contains(r.member) : nullptr;
    if (!v) continue;
    const std::string at = where + "/" + std::string(r.member);
    const auto names = [&] {
      const Names own = first_rows(r.side == Reference::Side::a ? a : b);
      return row.type == "attachment" ? with_ends(own) : own;
    };
    if (v->is_string() && row.type == "attachment") *v = json::array{*v};
    if (v->is_string()) resolve(*v, names(), "body of that side", at, errors);
    if (!v->is_array()) continue;
    for (size_t k = 0; k < v->as_array().size(); ++k) {
      json::value& item = v->as_array()[k];
      if (item.is_string()) resolve(item, names(), "body of that side", at + "/" + std::to_string(k), errors);
    }
  }
  return out;
}

namespace {

template <class F>
void each_named_probe(json::object& document, F f) {
  json::value* probes = document.if_contains("probes");
  if (!probes || !probes->is_array()) return;
  for (size_t k = 0; k < probes->as_array().size(); ++k) {
    json::object* probe = probes->as_array()[k].if_object();
    json::value* index = probe ? probe->if_contains("index") : nullptr;
    if (index && index->is_string()) f(k, *index);
  }
}

}  // namespace

std::optional<json::object> without_names_of_probes(const json::object& scene) {
  bool named = false;
  json::object copy;
  if (const json::value* probes = scene.if_contains("probes")) copy["probes"] = *probes;
  each_named_probe(copy, [&](size_t, json::value& index) {
    index = 0;
    named = true;
  });
  if (!named) return std::nullopt;
  for (const auto& [key, value] : scene) {
    if (key != "systems" && key != "probes") copy[key] = value;
  }
  return copy;
}

void name_rows_of_probes(const json::object& document, Scene& scene, std::vector<Issue>& errors) {
  json::object copy;
  if (const json::value* probes = document.if_contains("probes")) copy["probes"] = *probes;
  each_named_probe(copy, [&](size_t k, json::value& index) {
    if (k >= scene.header.probes.size()) return;
    ProbeParams& probe = scene.header.probes[k];
    for (const SceneSystem& s : scene.systems) {
      if (s.id != probe.system) continue;
      resolve(index, first_rows(s), "body of that system", "/probes/" + std::to_string(k) + "/index", errors);
      probe.index = index.to_number<int64_t>();
    }
  });
}

void allow_ids(json::object& schema) {
  json::object& properties = schema.at("properties").as_object();
  const auto variants = [&](const char* list) -> json::array& {
    return properties.at(list).at("items").at("oneOf").as_array();
  };
  for (json::value& system : variants("systems")) {
    json::object& own = system.at("properties").as_object();
    const auto type = own.at("type").at("const").as_string();
    if (type != "rigid2d" && type != "rigid3d") continue;
    for (json::value& joint : own.at("joints").at("items").at("oneOf").as_array()) {
      for (const std::string_view m : kBodyMembers) allow(joint.at("properties").as_object(), m);
      for (const std::string_view m : kJointMembers) allow(joint.at("properties").as_object(), m);
    }
  }
  for (json::value& coupling : variants("couplings")) {
    json::object& own = coupling.at("properties").as_object();
    for (const Reference& r : kReferences) {
      if (view_of(own.at("type").at("const")) == r.coupling) allow(own, r.member);
    }
  }
  allow(properties.at("probes").at("items").at("properties").as_object(), "index");
}

}  // namespace truestep
