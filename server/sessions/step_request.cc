#include "server/sessions/step_request.h"

#include <cmath>

#include "engine/base/hash.h"
#include "engine/scene/json/json_write.h"
#include "engine/session/command_list.h"
#include "engine/sinks/stream/wire_format.h"
#include "server/sessions/members.h"

namespace truestep {

namespace json = boost::json;

namespace {

constexpr std::string_view kMembers[] = {"steps",   "seconds", "until",   "from_step", "commands",
                                         "observe", "fields",  "systems", "queries"};

// The step that {"steps": n | "seconds": s | "until": t} leads to.
uint64_t target_of(const json::object& body, const Session& s) {
  constexpr uint64_t kMostSteps = StepRequest::kMostSteps;
  if (body.contains("steps") + body.contains("seconds") + body.contains("until") > 1)
    throw Error("bad_request", "the step request has faults",
                {{"", "inconsistent", "give exactly one of steps, seconds and until", "", "", "", ""}});
  const double now = static_cast<double>(s.step_index()), dt = s.world().dt();
  if (body.contains("from_step")) {
    const uint64_t from = integer_member(body, "from_step", kMostStep);
    if (from != s.step_index()) {
      throw Error("step_conflict", "the session is at step " + std::to_string(s.step_index()),
                  {{"/from_step", "precondition", "the session is at another step",
                    write_json(body.at("from_step")), std::to_string(s.step_index()), "", ""}});
    }
  }
  double steps = 1;
  if (body.contains("steps")) steps = static_cast<double>(integer_member(body, "steps", kMostSteps));
  if (body.contains("seconds")) steps = std::round(number_member(body, "seconds", 0, 1e9) / dt);
  if (body.contains("until"))
    steps = std::max(0.0, std::round(number_member(body, "until", 0, 1e9) / dt) - now);
  if (steps > kMostSteps) throw StepRequest::too_many(body.contains("until") ? "/until" : "/seconds");
  return s.step_index() + static_cast<uint64_t>(steps);
}

}  // namespace

json::object describe_clock(const SessionEntry& e) {
  const Session& s = e.session;
  json::object o{
      {"id", e.id},         {"step", s.step_index()},
      {"time", s.time()},   {"status", s.failure() ? "unstable" : s.playing() ? "playing" : "paused"},
      {"speed", s.speed()}, {"state_hash", hex64(s.hash())}};
  if (const auto achieved = s.achieved_speed()) o["achieved_speed"] = *achieved;
  return o;
}

Error StepRequest::too_many(const char* pointer) {
  return {"bad_request", "a request may do at most 1e9 steps",
          Issue{pointer, "out_of_range", "this is more than 1e9 steps", "", "0 to 1e9 steps", "", ""}};
}

StepRequest::StepRequest(json::object body, Form form) : body_(std::move(body)), form_(form) {
  require_members(body_, kMembers);
}

uint64_t StepRequest::begin(SessionEntry& e) {
  Session& session = e.session;
  const uint64_t target = target_of(body_, session);
  look_ = Look(body_, session.world(), form_ == Form::json ? WireEncoding::f64 : WireEncoding::f32);
  if (const json::array* commands = array_member(body_, "commands", SIZE_MAX))
    sequences_ = carry_out(session, *commands, "/commands");
  return target;
}

void StepRequest::reached(SessionEntry& e) {
  answer_ = describe_clock(e);
  if (body_.contains("commands")) answer_["commands"] = json::value_from(sequences_);
  for (auto& [key, value] : look_.seen(e.session)) answer_[key] = std::move(value);
  frame_ = look_.frame(e.session);
}

std::string StepRequest::json() const {
  std::string out = write_json(answer_);
  if (form_ != Form::json || !frame_) return out;
  out.pop_back();
  return out + ",\"frame\":" + encode_json(*frame_, look_.fields()) + '}';
}

std::string StepRequest::answer_bytes(std::string_view request_id) const {
  std::string out;
  wire::put_bytes(out, 1, request_id);
  wire::put_bytes(out, 2, json());
  if (form_ == Form::protobuf && frame_)
    wire::put_bytes(out, 3, encode_frame_fields(*frame_, {}) + *encode_blocks(*frame_, look_.fields()));
  return out;
}

}  // namespace truestep
