#include "engine/scene/params/params_text.h"

#include <cmath>

#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"

namespace truestep {

namespace json = boost::json;

std::string shorten(const json::value& value) {
  // Containers are named, not printed: they may be large.
  if (value.is_object()) return "{...}";
  if (value.is_array()) return "[" + std::to_string(value.as_array().size()) + " elements]";
  if (value.is_string() && value.as_string().size() > 60) {
    size_t cut = 60;
    const auto& s = value.as_string();
    while (cut > 0 && (static_cast<unsigned char>(s[cut]) & 0xC0) == 0x80) --cut;
    return write_json(json::value(json::string_view(s.data(), cut))) + "...";
  }
  return write_json(value);
}

namespace {

std::string number_text(double v) {
  return write_json(json::value(v));
}

}  // namespace

std::string join_names(std::span<const std::string> names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

std::string limits_text(const Limits& l) {
  const bool open_min = l.ends == Limits::Ends::open_min || l.ends == Limits::Ends::open;
  const bool open_max = l.ends == Limits::Ends::open_max || l.ends == Limits::Ends::open;
  if (std::isinf(l.min) && std::isinf(l.max)) return "any finite number";
  if (std::isinf(l.max)) return (open_min ? "> " : ">= ") + number_text(l.min);
  if (std::isinf(l.min)) return (open_max ? "< " : "<= ") + number_text(l.max);
  return (open_min ? "(" : "[") + number_text(l.min) + ", " + number_text(l.max) + (open_max ? ")" : "]");
}

std::string kind_text(const ParamRow& r) {
  switch (r.kind) {
    case ParamKind::number:
      return "a number " + limits_text(r.limits);
    case ParamKind::integer:
      return "an integer " + limits_text(r.limits);
    case ParamKind::boolean:
      return "true or false";
    case ParamKind::text:
      return "a string";
    case ParamKind::expression:
      return "a number or an expression in a string";
    case ParamKind::choice:
      return join_names(r.choices);
    case ParamKind::vector:
      return "[x, y, z]";
    case ParamKind::numbers:
      return "an array of numbers";
    case ParamKind::integers:
      return "an array of integers";
    case ParamKind::vectors:
      return "an array of [x, y, z]";
    case ParamKind::texts:
      return "an array of strings";
    case ParamKind::object:
      return "an object";
    case ParamKind::objects:
      return "an array of objects";
    case ParamKind::variants: {
      std::string types;
      for (const ParamVariant& v : r.variants) types += (types.empty() ? "" : ", ") + v.type;
      return "an array of objects with \"type\": " + types;
    }
    case ParamKind::named_numbers:
      return "an object of names with numbers or arrays of numbers";
    case ParamKind::named_texts:
      return "an object of names with strings";
  }
  return "";
}

}  // namespace truestep
