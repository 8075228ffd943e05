#include "server/sessions/look.h"

#include <algorithm>
#include <cmath>

#include "engine/base/error_place.h"
#include "engine/session/snapshot/references.h"
#include "server/sessions/members.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr size_t kMostNames = 256, kMostQueries = 100;

void require_observables(const World& world, const std::vector<std::string>& names) {
  std::vector<Issue> issues;
  const auto known = world.known_observables();
  for (size_t i = 0; i < names.size(); ++i) {
    if (auto fault = unknown_observable(names[i], "/observe/" + std::to_string(i), known))
      issues.push_back(std::move(*fault));
  }
  if (!issues.empty()) throw Error("invalid", "no observable has this name", std::move(issues));
}

// Names that this scene does not have are no fault of the request's form.
std::vector<WireField> known_fields(const World& world, const std::vector<std::string>& fields,
                                    const std::vector<std::string>& systems, WireEncoding encoding) try {
  return wire_fields(world, fields, systems, encoding);
} catch (const Error& e) {
  throw Error(e.code() == "bad_request" ? "invalid" : e.code(), e.what(), e.issues());
}

}  // namespace

Look::Look(const json::object& wish, const World& world, WireEncoding encoding)
    : observe_(names_member(wish, "observe", kMostNames)),
      all_observables_(wish.contains("observe") && observe_.empty()),
      has_fields_(wish.contains("fields")),
      has_queries_(wish.contains("queries")) {
  require_observables(world, observe_);
  const std::vector<std::string> systems = names_member(wish, "systems", kMostNames);
  if (has_fields_) {
    fields_ = known_fields(world, names_member(wish, "fields", kMostNames), systems, encoding);
  } else if (wish.contains("systems")) {
    throw Error("invalid", "the request has faults",
                {{"/systems", "inconsistent", "systems says whose fields; none are asked for", "",
                  "with \"fields\"", "", ""}});
  }
  const json::array* queries = array_member(wish, "queries", kMostQueries);
  for (size_t i = 0; queries && i < queries->size(); ++i) {
    try {
      queries_.push_back(read_query(world, (*queries)[i]));
    } catch (const Error& e) {
      throw placed_below(e, "/queries/" + std::to_string(i));
    }
  }
}

json::object Look::seen(const Session& session) const {
  json::object out;
  if (all_observables_ || !observe_.empty()) {
    json::object values;
    const Observables all = session.observe();
    for (const Observation& o : all.rows()) {
      const auto wants = [&](const std::string& name) { return selects(name, o.name); };
      if (!all_observables_ && std::none_of(observe_.begin(), observe_.end(), wants)) continue;
      values[o.name] = std::isfinite(o.value) ? json::value(o.value) : json::value(nullptr);
    }
    out["observables"] = std::move(values);
  }
  if (has_queries_) {
    Surroundings around(session, queries_.size());
    json::array answers;
    for (const PreparedQuery& q : queries_) answers.push_back(q(around));
    out["queries"] = std::move(answers);
  }
  return out;
}

FramePtr Look::frame(const Session& session) const {
  return has_fields_ ? session.frame(request_for(fields_, FrameRequest::Extras::state_hash)) : nullptr;
}

}  // namespace truestep
