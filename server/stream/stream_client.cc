#include "server/stream/stream_client.h"

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
