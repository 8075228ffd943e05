// What a stream's client asks for: subscriptions, control, commands, steps with answers.
#include "engine/base/log.h"
#include "engine/scene/json/json.h"
#include "engine/session/command_list.h"
#include "engine/session/commands.h"
#include "engine/sinks/stream/wire_format.h"
#include "server/sessions/step_request.h"
#include "server/stream/stream_client.h"

namespace truestep {

void StreamClient::handle(const v1::ClientMessage& message) {
  switch (message.kind_case()) {
    case v1::ClientMessage::kSubscribe:
      subscribe(message.subscribe());
      break;
    case v1::ClientMessage::kControl:
      if (message.control().action() == "reset") return reset(message.request_id());
      control(message.control());
      break;
    case v1::ClientMessage::kCommand:
      return command(message);
    case v1::ClientMessage::kStep:
      return step(message.request_id(), message.step().json());
    case v1::ClientMessage::kRequestKeyframe:
      base_.reset();
      send_current_frame();
      break;
    default:
      throw Error("bad_request", "the message is empty");
  }
  reply(message.request_id());
}

// Drags arrive many times a second and nobody waits for their answers.
void StreamClient::reply(const std::string& request_id) {
  if (request_id.empty()) return;
  v1::ServerMessage reply;
  entry_->acknowledge();
  reply.mutable_reply()->set_request_id(request_id);
  reply.mutable_reply()->set_step(entry_->session.step_index());
  send(reply);
}

void StreamClient::report(const std::exception_ptr& error, const std::string& request_id) {
  try {
    std::rethrow_exception(error);
  } catch (const Error& e) {
    send(problem_message(e.code(), e.what(), request_id,
                         e.issues().empty() ? "" : e.issues().front().pointer));
  } catch (const std::exception& e) {
    log_error("stream: {}", e.what());
    send(problem_message("internal", "", request_id, ""));
  }
}

// Between two steps, like everything that changes the state.
void StreamClient::between_steps(const std::string& request_id, std::function<void()> f) {
  const auto self = shared_from_this();
  runner_.queue(entry_, Job::between_steps([self, request_id, f = std::move(f)](SessionEntry&) {
                  if (self->closed_) return;
                  try {
                    f();
                    self->reply(request_id);
                  } catch (...) {
                    self->report(std::current_exception(), request_id);
                  }
                }));
}

void StreamClient::command(const v1::ClientMessage& message) {
  between_steps(message.request_id(), [this, document = parse_json(message.command().json())] {
    Session& session = entry_->session;
    if (const boost::json::array* all = document.if_array())
      carry_out(session, *all, "");
    else
      session.command(read_command_for(session.world(), session.state(), document));
    if (!entry_->session.playing()) send_current_frame();
  });
}

void StreamClient::subscribe(const v1::Subscribe& wish) {
  if (wish.encoding() < v1::F32 || wish.encoding() > v1::QUAT32)
    throw Error("bad_request", "encoding must be one of F32, F64, Q16, Q16_DELTA and QUAT32");
  if (!v1::Policy_IsValid(wish.policy())) throw Error("bad_request", "policy must be LATEST or EVERY");
  if (!(wish.rate() >= 0) || wish.rate() > 10000)
    throw Error("bad_request", "rate must be from 0 to 10000 frames per second");
  fields_ =
      wire_fields(entry_->session.world(), {wish.fields().begin(), wish.fields().end()},
                  {wish.systems().begin(), wish.systems().end()}, static_cast<WireEncoding>(wish.encoding()));
  using Extras = FrameRequest::Extras;
  request_ = request_for(fields_, (wish.observables() ? Extras::observables : Extras::none) |
                                      (wish.state_hash() ? Extras::state_hash : Extras::none));
  request_.wishes =
      kDrawn | (wish.contacts() ? Wish::contacts : Wish::none) | (wish.joints() ? Wish::joints : Wish::none);
  policy_ = wish.policy();
  interval_ =
      wish.rate() > 0
          ? std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / wish.rate()))
          : Clock::duration{};
  next_ = {};
  base_.reset();
  if (wish.credit() > 0) {
    credit_ = std::min<int64_t>(wish.credit(), 1000);
    flow_ = Flow::credit;
  }
  send_current_frame();
}

