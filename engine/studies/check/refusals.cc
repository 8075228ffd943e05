#include "engine/studies/check/refusals.h"

#include <algorithm>

namespace truestep {

std::vector<Issue> faults_of(const Error& e) {
  if (!e.issues().empty()) return e.issues();
  return {{"", e.code(), e.what(), "", "", "", ""}};
}

std::string described(const Issue& i) {
  std::string out = i.code;
  if (!i.did_you_mean.empty()) out += ", " + i.did_you_mean;
  out += " at " + i.pointer + ": " + i.message;
  if (!i.value.empty()) out += ", " + i.value;
  if (!i.allowed.empty()) out += ", allowed: " + i.allowed;
  return out;
}

std::string described(const TestRefusal& r) {
  std::string out;
  for (const std::string* text : {&r.pointer, &r.code, &r.did_you_mean, &r.says}) {
    if (!text->empty()) out += (out.empty() ? "" : ", ") + *text;
  }
  return out;
}

bool is_fault(const Issue& found, const TestRefusal& wanted) {
  const auto is = [](const std::string& text, const std::string& other) {
    return text.empty() || text == other;
  };
  const auto in = [&](const std::string& text) { return text.find(wanted.says) != std::string::npos; };
  return is(wanted.code, found.code) && is(wanted.pointer, found.pointer) &&
         is(wanted.did_you_mean, found.did_you_mean) &&
         (in(found.message) || in(found.value) || in(found.allowed));
}

std::optional<Issue> other_fault(const std::vector<Issue>& found, const TestRefusal& wanted) {
  const auto at =
      std::find_if(found.begin(), found.end(), [&](const Issue& i) { return !is_fault(i, wanted); });
  return at == found.end() ? std::nullopt : std::optional<Issue>(*at);
}

std::string differing_faults(const std::vector<Issue>& found, const std::vector<TestRefusal>& wanted) {
  std::vector<Issue> left = found;
  for (const TestRefusal& w : wanted) {
    const auto at = std::find_if(left.begin(), left.end(), [&](const Issue& i) { return is_fault(i, w); });
    if (at == left.end()) return "no fault is " + described(w);
    left.erase(at);
  }
  return left.empty() ? "" : "there is another fault: " + described(left[0]);
}

}  // namespace truestep
