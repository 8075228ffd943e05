#include "engine/scene/params.h"

#include <algorithm>
#include <cmath>

#include "engine/scene/json_write.h"
#include "engine/scene/units.h"

namespace truestep {

namespace json = boost::json;

std::string pointer_token(std::string_view key) {
  std::string out;
  for (const char c : key) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}

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

std::string join(std::span<const std::string> names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

std::string number_text(double v) {
  return write_json(json::value(v));
}

std::string limits_text(const Limits& l) {
  const bool open_min = l.ends == Limits::Ends::open_min || l.ends == Limits::Ends::open;
  const bool open_max = l.ends == Limits::Ends::open_max || l.ends == Limits::Ends::open;
  if (std::isinf(l.min) && std::isinf(l.max)) return "any finite number";
  if (std::isinf(l.max)) return (open_min ? "> " : ">= ") + number_text(l.min);
  if (std::isinf(l.min)) return (open_max ? "< " : "<= ") + number_text(l.max);
  return (open_min ? "(" : "[") + number_text(l.min) + ", " + number_text(l.max) + (open_max ? ")" : "]");
}

bool within(const Limits& l, double v) {
  const bool open_min = l.ends == Limits::Ends::open_min || l.ends == Limits::Ends::open;
  const bool open_max = l.ends == Limits::Ends::open_max || l.ends == Limits::Ends::open;
  return (open_min ? v > l.min : v >= l.min) && (open_max ? v < l.max : v <= l.max);
}

/// Reads one object; keeps the place in the document for the faults it finds.
class Reader {
 public:
  Reader(std::vector<Issue>& issues) : issues_(issues) {}

  void object(const DefTable& table, void* owner, const json::object& o, const std::string& pointer,
              std::span<const std::string_view> also_allowed) {
    for (const auto& [key_view, value] : o) {
      const std::string key(key_view);
      if (key.starts_with("x_") ||
          std::find(also_allowed.begin(), also_allowed.end(), key) != also_allowed.end()) {
        continue;
      }
      const std::string where = pointer + "/" + pointer_token(key);
      if (const ParamRow* row = table.find(key)) {
        this->row(*row, owner, value, where);
      } else {
        std::vector<std::string> names;
        for (const ParamRow& r : table.rows) names.push_back(r.name);
        for (const std::string_view k : also_allowed) names.emplace_back(k);
        fault(where, "unknown_key", "\"" + key.substr(0, 64) + "\" is no parameter here", value, join(names),
              "", nearest_name(key, names));
      }
    }
    for (const ParamRow& r : table.rows) {
      if (r.presence == Presence::required && !o.contains(r.name)) {
        fault(pointer + "/" + pointer_token(r.name), "missing",
              "\"" + r.name + "\" is required: " + r.sentence, json::value(nullptr), kind_text(r), r.unit);
      }
    }
  }

 private:
  void fault(const std::string& pointer, const char* code, const std::string& message,
             const json::value& value, const std::string& allowed, const std::string& unit = "",
             const std::string& did_you_mean = "") {
    // A document can hold millions of faults; nobody reads more than a screenful.
    if (issues_.size() < 100)
      issues_.push_back({pointer, code, message, shorten(value), allowed, did_you_mean, unit});
  }

  static std::string kind_text(const ParamRow& r) {
    switch (r.kind) {
      case ParamKind::number:
        return "a number " + limits_text(r.limits);
      case ParamKind::integer:
        return "an integer " + limits_text(r.limits);
      case ParamKind::boolean:
        return "true or false";
      case ParamKind::text:
        return "a string";
      case ParamKind::choice:
        return join(r.choices);
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
    }
    return "";
  }

  bool number(const ParamRow& r, const json::value& v, const std::string& where, double& out) {
    if (v.is_string()) {
      const Quantity q = parse_quantity(v.as_string(), r.unit);
      if (!q.value) {
        fault(where, "bad_unit", q.error, v,
              "a number in " + (r.unit.empty() ? "1" : r.unit) + ", or a string with a unit of that kind",
              r.unit);
        return false;
      }
      out = *q.value;
    } else if (v.is_number()) {
      out = v.to_number<double>();
    } else {
      fault(where, "wrong_type", "expected a number", v, "a number " + limits_text(r.limits), r.unit);
      return false;
    }
    if (!std::isfinite(out) || !within(r.limits, out)) {
      fault(where, "out_of_range", "the value is outside the allowed range", v, limits_text(r.limits),
            r.unit);
      return false;
    }
    return true;
  }

  bool integer(const ParamRow& r, const json::value& v, const std::string& where, int64_t& out) {
    bool exact = false;
    if (v.is_int64()) {
      out = v.as_int64(), exact = true;
    } else if (v.is_double() && std::abs(v.as_double()) <= 9007199254740992.0 &&
               std::floor(v.as_double()) == v.as_double()) {
      out = static_cast<int64_t>(v.as_double()), exact = true;
    }
    if (!exact) {
      fault(where, "wrong_type", "expected an integer", v, "an integer " + limits_text(r.limits));
      return false;
    }
    if (!within(r.limits, static_cast<double>(out))) {
      fault(where, "out_of_range", "the value is outside the allowed range", v, limits_text(r.limits));
      return false;
    }
    return true;
  }

  bool vector(const ParamRow& r, const json::value& v, const std::string& where, Vec3& out) {
    if (!v.is_array() || v.as_array().size() != 3) {
      fault(where, "wrong_type", "expected three numbers", v, "[x, y, z]", r.unit);
      return false;
    }
    const json::array& a = v.as_array();
    bool good = number(r, a[0], where + "/0", out.x);
    good &= number(r, a[1], where + "/1", out.y);
    good &= number(r, a[2], where + "/2", out.z);
    return good;
  }

  bool text(const ParamRow& r, const json::value& v, const std::string& where, std::string& out) {
    if (!v.is_string()) {
      fault(where, "wrong_type", "expected a string", v, kind_text(r));
      return false;
    }
    if (v.as_string().size() > 4096) {
      fault(where, "too_long", "the string is too long", v, "at most 4096 bytes");
      return false;
    }
    out.assign(v.as_string().begin(), v.as_string().end());
    return true;
  }

  template <class T, class ReadOne>
  void array(const ParamRow& r, void* owner, const json::value& v, const std::string& where,
             ReadOne read_one) {
    if (!array_shape(r, v, where)) return;
    std::vector<T> out;
    out.reserve(v.as_array().size());
    bool good = true;
    for (size_t i = 0; i < v.as_array().size(); ++i) {
      T element{};
      // The element's own pointer is built only when there is something to report.
      const size_t before = issues_.size();
      good &= read_one(v.as_array()[i], "", element);
      for (size_t k = before; k < issues_.size(); ++k) {
        issues_[k].pointer = where + "/" + std::to_string(i) + issues_[k].pointer;
      }
      out.push_back(std::move(element));
    }
    if (good) r.set(owner, ParamValue(std::move(out)));
  }

  bool array_shape(const ParamRow& r, const json::value& v, const std::string& where) {
    if (!v.is_array()) {
      fault(where, "wrong_type", "expected an array", v, kind_text(r), r.unit);
      return false;
    }
    const size_t n = v.as_array().size();
    if (n < r.count.min || n > r.count.max) {
      fault(where, n < r.count.min ? "too_few" : "too_many",
            "the number of elements is outside the allowed range", v,
            std::to_string(r.count.min) + " to " + std::to_string(r.count.max) + " elements");
      return false;
    }
    return true;
  }

  void row(const ParamRow& r, void* owner, const json::value& v, const std::string& where) {
    switch (r.kind) {
      case ParamKind::number: {
        double x;
        if (number(r, v, where, x)) r.set(owner, x);
        return;
      }
      case ParamKind::integer: {
        int64_t x;
        if (integer(r, v, where, x)) r.set(owner, x);
        return;
      }
      case ParamKind::boolean:
        if (v.is_bool())
          r.set(owner, v.as_bool());
        else
          fault(where, "wrong_type", "expected true or false", v, "true, false");
        return;
      case ParamKind::text: {
        std::string s;
        if (text(r, v, where, s)) r.set(owner, std::move(s));
        return;
      }
      case ParamKind::choice: {
        std::string s;
        if (!text(r, v, where, s)) return;
        if (std::find(r.choices.begin(), r.choices.end(), s) == r.choices.end()) {
          fault(where, "unknown_choice", "this is none of the choices", v, join(r.choices), "",
                nearest_name(s, r.choices));
        } else {
          r.set(owner, std::move(s));
        }
        return;
      }
      case ParamKind::vector: {
        Vec3 x;
        if (vector(r, v, where, x)) r.set(owner, x);
        return;
      }
      case ParamKind::numbers:
        return array<double>(r, owner, v, where,
                             [&](auto& e, const std::string& p, double& x) { return number(r, e, p, x); });
      case ParamKind::integers:
        return array<int64_t>(r, owner, v, where,
                              [&](auto& e, const std::string& p, int64_t& x) { return integer(r, e, p, x); });
      case ParamKind::vectors:
        return array<Vec3>(r, owner, v, where,
                           [&](auto& e, const std::string& p, Vec3& x) { return vector(r, e, p, x); });
      case ParamKind::texts:
        return array<std::string>(r, owner, v, where, [&](auto& e, const std::string& p, std::string& x) {
          return text(r, e, p, x);
        });
      case ParamKind::object:
        if (v.is_object())
          nested(*r.nested, r.append(owner), v.as_object(), where, {});
        else
          fault(where, "wrong_type", "expected an object", v, "an object");
        return;
      case ParamKind::objects:
        if (!array_shape(r, v, where)) return;
        for (size_t i = 0; i < v.as_array().size(); ++i) {
          const json::value& e = v.as_array()[i];
          const std::string p = where + "/" + std::to_string(i);
          if (e.is_object())
            nested(*r.nested, r.append(owner), e.as_object(), p, {});
          else
            fault(p, "wrong_type", "expected an object", e, "an object");
        }
        return;
      case ParamKind::variants:
        if (!array_shape(r, v, where)) return;
        for (size_t i = 0; i < v.as_array().size(); ++i)
          variant(r, owner, v.as_array()[i], where + "/" + std::to_string(i));
        return;
    }
  }

  void variant(const ParamRow& r, void* owner, const json::value& e, const std::string& where) {
    if (!e.is_object()) return fault(where, "wrong_type", "expected an object", e, kind_text(r));
    std::vector<std::string> types;
    for (const ParamVariant& alternative : r.variants) types.push_back(alternative.type);
    const json::value* type = e.as_object().if_contains("type");
    if (!type)
      return fault(where + "/type", "missing", "\"type\" is required", json::value(nullptr), join(types));
    if (type->is_string()) {
      for (const ParamVariant& alternative : r.variants) {
        if (json::string_view(alternative.type) == type->as_string()) {
          constexpr std::string_view kType[] = {"type"};
          return nested(*alternative.table, alternative.append(owner), e.as_object(), where, kType);
        }
      }
    }
    fault(where + "/type", "unknown_choice", "this is none of the types", *type, join(types), "",
          type->is_string()
              ? nearest_name(std::string_view(type->as_string().data(), type->as_string().size()), types)
              : "");
  }

  void nested(const DefTable& table, void* owner, const json::object& o, const std::string& where,
              std::span<const std::string_view> also_allowed) {
    const size_t before = issues_.size();
    object(table, owner, o, where, also_allowed);
    if (table.check && issues_.size() == before) {
      table.check(owner, [&](const std::string& suffix, const std::string& message) {
        fault(where + suffix, "inconsistent", message, json::value(nullptr), "");
      });
    }
  }

  std::vector<Issue>& issues_;
};

json::value to_json(const ParamValue& value) {
  return std::visit(
      [](const auto& v) -> json::value {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate>) {
          return nullptr;
        } else if constexpr (std::is_same_v<T, Vec3>) {
          return json::array{v.x, v.y, v.z};
        } else if constexpr (std::is_same_v<T, std::vector<Vec3>>) {
          json::array a;
          for (const Vec3& e : v) a.push_back(json::array{e.x, e.y, e.z});
          return a;
        } else if constexpr (std::is_same_v<T, std::string>) {
          return json::value(v);
        } else if constexpr (std::is_arithmetic_v<T>) {
          return json::value(v);
        } else {
          json::array a;
          for (const auto& e : v) a.emplace_back(json::value(e));
          return a;
        }
      },
      value);
}

json::object number_schema(const ParamRow& r, const char* type) {
  json::object s{{"type", type}};
  const bool open_min = r.limits.ends == Limits::Ends::open_min || r.limits.ends == Limits::Ends::open;
  const bool open_max = r.limits.ends == Limits::Ends::open_max || r.limits.ends == Limits::Ends::open;
  if (std::isfinite(r.limits.min)) s[open_min ? "exclusiveMinimum" : "minimum"] = r.limits.min;
  if (std::isfinite(r.limits.max)) s[open_max ? "exclusiveMaximum" : "maximum"] = r.limits.max;
  return s;
}

// A number in SI, or a string with a unit.
json::object quantity_schema(const ParamRow& r) {
  return {{"anyOf", json::array{number_schema(r, "number"),
                                json::object{{"type", "string"}, {"pattern", "^\\s*[-+]?[0-9.]"}}}}};
}

json::object array_schema(json::object items, const Count& count) {
  return {{"type", "array"}, {"items", std::move(items)}, {"minItems", count.min}, {"maxItems", count.max}};
}

json::object row_schema(const ParamRow& r) {
  switch (r.kind) {
    case ParamKind::number:
      return quantity_schema(r);
    case ParamKind::integer:
      return number_schema(r, "integer");
    case ParamKind::boolean:
      return {{"type", "boolean"}};
    case ParamKind::text:
      return {{"type", "string"}, {"maxLength", 4096}};
    case ParamKind::choice:
      return {{"enum", json::array(r.choices.begin(), r.choices.end())}};
    case ParamKind::vector:
      return array_schema(quantity_schema(r), {3, 3});
    case ParamKind::numbers:
      return array_schema(quantity_schema(r), r.count);
    case ParamKind::integers:
      return array_schema(number_schema(r, "integer"), r.count);
    case ParamKind::vectors:
      return array_schema(array_schema(quantity_schema(r), {3, 3}), r.count);
    case ParamKind::texts:
      return array_schema({{"type", "string"}}, r.count);
    case ParamKind::object:
      return schema_of(*r.nested);
    case ParamKind::objects:
      return array_schema(schema_of(*r.nested), r.count);
    case ParamKind::variants: {
      json::array alternatives;
      for (const ParamVariant& v : r.variants) {
        json::object s = schema_of(*v.table);
        s["properties"].as_object()["type"] = json::object{{"const", v.type}};
        if (!s.contains("required")) s["required"] = json::array{};
        s["required"].as_array().insert(s["required"].as_array().begin(), json::value("type"));
        alternatives.push_back(std::move(s));
      }
      return array_schema({{"oneOf", std::move(alternatives)}}, r.count);
    }
  }
  return {};
}

constexpr const char* kKindNames[] = {"number", "integer", "boolean",  "string",  "choice",
                                      "vector", "numbers", "integers", "vectors", "strings",
                                      "object", "objects", "variants"};

}  // namespace

