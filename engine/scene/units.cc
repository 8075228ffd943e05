#include "engine/scene/units.h"

#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

namespace truestep {

namespace {

struct NamedUnit {
  std::string_view name;
  Unit unit;
  enum class Prefix { no, yes } prefix;
};

constexpr auto kNo = NamedUnit::Prefix::no;
constexpr auto kYes = NamedUnit::Prefix::yes;
constexpr double kPi = std::numbers::pi;

// A longer name must come first only if a shorter one with a prefix reads the same ("min" against m-in,
// "deg").
const NamedUnit kUnits[] = {
    {"1", {1, {}}, kNo},
    {"rad", {1, {}}, kYes},
    {"deg", {kPi / 180, {}}, kNo},
    {"rev", {2 * kPi, {}}, kNo},
    {"rpm", {2 * kPi / 60, {0, 0, -1, 0, 0}}, kNo},
    {"%", {0.01, {}}, kNo},
    {"min", {60, {0, 0, 1, 0, 0}}, kNo},
    {"h", {3600, {0, 0, 1, 0, 0}}, kNo},
    {"s", {1, {0, 0, 1, 0, 0}}, kYes},
    {"Hz", {1, {0, 0, -1, 0, 0}}, kYes},
    {"m", {1, {0, 1, 0, 0, 0}}, kYes},
    {"in", {0.0254, {0, 1, 0, 0, 0}}, kNo},
    {"ft", {0.3048, {0, 1, 0, 0, 0}}, kNo},
    {"g", {1e-3, {1, 0, 0, 0, 0}}, kYes},
    {"t", {1e3, {1, 0, 0, 0, 0}}, kNo},
    {"N", {1, {1, 1, -2, 0, 0}}, kYes},
    {"Pa", {1, {1, -1, -2, 0, 0}}, kYes},
    {"bar", {1e5, {1, -1, -2, 0, 0}}, kYes},
    {"J", {1, {1, 2, -2, 0, 0}}, kYes},
    {"W", {1, {1, 2, -3, 0, 0}}, kYes},
    {"L", {1e-3, {0, 3, 0, 0, 0}}, kYes},
    {"A", {1, {0, 0, 0, 1, 0}}, kYes},
    {"C", {1, {0, 0, 1, 1, 0}}, kYes},
    {"V", {1, {1, 2, -3, -1, 0}}, kYes},
    {"T", {1, {1, 0, -2, -1, 0}}, kYes},
    {"K", {1, {0, 0, 0, 0, 1}}, kYes},
};

const std::pair<std::string_view, double> kPrefixes[] = {{"G", 1e9},  {"M", 1e6},  {"k", 1e3},
                                                         {"d", 1e-1}, {"c", 1e-2}, {"m", 1e-3},
                                                         {"u", 1e-6}, {"µ", 1e-6}, {"n", 1e-9}};

std::optional<Unit> named(std::string_view name) {
  for (const NamedUnit& u : kUnits) {
    if (u.name == name) return u.unit;
  }
  for (const auto& [prefix, factor] : kPrefixes) {
    if (!name.starts_with(prefix)) continue;
    for (const NamedUnit& u : kUnits) {
      if (u.prefix == kYes && u.name == name.substr(prefix.size())) {
        return Unit{u.unit.factor * factor, u.unit.powers};
      }
    }
  }
  return std::nullopt;
}

std::string_view trim(std::string_view s) {
  while (!s.empty() && s.front() == ' ') s.remove_prefix(1);
  while (!s.empty() && s.back() == ' ') s.remove_suffix(1);
  return s;
}

// One "name" or "name^power", multiplied into `unit` (divided when sign is -1).
bool multiply_factor(std::string_view factor, int sign, Unit& unit) {
  int power = 1;
  if (const auto caret = factor.find('^'); caret != std::string_view::npos) {
    const std::string_view digits = factor.substr(caret + 1);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), power);
    if (error != std::errc() || end != digits.data() + digits.size() || std::abs(power) > 9) return false;
    factor = factor.substr(0, caret);
  }
  const auto one = named(factor);
  if (!one) return false;
  for (int k = 0; k < std::abs(power); ++k) {
    if (sign * power > 0)
      unit.factor *= one->factor;
    else
      unit.factor /= one->factor;
  }
  for (size_t i = 0; i < unit.powers.size(); ++i) unit.powers[i] += sign * power * one->powers[i];
  return true;
}

}  // namespace

std::optional<Unit> parse_unit(std::string_view text) {
  text = trim(text);
  Unit unit;
  int sign = 1;
  if (text.empty() || text.size() > 64) return std::nullopt;
  while (true) {
    const size_t end = text.find_first_of(" */");
    const std::string_view factor = text.substr(0, end);
    if (factor.empty() || !multiply_factor(factor, sign, unit)) return std::nullopt;
    if (end == std::string_view::npos) return unit;
    // A slash divides only by the next factor: "N/m s" is (N/m) s, and N/(m s) is written "N/m/s".
    std::string_view rest = trim(text.substr(end));
    sign = 1;
    if (rest.front() == '/' || rest.front() == '*') {
      sign = rest.front() == '/' ? -1 : 1;
      rest = trim(rest.substr(1));
    }
    if (rest.empty()) return std::nullopt;
    text = rest;
  }
}

Quantity parse_quantity(std::string_view text, std::string_view si_unit) {
  text = trim(text);
  double number = 0;
  const char* begin = text.data();
  const char* end = begin + text.size();
  const auto [after, error] = std::from_chars(begin, end, number);
  if (error != std::errc() || !std::isfinite(number)) {
    return {std::nullopt,
            "a quantity must be a number followed by a unit, such as \"1 " + std::string(si_unit) + '"'};
  }
  const std::string_view rest = trim({after, static_cast<size_t>(end - after)});
  const auto wanted = parse_unit(si_unit.empty() ? "1" : si_unit);
  const auto given = parse_unit(rest.empty() ? "1" : rest);
  if (!given) return {std::nullopt, "unknown unit \"" + std::string(rest) + '"'};
  if (!wanted || given->powers != wanted->powers) {
    return {std::nullopt, rest.empty()
                              ? "the quantity has no unit"
                              : "\"" + std::string(rest) + "\" does not fit the dimension of this parameter"};
  }
  const double si = number * given->factor;
  if (!std::isfinite(si)) return {std::nullopt, "the quantity is too large"};
  return {si, ""};
}

}  // namespace truestep
