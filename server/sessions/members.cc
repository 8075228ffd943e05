#include "server/sessions/members.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/json/json.h"
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_text.h"

namespace truestep {

namespace json = boost::json;

void require_members(const json::object& body, std::span<const std::string_view> members) {
  const std::vector<std::string> names(members.begin(), members.end());
  std::vector<Issue> issues;
  for (const auto& [key, value] : body) {
    const std::string_view name(key.data(), key.size());
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    std::string pointer;
    append_pointer(pointer, name);
    issues.push_back({pointer, "unknown_key", "this request takes no such member", shorten(value),
                      names.empty() ? "no members" : join_names(names), nearest_name(name, names), ""});
  }
  if (!issues.empty()) throw Error("bad_request", "the request has faults", std::move(issues));
}

double number_member(const json::object& o, const char* name, double min, double max) {
  const json::value& v = o.at(name);
  const double x = v.is_number() ? v.to_number<double>() : NAN;
  if (!(x >= min && x <= max)) {
    throw Error(
        "bad_request", std::string(name) + " is out of range",
        {{std::string("/") + name, v.is_number() ? "out_of_range" : "wrong_type",
          "expected a number in the allowed range", v.is_structured() ? "" : write_json(v).substr(0, 80),
          write_json(json::value(min)) + " to " + write_json(json::value(max)), "", ""}});
  }
  return x;
}

uint64_t integer_member(const json::object& o, const char* name, uint64_t max) {
  const double x = number_member(o, name, 0, static_cast<double>(max));
  if (x != std::floor(x)) {
    throw Error("bad_request", std::string(name) + " must be a whole number",
                {{std::string("/") + name, "wrong_type", "expected a whole number", write_json(o.at(name)),
                  "0 to " + std::to_string(max), "", ""}});
  }
  return static_cast<uint64_t>(x);
}

bool boolean_member(const json::object& o, const char* name) {
  const json::value* v = o.if_contains(name);
  if (!v) return false;
  if (!v->is_bool()) {
    throw Error("bad_request", std::string(name) + " must be true or false",
                {{std::string("/") + name, "wrong_type", "expected true or false", shorten(*v), "true, false",
                  "", ""}});
  }
  return v->as_bool();
}

namespace {

[[noreturn]] void refuse_list(const std::string& pointer, const json::value& v, const std::string& wanted) {
  throw Error("bad_request", "the request has faults",
              {{pointer, "wrong_type", "expected " + wanted, shorten(v), wanted, "", ""}});
}

}  // namespace

const json::array* array_member(const json::object& o, const char* name, size_t most) {
  const json::value* v = o.if_contains(name);
  if (!v) return nullptr;
  const std::string pointer = std::string("/") + name;
  if (!v->is_array()) refuse_list(pointer, *v, "an array");
  if (v->as_array().size() > most) {
    throw Error("bad_request", "the request has faults",
                {{pointer, "out_of_range", "too many elements", std::to_string(v->as_array().size()),
                  "at most " + std::to_string(most), "", ""}});
  }
  return &v->as_array();
}

std::vector<std::string> names_member(const json::object& o, const char* name, size_t most) {
  std::vector<std::string> out;
  const json::array* names = array_member(o, name, most);
  for (size_t i = 0; names && i < names->size(); ++i) {
    const json::value& v = (*names)[i];
    if (!v.is_string()) refuse_list(std::string("/") + name + '/' + std::to_string(i), v, "a name");
    out.emplace_back(v.as_string());
  }
  return out;
}

}  // namespace truestep
