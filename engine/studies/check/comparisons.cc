// Runs of a scene test beside each other: the same bits, the same values, errors that fall as they should.
#include "engine/studies/check/comparisons.h"

#include <algorithm>
#include <cmath>

#include "engine/base/hash.h"
#include "engine/scene/json/json_write.h"
#include "engine/studies/check/scene_check.h"

namespace truestep {

namespace json = boost::json;

bool keeps_bits(const std::string& axis) {
  return axis == "threads" || axis == "resumed" || axis == "scratch";
}

std::optional<double> measured(const TrialResult& r, const std::string& quantity) {
  for (const Verdict& v : r.verdicts) {
    if (v.expected.quantity == quantity) return v.measured;
  }
  return std::nullopt;
}

std::string number(double x) {
  return write_json(json::value(x));
}

// Runs of a case (and control) that differ only in one axis, in groups.
std::vector<std::vector<const SceneCheck::Run*>> SceneCheck::groups(size_t axis, size_t of_case,
                                                                    std::optional<size_t> control) const {
  std::vector<std::vector<const Run*>> out;
  const auto alike = [axis](const Run& a, const Run& b) {
    for (size_t k = 0; k < a.at.size(); ++k) {
      if (k != axis && a.at[k] != b.at[k]) return false;
    }
    return true;
  };
  for (const Run& run : runs_) {
    if (run.of_case != of_case || run.control != control || run.result.refusal) continue;
    const auto group = std::find_if(out.begin(), out.end(), [&](const auto& g) { return alike(*g[0], run); });
    if (group == out.end()) {
      out.push_back({&run});
    } else {
      group->push_back(&run);
    }
  }
  return out;
}

void SceneCheck::compare(size_t of_case, std::optional<size_t> control,
                         std::vector<CheckFinding>& out) const {
  for (size_t axis = 0; axis < test_.vary.size(); ++axis) {
    const std::string& name = test_.vary[axis].name;
    if (!changes_no_bit(name)) continue;
    for (const auto& group : groups(axis, of_case, control)) {
      for (const Run* run : group) {
        if (run->result.hash == group[0]->result.hash) continue;
        out.push_back({run->label, kSame, std::nullopt, "the same bits for every " + name,
                       hex64(run->result.hash) + ", not " + hex64(group[0]->result.hash)});
      }
    }
  }
  for (const TestAgreement& a : test_.agree) {
    const auto axis = std::find_if(test_.vary.begin(), test_.vary.end(),
                                   [&](const TestAxis& x) { return x.name == a.over; });
    for (const auto& group : groups(static_cast<size_t>(axis - test_.vary.begin()), of_case, control)) {
      if (a.order) {
        compare_order(a, group, out);
        continue;
      }
      double least = INFINITY, most = -INFINITY;
      for (const Run* run : group) {
        const double v = measured(run->result, a.quantity).value_or(NAN);
        if (!(std::abs(v) < INFINITY)) least = -INFINITY;
        least = std::min(least, v), most = std::max(most, v);
      }
      if (!(most - least <= a.tolerance))
        out.push_back({group[0]->label, kAgree, most - least, "at most " + number(a.tolerance),
                       a.quantity + " differs over " + a.over});
    }
  }
}

// From each run to the next of a group.
void SceneCheck::compare_order(const TestAgreement& a, const std::vector<const Run*>& group,
                               std::vector<CheckFinding>& out) const {
  const auto axis =
      std::find_if(test_.vary.begin(), test_.vary.end(), [&](const TestAxis& x) { return x.name == a.over; });
  const auto at = static_cast<size_t>(axis - test_.vary.begin());
  const auto over = [&](const Run& run) {
    const json::value& v = axis->steps[run.at[at]].value;
    return v.is_number() ? v.to_number<double>() : NAN;
  };
  for (size_t k = 1; k < group.size(); ++k) {
    const auto of = [&](size_t i) { return measured(group[i]->result, a.quantity).value_or(NAN); };
    const double order = std::log(of(k) / of(k - 1)) / std::log(over(*group[k]) / over(*group[k - 1]));
    if (std::abs(order - *a.order) <= a.tolerance) continue;
    out.push_back({group[k]->label, kAgree, order, number(*a.order) + " +- " + number(a.tolerance),
                   a.quantity + " grows as another power of " + a.over});
  }
}

}  // namespace truestep
