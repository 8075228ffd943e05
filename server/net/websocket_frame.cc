#include "server/net/websocket_frame.h"

#include <algorithm>

namespace truestep::net {

FrameHead encode_frame_head(Opcode opcode, size_t n) {
  FrameHead h{};
  h.bytes[0] = static_cast<char>(0x80 | static_cast<uint8_t>(opcode));
  if (n < 126) {
    h.bytes[1] = static_cast<char>(n);
    h.size = 2;
  } else if (n < 65536) {
    h.bytes[1] = 126;
    h.bytes[2] = static_cast<char>(n >> 8);
    h.bytes[3] = static_cast<char>(n);
    h.size = 4;
  } else {
    h.bytes[1] = 127;
    for (int i = 0; i < 8; ++i) h.bytes[2 + i] = static_cast<char>(uint64_t{n} >> (56 - 8 * i));
    h.size = 10;
  }
  return h;
}

bool valid_close_code(uint16_t c) {
  return (c >= 1000 && c <= 1003) || (c >= 1007 && c <= 1014) || (c >= 3000 && c <= 4999);
}

std::string close_payload(uint16_t code, std::string_view reason) {
  std::string p;
  p += static_cast<char>(code >> 8);
  p += static_cast<char>(code);
  size_t n = std::min<size_t>(reason.size(), 123);
  while (n > 0 && n < reason.size() && (static_cast<unsigned char>(reason[n]) & 0xC0) == 0x80) --n;
  p.append(reason.substr(0, n));
  return p;
}

FrameDecoder::Event FrameDecoder::violate(uint16_t code, std::string_view reason) {
  violation_code_ = code;
  violation_reason_ = reason;
  return Event::violation;
}

FrameDecoder::Header FrameDecoder::take_header(char*& data, size_t& size) {
  const auto need = [&]() -> size_t {
    if (have_ < 2) return 2;
    const uint8_t n = header_[1] & 127;
    return 6 + (n == 126 ? 2 : n == 127 ? 8 : 0);
  };
  while (have_ < need()) {
    if (size == 0) return Header::incomplete;
    header_[have_++] = static_cast<uint8_t>(*data++);
    --size;
    if (have_ != 2) continue;
    // Everything that the first two bytes can prove wrong is refused before more is awaited.
    opcode_ = static_cast<Opcode>(header_[0] & 15);
    final_ = header_[0] & 0x80;
    const uint8_t op = header_[0] & 15;
    const bool control = op & 8;
    const char* wrong = nullptr;
    // RSV1 marks a compressed message, on its first frame only.
    const uint8_t allowed = compression_ == Compression::deflate && (op == 1 || op == 2) ? 0x40 : 0;
    if (header_[0] & 0x70 & ~allowed)
      wrong = "reserved bits are set";
    else if (op > 10 || (op > 2 && op < 8))
      wrong = "unknown opcode";
    else if (!(header_[1] & 0x80))
      wrong = "a client's frames must be masked";
    else if (control && !final_)
      wrong = "a control frame is fragmented";
    else if (control && (header_[1] & 127) > 125)
      wrong = "a control frame is longer than 125 bytes";
    else if (!control && op == 0 && !in_message_)
      wrong = "a continuation without a message";
    else if (!control && op != 0 && in_message_)
      wrong = "a new message inside another";
    if (wrong) {
      violate(1002, wrong);
      return Header::bad;
    }
  }
  const uint8_t n = header_[1] & 127;
  left_ = n;
  size_t at = 2;
  if (n >= 126) {
    const size_t bytes = n == 126 ? 2 : 8;
    left_ = 0;
    for (size_t i = 0; i < bytes; ++i) left_ = left_ << 8 | header_[at++];
    if (left_ >> 63 || left_ < (n == 126 ? 126u : 65536u)) {
      violate(1002, "the length is not in its shortest form");
      return Header::bad;
    }
  }
  std::copy_n(header_.begin() + static_cast<long>(at), 4, mask_.begin());
  mask_at_ = 0;
  have_ = 0;
  return Header::complete;
}

FrameDecoder::Event FrameDecoder::next(char*& data, size_t& size) {
  if (violation_code_) return Event::violation;
  if (deliver_) {
    // A long message's memory is given back at once; most are short and reuse theirs.
    if (message_.capacity() > 65536) std::string().swap(message_);
    if (inflated_.capacity() > 65536) std::string().swap(inflated_);
    message_.clear();
    deliver_ = false;
  }
  for (;;) {
    if (!in_payload_) {
      const Header h = take_header(data, size);
      if (h == Header::incomplete) return Event::need_more;
      if (h == Header::bad) return Event::violation;
      in_payload_ = true;
      if (static_cast<uint8_t>(opcode_) & 8) {
        control_.clear();
      } else {
        if (opcode_ != Opcode::continuation) {
          message_kind_ = opcode_;
          compressed_ = header_[0] & 0x40;
          utf8_.reset();
        }
        in_message_ = true;
        if (left_ > message_limit_ - message_.size()) return violate(1009, "the message is too long");
      }
    }
    const bool control = static_cast<uint8_t>(opcode_) & 8;
    const size_t n = static_cast<size_t>(std::min<uint64_t>(left_, size));
    for (size_t i = 0; i < n; ++i) data[i] = static_cast<char>(data[i] ^ mask_[(mask_at_ + i) & 3]);
    mask_at_ = static_cast<uint8_t>((mask_at_ + n) & 3);
    const std::string_view piece(data, n);
    data += n;
    size -= n;
    left_ -= n;
    (control ? control_ : message_).append(piece);
    if (!control && message_kind_ == Opcode::text && !compressed_ && !utf8_.feed(piece))
      return violate(1007, "the text is not valid UTF-8");
    if (left_ > 0) return Event::need_more;
    in_payload_ = false;
    if (control) return finish_control();
    if (!final_) continue;
    return finish_message();
  }
}

FrameDecoder::Event FrameDecoder::finish_message() {
  in_message_ = false;
  deliver_ = true;
  payload_ = message_;
  if (compressed_) {
    if (!inflater_) inflater_ = std::make_unique<Inflater>();
    switch (inflater_->run(message_, message_limit_, inflated_)) {
      case InflateResult::good:
        break;
      case InflateResult::bad:
        return violate(1007, "the compressed message is malformed");
      case InflateResult::too_large:
        return violate(1009, "the message is too long");
    }
    payload_ = inflated_;
    if (message_kind_ == Opcode::text && !utf8_.feed(payload_))
      return violate(1007, "the text is not valid UTF-8");
  }
  if (message_kind_ == Opcode::text && !utf8_.complete())
    return violate(1007, "the text ends inside a character");
  return message_kind_ == Opcode::text ? Event::text : Event::binary;
}

FrameDecoder::Event FrameDecoder::finish_control() {
  payload_ = control_;
  if (opcode_ == Opcode::ping) return Event::ping;
  if (opcode_ == Opcode::pong) return Event::pong;
  close_code_ = 1005;
  close_reason_ = {};
  if (control_.empty()) return Event::close;
  if (control_.size() == 1) return violate(1002, "a close frame holds one byte");
  close_code_ =
      static_cast<uint16_t>(static_cast<uint8_t>(control_[0]) << 8 | static_cast<uint8_t>(control_[1]));
  close_reason_ = std::string_view(control_).substr(2);
  if (!valid_close_code(close_code_)) return violate(1002, "the close code is not allowed");
  if (!valid_utf8(close_reason_)) return violate(1007, "the close reason is not valid UTF-8");
  return Event::close;
}

}  // namespace truestep::net
