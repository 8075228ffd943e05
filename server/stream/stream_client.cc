#include "server/stream/stream_client.h"

#include "engine/base/log.h"
#include "engine/scene/json/json.h"
#include "engine/session/command_list.h"
#include "engine/session/commands.h"
#include "engine/sinks/stream/wire_format.h"
#include "server/sessions/step_request.h"

namespace truestep {

namespace {
constexpr Wish kDrawn = Wish::constant | Wish::obstacles;
constexpr auto kPlaybackEvery = std::chrono::seconds(1);
}  // namespace

StreamClient::StreamClient(EntryPtr entry, Runner& runner, StreamStats& stats)
    : entry_(std::move(entry)), runner_(runner), stats_(stats), strand_(runner.pool()) {
  fields_ = wire_fields(entry_->session.world(), {}, {}, WireEncoding::f32);
  request_ = request_for(fields_, FrameRequest::Extras::none);
  request_.wishes = kDrawn;
}

std::shared_ptr<net::WebSocketHandler> make_stream(EntryPtr entry, Runner& runner, StreamStats& stats) {
  return std::make_shared<StreamClient>(std::move(entry), runner, stats);
}

template <class F>
void StreamClient::locked(F f) {
  strand_.post([self = shared_from_this(), f = std::move(f)] {
    if (self->closed_) return;
    const std::lock_guard lock(self->entry_->mutex);
    f();
  });
}

// --- from the connection

void StreamClient::on_open(std::shared_ptr<net::WebSocket> socket) {
  form_ = socket->subprotocol() == "truestep.v1.json" ? WireForm::json : WireForm::protobuf;
  socket_ = std::move(socket);
  entry_->streams++;
  locked([this] {
    Session& session = entry_->session;
    send(hello_message(session, entry_->id));
    send_topology(*session.frame({.wishes = kDrawn}));
    send_playback();
    send_current_frame();
    session.add_sink(shared_from_this());
  });
}

void StreamClient::on_close(uint16_t, std::string_view) {
  closed_ = true;
  entry_->streams--;
  entry_->touch();
  // Not through locked(), which does nothing once closed.
  strand_.post([self = shared_from_this()] {
    const std::lock_guard lock(self->entry_->mutex);
    self->entry_->session.remove_sink(self.get());
    if (self->entry_->streams > 0) return;
    self->entry_->encoded.clear();
    self->runner_.left_alone(self->entry_);
  });
}

void StreamClient::on_drain() {
  // Only a client that missed something needs more work now.
  if (!refresh_waiting_.exchange(false)) return;
  locked([this] {
    if (!stale_) return;
    // Set before the check: if room appears in between, this is called once more.
    refresh_waiting_ = true;
    if (has_room()) send_current_frame();
  });
}

void StreamClient::on_message(net::MessageKind kind, std::string_view payload) {
  const bool binary = kind == net::MessageKind::binary;
  if (binary != (form_ == WireForm::protobuf)) {
    send(problem_message(
        "bad_request",
        binary ? "this subprotocol takes only text messages" : "this subprotocol takes only binary messages",
        "", ""));
    return;
  }
  v1::ClientMessage message;
  try {
    message = client_message_from_wire(payload, form_);
  } catch (const Error& e) {
    send(problem_message(e.code(), e.what(), "", ""));
    return;
  }
  if (message.has_credit()) {
    flow_ = Flow::credit;
    credit_.fetch_add(std::min<int64_t>(message.credit().frames(), 1000));
    on_drain();
    return;
  }
  locked([this, message = std::move(message)] {
    try {
      handle(message);
    } catch (...) {
      report(std::current_exception(), message.request_id());
    }
  });
}

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
      carry_out(session, read_command_list(session, *all, ""));
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

// Nobody reads of a step that somebody else's reset or pause ended early, or that failed: the sender is told.
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

// --- from the session

bool StreamClient::has_room() const {
  if (closed_ || !socket_->is_open()) return false;
  if (flow_ == Flow::credit && credit_ <= 0) return false;
  // One frame may be in flight while the next is made; more would only add latency.
  return socket_->queued_bytes() == 0;
}

bool StreamClient::due(uint64_t) {
  if (closed_) return false;
  const auto now = Clock::now();
  if (interval_ > Clock::duration{} && now < next_) {
    stale_ = true;
    return false;
  }
  if (policy_ == v1::LATEST && !has_room()) {
    ++dropped_;
    stats_.dropped.fetch_add(1, std::memory_order_relaxed);
    stale_ = true;
    refresh_waiting_ = true;
    // A drain that happened just before the flag was set would be missed.
    if (has_room()) return true;
    return false;
  }
  // Stepping along the grid of the interval, not from the last frame, keeps the mean rate.
  next_ = next_ + interval_ > now ? next_ + interval_ : now + interval_;
  return true;
}

void StreamClient::accept(const FramePtr& frame) {
  if (closed_) return;
  entry_->acknowledge();
  send_topology(*frame);
  if (flow_ == Flow::credit) credit_.fetch_sub(1);
  const auto [blocks, held, kind] = entry_->encoded.get(frame, fields_, base_);
  const uint64_t base_seq = kind == EncodedBlocks::Kind::refers_to_base ? base_seq_ : 0;
  const auto head = std::make_shared<const std::string>(
      encode_head(*frame, {++seq_, dropped_, base_seq}, moving_fields(*frame), blocks->size()));
  const size_t bytes = head->size() + blocks->size();
  bool sent = false;
  if (form_ == WireForm::protobuf) {
    sent = socket_->send(net::MessageKind::binary, {head, blocks});
  } else {
    v1::ServerMessage message;
    message.ParseFromString(*head + *blocks);
    sent = socket_->send_text(to_wire(message, form_));
  }
  if (!sent) {
    if (socket_->is_open()) socket_->close(4408, "the client reads too slowly for policy every");
    return;
  }
  base_ = held;
  base_seq_ = seq_;
  stale_ = false;
  refresh_waiting_ = false;
  stats_.frames.fetch_add(1, std::memory_order_relaxed);
  stats_.bytes.fetch_add(bytes, std::memory_order_relaxed);
  if (request_.wants(FrameRequest::Extras::observables)) {
    v1::ServerMessage message;
    v1::Observables& o = *message.mutable_observables();
    o.set_step(frame->step);
    o.set_time(frame->time);
    for (const Observation& v : frame->observables.rows()) {
      v1::Observation& row = *o.add_values();
      row.set_name(v.name);
      row.set_value(v.value);
      row.set_unit(v.unit);
    }
    send(message);
  }
  // The achieved speed changes without a request.
  if (entry_->session.playing() && Clock::now() - playback_sent_ > kPlaybackEvery) send_playback();
}

void StreamClient::send_playback() {
  entry_->acknowledge();
  playback_sent_ = Clock::now();
  send(playback_message(entry_->session));
}

void StreamClient::bye(std::string_view code, const std::string& reason) {
  constexpr uint16_t kGoingAway = 1001, kGone = 4410;
  if (closed_) return;
  send(bye_message(code, reason));
  socket_->close(code == "draining" ? kGoingAway : kGone, reason);
}

void StreamClient::notify(std::string_view kind, uint64_t step, const std::string& detail) {
  if (kind != "playback" && kind != "reset" && kind != "seek") {
    entry_->acknowledge();
    v1::ServerMessage message;
    v1::Event& e = *message.mutable_event();
    e.set_kind(std::string(kind));
    e.set_step(step);
    e.set_detail(detail);
    send(message);
  }
  send_playback();
  if (kind == "reset" || kind == "seek" || stale_) {
    stale_ = true;
    refresh_waiting_ = true;
    if (has_room()) send_current_frame();
  }
}

void StreamClient::send_current_frame() {
  accept(entry_->session.frame(request_));
}

void StreamClient::send_topology(const Frame& frame) {
  if (frame.drawing_version == drawing_version_) return;
  send(topology_message(entry_->session.world(), frame));
  drawing_version_ = frame.drawing_version;
  shapes_ = shapes_fields(frame);
}

std::string StreamClient::moving_fields(const Frame& frame) {
  std::string out;
  if (!frame.moving.obstacles.empty()) {
    std::string now = shapes_fields(frame);
    if (now != shapes_) out = now;
    shapes_ = std::move(now);
  }
  if (wants(request_.wishes, Wish::marks)) out += marks_fields(frame);
  return out;
}

void StreamClient::send(const v1::ServerMessage& message) {
  if (closed_) return;
  const net::SharedBuffer wire = to_wire(message, form_);
  if (form_ == WireForm::protobuf)
    socket_->send_binary(wire);
  else
    socket_->send_text(wire);
}

}  // namespace truestep
