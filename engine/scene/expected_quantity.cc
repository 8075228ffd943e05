#include "engine/scene/expected_quantity.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "engine/math/expression/names.h"

namespace truestep {

namespace {

constexpr std::pair<std::string_view, Reduction> kReductions[] = {
    {"start", Reduction::start}, {"min", Reduction::min},         {"max", Reduction::max},
    {"mean", Reduction::mean},   {"largest", Reduction::largest}, {"change", Reduction::change},
    {"drift", Reduction::drift},
};

bool letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) || c == '_';
}
bool in_name(char c) {
  return letter(c) || std::isdigit(static_cast<unsigned char>(c)) || c == '.';
}

bool is_name(const std::string& text) {
  return !text.empty() && letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return in_name(c) || c == '-'; });
}

std::string trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(' ');
  return first == text.npos ? "" : std::string(text.substr(first, text.find_last_not_of(' ') - first + 1));
}

/// Where the number that starts at `at` ends.
size_t number_end(const std::string& text, size_t at) {
  while (at < text.size() && (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.')) ++at;
  if (at + 1 >= text.size() || (text[at] != 'e' && text[at] != 'E')) return at;
  size_t digits = at + 1 + (text[at + 1] == '-' || text[at + 1] == '+');
  if (digits >= text.size() || !std::isdigit(static_cast<unsigned char>(text[digits]))) return at;
  while (digits < text.size() && std::isdigit(static_cast<unsigned char>(text[digits]))) ++digits;
  return digits;
}

/// The argument of the call whose bracket opens at `open`: its end, and whether it is the only one.
struct Argument {
  size_t end = 0;
  bool only = true;
};
Argument argument(const std::string& text, size_t open) {
  Argument a;
  int depth = 0;
  for (a.end = open; a.end < text.size(); ++a.end) {
    if (text[a.end] == '(') ++depth;
    if (text[a.end] == ')' && --depth == 0) return a;
    if (text[a.end] == ',' && depth == 1) a.only = false;
  }
  throw ExpressionFault{open, "this bracket is never closed", ""};
}

/// Copies a text with its observables, and calls that `call` accepts, replaced by q0, q1 ...
template <class Value, class Call>
std::string replaced(const std::string& text, Value value, Call call) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    size_t end = at + 1;
    if (std::isdigit(static_cast<unsigned char>(text[at])) || text[at] == '.') {
      out.append(text, at, (end = number_end(text, at)) - at);
    } else if (letter(text[at])) {
      while (end < text.size() && in_name(text[end])) ++end;
      const std::string name = text.substr(at, end - at);
      const size_t open = text.find_first_not_of(' ', end);
      if (open != text.npos && text[open] == '(') {
        const Argument a = argument(text, open);
        if (const auto number = call(name, trimmed(text.substr(open + 1, a.end - open - 1)), a.only, at)) {
          out += 'q' + std::to_string(*number);
          end = a.end + 1;
        } else {
          out += name;
        }
      } else {
        out += name == "t" || name == "pi" ? name : 'q' + std::to_string(value(name));
      }
    } else {
      out += text[at];
    }
    at = end;
  }
  return out;
}

/// A text over q0 ... q(count - 1) and t.
ExpressionProgram compiled(const std::string& text, size_t count) {
  ExpressionGraph graph;
  ExpressionNames names;
  for (size_t i = 0; i < count; ++i)
    names.add_value('q' + std::to_string(i), graph.variable(static_cast<int32_t>(i)));
  names.add_value("t", graph.variable(static_cast<int32_t>(count)));
  const ExpressionGraph::Node root[] = {names.require(graph, text)};
  return {graph, root, count + 1};
}

double evaluated(const ExpressionProgram& program, const std::vector<double>& values, double t) {
  std::vector<double> registers(program.registers());
  program.start(registers.data());
  std::copy(values.begin(), values.end(), registers.begin());
  registers[values.size()] = t;
  double out = 0;
  program.run(registers.data(), &out);
  return out;
}

}  // namespace

QuantityTerm::QuantityTerm(const std::string& text) {
  if (is_name(text) && text != "t" && text != "pi") {
    names_ = {text};
    return;
  }
  const auto number_of = [this](const std::string& name) {
    const auto at = std::find(names_.begin(), names_.end(), name);
    if (at != names_.end()) return static_cast<size_t>(at - names_.begin());
    names_.push_back(name);
    return names_.size() - 1;
  };
  const std::string plain = replaced(text, number_of, [](auto&&...) { return std::optional<size_t>(); });
  program_ = compiled(plain, names_.size());
}

std::optional<double> QuantityTerm::value(const Observables& values, double t) const {
  if (plain()) return values.find(names_[0]);
  std::vector<double> found;
  for (const std::string& name : names_) {
    const auto v = values.find(name);
    if (!v) return std::nullopt;
    found.push_back(*v);
  }
  return evaluated(*program_, found, t);
}

ExpectedQuantity::ExpectedQuantity(const std::string& given) {
  const std::string text = given == "energy.drift" ? "drift(energy.total)" : trimmed(given);
  const auto track = [this](Reduction reduction, const std::string& of) {
    tracks_.push_back({reduction, QuantityTerm(of)});
    return tracks_.size() - 1;
  };
  const auto value = [&](const std::string& name) {
    if (name == "energy.gain") return track(Reduction::gain, "energy.total");
    if (name == "energy.loss") return track(Reduction::loss, "energy.total");
    return track(Reduction::last, name);
  };
  if (is_name(text) && text != "t" && text != "pi") {
    value(text);
    return;
  }
  const std::string outer =
      replaced(text, value, [&](const std::string& name, const std::string& of, bool only, size_t at) {
        const auto row = std::find_if(std::begin(kReductions), std::end(kReductions),
                                      [&](const auto& r) { return r.first == name; });
        if (row == std::end(kReductions) || !only) return std::optional<size_t>();
        const size_t number = track(row->second, of);
        if (row->second == Reduction::drift && !tracks_[number].term.plain())
          throw ExpressionFault{at, "drift takes one observable; change(...) takes an expression", "change"};
        return std::optional<size_t>(number);
      });
  if (outer != "q0") program_ = compiled(outer, tracks_.size());
}

std::optional<Reduction> ExpectedQuantity::only() const {
  return program_ ? std::nullopt : std::optional(tracks_[0].reduction);
}

double ExpectedQuantity::combine(const std::vector<double>& tracks, double t) const {
  return program_ ? evaluated(*program_, tracks, t) : tracks[0];
}

}  // namespace truestep