void StreamClient::run(Job::Kind kind, Aim aim) {
  const JobPtr job = Job::run(kind, std::move(aim));
  job->after = [self = shared_from_this()](const Job& ended) {
    if (ended.end == Job::End::threw) self->report(ended.error, "");
  };
  runner_.queue(entry_, job);
}

// A step that fails, or that a reset or pause ends early, is answered by a Problem.
void StreamClient::step(const std::string& request_id, const std::string& body) {
  const boost::json::value document = parse_json(body);
  if (!document.is_object()) throw Error("bad_request", "a step must be a JSON object");
  using Form = StepRequest::Form;
  const auto request = std::make_shared<StepRequest>(
      document.as_object(), form_ == WireForm::protobuf ? Form::protobuf : Form::json);
  const JobPtr job = Job::run(Job::Kind::step, [request](SessionEntry& e) { return request->begin(e); });
  job->reached = [request](SessionEntry& e) { request->reached(e); };
  job->after = [self = shared_from_this(), request, request_id](const Job& ended) {
    if (ended.end == Job::End::threw) return self->report(ended.error, request_id);
    if (ended.end == Job::End::reached) return self->answer(*request, request_id);
    const auto& failure = self->entry_->session.failure();
    self->send(
        failure ? problem_message("instability", failure->detail, request_id, "")
                : problem_message("interrupted", "interrupted by pause, reset or restore", request_id, ""));
  };
  runner_.queue(entry_, job);
}

void StreamClient::answer(const StepRequest& request, const std::string& request_id) {
  if (closed_) return;
  entry_->acknowledge();
  if (form_ == WireForm::protobuf) {
    constexpr uint32_t kAnswer = 12;  // of ServerMessage
    auto bytes = std::make_shared<std::string>();
    wire::put_bytes(*bytes, kAnswer, request.answer_bytes(request_id));
    socket_->send_binary(std::move(bytes));
    return;
  }
  v1::ServerMessage message;
  message.mutable_answer()->set_request_id(request_id);
  message.mutable_answer()->set_json(request.json());
  send(message);
}

void StreamClient::reset(const std::string& request_id) {
  runner_.interrupt(*entry_);
  between_steps(request_id, [this] { entry_->session.reset(); });
}

void StreamClient::control(const v1::Control& control) {
  Session& session = entry_->session;
  const std::string& action = control.action();
  const double value = control.value();
  if (action == "play" || action == "speed") {
    // Absent, to play means as before.
    const double speed = action == "play" && value == 0 ? session.speed() : value;
    if (!(speed >= Session::kLeastSpeed && speed <= Session::kMostSpeed))
      throw Error("bad_request", action + " needs a speed from 1e-18 to 1e15");
    if (action == "play" || session.playing()) {
      session.play(speed);
      if (action == "play") entry_->played(control.keep_running());
      runner_.keep_playing(entry_);
    }
  } else if (action == "pause") {
    session.pause();
    runner_.interrupt(*entry_);
  } else if (action == "step" || action == "seek") {
    if (!(value >= 0) || value > 1e15) throw Error("bad_request", action + " needs a number from 0 to 1e15");
    const auto n = static_cast<uint64_t>(value);
    if (action == "seek") {
      // The latest request wins: dragging a slider sends many a second.
      runner_.interrupt(*entry_);
      run(Job::Kind::seek, [n](SessionEntry&) { return n; });
    } else {
      run(Job::Kind::step,
          [n](SessionEntry& e) { return e.session.step_index() + std::max<uint64_t>(1, n); });
    }
  } else {
    throw Error("bad_request", "unknown action; use play, pause, step, seek, speed or reset");
  }
  entry_->publish();
}

}  // namespace truestep
