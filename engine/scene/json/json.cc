// Recursive descent over one contiguous text; the depth limit bounds the recursion.
#include "engine/scene/json/json.h"

#include <boost/json/array.hpp>
#include <boost/json/monotonic_resource.hpp>
#include <boost/json/object.hpp>
#include <cstring>

#include "engine/base/errors.h"
#include "engine/scene/json/json_tokens.h"

namespace truestep {
namespace {

namespace json = boost::json;

class Reader : JsonTokens {
 public:
  Reader(std::string_view text, const JsonLimits& limits)
      : JsonTokens(text), max_depth_(limits.max_depth), max_values_(limits.max_values) {}

  json::value document() {
    if (end_ - p_ >= 3 && std::memcmp(p_, "\xEF\xBB\xBF", 3) == 0) p_ += 3;
    json::value result(json::make_shared_resource<json::monotonic_resource>());
    skip_space();
    if (p_ == end_) fail("syntax", "the document is empty");
    read_value(result, 0);
    skip_space();
    if (p_ != end_) fail("syntax", "unexpected text after the end of the document");
    return result;
  }

 private:
  void read_value(json::value& out, int depth) {
    if (++values_ > max_values_) {
      throw Error("too_large",
                  "the document holds more than " + std::to_string(max_values_) + " values, the limit");
    }
    if (p_ == end_) fail("syntax", "the text ends where a value should be");
    switch (*p_) {
      case '{':
        return read_object(out, depth + 1);
      case '[':
        return read_array(out, depth + 1);
      case '"': {
        const std::string_view s = read_string();
        out.emplace_string().assign(s.data(), s.size());
        return;
      }
      case 't':
        literal("true");
        out = true;
        return;
      case 'f':
        literal("false");
        out = false;
        return;
      case 'n':
        literal("null");
        out.emplace_null();
        return;
      default:
        return read_number(out);
    }
  }

  void enter(int depth) {
    if (depth > max_depth_) fail("too_deep", "nested deeper than " + std::to_string(max_depth_) + " levels");
    ++p_;
    skip_space();
  }

  void read_array(json::value& out, int depth) {
    enter(depth);
    json::array& items = out.emplace_array();
    if (p_ != end_ && *p_ == ']') {
      ++p_;
      return;
    }
    path_.push_back({{}, 0});
    for (;;) {
      read_value(items.emplace_back(nullptr), depth);
      skip_space();
      if (p_ == end_) fail("syntax", "the text ends inside an array");
      if (*p_ == ']') break;
      if (*p_ != ',') fail("syntax", "expected ',' or ']' in an array");
      ++p_;
      ++path_.back().index;
      skip_space();
    }
    ++p_;
    path_.pop_back();
  }

  void read_object(json::value& out, int depth) {
    enter(depth);
    json::object& members = out.emplace_object();
    if (p_ != end_ && *p_ == '}') {
      ++p_;
      return;
    }
    path_.push_back({});
    for (;;) {
      path_.back().key = "";
      if (p_ == end_ || *p_ != '"') fail("syntax", "expected a key in double quotes");
      const char* start = p_;
      const std::string_view key = read_string();
      const auto [member, inserted] = members.emplace(json::string_view(key.data(), key.size()), nullptr);
      path_.back().key = member->key();
      if (!inserted) fail_at(start, "duplicate_key", "the key appears twice in one object");
      skip_space();
      if (p_ == end_ || *p_ != ':') fail("syntax", "expected ':' after a key");
      ++p_;
      skip_space();
      read_value(member->value(), depth);
      skip_space();
      if (p_ == end_) fail("syntax", "the text ends inside an object");
      if (*p_ == '}') break;
      if (*p_ != ',') fail("syntax", "expected ',' or '}' in an object");
      ++p_;
      skip_space();
    }
    ++p_;
    path_.pop_back();
  }

  int max_depth_;
  size_t max_values_, values_ = 0;
};

}  // namespace

json::value parse_json(std::string_view text, const JsonLimits& limits) {
  if (text.size() > limits.max_bytes) {
    throw Error("too_large", "the document has " + std::to_string(text.size()) + " bytes; at most " +
                                 std::to_string(limits.max_bytes) + " are accepted");
  }
  return Reader(text, limits).document();
}

void append_pointer(std::string& pointer, std::string_view token) {
  pointer += '/';
  for (const char c : token) {
    if (c == '~') {
      pointer += "~0";
    } else if (c == '/') {
      pointer += "~1";
    } else {
      pointer += c;
    }
  }
}

}  // namespace truestep
