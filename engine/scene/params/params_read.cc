// Reads objects by their tables: keys, nested objects, variants; single values are in params_values.cc.
#include <algorithm>

#include "engine/base/interrupt.h"
#include "engine/scene/params/box_words.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_reader.h"
#include "engine/scene/params/params_text.h"

namespace truestep {

namespace json = boost::json;

void ParamReader::members(const DefTable& table, void* owner, const json::object& o,
                          const std::string& pointer, std::span<const std::string_view> also_allowed) {
  interruption_point();
  for (const auto& [key_view, value] : o) {
    const std::string key(key_view);
    // "x_..." belongs to the user, unless it is a parameter ("x_min" of a box's sides).
    if ((key.starts_with("x_") && !table.find(key)) ||
        std::find(also_allowed.begin(), also_allowed.end(), key) != also_allowed.end()) {
      continue;
    }
    const std::string where = pointer + "/" + pointer_token(key);
    if (const ParamRow* row = table.find(key)) {
      if (row->name != key && o.contains(row->name)) {
        fault(where, "unknown_key",
              "\"" + key + "\" is another word for \"" + row->name + "\", which is also given", value,
              row->name);
        continue;
      }
      this->row(*row, owner, value, where);
    } else if (full()) {
      fault(where, kUnknownKey, "", {}, "");
    } else {
      std::vector<std::string> names;
      for (const ParamRow& r : table.rows) names.push_back(r.name);
      for (const std::string_view k : also_allowed) names.emplace_back(k);
      fault(where, kUnknownKey, "\"" + key.substr(0, 64) + "\" is not a parameter here", value,
            join_names(names), "", nearest_name(key, names));
    }
  }
  for (const ParamRow& r : table.rows) {
    const bool given = o.contains(r.name) || std::any_of(r.also.begin(), r.also.end(),
                                                         [&](const auto& word) { return o.contains(word); });
    if (r.presence == Presence::required && !given) {
      fault(pointer + "/" + pointer_token(r.name), "missing", "\"" + r.name + "\" is required: " + r.sentence,
            {}, kind_text(r), r.unit);
    }
  }
}

template <class T, class ReadOne>
void ParamReader::array(const ParamRow& r, void* owner, const json::value& v, const std::string& where,
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

void ParamReader::row(const ParamRow& r, void* owner, const json::value& v, const std::string& where) {
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
    case ParamKind::expression:
    case ParamKind::text: {
      std::string s;
      if (text(r, v, where, s)) r.set(owner, std::move(s));
      return;
    }
    case ParamKind::named_numbers:
      return named_numbers(r, owner, v, where);
    case ParamKind::named_texts:
      return named_texts(r, owner, v, where);
    case ParamKind::choice:
      return choice(r, owner, v, where);
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
        object(*r.nested, r.append(owner), v.as_object(), where, {});
      else
        fault(where, "wrong_type", "expected an object", v, "an object");
      return;
    case ParamKind::objects:
      return objects(r, owner, v, where);
    case ParamKind::variants:
      if (!array_shape(r, v, where)) return;
      for (size_t i = 0; i < v.as_array().size(); ++i)
        variant(r, owner, v.as_array()[i], where + "/" + std::to_string(i));
      return;
  }
}

void ParamReader::choice(const ParamRow& r, void* owner, const json::value& v, const std::string& where) {
  std::string s;
  if (!text(r, v, where, s)) return;
  if (std::find(r.choices.begin(), r.choices.end(), s) == r.choices.end()) {
    fault(where, "unknown_choice", "not one of the choices", v, join_names(r.choices), "",
          nearest_name(s, r.choices));
  } else {
    r.set(owner, std::move(s));
  }
}

void ParamReader::objects(const ParamRow& r, void* owner, const json::value& v, const std::string& where) {
  if (!array_shape(r, v, where)) return;
  for (size_t i = 0; i < v.as_array().size(); ++i) {
    const json::value& e = v.as_array()[i];
    const std::string p = where + "/" + std::to_string(i);
    if (e.is_object())
      object(*r.nested, r.append(owner), e.as_object(), p, {});
    else
      fault(p, "wrong_type", "expected an object", e, "an object");
  }
}

void ParamReader::variant(const ParamRow& r, void* owner, const json::value& e, const std::string& where) {
  if (!e.is_object()) return fault(where, "wrong_type", "expected an object", e, kind_text(r));
  std::vector<std::string> types;
  for (const ParamVariant& alternative : r.variants) types.push_back(alternative.type);
  const json::value* type = e.as_object().if_contains("type");
  if (!type) return fault(where + "/type", "missing", "\"type\" is required", {}, join_names(types));
  if (type->is_string()) {
    for (const ParamVariant& alternative : r.variants) {
      const std::string_view word(type->as_string().data(), type->as_string().size());
      if (alternative.type == word || std::ranges::find(alternative.also, word) != alternative.also.end()) {
        constexpr std::string_view kType[] = {"type"};
        return object(*alternative.table, alternative.append(owner), e.as_object(), where, kType);
      }
    }
  }
  fault(where + "/type", "unknown_choice", "not one of the types", *type, join_names(types), "",
        type->is_string()
            ? nearest_name(std::string_view(type->as_string().data(), type->as_string().size()), types)
            : "");
}

namespace {

// The value below `o` that a relative pointer names, if any.
FoundValue found_at(const json::object& o, const std::string& pointer) {
  const json::value* v = nullptr;
  for (size_t at = 0; at < pointer.size();) {
    const size_t end = std::min(pointer.find('/', at + 1), pointer.size());
    const std::string token = pointer.substr(at + 1, end - at - 1);
    const json::object* object = at == 0 ? &o : v->if_object();
    const json::array* array = at == 0 ? nullptr : v->if_array();
    v = object ? object->if_contains(token) : nullptr;
    if (array && !token.empty() && token.find_first_not_of("0123456789") == std::string::npos &&
        token.size() < 9) {
      v = array->if_contains(std::stoul(token));
    }
    if (!v) return {};
    at = end;
  }
  return v ? FoundValue(*v) : FoundValue();
}

}  // namespace

void ParamReader::object(const DefTable& table, void* owner, const json::object& o,
                         const std::string& pointer, std::span<const std::string_view> also_allowed) {
  const size_t before = bad_members_;
  const auto own_words = box_in_own_words(table, o);
  members(table, owner, own_words ? *own_words : o, pointer, also_allowed);
  // Checks across members make sense only when each member is good.
  if (!table.check || bad_members_ != before) return;
  table.check(owner, [&](const std::string& suffix, const std::string& message) {
    fault(pointer + suffix, "inconsistent", message, found_at(o, suffix), "");
  });
}

Reading read_params(const DefTable& table, void* owner, const json::object& object,
                    const std::string& pointer, std::span<const std::string_view> also_allowed,
                    std::vector<Issue>& issues) {
  ParamReader reader(issues);
  reader.object(table, owner, object, pointer, also_allowed);
  return reader.reading();
}

}  // namespace truestep
