// Streaming decoder of the chunked transfer coding (RFC 9112 section 7.1), strict: hexadecimal sizes only, CR
// LF only, bounded extensions and trailers. Trailer fields are read and dropped: no header may be changed by
// them.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace truestep::net {

/// Undoes the chunked coding of one body.
class ChunkDecoder {
 public:
  enum class Result { need_more, done, bad, too_large };

  explicit ChunkDecoder(size_t body_limit) : body_limit_(body_limit) {}

  /// Takes bytes from the front of `data`, appends content to `body`; `used` is how many bytes it took.
  Result feed(std::string_view data, std::string& body, size_t& used);

 private:
  enum class State : uint8_t {
    size_first,
    size,
    extension,
    size_lf,
    data,
    data_cr,
    data_lf,
    trailer_first,
    trailer,
    trailer_lf,
    end_lf
  };
  Result step(char c);
  size_t body_limit_;
  State state_ = State::size_first;
  uint64_t left_ = 0;    ///< of the current chunk
  size_t overhead_ = 0;  ///< bytes of extensions and trailers so far
  size_t received_ = 0;  ///< content bytes promised so far
};

}  // namespace truestep::net
