#include "engine/scene/file_references.h"

#include <algorithm>
#include <boost/json.hpp>
#include <cmath>
#include <fstream>
#include <sstream>

#include "engine/base/errors.h"
#include "engine/base/interrupt.h"
#include "engine/scene/file_value.h"
#include "engine/scene/json/json.h"

namespace truestep {

namespace json = boost::json;
namespace fs = std::filesystem;

namespace {

constexpr size_t kMostFile = size_t{64} << 20;       // bytes of one file
constexpr size_t kMostResolved = size_t{128} << 20;  // bytes of all files that a document refers to

/// One document's references while they are resolved.
struct Resolving {
  std::string_view key;
  const std::function<std::string(const std::string&)>& fetch;
  std::vector<Issue> issues = {};
  size_t bytes = 0;

  void value(json::value& v, const std::string& pointer) {
    if (is_reference(v)) {
      replace(v, pointer);
    } else if (json::object* o = v.if_object()) {
      for (auto& [name, member] : *o) {
        std::string at = pointer;
        append_pointer(at, {name.data(), name.size()});
        value(member, at);
      }
    } else if (json::array* a = v.if_array()) {
      // Lists of numbers are long and contain no references.
      for (size_t i = 0; i < a->size() && ((*a)[i].is_object() || (*a)[i].is_array()); ++i)
        value((*a)[i], pointer + "/" + std::to_string(i));
    }
  }

  bool is_reference(const json::value& v) const {
    const json::object* o = v.if_object();
    const json::value* name = o ? o->if_contains(key) : nullptr;
    if (!name || !name->is_string()) return false;
    return std::all_of(o->begin(), o->end(), [&](const auto& m) {
      return m.key() == key || m.key() == "as" || m.key() == "scale";
    });
  }

  void fault(const std::string& at, const char* code, const std::string& what, const std::string& value,
             const std::string& allowed) {
    issues.push_back({at, code, what, '"' + value.substr(0, 64) + '"', allowed, "", ""});
  }

  void replace(json::value& v, const std::string& pointer) {
    interruption_point();
    const json::object& o = v.get_object();
    const std::string name(o.at(key).get_string());
    const std::string at = pointer + "/" + std::string(key);
    FileUse use = FileUse::automatic;
    if (const json::value* as = o.if_contains("as")) {
      const auto given = as->is_string() ? std::string_view(as->get_string()) : std::string_view();
      const auto known = std::find(std::begin(kFileUses) + 1, std::end(kFileUses), given);
      if (known == std::end(kFileUses)) {
        return fault(pointer + "/as", "not_a_choice", "a file cannot be used as this", std::string(given),
                     "surface, cells, vertices, triangles, text, lines, gltf");
      }
      use = static_cast<FileUse>(known - std::begin(kFileUses));
    }
    double scale = 1;
    if (const json::value* s = o.if_contains("scale")) {
      scale = s->is_number() ? s->to_number<double>() : 0;
      if (!(scale > 0 && scale <= 1e9))
        return fault(pointer + "/scale", "out_of_range", "a scale must be a number", json::serialize(*s),
                     "above 0, at most 1e9");
    }
    try {
      const std::string text = fetch(name);
      bytes += text.size();
      if (bytes > kMostResolved)
        throw Error("too_large", "the scene's files are larger than 128 MiB together");
      v = file_value(text, use, scale);
    } catch (const FileFault& e) {
      fault(at, "bad_file", e.what(), name, "");
    } catch (const Error& e) {
      if (e.code() != "not_found") throw;
      fault(at, key == "asset" ? "unknown_asset" : "unknown_file", e.what(), name,
            key == "asset" ? "a hash given to PUT /v1/assets/{sha256}"
                           : "a file in the scene file's folder or below it");
    }
  }
};

std::string read_beside(const fs::path& folder, const std::string& name) {
  const fs::path path(name);
  const bool inside = !name.empty() && path.is_relative() &&
                      std::none_of(path.begin(), path.end(), [](const fs::path& p) { return p == ".."; });
  if (!inside) throw Error("not_found", "a path must lead to a file in the scene file's folder or below it");
  std::error_code failed;
  // Links must not lead out of the folder either.
  const fs::path whole = fs::weakly_canonical(folder / path, failed), root = fs::weakly_canonical(folder);
  const auto [end, rest] = std::mismatch(root.begin(), root.end(), whole.begin(), whole.end());
  if (failed || end != root.end())
    throw Error("not_found", "a path must lead to a file in the scene file's folder or below it");
  if (!fs::is_regular_file(whole, failed)) throw Error("not_found", "there is no such file");
  if (fs::file_size(whole, failed) > kMostFile)
    throw Error("too_large", "the file " + name + " is larger than 64 MiB");
  std::ifstream file(whole, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw Error("not_found", "the file cannot be read");
  return std::move(text).str();
}

}  // namespace

void resolve_files(json::value& document, std::string_view key,
                   const std::function<std::string(const std::string&)>& fetch) {
  Resolving all{key, fetch};
  all.value(document, "");
  if (!all.issues.empty()) {
    const Issue& first = all.issues.front();
    const std::string detail = all.issues.size() == 1 ? first.pointer + ": " + first.message
                                                      : "the scene refers to files that cannot be used";
    throw Error("scene_invalid", detail, std::move(all.issues));
  }
}

void resolve_paths(json::value& document, const fs::path& folder) {
  resolve_files(document, "path", [&](const std::string& name) { return read_beside(folder, name); });
}

}  // namespace truestep
