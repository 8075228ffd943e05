// What a request wants to see of the state that its steps lead to: observables, fields, answers to queries.
#pragma once
#include <array>
#include <boost/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "engine/session/queries/queries.h"
#include "engine/sinks/stream/frame_encoding.h"

namespace truestep {

class Look {
 public:
  static constexpr std::array<std::string_view, 4> kMembers{"observe", "fields", "systems", "queries"};

  Look() = default;
  /// {"observe": [names], "fields": [names], "systems": [ids], "queries": [...]}; fields in JSON come as f64,
  /// else as f32. Everything is read here: afterwards nothing of it can be refused. Errors "bad_request",
  /// "invalid", "unknown_system", "bad_query".
  Look(const boost::json::object& wish, const World& world, WireEncoding encoding);

  /// What was asked for, of the session's present state: "observables" by name (null when not finite),
  /// "queries".
  boost::json::object seen(const Session& session) const;
  /// The fields; null when none were asked for.
  FramePtr frame(const Session& session) const;
  const std::vector<WireField>& fields() const { return fields_; }

 private:
  std::vector<std::string> observe_;
  bool all_observables_ = false, has_fields_ = false, has_queries_ = false;
  std::vector<WireField> fields_;
  std::vector<PreparedQuery> queries_;
};

}  // namespace truestep
