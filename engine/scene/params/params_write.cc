// A struct as JSON, by its table; reading it gives the same struct again. Lists that were not given are left
// out if an empty one would be refused.
#include "engine/scene/params/params.h"

namespace truestep {

namespace json = boost::json;

namespace {

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
        } else if constexpr (std::is_same_v<T, std::vector<NamedNumbers>>) {
          json::object o;
          for (const NamedNumbers& e : v) {
            if (e.form == NamedNumbers::Form::number) {
              o[e.name] = e.values[0];
            } else {
              o[e.name] = json::array(e.values.begin(), e.values.end());
            }
          }
          return o;
        } else if constexpr (std::is_same_v<T, std::vector<NamedText>>) {
          json::object o;
          for (const NamedText& e : v) o[e.name] = json::value(e.text);
          return o;
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

}  // namespace

json::object write_params(const DefTable& table, const void* owner) {
  json::object out;
  const auto put = [&out](const ParamRow& r, json::array a) {
    if (a.size() >= r.count.min) out[r.name] = std::move(a);
  };
  for (const ParamRow& r : table.rows) {
    switch (r.kind) {
      case ParamKind::object:
        if (r.size(owner)) out[r.name] = write_params(*r.nested, r.at(owner, 0));
        break;
      case ParamKind::objects: {
        json::array a;
        for (size_t i = 0; i < r.size(owner); ++i) a.push_back(write_params(*r.nested, r.at(owner, i)));
        put(r, std::move(a));
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
        put(r, std::move(a));
        break;
      }
      default: {
        json::value v = to_json(r.get(owner));
        if (v.is_array() && r.kind != ParamKind::vector) {
          put(r, std::move(v.as_array()));
        } else if (!v.is_null()) {
          out[r.name] = std::move(v);
        }
      }
    }
  }
  return out;
}

}  // namespace truestep
