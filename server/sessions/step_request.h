// One request that acts, steps and looks: commands before, steps, and what is seen after, as POST step and
// the stream's Step have it.
#pragma once
#include <boost/json.hpp>
#include <cstdint>
#include <string>

#include "server/sessions/entry.h"
#include "server/sessions/look.h"

namespace truestep {

/// Where a session stands: id, step, time, status, speed, state_hash.
boost::json::object describe_clock(const SessionEntry& entry);

class StepRequest {
 public:
  static constexpr uint64_t kMostSteps = 1'000'000'000;  ///< of one request
  static Error too_many(const char* pointer);

  /// How the fields in the answer are written.
  enum class Form : uint8_t { json, protobuf };

  /// {"steps": n | "seconds": s | "until": t, "from_step": k, "commands": [...]} and the members of Look; one
  /// step when it says nothing. Error "bad_request" for other members.
  StepRequest(boost::json::object body, Form form);

  /// Reads everything, carries out the commands, and tells the step to reach. Under the entry's lock, between
  /// steps. Errors "bad_request", "step_conflict", "bad_command", "bad_query": nothing has happened then.
  uint64_t begin(SessionEntry& entry);
  /// Takes down the answer at that step. Under the entry's lock, between steps.
  void reached(SessionEntry& entry);

  /// After reached(): the clock, "commands" (sequence numbers), "observables", "queries" and, as JSON,
  /// "frame".
  std::string json() const;
  /// The same as the bytes of an Answer (proto/truestep/v1/stream.proto), with the fields as a Frame.
  std::string answer_bytes(std::string_view request_id) const;

 private:
  boost::json::object body_, answer_;
  Form form_;
  Look look_;
  FramePtr frame_;
  std::vector<uint64_t> sequences_;
};

}  // namespace truestep
