// Single values: numbers with units, integers, vectors, texts, and the length of arrays.
#include <cmath>

#include "engine/scene/json/json_write.h"
#include "engine/scene/params/params.h"
#include "engine/scene/params/params_reader.h"
#include "engine/scene/params/params_text.h"
#include "engine/scene/units.h"

namespace truestep {

namespace json = boost::json;

namespace {

bool within(const Limits& l, double v) {
  const bool open_min = l.ends == Limits::Ends::open_min || l.ends == Limits::Ends::open;
  const bool open_max = l.ends == Limits::Ends::open_max || l.ends == Limits::Ends::open;
  return (open_min ? v > l.min : v >= l.min) && (open_max ? v < l.max : v <= l.max);
}

}  // namespace

void ParamReader::fault(const std::string& pointer, std::string_view code, const std::string& message,
                        const FoundValue& found, const std::string& allowed, const std::string& unit,
                        const std::string& did_you_mean) {
  if (code != kUnknownKey) ++bad_members_;
  if (!full()) {
    issues_.push_back({pointer, std::string(code), message, found.text, allowed, did_you_mean, unit});
  } else if (issues_.size() == kMostFaults) {
    issues_.push_back({pointer, "more_faults", "this fault and what follows are not listed", "", "", "", ""});
  }
}

bool ParamReader::number(const ParamRow& r, const json::value& v, const std::string& where, double& out) {
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
    fault(where, "out_of_range", "the value is outside the allowed range", v, limits_text(r.limits), r.unit);
    return false;
  }
  return true;
}

bool ParamReader::integer(const ParamRow& r, const json::value& v, const std::string& where, int64_t& out) {
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

bool ParamReader::vector(const ParamRow& r, const json::value& v, const std::string& where, Vec3& out) {
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

bool ParamReader::text(const ParamRow& r, const json::value& v, const std::string& where, std::string& out) {
  if (r.kind == ParamKind::expression && v.is_number()) {
    out = write_json(v);
    return true;
  }
  if (!v.is_string()) {
    const bool expression = r.kind == ParamKind::expression;
    fault(where, "wrong_type", expression ? "expected a number or a string" : "expected a string", v,
          kind_text(r));
    return false;
  }
  if (v.as_string().size() > 4096) {
    fault(where, "too_long", "the string is too long", v, "at most 4096 bytes");
    return false;
  }
  out.assign(v.as_string().begin(), v.as_string().end());
  return true;
}

bool ParamReader::array_shape(const ParamRow& r, const json::value& v, const std::string& where) {
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

}  // namespace truestep
