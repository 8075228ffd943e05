// One client of WS /v1/sessions/{id}/stream: a sink that sends frames as fast as the client and the
// connection take them. Policy `latest` drops what cannot be sent at once, counts it, and sends the newest
// state as soon as there is room; policy `every` queues within the connection's bound and closes with 4408
// beyond it.
#pragma once
#include <memory>
#include <string>

#include "engine/sinks/stream/delta_coder.h"
#include "engine/sinks/stream/frame_encoding.h"
#include "server/net/worker_pool.h"
#include "server/stream/messages.h"
#include "server/stream/stream.h"

namespace truestep {

class StepRequest;

class StreamClient : public net::WebSocketHandler,
                     public Sink,
                     public std::enable_shared_from_this<StreamClient> {
 public:
  StreamClient(EntryPtr entry, Runner& runner, StreamStats& stats);

  // --- from the connection, on the network thread
  void on_open(std::shared_ptr<net::WebSocket> socket) override;
  void on_message(net::MessageKind kind, std::string_view payload) override;
  void on_drain() override;
  void on_close(uint16_t code, std::string_view reason) override;

  // --- from the session, under the entry's lock
  bool due(uint64_t step) override;
  const FrameRequest& request() const override { return request_; }
  void accept(const FramePtr& frame) override;
  void notify(std::string_view kind, uint64_t step, const std::string& detail) override;
  void bye(std::string_view code, const std::string& reason) override;

 private:
  /// Runs f on the pool, in the order of the calls, under the entry's lock.
  template <class F>
  void locked(F f);
  void handle(const v1::ClientMessage& message);
  void subscribe(const v1::Subscribe& wish);
  void control(const v1::Control& control);
  void step(const std::string& request_id, const std::string& body);
  void answer(const StepRequest& request, const std::string& request_id);
  void command(const v1::ClientMessage& message);
  void run(Job::Kind kind, Aim aim);
  void reset(const std::string& request_id);
  void between_steps(const std::string& request_id, std::function<void()> f);
  void reply(const std::string& request_id);
  void report(const std::exception_ptr& error, const std::string& request_id);
  void send_current_frame();
  void send(const v1::ServerMessage& message);
  bool has_room() const;
  /// Sends the constant part of the drawing when it is new.
  void send_topology(const Frame& frame);
  /// Fields of the Frame message: the shapes if any has moved, and the marks.
  std::string moving_fields(const Frame& frame);
  void send_playback();

  EntryPtr entry_;
  Runner& runner_;
  StreamStats& stats_;
  net::Strand strand_;
  std::shared_ptr<net::WebSocket> socket_;
  WireForm form_ = WireForm::protobuf;

  // Under the entry's lock.
  std::vector<WireField> fields_;
  FrameRequest request_;
  v1::Policy policy_ = v1::LATEST;
  Clock::duration interval_{};  ///< shortest time between frames; 0: every step
  Clock::time_point next_{};
  uint64_t seq_ = 0, dropped_ = 0;
  QuantisedFramePtr base_;  ///< what the client holds after the last frame sent
  uint64_t base_seq_ = 0;
  std::optional<uint32_t> drawing_version_;  ///< as sent last
  std::string shapes_;                       ///< as sent last
  Clock::time_point playback_sent_{};
  bool stale_ = false;  ///< the client has not seen the newest state

  enum class Flow : uint8_t { connection, credit };
  std::atomic<Flow> flow_{Flow::connection};
  std::atomic<int64_t> credit_{0};
  std::atomic<bool> closed_{false};
  std::atomic<bool> refresh_waiting_{false};
};

}  // namespace truestep