void read_params(const DefTable& table, void* owner, const json::object& object, const std::string& pointer,
                 std::span<const std::string_view> also_allowed, std::vector<Issue>& issues) {
  const size_t before = issues.size();
  Reader(issues).object(table, owner, object, pointer, also_allowed);
  // Checks across members make sense only when each member is good.
  if (table.check && issues.size() == before) {
    table.check(owner, [&](const std::string& suffix, const std::string& message) {
      issues.push_back({pointer + suffix, "inconsistent", message, "", "", "", ""});
    });
  }
}

json::object write_params(const DefTable& table, const void* owner) {
  json::object out;
  for (const ParamRow& r : table.rows) {
    switch (r.kind) {
      case ParamKind::object:
        if (r.size(owner)) out[r.name] = write_params(*r.nested, r.at(owner, 0));
        break;
      case ParamKind::objects: {
        json::array a;
        for (size_t i = 0; i < r.size(owner); ++i) a.push_back(write_params(*r.nested, r.at(owner, i)));
        out[r.name] = std::move(a);
        break;
      }
      case ParamKind::variants: {
        json::array a;
        for (size_t i = 0; i < r.size(owner); ++i) {
          for (const ParamVariant& v : r.variants) {
            if (const void* element = v.at(owner, i)) {
              json::object o{{"type", v.type}};
              for (auto& [key, value] : write_params(*v.table, element)) o[key] = std::move(value);
              a.push_back(std::move(o));
            }
          }
        }
        out[r.name] = std::move(a);
        break;
      }
      default: {
        json::value v = to_json(r.get(owner));
        if (!v.is_null()) out[r.name] = std::move(v);
      }
    }
  }
  return out;
}

