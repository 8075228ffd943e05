#include "engine/scene/json/json_habits.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace truestep {
namespace {

struct Word {
  std::string_view is, instead;
};
constexpr std::array kWords{
    Word{"NaN", "NaN is no JSON number: leave the value out"},
    Word{"nan", "NaN is no JSON number: leave the value out"},
    Word{"Infinity", "infinity is no JSON number: leave the limit out"},
    Word{"-Infinity", "infinity is no JSON number: leave the limit out"},
    Word{"inf", "infinity is no JSON number: leave the limit out"},
    Word{"-inf", "infinity is no JSON number: leave the limit out"},
    Word{"True", "JSON writes true"},
    Word{"False", "JSON writes false"},
    Word{"None", "JSON writes null"},
    Word{"undefined", "JSON writes null"},
};

bool of_a_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '$';
}

char last_printed(std::string_view text) {
  const auto it = std::find_if(text.rbegin(), text.rend(),
                               [](char c) { return std::isspace(static_cast<unsigned char>(c)) == 0; });
  return it == text.rend() ? '\0' : *it;
}

}  // namespace

std::string foreign_notation(std::string_view before, std::string_view at) {
  if (at.empty()) return {};
  if (at.starts_with("//") || at.starts_with("/*") || at[0] == '#')
    return "JSON has no comments: put the remark into \"description\", or take it out";
  const char last = last_printed(before);
  if ((at[0] == '}' || at[0] == ']') && last == ',')
    return std::string("a comma before ") + at[0] + ": take it out, JSON allows none after the last element";
  if (at[0] == '\'') return "JSON takes double quotes, not single ones";
  if (at.starts_with("\xE2\x80\x9C") || at.starts_with("\xE2\x80\x9D"))
    return "JSON takes straight double quotes, not typographic ones";
  const auto end = static_cast<size_t>(std::find_if_not(at.begin(), at.end(), of_a_word) - at.begin());
  const std::string_view word = at.substr(0, end);
  for (const Word& w : kWords) {
    if (word == w.is) return std::string(w.instead);
  }
  const bool digit_next = at.size() > 1 && std::isdigit(static_cast<unsigned char>(at[1])) != 0;
  if (at[0] == '+' && digit_next) return "a JSON number has no plus sign";
  if (at[0] == '.' && digit_next) return "a JSON number has a digit before its point: 0.5, not .5";
  if (at[0] == '=') return "JSON writes \"key\": value, with a colon";
  if ((last == '{' || last == ',') && !word.empty() &&
      std::isalpha(static_cast<unsigned char>(word[0])) != 0) {
    const size_t next = at.find_first_not_of(" \t", end);
    if (next != std::string_view::npos && at[next] == ':')
      return "a key stands in double quotes: \"" + std::string(word) + "\"";
  }
  return {};
}

}  // namespace truestep
