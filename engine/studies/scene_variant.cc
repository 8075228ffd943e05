#include "engine/studies/scene_variant.h"

#include <charconv>

#include "engine/base/errors.h"
#include "engine/scene/admission.h"

namespace truestep {

namespace json = boost::json;

namespace {

[[noreturn]] void bad_pointer(std::string_view pointer, const std::string& why) {
  throw Error("bad_pointer", "the scene has no place " + std::string(pointer) + ": " + why,
              {"", "bad_pointer", why, '"' + std::string(pointer.substr(0, 200)) + '"',
               "a JSON pointer to a value of the scene", "", ""});
}

std::string unescaped(std::string_view token) {
  std::string out;
  for (size_t i = 0; i < token.size(); ++i) {
    if (token[i] == '~' && i + 1 < token.size()) {
      out += token[++i] == '0' ? '~' : '/';
    } else {
      out += token[i];
    }
  }
  return out;
}

}  // namespace

void set_at(json::value& document, std::string_view pointer, json::value value) {
  if (pointer.empty() || pointer.front() != '/') bad_pointer(pointer, "a pointer starts with /");
  json::value* at = &document;
  for (std::string_view rest = pointer; !rest.empty();) {
    rest.remove_prefix(1);
    const size_t end = std::min(rest.find('/'), rest.size());
    const std::string token = unescaped(rest.substr(0, end));
    rest.remove_prefix(end);
    if (json::object* o = at->if_object()) {
      at = &(*o)[token];
      if (!rest.empty() && at->is_null()) at->emplace_object();
    } else if (json::array* a = at->if_array()) {
      size_t index = 0;
      const auto [last, fault] = std::from_chars(token.data(), token.data() + token.size(), index);
      if (fault != std::errc() || last != token.data() + token.size() || index >= a->size())
        bad_pointer(pointer, "the array there has " + std::to_string(a->size()) + " elements");
      at = &(*a)[index];
    } else {
      bad_pointer(pointer, "it leads through a value that is no object or array");
    }
  }
  *at = std::move(value);
}

void set_dt(json::value& document, double dt) {
  set_at(document, "/time/dt", dt);
  set_at(document, "/time/substeps", 1);
}

void set_integrator(json::value& document, size_t system, std::string_view name) {
  set_at(document, "/systems/" + std::to_string(system) + "/integrator", json::string(name));
}

void set_tolerance(json::value& document, size_t system, double tolerance) {
  set_at(document, "/systems/" + std::to_string(system) + "/tolerance", tolerance);
}

Scene read_variant(const json::value& document, const StudyContext& context) {
  Scene scene = require_scene(read_scene(document));
  if (context.admit) context.admit(estimate(scene));
  return scene;
}

World build_world(const json::value& document, const StudyContext& context) {
  return World(read_variant(document, context));
}

size_t studied_system(const Scene& scene, std::string_view id) {
  if (const auto found = scene.integrated_system(id)) return *found;
  std::string ids;
  for (const SceneSystem& s : scene.systems) {
    if (scene.integrated_system(s.id)) ids += (ids.empty() ? "" : ", ") + s.id;
  }
  throw Error("scene_invalid", "no system of the scene fits the study",
              {"/system", "unknown_system", "the study needs a system with an integrator",
               '"' + std::string(id.substr(0, 64)) + '"', ids, "", ""});
}

}  // namespace truestep
