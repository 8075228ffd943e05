// The WebSocket wire format (RFC 6455 sections 5 and 7.4), server side, with permessage-deflate for what is
// received. Beast's stream is not used because it answers out-of-range close codes with an echo and cannot
// queue shared buffers.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "engine/base/utf8.h"
#include "server/net/inflate.h"

namespace truestep::net {

enum class Opcode : uint8_t { continuation = 0, text = 1, binary = 2, close = 8, ping = 9, pong = 10 };

/// Header of an unmasked, final frame.
struct FrameHead {
  std::array<char, 10> bytes;
  uint8_t size;
};
FrameHead encode_frame_head(Opcode opcode, size_t payload_size);

/// May this code appear in a close frame (RFC 6455 section 7.4 and the IANA registry)?
bool valid_close_code(uint16_t code);

/// Payload of a close frame; the reason is cut to what fits, on a character boundary.
std::string close_payload(uint16_t code, std::string_view reason);

/// Reassembles messages from bytes that arrive in any pieces. Strict: a violation ends it for good.
class FrameDecoder {
 public:
  enum class Event : uint8_t { need_more, text, binary, ping, pong, close, violation };

  FrameDecoder(size_t message_limit, Compression compression)
      : message_limit_(message_limit), compression_(compression) {}

  /// Takes bytes from the front of `data` up to the next event and removes them from it. Unmasks in place.
  Event next(char*& data, size_t& size);

  /// After text or binary the message, after ping, pong and close the control payload. Valid until the next
  /// call.
  std::string_view payload() const { return payload_; }
  /// After close: the peer's code (1005 when none was sent) and reason.
  uint16_t close_code() const { return close_code_; }
  std::string_view close_reason() const { return close_reason_; }
  /// After violation: the code to close with and a sentence.
  uint16_t violation_code() const { return violation_code_; }
  std::string_view violation_reason() const { return violation_reason_; }

 private:
  enum class Header : uint8_t { incomplete, complete, bad };
  Header take_header(char*& data, size_t& size);
  Event finish_control();
  Event finish_message();
  Event violate(uint16_t code, std::string_view reason);

  size_t message_limit_;
  Compression compression_;
  std::array<uint8_t, 14> header_{};
  uint8_t have_ = 0;  ///< header bytes collected
  bool in_payload_ = false;
  bool final_ = false;
  Opcode opcode_ = Opcode::continuation;
  uint64_t left_ = 0;  ///< payload bytes of the current frame still to come
  std::array<uint8_t, 4> mask_{};
  uint8_t mask_at_ = 0;
  bool in_message_ = false;  ///< between a first fragment and the final one
  bool deliver_ = false;     ///< message_ was handed out and may be cleared
  Opcode message_kind_ = Opcode::text;
  bool compressed_ = false;  ///< the current message is
  std::string message_, inflated_, control_;
  std::unique_ptr<Inflater> inflater_;  ///< from the first compressed message on
  Utf8Validator utf8_;
  std::string_view payload_, close_reason_, violation_reason_;
  uint16_t close_code_ = 0, violation_code_ = 0;
};

}  // namespace truestep::net
