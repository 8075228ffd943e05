// JSON Schema (2020-12) of a table.
// Source: JSON Schema: A Media Type for Describing JSON Documents, draft 2020-12.
#include <cmath>

#include "engine/scene/params/box_words.h"
#include "engine/scene/params/params.h"

namespace truestep {

namespace json = boost::json;

namespace {

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

json::object named_schema(json::object values, const Count& count) {
  return {{"type", "object"},
          {"additionalProperties", std::move(values)},
          {"minProperties", count.min},
          {"maxProperties", count.max}};
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
    case ParamKind::expression:
      return {{"type", json::array{"string", "number"}}, {"maxLength", 4096}};
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
        json::array words{json::value(v.type)};
        for (const std::string& word : v.also) words.push_back(json::value(word));
        s["properties"].as_object()["type"] =
            v.also.empty() ? json::object{{"const", v.type}} : json::object{{"enum", std::move(words)}};
        if (!s.contains("required")) s["required"] = json::array{};
        s["required"].as_array().insert(s["required"].as_array().begin(), json::value("type"));
        alternatives.push_back(std::move(s));
      }
      return array_schema({{"oneOf", std::move(alternatives)}}, r.count);
    }
    case ParamKind::named_numbers:
      return named_schema({{"anyOf", json::array{quantity_schema(r),
                                                 array_schema(quantity_schema(r), {1, kMaxNamedNumbers})}}},
                          r.count);
    case ParamKind::named_texts:
      return named_schema({{"type", json::array{"string", "number"}}, {"maxLength", 4096}}, r.count);
  }
  return {};
}

}  // namespace

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
    for (const std::string& word : r.also) {
      json::object old = s;
      old["description"] = "another word for " + r.name;
      old["deprecated"] = true;
      properties[word] = std::move(old);
    }
    properties[r.name] = std::move(s);
  }
  for (const std::string_view word : other_box_words(table)) {
    if (properties.contains(word)) continue;
    properties[word] = json::object{{"type", json::array{"array", "number", "string"}},
                                    {"description", "the box in another system's words"},
                                    {"deprecated", true}};
  }
  json::object out{{"type", "object"},
                   {"description", table.sentence},
                   {"properties", std::move(properties)},
                   {"patternProperties", json::object{{"^x_", json::object{}}}},
                   {"additionalProperties", false}};
  if (!required.empty()) out["required"] = std::move(required);
  return out;
}

}  // namespace truestep
