#include "engine/scene/json/json_write.h"

#include <boost/json/serialize.hpp>
#include <charconv>
#include <cmath>

namespace truestep {

namespace json = boost::json;

namespace {

void append(std::string& out, double v) {
  if (!std::isfinite(v)) {
    out += "null";
    return;
  }
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, v).ptr);
}

void append(std::string& out, const json::value& v) {
  switch (v.kind()) {
    case json::kind::double_:
      return append(out, v.get_double());
    case json::kind::array: {
      out += '[';
      bool first = true;
      for (const json::value& e : v.get_array()) {
        if (!first) out += ',';
        first = false;
        append(out, e);
      }
      out += ']';
      return;
    }
    case json::kind::object: {
      out += '{';
      bool first = true;
      for (const auto& [key, e] : v.get_object()) {
        if (!first) out += ',';
        first = false;
        out += json::serialize(json::string_view(key));
        out += ':';
        append(out, e);
      }
      out += '}';
      return;
    }
    default:
      out += json::serialize(v);
  }
}

}  // namespace

std::string write_json(const json::value& value) {
  std::string out;
  append(out, value);
  return out;
}

}  // namespace truestep
