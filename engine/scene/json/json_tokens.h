// The tokens of a JSON text: strings, numbers, words; and errors with their position. Shared by json.cc,
// which knows the structure, and json_tokens.cc.
#pragma once
#include <boost/json/value.hpp>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace truestep {

class JsonTokens {
 protected:
  explicit JsonTokens(std::string_view text)
      : begin_(text.data()), p_(text.data()), end_(text.data() + text.size()) {}

  /// The path to the cursor: a member or an element on every level.
  struct Step {
    boost::json::string_view key;  ///< of an object's member; data() is null inside an array
    size_t index;
  };

  /// Throws Error("bad_json") with the JSON pointer of path_ and the line, column and byte of the place.
  [[noreturn]] void fail_at(const char* where, const char* code, const std::string& what);
  [[noreturn]] void fail(const char* code, const std::string& what) { fail_at(p_, code, what); }

  void skip_space() {
    while (p_ != end_ && (*p_ == ' ' || *p_ == '\n' || *p_ == '\r' || *p_ == '\t')) ++p_;
  }
  /// Consumes the word, which must come next.
  void literal(std::string_view word);
  /// The decoded string: a view into the text if nothing needed decoding, otherwise into scratch_.
  std::string_view read_string();
  /// Gives an int64 or uint64 for an integer that fits, otherwise a correctly rounded double.
  void read_number(boost::json::value& out);

  const char* begin_;
  const char* p_;
  const char* end_;
  std::vector<Step> path_;

 private:
  /// End of the run of characters that need no decoding; clears `ascii` if any was not ASCII.
  const char* plain_run(const char* p, bool& ascii) const;
  void check_utf8(std::string_view s, bool ascii);
  void read_escape();
  uint32_t hex4(const char* start);
  bool digits();
  bool read_integer(boost::json::value& out, const char* start, bool negative);
  bool underflows(const char* p) const;

  std::string scratch_;
};

}  // namespace truestep
