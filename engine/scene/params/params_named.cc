// Objects whose keys are names chosen by the user.
#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_reader.h"
#include "engine/scene/params/params_text.h"

namespace truestep {

namespace json = boost::json;

bool ParamReader::named_shape(const ParamRow& r, const json::value& v, const std::string& where) {
  if (!v.is_object()) {
    fault(where, "wrong_type", "expected an object", v, kind_text(r));
    return false;
  }
  const size_t n = v.as_object().size();
  if (n < r.count.min || n > r.count.max) {
    fault(where, n < r.count.min ? "too_few" : "too_many", "the number of names is outside the allowed range",
          v, std::to_string(r.count.min) + " to " + std::to_string(r.count.max) + " names");
    return false;
  }
  return true;
}

void ParamReader::named_numbers(const ParamRow& r, void* owner, const json::value& v,
                                const std::string& where) {
  if (!named_shape(r, v, where)) return;
  std::vector<NamedNumbers> out;
  bool good = true;
  for (const auto& [key, value] : v.as_object()) {
    const std::string at = where + "/" + pointer_token(key);
    NamedNumbers& entry = out.emplace_back(NamedNumbers{std::string(key), {}, NamedNumbers::Form::number});
    if (!value.is_array()) {
      good &= number(r, value, at, entry.values.emplace_back());
      continue;
    }
    entry.form = NamedNumbers::Form::array;
    const json::array& a = value.as_array();
    if (a.empty() || a.size() > kMaxNamedNumbers) {
      fault(at, a.empty() ? "too_few" : "too_many", "the number of elements is outside the allowed range",
            value, "1 to " + std::to_string(kMaxNamedNumbers) + " numbers");
      good = false;
      continue;
    }
    for (size_t i = 0; i < a.size(); ++i) {
      good &= number(r, a[i], at + "/" + std::to_string(i), entry.values.emplace_back());
    }
  }
  if (good) r.set(owner, ParamValue(std::move(out)));
}

void ParamReader::named_texts(const ParamRow& r, void* owner, const json::value& v,
                              const std::string& where) {
  if (!named_shape(r, v, where)) return;
  std::vector<NamedText> out;
  bool good = true;
  for (const auto& [key, value] : v.as_object()) {
    NamedText& entry = out.emplace_back(NamedText{std::string(key), ""});
    if (value.is_number()) {
      entry.text = write_json(value);
    } else {
      good &= text(r, value, where + "/" + pointer_token(key), entry.text);
    }
  }
  if (good) r.set(owner, ParamValue(std::move(out)));
}

}  // namespace truestep
