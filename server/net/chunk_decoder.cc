#include "server/net/chunk_decoder.h"

#include <algorithm>

namespace truestep::net {
namespace {

// More than any honest client sends in extensions and trailers of one body.
constexpr size_t kOverheadLimit = 8192;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const char l = static_cast<char>(c | 32);
  return l >= 'a' && l <= 'f' ? l - 'a' + 10 : -1;
}

bool is_control(char c) {
  return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7F;
}

}  // namespace

ChunkDecoder::Result ChunkDecoder::feed(std::string_view data, std::string& body, size_t& used) {
  used = 0;
  while (used < data.size()) {
    if (state_ == State::data) {
      const size_t n = static_cast<size_t>(std::min<uint64_t>(left_, data.size() - used));
      body.append(data.substr(used, n));
      used += n;
      left_ -= n;
      if (left_ == 0) state_ = State::data_cr;
      continue;
    }
    const Result r = step(data[used++]);
    if (r != Result::need_more) return r;
  }
  return Result::need_more;
}

ChunkDecoder::Result ChunkDecoder::step(char c) {
  switch (state_) {
    case State::size_first:
    case State::size: {
      const int digit = hex_digit(c);
      if (digit >= 0) {
        if (left_ > body_limit_) return Result::too_large;
        left_ = left_ * 16 + static_cast<uint64_t>(digit);
        state_ = State::size;
        return Result::need_more;
      }
      if (state_ == State::size_first) return Result::bad;
      if (c != '\r' && c != ';') return Result::bad;
      if (left_ > body_limit_ - received_) return Result::too_large;
      received_ += static_cast<size_t>(left_);
      state_ = c == ';' ? State::extension : State::size_lf;
      return Result::need_more;
    }
    case State::extension:
      if (c == '\r') {
        state_ = State::size_lf;
      } else if (is_control(c) || ++overhead_ > kOverheadLimit) {
        return Result::bad;
      }
      return Result::need_more;
    case State::size_lf:
      state_ = left_ ? State::data : State::trailer_first;
      return c == '\n' ? Result::need_more : Result::bad;
    case State::data_cr:
      state_ = State::data_lf;
      return c == '\r' ? Result::need_more : Result::bad;
    case State::data_lf:
      state_ = State::size_first;
      return c == '\n' ? Result::need_more : Result::bad;
    case State::trailer_first:
      if (c == '\r') {
        state_ = State::end_lf;
        return Result::need_more;
      }
      if (c == ' ' || c == '\t') return Result::bad;
      state_ = State::trailer;
      [[fallthrough]];
    case State::trailer:
      if (c == '\r') {
        state_ = State::trailer_lf;
      } else if (is_control(c) || ++overhead_ > kOverheadLimit) {
        return Result::bad;
      }
      return Result::need_more;
    case State::trailer_lf:
      state_ = State::trailer_first;
      return c == '\n' ? Result::need_more : Result::bad;
    case State::end_lf:
      return c == '\n' ? Result::done : Result::bad;
    case State::data:
      break;
  }
  return Result::bad;
}

}  // namespace truestep::net