json::object schema_of(const DefTable& table) {
  const auto defaults = table.make();
  const json::object values = write_params(table, defaults.get());
  json::object properties;
  json::array required;
  for (const ParamRow& r : table.rows) {
    json::object s = row_schema(r);
    s["description"] = r.sentence;
    if (!r.unit.empty()) s["x-unit"] = r.unit;
    const bool plain =
        r.kind != ParamKind::object && r.kind != ParamKind::objects && r.kind != ParamKind::variants;
    if (r.presence == Presence::required)
      required.emplace_back(r.name);
    else if (const json::value* v = values.if_contains(r.name); v && plain)
      s["default"] = *v;
    properties[r.name] = std::move(s);
  }
  json::object out{{"type", "object"},
                   {"description", table.sentence},
                   {"properties", std::move(properties)},
                   {"patternProperties", json::object{{"^x_", json::object{}}}},
                   {"additionalProperties", false}};
  if (!required.empty()) out["required"] = std::move(required);
  return out;
}

json::array describe_params(const DefTable& table) {
  const auto defaults = table.make();
  const json::object values = write_params(table, defaults.get());
  json::array rows;
  for (const ParamRow& r : table.rows) {
    json::object row{
        {"name", r.name}, {"kind", kKindNames[static_cast<size_t>(r.kind)]}, {"description", r.sentence}};
    if (!r.unit.empty()) row["unit"] = r.unit;
    if (r.presence == Presence::required) row["required"] = true;
    if (r.kind == ParamKind::number || r.kind == ParamKind::integer) row["allowed"] = limits_text(r.limits);
    if (!r.choices.empty()) row["choices"] = json::array(r.choices.begin(), r.choices.end());
    if (r.nested) row["parameters"] = describe_params(*r.nested);
    if (!r.variants.empty()) {
      json::object types;
      for (const ParamVariant& v : r.variants) types[v.type] = describe_params(*v.table);
      row["types"] = std::move(types);
    } else if (!r.nested && r.presence == Presence::optional) {
      if (const json::value* v = values.if_contains(r.name)) row["default"] = *v;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace truestep
